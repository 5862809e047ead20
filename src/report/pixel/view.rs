//! The side view: the plane that holds most of the ray tree, the scene's outlines on it, and the rays.
//!
//! Upright planes are preferred, so that a floor lies below: another plane is taken only where it holds the rays clearly
//! better. The projection is parallel, the eye stands to the left. The frame holds every hit that is shown; what reaches
//! farther, rays into the background and distant lights, is cut at its edge.

use super::outline::{Outline, outline};
use super::paths::{Line, Segment};
use super::svg::{Drawing, Point, cut, path};
use crate::explain::Explanation;
use crate::math::DVec3;
use crate::scene::Scene;

/// A parallel projection onto the drawing: y down, pixels.
pub(super) struct View {
    right: DVec3,
    up: DVec3,
    /// Towards the viewer.
    towards: DVec3,
    scale: f64,
    /// Middle of the frame, on the plane.
    middle: Point,
    /// Width and height of the frame, pixels.
    pub(super) size: [f64; 2],
}

/// The largest frame.
const FRAME: [f64; 2] = [640.0, 560.0];
/// The lowest frame.
const LOWEST: f64 = 260.0;
/// How much better another plane than an upright one must hold the rays: share of their squared length.
const BETTER: f64 = 0.2;

impl View {
    /// The view for some rays of a scene.
    pub(super) fn new(scene: &Scene, e: &Explanation, segments: &[Segment]) -> Self {
        let (right, up) = plane(scene, segments);
        let mut view = Self {
            right,
            up,
            towards: right.cross(up),
            scale: 1.0,
            middle: [0.0; 2],
            size: FRAME,
        };
        view.fit(e, segments);
        view
    }

    /// A world point on the plane, before scaling.
    fn flat(&self, p: DVec3) -> Point {
        [p.dot(self.right), p.dot(self.up)]
    }

    /// A world point on the drawing.
    pub(super) fn at(&self, p: DVec3) -> Point {
        let [x, y] = self.flat(p);
        [
            self.size[0] / 2.0 + (x - self.middle[0]) * self.scale,
            self.size[1] / 2.0 - (y - self.middle[1]) * self.scale,
        ]
    }

    /// The frame around all hits and the eye, and around lights that are not far off.
    fn fit(&mut self, e: &Explanation, segments: &[Segment]) {
        let ends = segments
            .iter()
            .filter(|s| !s.open && s.line != Line::Shadow);
        let starts = segments.iter().map(|s| s.from);
        let points = starts.chain(ends.map(|s| s.to)).map(|p| self.flat(p));
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        let grow = |low: &mut Point, high: &mut Point, p: Point| {
            for k in 0..2 {
                low[k] = low[k].min(p[k]);
                high[k] = high[k].max(p[k]);
            }
        };
        points.for_each(|p| grow(&mut low, &mut high, p));
        let span = (high[0] - low[0]).max(high[1] - low[1]);
        for light in &e.lights {
            let Some(place) = light.position.map(DVec3::from_array).map(|p| self.flat(p)) else {
                continue;
            };
            let off = |k: usize| (low[k] - place[k]).max(place[k] - high[k]).max(0.0);
            if off(0).max(off(1)) <= 0.6 * span {
                grow(&mut low, &mut high, place);
            }
        }
        let span = (high[0] - low[0]).max(high[1] - low[1]);
        let span = if span > 0.0 { span } else { 1.0 };
        let margin = 0.12 * span;
        let wanted = [0, 1].map(|k| (high[k] - low[k]).max(0.35 * span) + 2.0 * margin);
        self.middle = [0, 1].map(|k| f64::midpoint(low[k], high[k]));
        self.scale = (FRAME[0] / wanted[0]).min(FRAME[1] / wanted[1]);
        self.size = [FRAME[0], (wanted[1] * self.scale).clamp(LOWEST, FRAME[1])];
    }

