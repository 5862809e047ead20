//! What the page shows without a script, and on paper: the pictures, a map for each cause, the equation growing.

use maud::{Markup, html};

use super::Report;
use super::parts::{label, legend, map_overview, overview};
use super::sections::capital;
use crate::error::Error;
use crate::frame::Plane;
use crate::report::causes::{ORDER, result};
use crate::report::equation::{Term, pieces, plain};
use crate::report::numbers::{count, percent, value};
use rastray_compare::Map;

/// Width that the three pictures come near to.
const PICTURE: usize = 480;
/// Width that maps of causes and steps of the equation come near to.
const SMALL: usize = 240;

/// Raster, trace, difference.
pub(super) fn pictures(report: &Report) -> Result<Markup, Error> {
    let m = &report.summary.metrics;
    let differ = report.difference.summary.pixels;
    let numbers = format!(
        "rmse {}, {} of the pixels differ{}",
        value(m.rmse),
        percent(differ, report.pixels()),
        place(&report.difference)
    );
    let mean = |p: &Plane<[f32; 3]>| format!("mean value {}", value(mean_value(p)));
    let raster = format!(
        "The rasterized picture, {}. Against the traced one: {numbers}",
        mean(&report.raster)
    );
    let trace = format!(
        "The ray traced picture, {}. Against the rasterized one: {numbers}",
        mean(&report.trace)
    );
    let difference = format!(
        "Signed difference of the two pictures: {} pixels, at most {}, {numbers}",
        count(differ),
        value(m.max)
    );
    Ok(html! {
        section.still {
            h2 { "Two pictures of one scene" }
            div.grid.triple {
                figure {
                    (overview(&report.raster, report.view, PICTURE, &raster)?)
                    figcaption { strong { "raster" } "OpenGL's fixed-function lighting: every surface on its own." }
                }
                figure {
                    (overview(&report.trace, report.view, PICTURE, &trace)?)
                    figcaption { strong { "trace" } "Whitted's ray tracing: shadows, mirrors and refraction." }
                }
                figure {
                    (map_overview(&report.difference, PICTURE, &difference)?)
                    figcaption {
                        strong { "difference" }
                        "trace − raster: orange where the traced picture is brighter, blue where it is darker."
                    }
                    (legend(&report.difference.scale))
                }
            }
            @if report.live.index.is_null() {
                @for sentence in &report.live.left_out { p.notice { (sentence) } }
            }
            noscript { p.notice { "This page does more with JavaScript: a slider between any two pictures, a term mixer, and the numbers of every pixel." } }
        }
    })
}

/// Mean of all values, rows top to bottom.
fn mean_value(plane: &Plane<[f32; 3]>) -> f64 {
    let values = plane.data.as_flattened();
    values.iter().map(|&v| f64::from(v)).sum::<f64>() / values.len().max(1) as f64
}

/// ", mostly at the lower left (x 10 to 60, y 80 to 120)": where most of a map's pixels with a difference lie; or nothing.
///
/// Columns and rows between which nine tenths of those pixels lie, and in which ninth of the picture their middle is.
fn place(map: &Map) -> String {
    let none = match map.scale.kind {
        rastray_compare::ScaleKind::Signed => [255; 3],
        rastray_compare::ScaleKind::Magnitude => map.scale.color(0.0),
    };
    let changed = |i: &usize| map.pixels[*i] != none;
    let places: Vec<usize> = (0..map.pixels.len()).filter(changed).collect();
    if places.is_empty() {
        return String::new();
    }
    let range = |of: &dyn Fn(usize) -> usize| {
        let mut all: Vec<usize> = places.iter().map(|&i| of(i)).collect();
        all.sort_unstable();
        (all[all.len() / 20], all[all.len() - 1 - all.len() / 20])
    };
    let (x, y) = (range(&|i| i % map.width), range(&|i| i / map.width));
    let third = |(low, high): (usize, usize), size: usize| ((low + high) * 3 / (2 * size)).min(2);
    let row = ["upper", "middle", "lower"][third(y, map.height)];
    let column = ["left", "centre", "right"][third(x, map.width)];
    format!(
        ", mostly at the {row} {column} (x {} to {}, y {} to {})",
        x.0, x.1, y.0, y.1
    )
}

