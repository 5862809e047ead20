//! The page of a trade.

use maud::{Markup, html};

use super::words::{
    answer, band, capital, followed, judged, minus, number_cell, sentences, short, target, time,
    times, verdict,
};
use super::{TradeReport, charts, plot};
use crate::error::Error;
use crate::report::document::{ARTICLE, Document};
use crate::report::numbers::{count, tick, value};
use crate::report::page::linear_image;
use crate::trade::axis::Law;
use crate::trade::cost::{F64_FACTOR, WEIGHTS};
use crate::trade::finding::{AxisFinding, Curve, Row};

impl TradeReport {
    /// The page's text.
    pub(super) fn to_html(&self) -> Result<String, Error> {
        let trade = &self.trade;
        let [w, h] = trade.size;
        let body = html! {
            body {
                header {
                    p.kicker { "rastray trade · " (w) " × " (h) " pixels · " (trade.measured) " settings" }
                    h1 { (trade.scene) }
                    p.lead { (verdict(trade)) }
                    @if trade.measured < trade.settings {
                        p.unfinished {
                            (trade.measured) " of " (trade.settings) " settings are measured so far. The same command goes on "
                            "where this run ended."
                        }
                    }
                }
                main {
                    (self.answer_cards()?)
                    (self.front_section())
                    (self.knobs())
                    (self.slopes())
                    (self.power())
                    (self.all_settings())
                    (self.origin())
                }
                footer { "Made by rastray " (env!("CARGO_PKG_VERSION")) ". Type: Inter, SIL Open Font License 1.1." }
            }
        };
        let document = Document {
            title: format!("{} · rastray trade", trade.scene),
            policy: None,
            sheets: &[ARTICLE, include_str!("trade.css")],
            body,
        };
        Ok(document.into_html())
    }

    /// The cheapest setting for each error, with its command and picture; the truth beside them.
    fn answer_cards(&self) -> Result<Markup, Error> {
        let trade = &self.trade;
        let mut cards = Vec::new();
        let all: Vec<_> = trade.answers.iter().zip(&self.answers).collect();
        // Targets that one setting meets share a card.
        for group in all.chunk_by(|(a, _), (b, _)| a.row == b.row) {
            let (a, picture) = group[0];
            let names: Vec<String> = group.iter().map(|(a, _)| target(a.target)).collect();
            let name = names.join(", ");
            cards.push(html! {
                article {
                    h3 { "Error below " (name) span { (meaning(a.target)) } }
                    @if let Some(plane) = picture {
                        (linear_image(plane, self.view, &format!("The scene with an error below {name}"))?)
                    } @else { div.nothing { (if trade.measured < trade.settings { "not reached yet" } else { "out of reach" }) } }
                    @if let Some(command) = self.command_of(a.row) { pre { code { (command) } } }
                    p { (answer(a, trade)) }
                }
            });
        }
        Ok(html! {
            section {
                h2 { "What to type" }
                p {
                    "The cheapest setting whose picture is that close to the truth: exact shapes, lit at every pixel, with "
                    "shadows, all rays " (followed(&trade.truth)) ", in f64. The error is the root of the mean "
                    "square over all pixels, on linear values "
                    "before any clamp, at pixel centres; FLIP is the difference as an eye sees it, from 0 to 1."
                }
                div.grid.answers {
                    article {
                        h3 { "The truth" span { "what every setting is measured against" } }
                        (linear_image(&self.truth, self.view, "The truth")?)
                    }
                    @for card in &cards { (card) }
                }
            }
        })
    }

    fn front_section(&self) -> Markup {
        html! {
            section {
                h2 { "Error against work" }
                p {
                    "Each dot is a setting: the further left the cheaper, the lower the truer. Settings on the line are the ones "
                    "to choose from; for each grey one, some setting on the line is cheaper and truer."
                }
                (plot::figure(&charts::front(&self.trade)))
                p.key {
                    span.raster { i { "●" } "rasterizer" }
                    span.cast { i { "■" } "primary rays only" }
                    span.trace { i { "◆" } "ray tracer" }
                    span { "grey: dominated" }
                    span { "numbers: slices of a full turn, or generations of rays" }
                }
            }
        }
    }

