//! Coverage of one triangle from homogeneous vertices: exact half-planes where there are no snapped integers to step.
//!
//! For triangles that cross near or far, reach beyond the range of the integers, or are drawn without a snap grid. Nothing
//! is clipped and nothing divided: a side is the plane through the eye and two vertices, and a sample is inside by the sign
//! of a 3 x 3 determinant, decided exactly (Olano and Greer 1997; Shewchuk 1997). Where all three signs agree with the
//! triangle's own orientation the sample's ray meets it in front of the eye, so w <= 0 needs no care (GL 2.1 section 2.12
//! clips to the same end). Samples on a side belong to the triangle for which it is a left side or a horizontal top side,
//! as in `edges`.
//!
//! A side between two snapped vertices lies where the integers of `edges` have it (pixel frame); any other side runs between
//! the vertices as they are, or through the ray of its snapped end (ray frame: x, y, w and the sample's (X, Y, 1)); a side to
//! a vertex beyond the near plane keeps its direction there ([`end`]).
//! Neighbours share both ends, so they share the line, whichever of them needs this module: each sample has one owner.
//!
//! Near and far bound a sample by the triangle's own distance under it, which is linear over w, too. That is a value, not
//! a decision that two triangles must share, and is taken in f64.

use super::edges::double_area;
use super::view::{Vertex, View, orientation, scaled};
use crate::lanes::Real;
use crate::math::Each;
use crate::math::float::{difference_of_products, dot};

/// A multiple of the sum of absolute products that exceeds the rounding of a determinant; as in [`orientation`].
const DOUBT: f64 = 8.0 * f64::EPSILON;

/// One side: inside = the determinant of `from`, `to` and the sample is positive.
#[derive(Clone, Copy, Debug, Default)]
struct Side {
    from: [f64; 3],
    to: [f64; 3],
    /// from x to, rounded.
    normal: [f64; 3],
    /// Bound of the rounding of normal . sample = doubt . |sample|.
    doubt: [f64; 3],
    /// Both ends are snapped: the frame is the pixel frame.
    in_pixels: bool,
    /// A sample on the side is inside.
    owns_ties: bool,
}

/// Three sides, and what near and far cut off.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sides {
    side: [Side; 3],
    /// Inside = normal . (X, Y, 1) not negative; (0, 0, 0) = no cut.
    near: [f64; 3],
    far: [f64; 3],
}

/// A sample in both frames.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    /// Pixel frame, y down.
    pub(super) pixel: [f64; 2],
    /// Ray (X, Y).
    pub(super) ray: [f64; 2],
}

/// Which tests a run of samples still needs: a bit for each side, then near, then far.
pub(super) type Needed = u8;

/// All tests.
pub(super) const ALL: Needed = 0b1_1111;

/// A vertex in both frames.
#[derive(Clone)]
struct Place {
    snapped: Option<[i64; 2]>,
    pixel: [f64; 3],
    ray: [f64; 3],
}

impl Place {
    fn new(view: &View, v: &Vertex) -> Self {
        let snapped = view.snap(v);
        match snapped {
            Some(p) => {
                let unit = view.unit() as f64;
                let pixel = [p[0] as f64 / unit, p[1] as f64 / unit];
                let ray = view.ray(pixel);
                Self {
                    snapped,
                    pixel: [pixel[0], pixel[1], 1.0],
                    ray: [ray[0], ray[1], 1.0],
                }
            }
            None => Self {
                snapped,
                pixel: [0.0; 3],
                ray: scaled(v.homogeneous()),
            },
        }
    }
}

