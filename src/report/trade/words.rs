//! What a trade says in sentences.

use crate::report::numbers::{count, value};
use crate::trade::axis::{Law, Part};
use crate::trade::finding::{Answer, AxisFinding, Curve, Point, Time, Trade};
use crate::trade::truth::{End, LEAST_WEIGHT};

/// A setting's name without what every setting of its kind says.
pub(super) fn short(setting: &str) -> String {
    let text = setting.replace(" snap 8", "").replace("raster ", "");
    text.replace("trace depth ", "trace ")
}

/// The same with room to spare.
fn spelled(setting: &str) -> String {
    short(&setting.replace("trace depth ", "trace, depth "))
}

/// The result in one or two sentences.
pub(super) fn verdict(trade: &Trade) -> String {
    let found = trade
        .answers
        .first()
        .and_then(|a| Some((a, trade.rows.get(a.row?)?)));
    let Some((answer, row)) = found else {
        let least = trade.answers.first().map_or(f64::INFINITY, |a| a.least);
        return format!(
            "No setting measured so far comes within {} of the truth; the best is off by {} (rmse).",
            target(1.0 / 255.0),
            value(least)
        );
    };
    let error = row.full.map_or(0.0, |a| a.all.rmse);
    let dearest = trade
        .rows
        .iter()
        .filter(|r| r.full.is_some())
        .map(|r| r.work)
        .fold(0.0, f64::max);
    format!(
        "The cheapest setting with an error below {} is {}: rmse {}, {} of the work of the dearest setting that was tried.",
        target(answer.target),
        spelled(&row.setting),
        value(error),
        share(row.work / dearest),
    )
}

/// "1/255", "10⁻³": an error that an answer is given for.
pub(super) fn target(error: f64) -> String {
    if error == 1.0 / 255.0 {
        return "1/255".to_owned();
    }
    match error.log10() {
        l if (l - l.round()).abs() < 1e-9 => {
            let digits = format!("{}", -l.round());
            let raised: String = digits
                .chars()
                .filter_map(|c| c.to_digit(10))
                .map(|d| ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][d as usize])
                .collect();
            format!("10⁻{raised}")
        }
        _ => value(error),
    }
}

/// A share as "1/12" or "80 %".
fn share(part: f64) -> String {
    if part < 0.1 {
        format!("1/{:.0}", 1.0 / part)
    } else {
        format!("{:.0} %", 100.0 * part)
    }
}

/// A factor with two digits: "3.2 times", "22 times", "1,400 times".
pub(super) fn times(factor: f64) -> String {
    match factor {
        f if f >= 1000.0 => {
            let rounded = 10f64.powi(f.log10().floor() as i32 - 1);
            format!(
                "{} times",
                count(((f / rounded).round() * rounded) as usize)
            )
        }
        f if f >= 10.0 => format!("{f:.0} times"),
        f => format!("{f:.1} times"),
    }
}

/// What an axis taught, one sentence a series; for choices one for all.
pub(super) fn sentences(axis: &AxisFinding) -> Vec<String> {
    if axis.knob.is_empty() || axis.curves.iter().all(|c| c.law == Law::None) {
        return vec![choice(axis)];
    }
    axis.curves
        .iter()
        .map(|curve| sentence(axis, curve))
        .collect()
}

/// One series: how its error falls, what theory says, what a digit costs.
fn sentence(axis: &AxisFinding, curve: &Curve) -> String {
    let name = capital(&curve.name);
    let Some(slope) = curve.slope else {
        return match curve.points.last() {
            Some(last) if last.error.pixels == 0 => {
                format!("{name}: no such pixel in this picture.")
            }
            Some(last) if last.error.rmse == 0.0 => format!("{name}: no error at all."),
            Some(last) => format!("{name}: {}", level(axis, curve, last)),
            None => format!("{name}: not measured yet."),
        };
    };
    let law = match curve.law {
        Law::Step { factor } if factor >= 1.0 => format!(
            "each further generation leaves {} of the error (the strongest surface passes on all light, so theory has no bound)",
            value(slope)
        ),
        Law::Step { factor } => format!(
            "each further generation leaves {} of the error (the strongest surface passes on {}, so theory says at most that)",
            value(slope),
            value(factor)
        ),
        Law::Power { low, high } => format!(
            "error falls with {} to the power {} (theory: {})",
            axis.knob,
            minus(slope),
            band(low, high)
        ),
        Law::None => String::new(),
    };
    let price = match curve.price {
        Some(price) => format!("; ten times less error costs {} the work", times(price)),
        None => String::new(),
    };
    format!("{name}: {law}{price}.{}", flat_rest(axis, curve))
}