    /// One article an axis.
    fn knobs(&self) -> Markup {
        html! {
            section {
                h2 { "One knob at a time" }
                div.grid.knobs {
                    @for axis in &self.trade.axes {
                        article {
                            h3 { (capital(axis.name)) }
                            p.judged { (judged(axis)) }
                            @if drawable(axis) { (plot::figure(&charts::knob(axis))) }
                            @if axis.knob.is_empty() { (choices(axis)) }
                            ul { @for sentence in sentences(axis) { li { (sentence) } } }
                        }
                    }
                }
            }
        }
    }

    /// Measured slopes beside those that theory predicts.
    fn slopes(&self) -> Markup {
        let curves = || {
            self.trade
                .axes
                .iter()
                .flat_map(|a| a.curves.iter().map(move |c| (a, c)))
        };
        let known: Vec<(&AxisFinding, &Curve)> =
            curves().filter(|(_, c)| c.slope.is_some()).collect();
        html! {
            @if !known.is_empty() {
                section {
                    h2 { "Slopes, measured and predicted" }
                    p {
                        "How the error follows the knob: an exponent, or for rays the share that each generation leaves. Fitted to "
                        "the finest settings that still fall. A slope off the prediction says that something else rules the error there: "
                        "a highlight smaller than the triangles, a shadow's border, rounding."
                    }
                    div.scroll {
                        table {
                            thead { tr {
                                th { "axis" } th { "series" } th.number { "predicted" } th.number { "measured" } th {}
                                th.number { "ten times less error costs" }
                            } }
                            tbody {
                                @for (axis, curve) in &known {
                                    tr {
                                        th scope="row" { (axis.name) }
                                        td { (curve.name) }
                                        td.number { (predicted(curve)) }
                                        td.number { (measured(curve)) }
                                        td class=[(curve.as_predicted == Some(false)).then_some("off")] { (verdict_of(curve)) }
                                        td.number { @if let Some(price) = curve.price { (times(price)) } @else { "–" } }
                                    }
                                }
                            }
                        }
                    }
                }
            }
        }
    }

    /// Forms of the power.
    fn power(&self) -> Markup {
        let trade = &self.trade;
        html! {
            @if !trade.exponents.is_empty() {
                section {
                    h2 { "Forms of the power" }
                    p {
                        "The highlight needs (cos)" sup { "n" } ". How far each way to compute it is off, at worst, over all angles; "
                        "times the highlight's colour that is the error of a pixel. A step of an 8-bit display is 0.0039. Only the first "
                        "form lights anything."
                    }
                    div.scroll {
                        table {
                            thead { tr {
                                th { "form, in f32" }
                                @for n in &trade.exponents { th.number { "n = " (tick(*n)) } }
                            } }
                            tbody {
                                @for row in &trade.power {
                                    tr {
                                        th scope="row" { (row.form) }
                                        @for e in &row.errors { td.number { (e.map_or("–".to_owned(), value)) } }
                                    }
                                }
                            }
                        }
                    }
                }
            }
        }
    }

    /// Every row.
    fn all_settings(&self) -> Markup {
        html! {
            section {
                h2 { "All settings" }
                p {
                    "Cheapest first; those on the front have a dot. Errors are against the full truth; settings of several samples, which "
                    "are judged by their edges, stand in " code { "trade.csv" } "."
                }
                details {
                    summary { "The table: errors, exact counts, times" }
                    div.scroll.wide {
                        table {
                            thead { tr {
                                th { "setting" }
                                @for name in ["rmse", "p99", "max", "interior", "silhouette", "FLIP", "shaded", "pow", "rays", "box tests",
                                    "primitive tests", "work a pixel", "measured ns/pixel [95 %]"] { th.number { (name) } }
                            } }
                            tbody { @for row in self.trade.rows.iter().filter(|r| r.full.is_some()) { (table_row(row)) } }
                        }
                    }
                }
            }
        }
    }