    /// Draws scene and rays; `numbers` are those of the hits that have a card.
    pub(super) fn draw(
        &self,
        scene: &Scene,
        e: &Explanation,
        segments: &[Segment],
        numbers: &[Option<usize>],
    ) -> Drawing {
        let mut drawing = Drawing::default();
        let named = named(e, numbers);
        let mut labels = Vec::new();
        for object in &scene.objects {
            let outline = outline(object, |p| self.at(p), self.towards);
            let touched = named.contains(&object.name.as_str());
            let class = if touched { "object" } else { "object other" };
            match &outline {
                Outline::Hull(points) => drawing.path(class, &path(points, true)),
                Outline::Edges(edges) => {
                    let data: String = edges.iter().map(|edge| path(edge, false)).collect();
                    drawing.path(&format!("{class} open"), &data);
                }
            }
            if touched {
                labels.push((object.name.as_str(), outline.points()));
            }
        }
        for segment in segments.iter().rev() {
            self.segment(&mut drawing, segment);
        }
        let mut taken = Vec::new();
        self.lights(&mut drawing, e, &mut taken);
        self.eye(&mut drawing, scene, segments, &mut taken);
        self.badges(&mut drawing, e, numbers, &mut taken);
        for (name, points) in labels {
            self.label(&mut drawing, name, &points, &mut taken);
        }
        drawing
    }

    fn segment(&self, drawing: &mut Drawing, segment: &Segment) {
        let (from, to) = (self.at(segment.from), self.at(segment.to));
        let class = format!("ray {}", segment.line.name());
        drawing.line(&class, from, to);
        let length = ((to[0] - from[0]).powi(2) + (to[1] - from[1]).powi(2)).sqrt();
        if length < 24.0 {
            return;
        }
        let way = [(to[0] - from[0]) / length, (to[1] - from[1]) / length];
        match segment.line {
            Line::Blocked => {
                let [x, y] = to;
                for d in [4.5, -4.5] {
                    drawing.line("cross", [x - 4.5, y - d], [x + 4.5, y + d]);
                }
            }
            Line::Shadow => {}
            // An arrow in the middle of what is inside the frame.
            _ => {
                let end = if segment.open {
                    length.min(160.0)
                } else {
                    length
                };
                let [x, y] = [0, 1].map(|k| from[k] + way[k] * end * 0.55);
                let (a, b) = ([-way[1], way[0]], 6.0);
                let tip = |side: f64| {
                    [0, 1].map(|k| [x, y][k] - way[k] * b * 1.6 + a[k] * side * b * 0.7)
                };
                let data = path(&[tip(1.0), [x, y], tip(-1.0)], true);
                drawing.path(&format!("arrow {}", segment.line.name()), &data);
            }
        }
    }

    fn inside(&self, [x, y]: Point) -> bool {
        x > 8.0 && y > 8.0 && x < self.size[0] - 8.0 && y < self.size[1] - 8.0
    }

    fn lights(&self, drawing: &mut Drawing, e: &Explanation, taken: &mut Vec<[f64; 4]>) {
        for light in &e.lights {
            let Some(place) = light.position.map(|p| self.at(DVec3::from_array(p))) else {
                continue;
            };
            if self.inside(place) {
                drawing.circle("lamp", place, 6.0);
                taken.push(around(place, 8.0));
                self.label(drawing, &light.name, &[place], taken);
            }
        }
    }

    fn eye(
        &self,
        drawing: &mut Drawing,
        scene: &Scene,
        segments: &[Segment],
        taken: &mut Vec<[f64; 4]>,
    ) {
        let start = segments.first().map_or(scene.camera.eye, |s| s.from);
        let [x, y] = self.at(start);
        drawing.circle("eye", [x, y], 6.0);
        drawing.circle("pupil", [x, y], 2.5);
        taken.push(around([x, y], 8.0));
        self.label(drawing, "eye", &[[x, y]], taken);
    }

    fn badges(
        &self,
        drawing: &mut Drawing,
        e: &Explanation,
        numbers: &[Option<usize>],
        taken: &mut Vec<[f64; 4]>,
    ) {
        for (ray, number) in e.trace.rays.iter().zip(numbers) {
            let (Some(hit), Some(number)) = (&ray.hit, number) else {
                continue;
            };
            let [x, y] = self.at(DVec3::from_array(hit.point));
            drawing.circle("dot", [x, y], 2.6);
            // Beside the hit, where it covers no other number.
            let places = [
                [11.0, -11.0],
                [-11.0, -11.0],
                [11.0, 12.0],
                [-11.0, 12.0],
                [0.0, -19.0],
                [21.0, 0.0],
            ];
            let free = places
                .iter()
                .map(|[dx, dy]| [x + dx, y + dy])
                .find(|p| self.inside(*p) && !taken.iter().any(|t| overlaps(t, &around(*p, 8.5))));
            let place = free.unwrap_or([x + 11.0, y - 11.0]);
            taken.push(around(place, 8.5));
            drawing.badge(place, *number);
        }
    }

