//! The plots of a trade: error against work with the front, and error against a knob.

use super::plot::{Anchor, Ink, LogScale, Mark, Plot, Shape, Words};
use super::words::short;
use crate::render::Renderer;
use crate::report::numbers::{tick, value};
use crate::report::text::{Face, measure};
use crate::trade::axis::Law;
use crate::trade::finding::{AxisFinding, Curve, TARGETS, Trade};

/// Colour and shape of a renderer.
fn style(renderer: Renderer) -> (Ink, Shape) {
    match renderer {
        Renderer::Raster => (Ink::First, Shape::Circle),
        Renderer::Cast => (Ink::Text, Shape::Square),
        Renderer::Trace => (Ink::Second, Shape::Diamond),
    }
}

fn line(points: Vec<[f32; 2]>, ink: Ink, width: f32, dashed: bool) -> Mark {
    Mark::Line {
        points,
        ink,
        width,
        dashed,
    }
}

fn words(at: [f32; 2], text: impl Into<String>, ink: Ink, size: f32, anchor: Anchor) -> Mark {
    Mark::Text(Words {
        at,
        text: text.into(),
        ink,
        size,
        anchor,
        upright: false,
    })
}

/// The rectangle of a chart between its scales, with rules, ticks and titles.
struct Paper {
    x: LogScale,
    y: LogScale,
    size: f32,
    /// The foot of the scale stands for 0, which no logarithm reaches.
    zero: bool,
}

/// A scale's number, powers of ten without "1 ×".
fn power_of_ten(x: f64) -> String {
    let text = tick(x);
    text.strip_prefix("1 × ").unwrap_or(&text).to_owned()
}

impl Paper {
    fn marks(&self, x_title: &str, y_title: &str, x_ticks: &[f64]) -> Vec<Mark> {
        let (left, right) = (self.x.from, self.x.to);
        let (bottom, top) = (self.y.from, self.y.to);
        let mut marks = Vec::new();
        for decade in self.y.ticks() {
            let y = self.y.place(decade);
            if self.zero && y > bottom - 1.5 * self.size {
                continue;
            }
            marks.push(line(vec![[left, y], [right, y]], Ink::Line, 1.0, false));
            let at = [left - 8.0, y + 0.36 * self.size];
            marks.push(words(
                at,
                power_of_ten(decade),
                Ink::Grey,
                self.size,
                Anchor::End,
            ));
        }
        for value in x_ticks {
            let x = self.x.place(*value);
            marks.push(line(vec![[x, top], [x, bottom]], Ink::Line, 1.0, false));
            let at = [x, bottom + 1.5 * self.size];
            marks.push(words(
                at,
                tick(*value),
                Ink::Grey,
                self.size,
                Anchor::Middle,
            ));
        }
        if self.zero {
            let at = [left - 8.0, bottom + 0.36 * self.size];
            marks.push(words(at, "0", Ink::Grey, self.size, Anchor::End));
        }
        let middle = f32::midpoint(left, right);
        let at = [middle, bottom + 3.2 * self.size];
        marks.push(words(at, x_title, Ink::Grey, self.size, Anchor::Middle));
        marks.push(Mark::Text(Words {
            at: [1.1 * self.size, f32::midpoint(top, bottom)],
            text: y_title.to_owned(),
            ink: Ink::Grey,
            size: self.size,
            anchor: Anchor::Middle,
            upright: true,
        }));
        marks
    }
}

/// Error against work for every setting at pixel centres: the front in colour and joined, dominated settings grey.
pub(super) fn front(trade: &Trade) -> Plot {
    let (width, height, size) = (1000.0, 560.0, 14.0);
    let points: Vec<(usize, f64, f64)> = trade
        .rows
        .iter()
        .enumerate()
        .filter(|(_, row)| row.offered)
        .filter_map(|(i, row)| Some((i, row.work, row.full?.all.rmse)))
        .collect();
    let errors = points
        .iter()
        .map(|p| p.2)
        .chain(TARGETS.iter().copied().take(2));
    let mut y = LogScale::around(errors, height - 62.0, 16.0);
    let zero = points.iter().any(|p| p.2 == 0.0);
    if zero {
        y.low -= 1.0;
    }
    let paper = Paper {
        x: LogScale::around(points.iter().map(|p| p.1), 84.0, width - 24.0),
        y,
        size,
        zero,
    };
    let title = "work a pixel: exact counts of operations × their weights";
    let mut marks = paper.marks(title, "error: rmse of linear values", &paper.x.ticks());
    marks.extend(targets(&paper));
    let on = points.iter().filter(|p| trade.rows[p.0].front).count();
    marks.extend(dots(trade, &points, &paper));
    Plot {
        width,
        height,
        description: format!(
            "Error against work of {} settings on logarithmic axes; {on} are on the Pareto front",
            points.len()
        ),
        marks,
    }
}

