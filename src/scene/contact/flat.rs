//! Flat faces: convex polygons in the world, some with a hole; whether two lie in one plane, and overlap there.

use crate::math::DVec3;
use crate::math::float::normalize;

/// Corners of a polygon in order: of most faces three, without a list of their own.
#[derive(Clone, Debug)]
pub(super) enum Rim {
    Three([DVec3; 3]),
    Many(Vec<DVec3>),
}

impl std::ops::Deref for Rim {
    type Target = [DVec3];
    fn deref(&self) -> &[DVec3] {
        match self {
            Self::Three(corners) => corners,
            Self::Many(corners) => corners,
        }
    }
}

/// A convex polygon.
#[derive(Clone, Debug)]
pub(super) struct Flat {
    /// Its corners, in order.
    rim: Rim,
    /// Corners of a convex hole in it; may be empty.
    hole: Vec<DVec3>,
    center: DVec3,
    /// Unit normal, on either side.
    normal: DVec3,
    /// The least extent across it.
    width: f64,
    /// Outward side of the surface, any length.
    pub(super) outward: DVec3,
    /// It is part of a surface that encloses nothing.
    pub(super) sheet: bool,
}

impl Flat {
    /// `None` where it has no area.
    pub(super) fn new(rim: Rim, hole: Vec<DVec3>, outward: DVec3, sheet: bool) -> Option<Self> {
        let first = *rim.first()?;
        // Twice the area, as a sum of triangles about the first corner.
        let area = rim.windows(2).fold(DVec3::ZERO, |sum, side| {
            sum + (side[0] - first).cross(side[1] - first)
        });
        let (normal, length) = normalize(area.to_array());
        let normal = DVec3::from_array(normal);
        let longest = rim
            .iter()
            .flat_map(|p| rim.iter().map(|q| (*p - *q).length()));
        // Triangles and quads have few corners; of round rims a few diagonals are as good as all.
        let longest = longest.take(256).fold(0.0, f64::max);
        let width = length / (2.0 * longest);
        let center = rim.iter().sum::<DVec3>() / rim.len() as f64;
        (width > 0.0 && center.is_finite() && width.is_finite()).then_some(Self {
            rim,
            hole,
            center,
            normal,
            width,
            outward,
            sheet,
        })
    }

    /// Distance of a point from the plane.
    pub(super) fn distance(&self, p: DVec3) -> f64 {
        (p - self.center).dot(self.normal).abs()
    }

    /// How far the plane may be from where it seems at a point, if its corners are wrong by `error`: a narrow face says
    /// little about what is far from it.
    pub(super) fn doubt(&self, p: DVec3, error: f64) -> f64 {
        error * (1.0 + 2.0 * (p - self.center).length() / self.width)
    }

    /// All corners of another lie in this plane, as far as can be told.
    fn holds(&self, other: &Self, own_error: f64, error: f64) -> bool {
        let in_plane = |p: &DVec3| self.distance(*p) <= error + self.doubt(*p, own_error);
        in_plane(&other.center) && other.rim.iter().all(in_plane)
    }
}

/// Whether two polygons, with the errors of their corners, lie in one plane and overlap by more than those.
pub(super) fn on_each_other((a, a_error): (&Flat, f64), (b, b_error): (&Flat, f64)) -> bool {
    // Not parallel, or apart: the common case, decided first.
    if !a.holds(b, a_error, b_error) || !b.holds(a, b_error, a_error) {
        return false;
    }
    let least = 4.0 * (a_error + b_error);
    overlap(&a.rim, &b.rim, a.normal, least)
        && !is_within(&b.rim, &a.hole, a.normal, least)
        && !is_within(&a.rim, &b.hole, a.normal, least)
}

/// Separating axes: convex polygons overlap where their shadows on the normal of every side do.
fn overlap(a: &[DVec3], b: &[DVec3], normal: DVec3, least: f64) -> bool {
    let separated = |side: DVec3| {
        let axis = DVec3::from_array(normalize(normal.cross(side).to_array()).0);
        if axis == DVec3::ZERO {
            return false;
        }
        let [a_low, a_high] = shadow(a, axis);
        let [b_low, b_high] = shadow(b, axis);
        a_high.min(b_high) - a_low.max(b_low) <= least
    };
    !sides(a).chain(sides(b)).any(separated)
}

/// Whether all points lie in a convex polygon, its border included.
fn is_within(points: &[DVec3], polygon: &[DVec3], normal: DVec3, least: f64) -> bool {
    if polygon.is_empty() {
        return false;
    }
    let center = polygon.iter().sum::<DVec3>() / polygon.len() as f64;
    // A rim drawn around its circle stands out over the circle of a hole of the same size.
    let slack = 2.0 * (1.0 - libm::cos(std::f64::consts::PI / polygon.len() as f64));
    polygon.iter().zip(sides(polygon)).all(|(corner, side)| {
        let axis = DVec3::from_array(normalize(normal.cross(side).to_array()).0);
        let room = (center - *corner).dot(axis);
        let axis = if room < 0.0 { -axis } else { axis };
        let allowed = -least - slack * room.abs();
        points.iter().all(|p| (*p - *corner).dot(axis) >= allowed)
    })
}

fn sides(polygon: &[DVec3]) -> impl Iterator<Item = DVec3> {
    let next = polygon.iter().cycle().skip(1);
    polygon.iter().zip(next).map(|(p, q)| *q - *p)
}

fn shadow(points: &[DVec3], axis: DVec3) -> [f64; 2] {
    let along = points.iter().map(|p| p.dot(axis));
    along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
        [low.min(x), high.max(x)]
    })
}