    fn origin(&self) -> Markup {
        let trade = &self.trade;
        let weights = WEIGHTS.map(|(name, _, w)| format!("{name} {}", tick(w)));
        html! {
            section {
                h2 { "How this was made" }
                pre { code { (self.command) } }
                dl {
                    @for (name, setting) in &self.settings { dt { (name) } dd { (setting) } }
                    dt { "work" }
                    dd {
                        "Exact counts of operations times weights: " (weights.join(", ")) "; in f64 all of it "
                        (tick(F64_FACTOR)) " times. The same on every machine: a model of the cost, not a time."
                    }
                    dt { "times" }
                    dd {
                        "One thread. Rounds of A B B A against “" (short(&trade.base)) "”; the median of the rounds' ratios with "
                        "its order-statistic 95 % interval, times the base's fastest run. “Inconclusive” where the interval reaches more than "
                        "5 % from the median, or the fastest runs disagree with it by more."
                    }
                    dt { "ideal picture" }
                    dd { (trade.ideal_samples) " jittered samples a pixel: what the samples are judged by." }
                    dt { "FLIP" }
                    dd { "Mean difference as seen at 67 pixels a degree, of the 8-bit pictures; 0 = nothing to see, 1 = green against blue." }
                }
                @if !self.notes.is_empty() {
                    h2 { "Notes" }
                    ul { @for note in &self.notes { li { (note.to_string()) } } }
                }
            }
        }
    }
}

/// Whether a slope is what theory says.
fn verdict_of(curve: &Curve) -> &'static str {
    match curve.as_predicted {
        Some(true) => "as predicted",
        Some(false) => "off",
        None => "",
    }
}

/// What an error means to the eye.
fn meaning(error: f64) -> &'static str {
    match error {
        e if e >= 1.0 / 255.0 => "on average a step of an 8-bit display: hard to see",
        e if e >= 1e-3 => "a quarter of a step: not to be seen",
        _ => "next to what f32 can hold",
    }
}

/// Whether an axis has a line to draw.
fn drawable(axis: &AxisFinding) -> bool {
    let mut points = axis.curves.iter().flat_map(|c| &c.points);
    !axis.knob.is_empty() && points.any(|p| p.error.rmse > 0.0)
}

/// The choices of an axis as a table.
fn choices(axis: &AxisFinding) -> Markup {
    html! {
        div.scroll {
            table {
                thead { tr { th {} th.number { "rmse" } th.number { "largest" } th.number { "work a pixel" } } }
                tbody {
                    @for curve in &axis.curves {
                        @for point in &curve.points {
                            tr {
                                th scope="row" { (curve.name) }
                                td.number { (value(point.error.rmse)) }
                                td.number { (value(point.error.max)) }
                                td.number { (value(point.work)) }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn predicted(curve: &Curve) -> String {
    match curve.law {
        Law::Power { low, high } if high - low < 0.35 => band(low, high),
        Law::Power { low, high } => format!("{}…{}", minus(low), minus(high)),
        Law::Step { factor } if factor < 1.0 => format!("at most {}", value(factor)),
        Law::Step { .. } => "no bound".to_owned(),
        Law::None => "–".to_owned(),
    }
}

fn measured(curve: &Curve) -> String {
    match (curve.law, curve.slope) {
        (_, None) => "–".to_owned(),
        (Law::Step { .. }, Some(slope)) => value(slope),
        (_, Some(slope)) => minus(slope),
    }
}

fn table_row(row: &Row) -> Markup {
    let a = row.full.unwrap_or_default();
    let c = &row.counts;
    let errors = [
        a.all.rmse,
        a.all.p99,
        a.all.max,
        a.interior.rmse,
        a.silhouette.rmse,
        a.flip,
    ];
    let counts = [
        c.shaded,
        c.pow_calls,
        c.rays(),
        c.box_tests,
        c.primitive_tests,
    ];
    html! {
        tr class=(if row.front { "front" } else { "rest" }) {
            th scope="row" { (row.setting) }
            @for e in errors { td.number { (number_cell(e)) } }
            @for n in counts { td.number { (count(n as usize)) } }
            td.number { (value(row.work)) }
            td.number title=[row.time.as_ref().and_then(|t| t.inconclusive.clone())] { (time(row.time.as_ref())) }
        }
    }
}