impl Sides {
    /// The sides of a triangle of finite vertices that faces as `facing` says (not 0); `None` where it has no area.
    pub(super) fn new(view: &View, corners: &[Vertex; 3], facing: i32) -> Option<Self> {
        let places = [0, 1, 2].each(|i| Place::new(view, &corners[i]));
        let turn = match [0, 1, 2].each(|i| places[i].snapped) {
            [Some(a), Some(b), Some(c)] => {
                let area = double_area([a, b, c]).signum() as i32;
                if view.y_up() { -area } else { area }
            }
            // Snapping may leave no area between two ends that are far ahead; the part before the eye has its own all the same.
            _ => orientation(corners.each(|v| scaled(v.homogeneous()))),
        };
        if turn == 0 {
            return None;
        }
        let side = [(0, 1), (1, 2), (2, 0)].each(|(i, j)| {
            let (from, to) = if turn > 0 { (i, j) } else { (j, i) };
            let ends = [(from, to), (to, from)].each(|(this, other)| {
                let snapped = places[other].snapped.is_some();
                end(
                    view,
                    &places[this],
                    [&corners[this], &corners[other]],
                    snapped,
                )
            });
            Side::new(&ends[0], &ends[1], view.y_up())
        });
        let [near, far] = cuts(view, corners, facing);
        Some(Self { side, near, far })
    }

    /// Whether a sample is inside, as far as the tests that are needed say.
    #[inline]
    pub(super) fn contains(&self, sample: &Sample, needed: Needed) -> bool {
        (0..3).all(|i| needed & (1 << i) == 0 || self.side[i].contains(sample))
            && (needed & 0b0_1000 == 0 || along(&self.near, sample.ray) >= 0.0)
            && (needed & 0b1_0000 == 0 || along(&self.far, sample.ray) >= 0.0)
    }

    /// What the samples of a row between two of its samples still need; `None` where all are outside.
    pub(super) fn between(&self, first: &Sample, last: &Sample) -> Option<Needed> {
        let mut needed = ALL;
        for (i, side) in self.side.iter().enumerate() {
            // Values are linear in the row, so what holds beyond doubt at both ends holds between them.
            match (side.certain(first), side.certain(last)) {
                (-1, -1) => return None,
                (1, 1) => needed &= !(1 << i),
                _ => {}
            }
        }
        for (bit, cut) in [(0b0_1000, &self.near), (0b1_0000, &self.far)] {
            if *cut == [0.0; 3] {
                needed &= !bit;
            }
        }
        Some(needed)
    }
}

impl Side {
    fn new(from: &Place, to: &Place, y_up: bool) -> Self {
        let in_pixels = from.snapped.is_some() && to.snapped.is_some();
        if in_pixels && from.snapped == to.snapped {
            // A side without length bounds nothing: the other two meet there.
            return Self {
                normal: [0.0, 0.0, 1.0],
                ..Self::default()
            };
        }
        // Where rays count y upwards, the pixel frame is theirs turned over, and the ends change places.
        let (from, to) = match (in_pixels, y_up) {
            (true, true) => (to.pixel, from.pixel),
            (true, false) => (from.pixel, to.pixel),
            (false, _) => (from.ray, to.ray),
        };
        let (mut normal, mut doubt) = ([0.0; 3], [0.0; 3]);
        for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
            let (p, q) = (from[j] * to[k], from[k] * to[j]);
            normal[i] = p - q;
            doubt[i] = DOUBT * (p.abs() + q.abs());
        }
        // Inside lies to the right of a left side, and below a top side.
        let rightwards = orientation([from, to, [1.0, 0.0, 0.0]]);
        let down = if y_up && !in_pixels { -1.0 } else { 1.0 };
        let downwards = orientation([from, to, [0.0, down, 0.0]]);
        Self {
            from,
            to,
            normal,
            doubt,
            in_pixels,
            owns_ties: rightwards > 0 || (rightwards == 0 && downwards > 0),
        }
    }

    /// The sample in this side's frame.
    #[inline]
    fn place(&self, sample: &Sample) -> [f64; 2] {
        if self.in_pixels {
            sample.pixel
        } else {
            sample.ray
        }
    }

    /// +1 inside, -1 outside, 0 in doubt.
    #[inline]
    fn certain(&self, sample: &Sample) -> i32 {
        let place = self.place(sample);
        let value = along(&self.normal, place);
        let bound = along(&self.doubt, place.each(f64::abs));
        i32::from(value > bound) - i32::from(value < -bound)
    }

    #[inline]
    fn contains(&self, sample: &Sample) -> bool {
        match self.certain(sample) {
            0 => self.decide(self.place(sample)),
            certain => certain > 0,
        }
    }

    #[cold]
    fn decide(&self, [x, y]: [f64; 2]) -> bool {
        match orientation([self.from, self.to, [x, y, 1.0]]) {
            0 => self.owns_ties,
            sign => sign > 0,
        }
    }
}

