//! The ray tree as in a lecture's figure: the eye at the top, a card for each hit, edges labelled R or T with their weights,
//! and on each card the lights that its shadow rays ask for.

use super::paths::Line;
use super::pick::{Picked, added};
use super::svg::{Drawing, Point, cut};
use super::{brief, bytes, degrees, from_inside, short, triple};
use crate::explain::{Explanation, Factors, Kind, Ray};

/// Width of a card.
const CARD: f64 = 204.0;
/// Between two cards.
const GAP: f64 = 18.0;
/// Between two generations.
const EDGE: f64 = 46.0;
/// Height of a row on a card.
const ROW: f64 = 15.0;
/// Characters that a row holds.
const LETTERS: usize = 31;

/// What a row on a card begins with.
enum Sign {
    /// Nothing.
    None,
    /// A light that is seen.
    Seen,
    /// A light that is blocked.
    Blocked,
}

/// A card and its place.
struct Card {
    ray: usize,
    /// Middle of the upper edge.
    top: Point,
    rows: Vec<(Sign, String)>,
}

impl Card {
    fn height(&self) -> f64 {
        let rows = self.rows.len() as f64;
        46.0 + if rows > 0.0 { ROW * rows + 5.0 } else { 0.0 }
    }

    fn bottom(&self) -> Point {
        [self.top[0], self.top[1] + self.height()]
    }
}

/// The tree laid out.
pub(super) struct Diagram<'a> {
    e: &'a Explanation,
    cards: Vec<Card>,
    /// For each ray its card.
    card_of: Vec<Option<usize>>,
    pub(super) size: [f64; 2],
}

impl<'a> Diagram<'a> {
    /// Lays out the rays that are picked.
    pub(super) fn new(e: &'a Explanation, picked: &Picked) -> Self {
        let rays = &e.trace.rays;
        let mut diagram = Self {
            e,
            cards: Vec::new(),
            card_of: vec![None; rays.len()],
            size: [CARD, 0.0],
        };
        for (id, ray) in rays.iter().enumerate().filter(|(id, _)| picked.shown[*id]) {
            diagram.card_of[id] = Some(diagram.cards.len());
            diagram.cards.push(Card {
                ray: id,
                top: [0.0; 2],
                rows: rows(e, ray, &picked.children[id], picked),
            });
        }
        diagram.place(picked);
        diagram
    }

    /// For each ray with a card its number: hits are counted, the background has none.
    pub(super) fn numbers(&self) -> Vec<Option<usize>> {
        let rays = self.e.trace.rays.iter().zip(&self.card_of);
        let mut count = 0;
        rays.map(|(ray, card)| {
            (card.is_some() && ray.hit.is_some()).then(|| {
                count += 1;
                count
            })
        })
        .collect()
    }

    /// Leaves side by side, parents above the middle of their children; generations in rows.
    fn place(&mut self, picked: &Picked) {
        let rays = &self.e.trace.rays;
        let mut heights: Vec<f64> = Vec::new();
        for card in &self.cards {
            let generation = rays[card.ray].generation as usize;
            heights.resize(heights.len().max(generation + 1), 0.0);
            heights[generation] = heights[generation].max(card.height());
        }
        let mut tops = vec![EDGE + 16.0];
        for height in &heights {
            let last = tops[tops.len() - 1];
            tops.push(last + height + EDGE);
        }
        let mut next = CARD / 2.0;
        // Children have larger numbers than their parents, so leaves are met in an order of their own: depth first.
        let mut waiting = vec![(0, false)];
        while let Some((id, done)) = waiting.pop() {
            let Some(card) = self.card_of.get(id).copied().flatten() else {
                continue;
            };
            let below = || picked.children[id].iter().filter_map(|c| self.card_of[*c]);
            if !done && below().next().is_some() {
                waiting.push((id, true));
                waiting.extend(picked.children[id].iter().rev().map(|c| (*c, false)));
                continue;
            }
            let places: Vec<f64> = below().map(|c| self.cards[c].top[0]).collect();
            let x = match (places.first(), places.last()) {
                (Some(first), Some(last)) => f64::midpoint(*first, *last),
                _ => {
                    next += CARD + GAP;
                    next - CARD - GAP
                }
            };
            self.cards[card].top = [x, tops[rays[id].generation as usize]];
        }
        let bottom = self.cards.iter().map(|c| c.bottom()[1]).fold(0.0, f64::max);
        self.size = [next - GAP - CARD / 2.0, bottom];
    }

    /// Draws eye, edges and cards.
    pub(super) fn draw(&self) -> Drawing {
        let mut drawing = Drawing::default();
        let Some(root) = self.cards.first() else {
            return drawing;
        };
        let eye = [root.top[0], 12.0];
        for card in &self.cards {
            let ray = &self.e.trace.rays[card.ray];
            let parent = ray.parent.and_then(|p| self.card_of[p]);
            let from = parent.map_or(eye, |p| self.cards[p].bottom());
            self.edge(&mut drawing, ray, from, card.top);
        }
        drawing.circle("eye", eye, 7.0);
        drawing.circle("pupil", eye, 3.0);
        drawing.text("small", [eye[0] + 14.0, eye[1] + 4.0], "eye");
        let numbers = self.numbers();
        for card in &self.cards {
            self.card(&mut drawing, card, numbers[card.ray]);
        }
        drawing
    }