/// A series that falls at once, or not at all.
fn level(axis: &AxisFinding, curve: &Curve, last: &Point) -> String {
    let (knob, stays) = (axis.knob, value(last.error.rmse));
    let reached = curve
        .points
        .iter()
        .find(|p| p.error.rmse <= 1.1 * last.error.rmse);
    match (curve.points.first(), reached) {
        (Some(first), Some(p)) if p.knob > first.knob => format!(
            "the error is {stays} from {} {knob} on; with {} it is {}.",
            p.knob,
            first.knob,
            value(first.error.rmse)
        ),
        _ => format!("{knob} do not lower the error, which stays at {stays}."),
    }
}

/// What a tessellation leaves as it is: flat shapes have the same corners at any level.
fn flat_rest(axis: &AxisFinding, curve: &Curve) -> String {
    match curve.points.last() {
        Some(last) if axis.part == Part::Curved && last.interior > 2.0 * last.error.rmse => {
            let left = value(last.interior);
            format!(" Flat shapes keep their corners: with them, the error stays at {left}.")
        }
        _ => String::new(),
    }
}

/// A slope with a true minus sign.
pub(super) fn minus(slope: f64) -> String {
    format!("−{slope:.2}")
}

/// What theory says of a slope.
pub(super) fn band(low: f64, high: f64) -> String {
    let middle = f64::midpoint(low, high);
    if high - low < 0.35 {
        let rounded = (middle * 20.0).round() / 20.0;
        return format!("−{rounded}");
    }
    "−2, and −1.5 where a terminator or a highlight's border is in view".to_owned()
}

/// Choices: the worst and the best, and what the difference costs.
fn choice(axis: &AxisFinding) -> String {
    let points = || {
        axis.curves
            .iter()
            .flat_map(|c| c.points.iter().map(move |p| (c, p)))
    };
    let by_error =
        |a: &(&Curve, &Point), b: &(&Curve, &Point)| a.1.error.rmse.total_cmp(&b.1.error.rmse);
    let (Some(best), Some(worst)) = (points().min_by(by_error), points().max_by(by_error)) else {
        return "Not measured yet.".to_owned();
    };
    let name = |(curve, point): (&Curve, &Point)| match curve.points.len() {
        1 => curve.name.clone(),
        _ => format!("{} of {} {}", curve.name, point.knob, axis.knob),
    };
    if best.1.error.rmse == worst.1.error.rmse {
        return format!(
            "All the same on this scene: rmse {}.",
            value(best.1.error.rmse)
        );
    }
    let cost = best.1.work / worst.1.work;
    let cost = match cost {
        c if c > 1.05 => format!("costs {} the work", times(c)),
        c if c < 0.95 => format!("takes {} of the work", share(c)),
        _ => "costs about the same".to_owned(),
    };
    format!(
        "{} instead of {} lowers the error from {} to {} and {cost}.",
        capital(&name(best)),
        name(worst),
        value(worst.1.error.rmse),
        value(best.1.error.rmse),
    )
}

/// Which pixels an axis is judged by, and against what.
pub(super) fn judged(axis: &AxisFinding) -> String {
    let part = match axis.part {
        Part::All => "all pixels",
        Part::Interior => "pixels away from silhouettes",
        Part::Silhouette => "pixels at silhouettes",
        Part::Curved => "pixels of curved shapes, away from silhouettes,",
    };
    let truth = match axis.truth.split_once(' ') {
        None if axis.truth == "local" => "the local terms on the exact shapes".to_owned(),
        None => "the full truth".to_owned(),
        Some(("mesh", level)) => format!("the triangles of {level} slices, exactly"),
        Some((_, samples)) => format!("the mean of {samples} samples a pixel"),
    };
    format!("rmse of {part} against {truth}")
}

