//! The weighted ray tree as indented lines: what each ray adds, its weight, and what it meets.

use super::pick::{Picked, added, pick, plus};
use super::sheet::{FAINT, MARK, NAME, Sheet, cells, length, styled};
use super::{degrees, from_inside, short, triple};
use crate::explain::{Kind, Ray, Refraction};
use crate::math::color::Rgb;

/// A line of the tree.
struct Line {
    adds: Option<Rgb>,
    weight: String,
    text: String,
}

/// Rays to show, and the lines so far.
struct Tree<'a> {
    rays: &'a [Ray],
    picked: Picked,
    lines: Vec<Line>,
}

/// Writes the tree; at most `most` rays that add at least `least` in lines of their own.
pub(super) fn rows(sheet: &mut Sheet, rays: &[Ray], most: usize, least: f64) {
    let mut tree = Tree {
        rays,
        picked: pick(rays, most, least),
        lines: Vec::new(),
    };
    tree.walk();
    let weights = tree.lines.iter().map(|l| length(&l.weight));
    let width = weights.max().unwrap_or(0).max("weight".len());
    sheet.columns(0, &format!("{:width$}   ray", "weight"));
    let mut sum = [0.0; 3];
    for line in &tree.lines {
        let numbers = line.adds.map_or_else(|| " ".repeat(27), cells);
        sum = line.adds.map_or(sum, |adds| plus(sum, adds));
        let pad = width - length(&line.weight);
        let weight = format!("{}{:pad$}", line.weight, "");
        sheet.line(&format!(
            "{numbers}   {}   {}",
            styled(FAINT, weight),
            line.text
        ));
    }
    sheet.line(&styled(FAINT, "─".repeat(27)));
    sheet.line(&format!("{}   all rays together", cells(sum)));
}

/// What is to be written next: a ray, what is left out below one, or an end without a ray.
enum Step {
    Ray(usize),
    Rest(Vec<usize>),
    End(String),
}

impl Tree<'_> {
    /// Depth first, without recursion: trees may be 10,000 rays deep.
    fn walk(&mut self) {
        // A step with the lines drawn before it, and whether it is the last of its parent.
        let mut waiting = vec![(Step::Ray(0), String::new(), true)];
        while let Some((step, before, last)) = waiting.pop() {
            let root = matches!(step, Step::Ray(0));
            let joint = match (root, last) {
                (true, _) => "",
                (_, true) => "└ ",
                _ => "├ ",
            };
            let start = styled(FAINT, format!("{before}{joint}"));
            match step {
                Step::Ray(id) => {
                    self.ray(id, &start);
                    let below = match (root, last) {
                        (true, _) => "",
                        (_, true) => "  ",
                        _ => "│ ",
                    };
                    let steps = self.steps(id);
                    let count = steps.len();
                    for (i, step) in steps.into_iter().enumerate().rev() {
                        waiting.push((step, format!("{before}{below}"), i + 1 == count));
                    }
                }
                Step::Rest(ids) => self.rest(&ids, &start),
                Step::End(text) => self.lines.push(Line {
                    adds: None,
                    weight: String::new(),
                    text: format!("{start}{text}"),
                }),
            }
        }
    }

    /// What follows from a ray.
    fn steps(&self, id: usize) -> Vec<Step> {
        let ray = &self.rays[id];
        let mut steps = Vec::new();
        let mut rest = Vec::new();
        for child in &self.picked.children[id] {
            if self.picked.shown[*child] {
                steps.push(Step::Ray(*child));
            } else {
                rest.push(*child);
            }
        }
        if !rest.is_empty() {
            steps.push(Step::Rest(rest));
        }
        if let Some(refraction) = ray.refraction.as_ref().filter(|r| r.tir) {
            steps.push(Step::End(format!("T {}", total_reflection(refraction))));
        }
        if ray.depth_reached {
            let text = styled(
                MARK,
                "depth reached: its mirror and transmitted rays are not cast",
            );
            steps.push(Step::End(text));
        }
        steps
    }

    fn ray(&mut self, id: usize, start: &str) {
        let ray = &self.rays[id];
        let how = match ray.kind {
            Kind::Primary => "from the eye".to_owned(),
            Kind::Reflection => "R mirrored".to_owned(),
            Kind::Refraction => format!("T {}", self.bent(ray)),
        };
        self.lines.push(Line {
            adds: Some(added(ray)),
            weight: triple(ray.weight),
            text: format!("{start}{how} → {}", met(ray)),
        });
    }

    /// Eta and angles at the hit that a transmitted ray leaves.
    fn bent(&self, ray: &Ray) -> String {
        let parent = ray.parent.map(|p| &self.rays[p]);
        let Some((refraction, hit)) =
            parent.and_then(|p| p.refraction.as_ref().zip(p.hit.as_ref()))
        else {
            return "transmitted".to_owned();
        };
        let [from, to] = refraction.eta;
        match refraction.angle_deg {
            Some(angle) if from != to => format!(
                "n {} → {}, {} → {}",
                short(from),
                short(to),
                degrees(hit.incidence_deg),
                degrees(angle)
            ),
            _ => "straight on".to_owned(),
        }
    }

    fn rest(&mut self, ids: &[usize], start: &str) {
        let parts = ids.iter().map(|id| self.picked.subtree(self.rays, *id));
        let (count, sum) = parts.fold((0, [0.0; 3]), |(n, s), (more, part)| {
            (n + more, plus(s, part))
        });
        let s = if count == 1 { "" } else { "s" };
        self.lines.push(Line {
            adds: Some(sum),
            weight: String::new(),
            text: format!("{start}{}", styled(FAINT, format!("… {count} more ray{s}"))),
        });
    }
}

/// What a ray meets.
fn met(ray: &Ray) -> String {
    let Some(hit) = &ray.hit else {
        return "nothing: the background".to_owned();
    };
    let from = if from_inside(hit) {
        ", from inside"
    } else {
        ""
    };
    format!(
        "{} ({}){from}, {} away, {}",
        styled(NAME, &hit.object),
        hit.material,
        short(hit.distance),
        degrees(hit.incidence_deg)
    )
}

/// Eta, the critical angle and what follows, at total internal reflection.
pub(super) fn total_reflection(refraction: &Refraction) -> String {
    let [from, to] = refraction.eta;
    let critical = libm::asin((to / from).min(1.0)).to_degrees();
    let what = if refraction.fresnel > 0.0 {
        "K_T goes to the mirror ray"
    } else {
        "I_T = 0"
    };
    let text = format!(
        "total internal reflection: n {} → {} beyond {}, so {what}",
        short(from),
        short(to),
        degrees(critical)
    );
    styled(MARK, text)
}
