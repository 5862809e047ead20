//! `summary.json`: every number of a comparison, for programs.
//!
//! Keys stand in the order of the fields below. Values are in the unit of the stored values (1 = full intensity) unless
//! their name says otherwise; lists of three are red, green, blue. All numbers are finite.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use rastray_compare::{Metrics as Measured, StepSummary};

/// The whole file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// The traced picture (test) against the rasterized one (reference), 8-bit values as fractions of 255.
    pub metrics: Metrics,
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

/// See `rastray_compare` for what each number means and when it misleads.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Metrics {
    /// Mean squared error.
    pub mse: f64,
    /// Its root.
    pub rmse: f64,
    /// Mean absolute error.
    pub mae: f64,
    /// Largest absolute error.
    pub max: f64,
    /// Median absolute error of a value.
    pub p50: f64,
    /// 95th percentile.
    pub p95: f64,
    /// 99th percentile.
    pub p99: f64,
    /// In dB; null when identical.
    pub psnr: Option<f64>,
}

impl From<Measured> for Metrics {
    fn from(m: Measured) -> Self {
        let Measured {
            mse,
            rmse,
            mae,
            max,
            p50,
            p95,
            p99,
            psnr,
        } = m;
        Self {
            mse,
            rmse,
            mae,
            max,
            p50,
            p95,
            p99,
            psnr,
        }
    }
}

/// Rungs 3 and 4: per-fragment rasterization and primary rays on the same triangles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Agreement {
    /// Largest difference relative to max(1, magnitude), away from triangle edges and discontinuities of the model.
    pub interior_max: f64,
    /// Mean of the same.
    pub interior_mean: f64,
    /// Pixels left out because they lie at an edge or discontinuity.
    pub edge_pixels: usize,
    /// Which renderer sees a surface where.
    pub coverage: Coverage,
}

/// Pixels with a surface at their centre.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Coverage {
    /// In both renderers.
    pub both: usize,
    /// Only in the rasterizer.
    pub raster_only: usize,
    /// Only in the tracer.
    pub trace_only: usize,
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
    /// The file's text: indented, keys in order, a newline at the end.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

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
            },
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
        let expected = "size metrics agreement causes residual_max limited_pixels counters seconds";
        assert_eq!(keys.join(" "), expected);
        let keys = |v: &Value| {
            v.as_object()
                .unwrap()
                .keys()
                .cloned()
                .collect::<Vec<_>>()
                .join(" ")
        };
        assert_eq!(keys(&value["metrics"]), "mse rmse mae max p50 p95 p99 psnr");
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
    fn it_comes_back_number_for_number() {
        let mut summary = example();
        summary.metrics.psnr = None;
        summary.metrics.mse = 0.1 + 0.2;
        let json = summary.to_json().unwrap();
        assert!(json.contains("\"psnr\": null"));
        assert_eq!(serde_json::from_str::<Summary>(&json).unwrap(), summary);
    }
}
