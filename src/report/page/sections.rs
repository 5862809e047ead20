//! The page's sections that are mostly words and tables: the verdict, causes, agreement, numbers, work, origin.

use maud::{Markup, html};
use serde_json::{Map as Object, Value};

use super::parts::{label, legend, map_overview};
use super::{Live, Report};
use crate::error::Error;
use crate::report::causes::{explanation, figures};
use crate::report::equation::Term;
use crate::report::numbers::{count, duration, percent, value};
use crate::report::summary::{Metrics, Summary};

/// The result in a sentence or two.
pub(super) fn verdict(report: &Report) -> String {
    let differ = report.difference.summary.pixels;
    if differ == 0 {
        return "The two pictures are identical: this scene needs nothing that local lighting lacks.".to_owned();
    }
    let m = &report.summary.metrics;
    let psnr = m
        .psnr
        .map_or(String::new(), |p| format!(", PSNR {p:.1} dB"));
    let largest = report
        .summary
        .causes
        .iter()
        .max_by(|a, b| a.rmse.total_cmp(&b.rmse));
    let cause = largest.filter(|c| c.rmse > 0.0).map_or(String::new(), |c| {
        format!(
            " The largest cause is {}, with an rmse of {}.",
            c.name,
            value(c.rmse)
        )
    });
    format!(
        "{} of {} pixels ({}) differ between the rasterized and the traced picture, rmse {}{psnr}.{cause}",
        count(differ),
        count(report.pixels()),
        percent(differ, report.pixels()),
        value(m.rmse),
    )
}

/// What each cause is, with its numbers.
pub(super) fn explanations(summary: &Summary, pixels: usize) -> Markup {
    html! {
        section.explanations {
            h2 { "What each cause is" }
            dl {
                @for (i, cause) in summary.causes.iter().enumerate() {
                    @let known = explanation(&cause.name);
                    dt { span.number { (i + 1) } (cause.name)
                        @if let Some(term) = Term::of_name(&cause.name) { " " span.symbol { (label(term)) } } }
                    dd {
                        @if let Some(known) = known { (capital(known.step)) ". " (known.text) " " }
                        span.result { (capital(&figures(cause, pixels))) }
                    }
                }
            }
        }
    }
}

/// The sentence with a capital.
pub(in crate::report) fn capital(text: &str) -> String {
    let mut chars = text.chars();
    chars
        .next()
        .map_or(String::new(), |c| c.to_uppercase().chain(chars).collect())
}

/// Rungs 3 and 4 in words.
pub(super) fn agreement(summary: &Summary) -> Markup {
    let a = &summary.agreement;
    let c = &a.coverage;
    let count = |pixels: u64| count(pixels as usize);
    let coverage = match c.raster_only + c.trace_only {
        0 => "Neither sees a surface where the other does not.".to_owned(),
        _ => format!(
            "{} pixels show a surface only in the rasterizer, {} only in the tracer.",
            count(c.raster_only),
            count(c.trace_only)
        ),
    };
    html! {
        section {
            h2 { "Where they must agree" }
            p {
                "Lit at every fragment and without shadows or secondary rays, both renderers evaluate one equation on the "
                "same triangles. Away from edges and from jumps of the model they differ by at most "
                strong { (value(a.interior_max)) } ", on average by " (value(a.interior_mean))
                ", relative to the larger of 1 and the value. "
                (count(a.edge_pixels)) " pixels lie at an edge or a jump and are left out."
            }
            p { "Both see a surface in " (count(c.both)) " pixels. " (coverage) }
        }
    }
}

