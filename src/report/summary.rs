//! `summary.json`: every number of a comparison, for programs.
//!
//! Keys stand in the order of the fields below. Values are in the unit of the stored values (1 = full intensity) unless
//! their name says otherwise; lists of three are red, green, blue. All numbers are finite.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

pub use rastray_compare::{FlipSummary, Metrics};

use rastray_compare::StepSummary;

use super::numbers::value;
use crate::decompose::Agreement;

/// The whole file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// The traced picture (test) against the rasterized one (reference), 8-bit values as fractions of 255. See
    /// `rastray_compare` for what each number means and when it misleads.
    pub metrics: Metrics,
    /// The same within one pixel of a change of object, or where the renderers see different objects; null where there is
    /// no such pixel.
    pub silhouette: Option<Metrics>,
    /// The same of the other pixels; null where there are none.
    pub interior: Option<Metrics>,
    /// How well the two renderers agree where they compute the same thing (rungs 3 and 4).
    pub agreement: Agreement,
    /// The steps of the ladder, in ladder order: the order is part of the answer.
    pub causes: Vec<Cause>,
    /// Largest magnitude of the total difference minus the sum of the causes: 0.
    pub residual_max: f64,
    /// Pixels whose values had to be limited for the sums to be exact.
    pub limited_pixels: usize,
    /// Work counts of both renderers, as they report them.
    pub counters: Map<String, Value>,
    /// Wall-clock seconds by phase.
    pub seconds: Map<String, Value>,
}

/// One step of the ladder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cause {
    /// quantization, clamping, interpolation, coverage, tessellation, shadow, reflection, refraction or display.
    pub name: String,
    /// Root mean square of the step over all values.
    pub rmse: f64,
    /// Largest magnitude of the step.
    pub max: f64,
    /// Pixels that it changes at all.
    pub pixels: usize,
    /// Sum of the step over all pixels, signed.
    pub sum: [f64; 3],
}

impl Cause {
    /// A cause with the numbers of its step.
    pub fn new(name: impl Into<String>, step: &StepSummary) -> Self {
        let StepSummary {
            rmse,
            max,
            pixels,
            sum,
        } = *step;
        Self {
            name: name.into(),
            rmse,
            max,
            pixels,
            sum,
        }
    }
}

impl Summary {
    /// What the numbers that model a viewer say, and where the error sits, in lines for a terminal.
    pub fn as_seen(&self) -> String {
        let m = &self.metrics;
        let ssim = m.ssim.map_or(String::new(), |ssim| {
            format!("SSIM {} (1 = the same structure), ", value(ssim))
        });
        let part = |name: &str, part: &Option<Metrics>| {
            part.map(|m| format!("{name} rmse {}, FLIP {}", value(m.rmse), value(m.flip.mean)))
        };
        let parts = [
            part("at silhouettes", &self.silhouette),
            part("elsewhere", &self.interior),
        ];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        format!(
            "as seen: {ssim}FLIP {} on average (0 = nothing to see, 1 = green against blue)\n  {}",
            value(m.flip.mean),
            parts.join("; ")
        )
    }

    /// The file's text: indented, keys in order, a newline at the end.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::decompose::Coverage;

    pub(in crate::report) fn example() -> Summary {
        let names = [
            "quantization",
            "clamping",
            "interpolation",
            "coverage",
            "tessellation",
        ];
        let names = names
            .into_iter()
            .chain(["shadow", "reflection", "refraction", "display"]);
        let causes = names.enumerate().map(|(i, name)| {
            let pixels = if name == "clamping" {
                0
            } else {
                12_345 * (i + 1)
            };
            let size = if pixels == 0 {
                0.0
            } else {
                0.1 / (1.0 + i as f64)
            };
            Cause {
                name: name.into(),
                rmse: size,
                max: 2.0 * size,
                pixels,
                sum: [size, -size, 0.1],
            }
        });
        let object = |json: &str| serde_json::from_str(json).unwrap();
        Summary {
            size: [640, 480],
            metrics: Metrics {
                mse: 0.01,
                rmse: 0.1,
                mae: 0.05,
                max: 0.75,
                p50: 0.0,
                p95: 0.3,
                p99: 0.6,
                psnr: Some(20.0),
                ssim: Some(0.9),
                flip: FlipSummary {
                    mean: 0.07,
                    median: 0.01,
                    max: 0.8,
                },
            },
            silhouette: None,
            interior: None,
            agreement: Agreement {
                interior_max: 3.1e-7,
                interior_mean: 1.2e-8,
                edge_pixels: 2345,
                coverage: Coverage {
                    both: 200_000,
                    raster_only: 3,
                    trace_only: 1,
                },
            },
            causes: causes.collect(),
            residual_max: 0.0,
            limited_pixels: 0,
            counters: object(
                r#"{"raster": {"triangles": 8192, "fragments": 260000}, "rays": {"primary": 307200, "shadow": 412345}}"#,
            ),
            seconds: object(r#"{"raster": 0.0123, "trace": 0.482, "total": 1.9}"#),
        }
    }

    #[test]
    fn keys_stand_in_the_stated_order() {
        let json = example().to_json().unwrap();
        let value: Map<String, Value> = serde_json::from_str(&json).unwrap();
        let keys: Vec<&str> = value.keys().map(String::as_str).collect();
        let expected = "size metrics silhouette interior agreement causes residual_max limited_pixels counters seconds";
        assert_eq!(keys.join(" "), expected);
        let keys = |v: &Value| {
            v.as_object()
                .unwrap()
                .keys()
                .cloned()
                .collect::<Vec<_>>()
                .join(" ")
        };
        assert_eq!(
            keys(&value["metrics"]),
            "mse rmse mae max p50 p95 p99 psnr ssim flip"
        );
        assert_eq!(keys(&value["metrics"]["flip"]), "mean median max");
        assert!(value["silhouette"].is_null());
        assert_eq!(
            keys(&value["agreement"]),
            "interior_max interior_mean edge_pixels coverage"
        );
        assert_eq!(
            keys(&value["agreement"]["coverage"]),
            "both raster_only trace_only"
        );
        assert_eq!(keys(&value["causes"][0]), "name rmse max pixels sum");
        assert_eq!(keys(&value["counters"]), "raster rays");
    }

    #[test]
    fn what_is_seen_is_said() {
        let mut summary = example();
        summary.interior = Some(summary.metrics);
        assert_eq!(
            summary.as_seen(),
            "as seen: SSIM 0.9 (1 = the same structure), FLIP 0.07 on average (0 = nothing to see, 1 = green against blue)\n  \
             elsewhere rmse 0.1, FLIP 0.07"
        );
    }

    #[test]
    fn it_comes_back_number_for_number() {
        let mut summary = example();
        summary.silhouette = Some(summary.metrics);
        summary.metrics.psnr = None;
        summary.metrics.ssim = None;
        summary.metrics.mse = 0.1 + 0.2;
        let json = summary.to_json().unwrap();
        assert!(json.contains("\"psnr\": null"));
        assert_eq!(serde_json::from_str::<Summary>(&json).unwrap(), summary);
    }
}