    /// A name near the top of some points, moved down until it covers nothing.
    fn label(
        &self,
        drawing: &mut Drawing,
        name: &str,
        points: &[Point],
        taken: &mut Vec<[f64; 4]>,
    ) {
        let name = cut(name, 28);
        let width = 7.0 * name.chars().count() as f64 + 4.0;
        let [frame_width, frame_height] = self.size;
        let fold = |k: usize, most: f64| {
            let inner = points.iter().map(|p| p[k].clamp(0.0, most));
            inner.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
                (a.min(x), b.max(x))
            })
        };
        let ((left, right), (top, _)) = (fold(0, frame_width), fold(1, frame_height));
        if left > right {
            return;
        }
        let least = width / 2.0 + 6.0;
        let x = f64::midpoint(left, right).clamp(least, (frame_width - least).max(least));
        let mut y = (top - 8.0).clamp(16.0, frame_height - 8.0);
        let area = |y: f64| [x - width / 2.0, y - 12.0, x + width / 2.0, y + 4.0];
        for _ in 0..12 {
            if !taken.iter().any(|t| overlaps(t, &area(y))) || y > frame_height - 24.0 {
                break;
            }
            y += 16.0;
        }
        taken.push(area(y));
        drawing.text("label", [x, y], &name);
    }
}

fn around([x, y]: Point, radius: f64) -> [f64; 4] {
    [x - radius, y - radius, x + radius, y + radius]
}

fn overlaps(a: &[f64; 4], b: &[f64; 4]) -> bool {
    a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3]
}

/// Objects that rays meet or that block a light, of the hits that have a number.
fn named<'e>(e: &'e Explanation, numbers: &[Option<usize>]) -> Vec<&'e str> {
    let shown = e
        .trace
        .rays
        .iter()
        .zip(numbers)
        .filter(|(_, n)| n.is_some());
    let mut names = Vec::new();
    for (ray, _) in shown {
        names.extend(ray.hit.as_ref().map(|hit| hit.object.as_str()));
        for light in &ray.terms.lights {
            names.extend(light.factors.as_ref().and_then(|f| f.blocker.as_deref()));
        }
    }
    names
}

/// Right and up of the plane that the rays lie in best.
fn plane(scene: &Scene, segments: &[Segment]) -> (DVec3, DVec3) {
    let camera = &scene.camera;
    // Scenes have y up, or z where the camera says so.
    let sky = if camera.up.normalize_or_zero().z > 0.7 {
        DVec3::Z
    } else {
        DVec3::Y
    };
    let ways: Vec<(DVec3, f64)> = segments
        .iter()
        .map(|s| {
            let weight = match s.line {
                Line::Shadow | Line::Blocked => 0.1,
                _ => 1.0,
            };
            ((s.to - s.from).normalize_or_zero(), weight)
        })
        .collect();
    let total: f64 = ways.iter().map(|(_, w)| w).sum();
    let outside = |n: DVec3| {
        let sum: f64 = ways.iter().map(|(d, w)| w * d.dot(n) * d.dot(n)).sum();
        sum / total.max(f64::MIN_POSITIVE)
    };
    let best = |normals: &mut dyn Iterator<Item = DVec3>| {
        normals
            .map(|n| (outside(n), n))
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .unwrap_or((0.0, DVec3::Z))
    };
    let (e1, e2) = sky.any_orthonormal_pair();
    let upright = best(&mut (0..360).map(|i| {
        let (sine, cosine) = libm::sincos(f64::from(i) * std::f64::consts::PI / 360.0);
        e1 * cosine + e2 * sine
    }));
    let any = best(&mut (0..4000).map(fibonacci));
    let normal = if upright.0 <= any.0 + BETTER {
        upright.1
    } else {
        any.1
    };
    let up = (sky - normal * sky.dot(normal)).normalize_or_zero();
    let up = if up == DVec3::ZERO { e1 } else { up };
    let right = up.cross(normal);
    // The eye looks to the right.
    let forward = segments
        .first()
        .map_or(camera.target - camera.eye, |s| s.to - s.from);
    if forward.dot(right) < 0.0 {
        (-right, up)
    } else {
        (right, up)
    }
}

/// Directions spread evenly over the sphere.
fn fibonacci(i: u32) -> DVec3 {
    let z = 1.0 - (f64::from(i) + 0.5) / 2000.0;
    let turn = f64::from(i) * std::f64::consts::PI * (3.0 - 5f64.sqrt());
    let (sine, cosine) = libm::sincos(turn);
    let radius = (1.0 - z * z).max(0.0).sqrt();
    DVec3::new(radius * cosine, radius * sine, z)
}