/// Metrics with what they mean, then how every number was obtained.
pub(super) fn numbers(report: &Report) -> Result<Markup, Error> {
    let summary = &report.summary;
    let columns = [
        Some(&summary.metrics),
        summary.silhouette.as_ref(),
        summary.interior.as_ref(),
    ];
    let max = value(summary.metrics.max);
    let alt = format!("Magnitude of the difference: at most {max}");
    Ok(html! {
        section {
            h2 { "The difference in numbers" }
            p {
                "Trace against raster, over all pixels and channels, on the stored 8-bit values as fractions of 255: the whole picture, "
                "its silhouettes (within one pixel of a change of object, or covered by one renderer only), and the rest."
            }
            div.scroll {
                table {
                    thead { tr {
                        th scope="col" { "metric" }
                        @for part in ["all", "silhouettes", "elsewhere"] { th.number scope="col" { (part) } }
                        th scope="col" { "what it means, and hides" }
                    } }
                    tbody {
                        @for (name, number, meaning) in METRICS {
                            tr {
                                th scope="row" { (name) }
                                @for m in columns { td.number { (m.map_or("none".to_owned(), number)) } }
                                td.text { (meaning) }
                            }
                        }
                    }
                }
            }
            div.grid.half {
                figure {
                    (map_overview(&report.error, 480, &alt)?)
                    figcaption { strong { "error" } "Magnitude of trace − raster: the lighter, the larger." }
                    (legend(&report.error.scale))
                }
            }
        }
    })
}

/// A metric's name, how it is printed, what it means.
type Row = (&'static str, fn(&Metrics) -> String, &'static str);

const METRICS: [Row; 10] = [
    (
        "rmse",
        |m| value(m.rmse),
        "root of the mean squared difference; one bright pixel outweighs many faint ones",
    ),
    ("mse", |m| value(m.mse), "its square"),
    (
        "mae",
        |m| value(m.mae),
        "mean of the absolute differences; hides what is small in area",
    ),
    (
        "max",
        |m| value(m.max),
        "largest absolute difference; decided by a single value",
    ),
    (
        "p50",
        |m| value(m.p50),
        "half of the values differ by no more than this",
    ),
    (
        "p95",
        |m| value(m.p95),
        "95 % of the values differ by no more than this",
    ),
    (
        "p99",
        |m| value(m.p99),
        "99 % of the values differ by no more than this",
    ),
    (
        "psnr",
        |m| m.psnr.map_or("none".to_owned(), |p| format!("{p:.2} dB")),
        "10 log₁₀(1 / mse); none where the pictures are identical",
    ),
    (
        "ssim",
        |m| m.ssim.map_or("none".to_owned(), |s| format!("{s:.4}")),
        "likeness of local structure in luma, 1 = the same (Wang et al. 2004); blind to colour",
    ),
    (
        "flip",
        |m| value(m.flip.mean),
        "mean of what somebody sees who flips between the two, 0 to 1 (Andersson et al. 2020), at 67 pixels a degree",
    ),
];

/// How each number was obtained.
pub(super) fn methods(live: &Live) -> Markup {
    html! {
        section.methods {
            h2 { "How each number was obtained" }
            dl {
                dt { "causes" }
                dd { "The scene is rendered along a ladder of ten rungs, from OpenGL's picture to the traced one. Each rung changes one thing, and the cause is the difference between neighbouring rungs." }
                dt { "sums" }
                dd { "Rung values are rounded to multiples of 2⁻³² and limited to 2²⁰, so that every difference and every sum in double precision is exact." }
                dt { "pixels" }
                dd { "A pixel counts as different if any of its channels differs at all." }
                dt { "percentiles" }
                dd { "Nearest rank over the absolute differences of single values, three a pixel." }
                dt { "maps" }
                dd { "Each pixel shows its channel of largest difference, on a linear scale that ends at the next 1, 2 or 5 times a power of ten. Exactly the pixels without difference are white." }
                dt { "shares" }
                dd { "Squared rmse of a cause over the sum of the squared rmse of all." }
                @if !live.index.is_null() {
                dt { "moving pictures" }
                dd {
                    "Rungs 0 and 9 are the stored 8-bit values. All other pictures and layers are half floats: 11 significant bits, "
                    "below 1/8 steps of 2⁻¹³. Differences finer than that show as none here, and count in the numbers above."
                }
                }
                @if let Some(error) = live.mix_error {
                    dt { "mixer" }
                    dd {
                        "A mix is off from the sum of the float layers by at most " (value(f64::from(error)))
                        " times the larger of 1 and its largest layer: the rounding of all layers, added up at every pixel for the worst "
                        "choice of switches and strengths up to 2, when this page was made."
                    }
                }
                dt { "agreement" }
                dd { "Rungs 3 and 4: more than 1/256 pixel away from triangle edges and from jumps of the model (spot cones, the specular gate, texel borders, coinciding surfaces)." }
            }
        }
    }
}