    fn edge(&self, drawing: &mut Drawing, ray: &Ray, from: Point, to: Point) {
        let (line, label) = match ray.kind {
            Kind::Primary => (Line::Primary, String::new()),
            Kind::Reflection => (Line::Reflection, "R".to_owned()),
            Kind::Refraction => (Line::Refraction, "T".to_owned()),
        };
        drawing.line(&format!("ray {}", line.name()), from, to);
        if label.is_empty() {
            return;
        }
        let parent = ray.parent.map(|p| &self.e.trace.rays[p]);
        let weight = parent.and_then(|p| match ray.kind {
            Kind::Reflection => p.reflection.map(|r| r.weight),
            _ => p.refraction.map(|r| r.weight),
        });
        let text = format!("{label} × {}", triple(weight.unwrap_or([1.0; 3])));
        let middle = [0, 1].map(|k| f64::midpoint(from[k], to[k]));
        let width = 7.2 * text.chars().count() as f64 + 6.0;
        drawing.push(&format!(
            "<rect class=\"edge-back\" x=\"{:.1}\" y=\"{:.1}\" width=\"{width:.1}\" height=\"17\" rx=\"3\"/>",
            middle[0] - width / 2.0,
            middle[1] - 8.5
        ));
        drawing.text(
            &format!("edge-label {}", line.name()),
            [middle[0], middle[1] + 4.0],
            &text,
        );
    }

    fn card(&self, drawing: &mut Drawing, card: &Card, number: Option<usize>) {
        let ray = &self.e.trace.rays[card.ray];
        let [x, y] = [card.top[0] - CARD / 2.0, card.top[1]];
        drawing.push(&format!(
            "<rect class=\"card\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"{CARD}\" height=\"{:.1}\" rx=\"6\"/>",
            card.height()
        ));
        let name = ray.hit.as_ref().map_or("background", |hit| &hit.object);
        if let Some(number) = number {
            drawing.badge([x + 15.0, y + 15.0], number);
        }
        let inside = ray.hit.as_ref().is_some_and(from_inside);
        let title = format!("{}{}", cut(name, 20), if inside { ", inside" } else { "" });
        let start = if number.is_some() { 29.0 } else { 10.0 };
        drawing.text("title", [x + start, y + 19.5], &title);
        let adds = added(ray);
        drawing.swatch([x + 10.0, y + 28.0], [12.0, 10.0], bytes(adds));
        drawing.text(
            "small",
            [x + 29.0, y + 37.0],
            &format!("adds {}", brief(adds)),
        );
        for (i, (sign, text)) in card.rows.iter().enumerate() {
            let middle = [x + 24.0, y + 46.0 + ROW * (i as f64 + 0.45)];
            let start = [x + 4.0, middle[1]];
            match sign {
                Sign::None => {}
                Sign::Seen => {
                    drawing.line("ray shadow", start, middle);
                    drawing.circle("lamp", middle, 4.0);
                }
                Sign::Blocked => {
                    drawing.line("ray blocked", start, middle);
                    for d in [3.5, -3.5] {
                        drawing.line(
                            "cross",
                            [middle[0] - 3.5, middle[1] - d],
                            [middle[0] + 3.5, middle[1] + d],
                        );
                    }
                }
            }
            let start = if matches!(sign, Sign::None) {
                10.0
            } else {
                34.0
            };
            drawing.text("small", [x + start, middle[1] + 3.8], &cut(text, LETTERS));
        }
    }
}

/// The rows of a card: shadow rays, eta and angles, and what has no card of its own.
fn rows(e: &Explanation, ray: &Ray, children: &[usize], picked: &Picked) -> Vec<(Sign, String)> {
    let mut rows = Vec::new();
    for light in &ray.terms.lights {
        if let Some(factors) = &light.factors {
            rows.extend(light_row(&light.name, factors));
        }
    }
    if let (Some(refraction), Some(hit)) = (&ray.refraction, &ray.hit) {
        let [from, to] = refraction.eta;
        let (from, to) = (short(from), short(to));
        rows.push((
            Sign::None,
            match refraction.angle_deg {
                None => format!("total reflection, n {from} → {to}"),
                Some(angle) if from != to => format!(
                    "n {from} → {to}, {} → {}",
                    degrees(hit.incidence_deg),
                    degrees(angle)
                ),
                Some(_) => "T: straight on".to_owned(),
            },
        ));
    }
    if ray.depth_reached {
        rows.push((Sign::None, "depth reached".to_owned()));
    }
    let left_out = children.iter().filter(|c| !picked.shown[**c]);
    let count: usize = left_out.map(|c| picked.subtree(&e.trace.rays, *c).0).sum();
    if count > 0 {
        let s = if count == 1 { "" } else { "s" };
        rows.push((Sign::None, format!("… {count} more ray{s}")));
    }
    rows
}

/// A light on a card; none where no shadow ray asks for it.
fn light_row(name: &str, factors: &Factors) -> Option<(Sign, String)> {
    let shadow = factors.shadow?;
    Some(match &factors.blocker {
        Some(blocker) => (Sign::Blocked, format!("{name}: {blocker}")),
        None if shadow == [1.0; 3] => (Sign::Seen, name.to_owned()),
        None => (Sign::Seen, format!("{name} × {}", triple(shadow))),
    })
}