/// The border of the front, and the settings (row, work, error) with the names of those on it.
fn dots(trade: &Trade, points: &[(usize, f64, f64)], paper: &Paper) -> Vec<Mark> {
    let place = |p: &(usize, f64, f64)| [paper.x.place(p.1), paper.y.place(p.2)];
    let is_on = |p: &&(usize, f64, f64)| trade.rows[p.0].front;
    let on: Vec<_> = points.iter().filter(is_on).collect();
    let border: Vec<[f32; 2]> = on.iter().map(|p| place(p)).collect();
    let mut marks = vec![line(staircase(&border), Ink::Text, 1.4, false)];
    // Dominated settings first, so that the front lies above them.
    let behind = points.iter().filter(|p| !is_on(p));
    for p in behind.chain(on.iter().copied()) {
        let row = &trade.rows[p.0];
        let (ink, shape) = style(row.renderer);
        marks.push(Mark::Dot {
            at: place(p),
            shape,
            ink: if row.front { ink } else { Ink::Grey },
            radius: if row.front { 5.5 } else { 3.2 },
            filled: row.front,
            title: format!(
                "{}: rmse {}, work {} a pixel",
                row.setting,
                value(p.2),
                value(p.1)
            ),
        });
    }
    let labels = on
        .iter()
        .map(|p| (place(p), short(&trade.rows[p.0].setting)));
    marks.extend(labelled(labels.collect(), paper, paper.size));
    marks
}

/// Dashed rules at the errors that answers are given for.
fn targets(paper: &Paper) -> Vec<Mark> {
    let names = ["1/255", "10⁻³", "10⁻⁶"];
    let shown = TARGETS
        .iter()
        .zip(names)
        .filter(|(t, _)| (paper.y.low..=paper.y.high).contains(&t.log10()));
    shown
        .flat_map(|(target, name)| {
            let y = paper.y.place(*target);
            let label = [paper.x.to - 4.0, y - 5.0];
            [
                line(
                    vec![[paper.x.from, y], [paper.x.to, y]],
                    Ink::Grey,
                    1.0,
                    true,
                ),
                words(label, name, Ink::Grey, paper.size, Anchor::End),
            ]
        })
        .collect()
}

/// The border of what can be had: level until the next better setting, then down.
fn staircase(front: &[[f32; 2]]) -> Vec<[f32; 2]> {
    let mut steps = Vec::new();
    for pair in front.windows(2) {
        steps.extend([pair[0], [pair[1][0], pair[0][1]]]);
    }
    steps.extend(front.last());
    steps
}

/// Labels right above their dots, left of them or below; those that would cover another label or dot are left out, since
/// the table and the pointer name every dot.
fn labelled(dots: Vec<([f32; 2], String)>, paper: &Paper, size: f32) -> Vec<Mark> {
    let mut taken: Vec<[f32; 4]> = dots
        .iter()
        .map(|([x, y], _)| [x - 6.0, y - 6.0, x + 6.0, y + 6.0])
        .collect();
    let clear = |taken: &[[f32; 4]], b: [f32; 4]| {
        taken
            .iter()
            .all(|t| b[2] < t[0] || t[2] < b[0] || b[3] < t[1] || t[3] < b[1])
            && b[0] > paper.x.from
            && b[2] < paper.x.to
            && b[1] > paper.y.to - 8.0
            && b[3] < paper.y.from
    };
    let mut marks = Vec::new();
    for ([x, y], name) in dots {
        let w = measure(&name, Face::Regular, size);
        let places = [
            (Anchor::Start, [x + 9.0, y - 7.0], x + 9.0),
            (Anchor::End, [x - 9.0, y + 15.0], x - 9.0 - w),
            (Anchor::Start, [x + 9.0, y + 17.0], x + 9.0),
            (Anchor::End, [x - 9.0, y - 7.0], x - 9.0 - w),
            (Anchor::Middle, [x, y - 13.0], x - w / 2.0),
        ];
        let found = places.into_iter().find_map(|(anchor, at, left)| {
            let area = [left, at[1] - 0.8 * size, left + w, at[1] + 0.25 * size];
            clear(&taken, area).then_some((anchor, at, area))
        });
        if let Some((anchor, at, area)) = found {
            taken.push(area);
            marks.push(words(at, name, Ink::Text, size, anchor));
        }
    }
    marks
}