/// Counters and times.
pub(super) fn work(summary: &Summary) -> Markup {
    html! {
        @if !summary.counters.is_empty() || !summary.seconds.is_empty() {
            section.work-done {
                h2 { "Work and time" }
                details { summary { "Counters and seconds of each rung" } div.columns {
                    (object_table("Work counts", &summary.counters, |n| n.as_u64().map(|n| count(n as usize))))
                    (object_table("Wall-clock time", &summary.seconds, |n| n.as_f64().map(duration)))
                } }
            }
        }
    }
}

/// A table of an object's numbers; nested names are joined by dots.
fn object_table(
    title: &str,
    object: &Object<String, Value>,
    show: impl Fn(&Value) -> Option<String>,
) -> Markup {
    let mut rows = Vec::new();
    flatten("", object, &mut rows);
    html! {
        @if !rows.is_empty() {
            div.scroll {
                table {
                    caption { (title) }
                    tbody {
                        @for (name, value) in &rows {
                            tr { th scope="row" { (name) } td.number { (show(value).unwrap_or_else(|| plain(value))) } }
                        }
                    }
                }
            }
        }
    }
}

/// A JSON value as text.
fn plain(json: &Value) -> String {
    match json {
        Value::String(text) => text.clone(),
        Value::Number(n) => n.as_f64().map_or_else(|| n.to_string(), value),
        other => other.to_string(),
    }
}

/// Adds the leaves of an object in order.
fn flatten<'a>(
    prefix: &str,
    object: &'a Object<String, Value>,
    rows: &mut Vec<(String, &'a Value)>,
) {
    for (key, value) in object {
        let name = format!("{prefix}{key}");
        match value {
            Value::Object(inner) => flatten(&format!("{name}."), inner, rows),
            leaf => rows.push((name, leaf)),
        }
    }
}

/// Command, settings, notes of the import.
pub(super) fn origin(report: &Report) -> Markup {
    html! {
        section {
            h2 { "How this was made" }
            pre { code { (report.command) } }
            @if !report.settings.is_empty() {
                dl.settings { @for (name, setting) in &report.settings { dt { (name) } dd { (setting) } } }
            }
            h2 { "Notes on the scene" }
            @if report.notes.is_empty() {
                p { "The importer dropped nothing and invented nothing." }
            } @else {
                ul { @for note in &report.notes { li { (note.to_string()) } } }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::page::tests::example;

    #[test]
    fn the_verdict_names_the_largest_cause() {
        let report = example();
        let text = verdict(&report);
        assert!(
            text.contains("The largest cause is quantization, with an rmse of 0.1."),
            "{text}"
        );
        assert!(text.contains("PSNR 20.0 dB"), "{text}");
    }

    #[test]
    fn nested_counters_keep_their_order_and_get_dotted_names() {
        let report = example();
        let mut rows = Vec::new();
        flatten("", &report.summary.counters, &mut rows);
        let names: Vec<&str> = rows.iter().map(|(n, _)| n.as_str()).collect();
        assert_eq!(
            names,
            [
                "raster.triangles",
                "raster.fragments",
                "rays.primary",
                "rays.shadow"
            ]
        );
    }
}