/// The end of a side: `place`, that of the first vertex; but where only the other end is snapped and this one is beyond the near
/// plane, the point at infinity in the side's direction.
///
/// Such a side is the true one moved by what snapping moves its seen end: half a sub-pixel step at most, everywhere. Drawn to the
/// vertex behind the eye it would leave the true line without bound, since what is seen of it lies beyond that vertex, around
/// through infinity. GL clips and then snaps (GL 2.1 sections 2.12 and 3.5.1): within a step of the same.
fn end(view: &View, place: &Place, [this, other]: [&Vertex; 2], other_snapped: bool) -> Place {
    if place.snapped.is_some() || !other_snapped || view.inside_near(this) >= 0.0 {
        return place.clone();
    }
    // With a the seen end, b this one, and d = (b_xy a_w - a_xy b_w, 0): det(a, b, s) = det(a, d, s) / a_w, and a_w > 0. Common
    // powers of two change no direction and keep products within range.
    let [a, b] = [other, this].each(Vertex::homogeneous);
    let largest = a.iter().chain(&b).fold(0.0f64, |m, x| m.max(x.abs()));
    let (down, _) = largest.power_of_two_scale();
    let [a, b] = [a, b].each(|v| v.each(|x| x * down));
    let along = |k: usize| difference_of_products(b[k], a[2], a[k], b[2]);
    Place {
        ray: scaled([along(0), along(1), 0.0]),
        ..place.clone()
    }
}

#[inline]
fn along(normal: &[f64; 3], [x, y]: [f64; 2]) -> f64 {
    normal[0] * x + normal[1] * y + normal[2]
}

/// The half-planes of the near and the far plane: a sample's weights times the corners' distances from the plane.
fn cuts(view: &View, corners: &[Vertex; 3], facing: i32) -> [[f64; 3]; 2] {
    let h = corners.each(|v| scaled(v.homogeneous()));
    // Weights refer to the vertices themselves, so each scaled one gives back what the other two were divided by.
    let scale = corners.each(|v| {
        let [x, y, w] = v.homogeneous();
        let largest = x.abs().max(y.abs()).max(w.abs());
        largest.power_of_two_scale().0
    });
    let mut normals = [[0.0; 3]; 3];
    for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
        let (a, b) = if facing > 0 {
            (h[j], h[k])
        } else {
            (h[k], h[j])
        };
        normals[i] = crate::math::float::cross(a, b);
    }
    let cut = |inside: [f64; 3]| {
        if inside.iter().all(|d| *d >= 0.0) {
            return [0.0; 3];
        }
        // The plane's distances may be as large as the vertices: they are scaled alike.
        let inside = [0, 1, 2].each(|i| inside[i] * scale[i]);
        let form = [0, 1, 2].each(|axis| dot(normals.each(|n| n[axis]), inside));
        // All zero would mean no cut; here nothing is certain, and nothing is drawn.
        if form == [0.0; 3] {
            [0.0, 0.0, -1.0]
        } else {
            form
        }
    };
    [
        cut(corners.each(|v| view.inside_near(&v))),
        cut(corners.each(|v| view.inside_far(&v))),
    ]
}