/// An answer in a sentence, before the command.
pub(super) fn answer(answer: &Answer, trade: &Trade) -> String {
    match answer.row.and_then(|i| trade.rows.get(i)) {
        Some(row) => {
            let accuracy = row.full.unwrap_or_default();
            format!(
                "{}: rmse {}, largest error {}, FLIP {}",
                spelled(&row.setting),
                value(accuracy.all.rmse),
                value(accuracy.all.max),
                value(accuracy.flip)
            )
        }
        None if trade.measured < trade.settings => format!(
            "Not reached by the {} of {} settings measured so far (best: {}); the same command goes on.",
            trade.measured,
            trade.settings,
            value(answer.least)
        ),
        None => format!(
            "Out of reach: the best setting is off by {}.",
            value(answer.least)
        ),
    }
}

/// How far the truth follows rays.
pub(super) fn followed(end: &End) -> String {
    let Some(left) = end.weight_left else {
        return format!(
            "followed until their weight is below {}",
            target(LEAST_WEIGHT)
        );
    };
    let depth = end.depth;
    if left < 1.0 {
        format!(
            "followed for {depth} generations (the next would weigh up to {})",
            value(left)
        )
    } else {
        format!(
            "followed for {depth} generations (surfaces pass on all light, so what is left then has no bound)"
        )
    }
}

/// A measured time as a table shows it.
pub(super) fn time(time: Option<&Time>) -> String {
    match time {
        None => "–".to_owned(),
        Some(Time {
            ns_per_pixel: Some(ns),
            interval: Some([low, high]),
            ..
        }) => format!("{} [{}…{}]", value(*ns), value(*low), value(*high)),
        Some(_) => "inconclusive".to_owned(),
    }
}

/// An error in a narrow cell: two digits, small ones as 3.1e−7.
pub(super) fn number_cell(x: f64) -> String {
    match x {
        0.0 => "0".to_owned(),
        x if x.abs() < 1e-3 => format!("{x:.1e}").replace('-', "−"),
        x => format!("{x:.4}"),
    }
}

/// With its first letter large.
pub(super) fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_as_people_write_them() {
        assert_eq!(
            [1.0 / 255.0, 1e-3, 1e-6].map(target),
            ["1/255", "10⁻³", "10⁻⁶"]
        );
        assert_eq!(
            [1.24, 21.6, 99_400.0].map(times),
            ["1.2 times", "22 times", "99,000 times"]
        );
        assert_eq!([0.5, 0.0816].map(share), ["50 %", "1/12"]);
        assert_eq!(band(0.85, 1.15), "−1");
        assert_eq!(band(0.65, 0.85), "−0.75");
        assert_eq!(short("raster gouraud 64 snap 8"), "gouraud 64");
        assert_eq!(
            ["trace depth 3 f64", "trace f64"].map(spelled),
            ["trace, depth 3 f64", "trace f64"]
        );
    }

    #[test]
    fn what_the_truth_leaves_out_is_said() {
        let said = |weight_left| {
            followed(&End {
                depth: 128,
                weight_left,
            })
        };
        assert_eq!(said(None), "followed until their weight is below 10⁻⁷");
        assert!(said(Some(2e-5)).contains("128 generations (the next would weigh up to 2"));
        assert!(said(Some(1.0)).contains("no bound"));
    }

    #[test]
    fn times_are_numbers_or_the_word() {
        let known = Time {
            ns_per_pixel: Some(12.0),
            interval: Some([11.0, 13.0]),
            inconclusive: None,
            rounds: 31,
        };
        assert_eq!(time(Some(&known)), "12 [11…13]");
        let noisy = Time {
            ns_per_pixel: None,
            inconclusive: Some("noise".to_owned()),
            ..known
        };
        assert_eq!(
            (time(Some(&noisy)).as_str(), time(None).as_str()),
            ("inconclusive", "–")
        );
    }
}