/// Error against the knob of an axis, a line a series, with the predicted slope dashed where theory has one.
pub(super) fn knob(axis: &AxisFinding) -> Plot {
    let (width, height, size) = (560.0, 380.0, 14.0);
    let points = || axis.curves.iter().flat_map(|c| &c.points);
    // Steps multiply the error: a straight line over the knob itself.
    let steps = axis
        .curves
        .iter()
        .any(|c| matches!(c.law, Law::Step { .. }));
    let across = |knob: f64| if steps { 10f64.powf(knob) } else { knob };
    let knobs: Vec<f64> = {
        let mut all: Vec<f64> = points().map(|p| p.knob).collect();
        all.sort_by(f64::total_cmp);
        all.dedup();
        all
    };
    let paper = Paper {
        x: LogScale::around(knobs.iter().map(|k| across(*k)), 84.0, width - 92.0),
        y: LogScale::around(points().map(|p| p.error.rmse), height - 62.0, 16.0),
        size,
        zero: false,
    };
    let mut marks = paper.marks(axis.knob, "rmse", &[]);
    for knob in &knobs {
        let at = [paper.x.place(across(*knob)), paper.y.from + 1.5 * size];
        marks.push(words(at, tick(*knob), Ink::Grey, size, Anchor::Middle));
    }
    let mut ends: Vec<f32> = Vec::new();
    for (i, curve) in axis.curves.iter().enumerate() {
        marks.extend(series(curve, i, &paper, &across, &mut ends));
    }
    Plot {
        width,
        height,
        description: format!(
            "Error against {} for {} series",
            axis.knob,
            axis.curves.len()
        ),
        marks,
    }
}

/// Line, dots, name and prediction of one series. `ends` are the heights of names so far.
fn series(
    curve: &Curve,
    number: usize,
    paper: &Paper,
    across: &dyn Fn(f64) -> f64,
    ends: &mut Vec<f32>,
) -> Vec<Mark> {
    const STYLES: [(Ink, Shape); 3] = [
        (Ink::First, Shape::Circle),
        (Ink::Second, Shape::Diamond),
        (Ink::Text, Shape::Square),
    ];
    let (ink, shape) = STYLES[number % STYLES.len()];
    let shown: Vec<_> = curve.points.iter().filter(|p| p.error.rmse > 0.0).collect();
    let place = |knob: f64, error: f64| [paper.x.place(across(knob)), paper.y.place(error)];
    let places: Vec<_> = shown.iter().map(|p| place(p.knob, p.error.rmse)).collect();
    let mut marks = Vec::new();
    if let (Some(last), Some(predicted)) = (shown.last(), prediction(curve)) {
        let ends = [shown[0].knob, last.knob].map(|knob| place(knob, predicted(knob)));
        // A law beyond the paper would be bent by its border.
        let inside = ends
            .iter()
            .all(|[_, y]| *y > paper.y.to && *y < paper.y.from);
        if inside {
            marks.push(line(ends.to_vec(), ink, 1.0, true));
        }
    }
    marks.push(line(places.clone(), ink, 2.0, false));
    for (at, point) in places.iter().zip(&shown) {
        marks.push(Mark::Dot {
            at: *at,
            shape,
            ink,
            radius: 4.0,
            filled: true,
            title: format!("{}: rmse {}", point.setting, value(point.error.rmse)),
        });
    }
    if let Some([x, y]) = places.last() {
        // Names of lines that end together move apart.
        let mut y = y + 0.36 * paper.size;
        while let Some(near) = ends.iter().find(|e| (**e - y).abs() < 1.2 * paper.size) {
            y = near + 1.2 * paper.size + 0.01;
        }
        ends.push(y);
        marks.push(words(
            [x + 10.0, y],
            curve.name.clone(),
            ink,
            paper.size,
            Anchor::Start,
        ));
    }
    marks
}

/// The predicted law through the series' middle; the middle of its band where it has one.
fn prediction(curve: &Curve) -> Option<impl Fn(f64) -> f64 + use<>> {
    let shown: Vec<_> = curve.points.iter().filter(|p| p.error.rmse > 0.0).collect();
    let middle = shown.get(shown.len() / 2)?;
    let (knob, error, law) = (middle.knob, middle.error.rmse, curve.law);
    let bounded = match law {
        Law::Power { .. } => true,
        Law::Step { factor } => factor < 1.0,
        Law::None => false,
    };
    bounded.then_some(move |k: f64| match law {
        Law::Power { low, high } => error * (k / knob).powf(-f64::midpoint(low, high)),
        Law::Step { factor } => error * factor.powf(k - knob),
        Law::None => error,
    })
}