/// A card for each cause: its share, its map, a click to see where.
pub(super) fn causes(report: &Report) -> Result<Markup, Error> {
    let causes = &report.summary.causes;
    let total: f64 = causes.iter().map(|c| c.rmse * c.rmse).sum();
    let card = |(i, map): (usize, &Map)| -> Result<Markup, Error> {
        let cause = &causes[i];
        let share = if total > 0.0 {
            cause.rmse * cause.rmse / total
        } else {
            0.0
        };
        let alt = format!(
            "Map of the step {}{}",
            result(cause, report.pixels()).trim_end_matches('.'),
            place(map)
        );
        Ok(html! {
            li {
                button.cause type="button" data-cause=(i) disabled[cause.pixels == 0] title="Show where" {
                    span.name { (cause.name)
                        @if let Some(term) = Term::of_name(&cause.name) { span.symbol { (label(term)) } } }
                    span.share aria-hidden="true" { i style={ "width:" (format!("{:.2}", 100.0 * share)) "%" } {} }
                    @if cause.pixels == 0 { span.nothing { "no difference" } }
                    @else { (map_overview(map, SMALL, &alt)?) }
                    span.figures {
                        strong { (share_text(share, cause.pixels)) }
                        @if cause.pixels > 0 { " rmse " (value(cause.rmse)) br; (percent(cause.pixels, report.pixels())) " of the pixels" }
                    }
                }
            }
        })
    };
    let maps = report.cause_maps.iter().enumerate().take(causes.len());
    let cards: Vec<Markup> = maps.map(card).collect::<Result<_, _>>()?;
    Ok(html! {
        section.causes {
            h2 #causes { "Why they differ" }
            p { (capital(&residual(report))) " " (ORDER) " The bars are shares of the squared change along the ladder; a click shows where." }
            ol.cards { @for card in &cards { (card) } }
        }
    })
}

/// "12.3 %", and never 0 % or 100 % of what is not.
fn share_text(share: f64, pixels: usize) -> String {
    match 100.0 * share {
        _ if pixels == 0 => "0 %".to_owned(),
        s if s < 0.1 => "< 0.1 %".to_owned(),
        s if s > 99.9 && s < 100.0 => "> 99.9 %".to_owned(),
        s => format!("{s:.1} %"),
    }
}

/// That the causes add up, or by how much they do not.
fn residual(report: &Report) -> String {
    let summary = &report.summary;
    let mut text = match summary.residual_max {
        0.0 => "the causes add up to the whole difference exactly: the residual is 0.".to_owned(),
        r => format!(
            "the causes miss the whole difference by at most {}.",
            value(r)
        ),
    };
    if summary.limited_pixels > 0 {
        let n = count(summary.limited_pixels);
        text += &format!(" {n} pixels hold values beyond 2²⁰ and were limited to that.");
    }
    text
}

/// The equation growing: a step for each term.
pub(super) fn growth(report: &Report) -> Result<Markup, Error> {
    let step = |(term, plane): &(Term, Plane<[f32; 3]>)| -> Result<Markup, Error> {
        let equation = pieces(report.form, *term);
        let alt = format!("The picture with {}", plain(&equation));
        Ok(html! {
            li {
                button.step type="button" data-grow=(term.name()) title="Show it in the mixer" {
                    span.name { (label(*term)) span { (term.name()) } }
                    (overview(plane, report.view, SMALL, &alt)?)
                }
            }
        })
    };
    let steps: Vec<Markup> = report.buildup.iter().map(step).collect::<Result<_, _>>()?;
    Ok(html! {
        @if !steps.is_empty() {
            section.growth {
                h2 { "The equation, growing" }
                p {
                    "Up to specular, both renderers compute the same. S" sub { "L" } ", I" sub { "R" } " and I"
                    sub { "T" } " need other surfaces. " (crate::report::causes::NOT_MODELLED)
                }
                ol.cards { @for step in &steps { (step) } }
            }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::page::tests::example;
    use rastray_compare::{Reduction, signed_map};

    #[test]
    fn a_residual_is_told() {
        let mut report = example();
        assert!(residual(&report).contains("exactly"));
        (report.summary.residual_max, report.summary.limited_pixels) = (0.5, 1234);
        let text = residual(&report);
        assert!(
            text.contains("at most 0.5") && text.contains("1,234 pixels"),
            "{text}"
        );
    }

    #[test]
    fn places_are_named() {
        let mut values = vec![[0.0; 3]; 90 * 60];
        for y in 45..55 {
            for x in 5..15 {
                values[y * 90 + x] = [0.25; 3];
            }
        }
        let map = signed_map(90, 60, &values, Reduction::Largest).unwrap();
        assert_eq!(
            place(&map),
            ", mostly at the lower left (x 5 to 14, y 45 to 54)"
        );
        let none = signed_map(2, 1, &[[0.0; 3]; 2], Reduction::Largest).unwrap();
        assert_eq!(place(&none), "");
    }

    #[test]
    fn shares_are_never_rounded_to_none_or_all() {
        let text = |share| share_text(share, 5);
        assert_eq!(
            [text(0.5), text(1e-9), text(0.9999), text(1.0)],
            ["50.0 %", "< 0.1 %", "> 99.9 %", "100.0 %"]
        );
        assert_eq!(share_text(0.0, 0), "0 %");
    }
}
