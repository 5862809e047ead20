//! The faces of objects in world space: flat polygons, and curved carriers with their extents.

use super::curved::{Curved, Kind};
use super::flat::{Flat, Rim};
use super::{Detail, Key};
use crate::math::float::normalize;
use crate::math::transform::{mirrors, normal_matrix};
use crate::math::{DAffine3, DMat3, DVec3};
use crate::scene::assembly::object_mesh;
use crate::scene::fit::Bounds;
use crate::scene::profile::{Piece, Profile};
use crate::scene::{Geometry, Mesh, Object, Shape, fit, revolution};

/// A face.
#[derive(Clone, Debug)]
pub(super) struct Face {
    pub(super) key: Key,
    /// Widened by the error.
    pub(super) bounds: Bounds,
    /// How far rounding may have moved its points.
    pub(super) error: f64,
    pub(super) form: Form,
}

#[derive(Clone, Debug)]
pub(super) enum Form {
    Flat(Flat),
    Curved(Box<Curved>),
}

/// Sides of the polygon around a round face.
const SLICES: u32 = 64;

/// What rounding may do to a coordinate of this size: a transform of three products and three sums, and a chain of
/// steps that composed it, each within a few units in the last place.
pub(super) fn rounding(size: f64) -> f64 {
    16.0 * f64::EPSILON * size
}

/// The rounding of an object whose bounds these are; parts that cancel in its transform reach twice as far.
pub(super) fn object_rounding(bounds: &Bounds) -> f64 {
    let size = bounds.min.abs().max(bounds.max.abs()).max_element();
    4.0 * rounding(size)
}

pub(super) fn widened(bounds: &Bounds, by: f64) -> Bounds {
    Bounds {
        min: bounds.min - by,
        max: bounds.max + by,
    }
}

/// Shows every face of an object whose bounds are asked for.
pub(super) fn each(
    object: &Object,
    number: u32,
    detail: Detail,
    wanted: &impl Fn(&Bounds) -> bool,
    visit: &mut impl FnMut(Face),
) {
    let place = &object.world_from_object;
    let mut offer = |face: Face| {
        let finite = face.bounds.min.is_finite() && face.bounds.max.is_finite();
        if finite && wanted(&face.bounds) {
            visit(face);
        }
    };
    match (&object.geometry, detail) {
        (Geometry::Shape(shape), Detail::Exact) => {
            let maker = Maker {
                place,
                number,
                sheet: !shape.is_closed(),
            };
            maker.shape(shape, &mut offer);
        }
        (Geometry::Mesh(mesh), _) => triangles(mesh, place, number, false, wanted, &mut offer),
        (Geometry::Shape(_), Detail::Triangles(level)) => {
            let mesh = object_mesh(object, level);
            let flip = mirrors(place);
            triangles(&mesh, place, number, flip, wanted, &mut offer);
        }
    }
}

/// The triangles of a mesh; `flip` where a mirrored shape keeps its outward side.
fn triangles(
    mesh: &Mesh,
    place: &DAffine3,
    number: u32,
    flip: bool,
    wanted: &impl Fn(&Bounds) -> bool,
    offer: &mut impl FnMut(Face),
) {
    let sheet = std::cell::OnceCell::new();
    let reach = absolute(&place.matrix3);
    for (part, triangle) in mesh.triangles.iter().enumerate() {
        let object = triangle.map(|v| mesh.positions[v as usize]);
        let rim = object.map(|p| place.transform_point3(p));
        let bounds = around(&rim);
        let size = object.map(|p| (reach * p.abs() + place.translation.abs()).max_element());
        let error = rounding(size[0].max(size[1]).max(size[2]));
        let bounds = widened(&bounds, 2.0 * error);
        if !wanted(&bounds) {
            continue;
        }
        let sheet = *sheet.get_or_init(|| !mesh.is_closed());
        let normal = (rim[1] - rim[0]).cross(rim[2] - rim[0]);
        let outward = if flip { -normal } else { normal };
        if let Some(flat) = Flat::new(Rim::Three(rim), Vec::new(), outward, sheet) {
            let part = part as u32;
            offer(Face {
                key: Key {
                    object: number,
                    part,
                },
                bounds,
                error,
                form: Form::Flat(flat),
            });
        }
    }
}

/// Makes the faces of one shape.
struct Maker<'a> {
    place: &'a DAffine3,
    number: u32,
    /// It encloses nothing.
    sheet: bool,
}

impl Maker<'_> {
    fn shape(&self, shape: &Shape, offer: &mut impl FnMut(Face)) {
        match *shape {
            Shape::Patch {
                corner,
                edge_u: u,
                edge_v: v,
                ..
            } => {
                let rim = [corner, corner + u, corner + u + v, corner + v];
                self.flat(0, &rim, &[], u.cross(v), offer);
            }
            Shape::Box { min, max } => self.cuboid(min, max, offer),
            Shape::Disk {
                center,
                normal,
                radius,
            } => self.round(0, center, normal, [0.0, radius], offer),
            Shape::Sphere { center, radius } => {
                self.curved(0, shape, Kind::Sphere { center, radius }, offer);
            }
            Shape::Torus {
                center,
                axis,
                major,
                minor,
            } => {
                let axis = unit(axis);
                let kind = Kind::Torus {
                    center,
                    axis,
                    major,
                    minor,
                };
                self.curved(0, shape, kind, offer);
            }
            Shape::Cylinder {
                base,
                top,
                radius,
                caps,
            } => {
                let axis = top - base;
                let kind = Kind::Tube { base, axis, radius };
                self.curved(0, shape, kind, offer);
                if caps {
                    self.round(1, base, -axis, [0.0, radius], offer);
                    self.round(2, top, axis, [0.0, radius], offer);
                }
            }
            Shape::Cone {
                base,
                apex,
                radius,
                cap,
            } => {
                let axis = base - apex;
                self.curved(0, shape, Kind::Cone { apex, axis, radius }, offer);
                if cap {
                    self.round(1, base, axis, [0.0, radius], offer);
                }
            }
            Shape::Revolution {
                base,
                axis,
                ref profile,
            } => self.turned(base, axis, profile, offer),
            Shape::Bezier { .. } => {}
        }
    }

    fn cuboid(&self, min: DVec3, max: DVec3, offer: &mut impl FnMut(Face)) {
        for part in 0..6u32 {
            let axis = (part / 2) as usize;
            let end = if part.is_multiple_of(2) { min } else { max };
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let corner = |on_u: DVec3, on_v: DVec3| {
                let mut p = [0.0; 3];
                p[axis] = end.to_array()[axis];
                p[u] = on_u.to_array()[u];
                p[v] = on_v.to_array()[v];
                DVec3::from_array(p)
            };
            let rim = [
                corner(min, min),
                corner(max, min),
                corner(max, max),
                corner(min, max),
            ];
            let mut outward = [0.0; 3];
            outward[axis] = if part.is_multiple_of(2) { -1.0 } else { 1.0 };
            self.flat(part, &rim, &[], DVec3::from_array(outward), offer);
        }
    }

    fn turned(&self, base: DVec3, axis: DVec3, profile: &Profile, offer: &mut impl FnMut(Face)) {
        let n = unit(axis);
        for (part, piece) in profile.pieces().iter().enumerate() {
            let part = part as u32;
            let [from, to] = [piece.at(0.0), piece.at(1.0)];
            if is_level(piece) {
                let outward = if to.x > from.x { -n } else { n };
                let radii = [from.x.min(to.x), from.x.max(to.x)];
                self.round(part, base + from.y * n, outward, radii, offer);
                continue;
            }
            let bounds = revolution::bounds(base, axis, piece, self.place);
            let kind = Kind::Band {
                base,
                axis: n,
                piece: *piece,
            };
            let size = base.abs().max_element() + profile.radius() + from.y.abs().max(to.y.abs());
            self.bent(part, kind, bounds, size, offer);
        }
    }

    /// A face of a shape whose bounds are the shape's.
    fn curved(&self, part: u32, shape: &Shape, kind: Kind, offer: &mut impl FnMut(Face)) {
        if let Some(bounds) = fit::of_shape(shape, self.place) {
            let size = kind.size();
            self.bent(part, kind, bounds, size, offer);
        }
    }

    fn bent(&self, part: u32, kind: Kind, bounds: Bounds, size: f64, offer: &mut impl FnMut(Face)) {
        let reach = absolute(&self.place.matrix3) * DVec3::splat(size);
        let error = rounding((reach + self.place.translation.abs()).max_element());
        if let Some(curved) = Curved::new(kind, self.place) {
            offer(Face {
                key: self.key(part),
                bounds: widened(&bounds, 2.0 * error),
                error,
                form: Form::Curved(Box::new(curved)),
            });
        }
    }

    /// A ring between two radii, or a disk.
    fn round(
        &self,
        part: u32,
        center: DVec3,
        normal: DVec3,
        [least, most]: [f64; 2],
        offer: &mut impl FnMut(Face),
    ) {
        let n = unit(normal);
        let (x, y) = n.any_orthonormal_pair();
        let half = std::f64::consts::PI / f64::from(SLICES);
        let ring = |radius: f64| -> Vec<DVec3> {
            let point = |i: u32| {
                let (sin, cos) = libm::sincos(2.0 * half * f64::from(i));
                center + radius * (cos * x + sin * y)
            };
            (0..SLICES).map(point).collect()
        };
        // Around the rim, and within the hole.
        let rim = ring(most / libm::cos(half));
        let hole = if least > 0.0 { ring(least) } else { Vec::new() };
        self.flat(part, &rim, &hole, n, offer);
    }

    fn flat(
        &self,
        part: u32,
        rim: &[DVec3],
        hole: &[DVec3],
        outward: DVec3,
        offer: &mut impl FnMut(Face),
    ) {
        let reach = absolute(&self.place.matrix3);
        let size = |p: &DVec3| (reach * p.abs() + self.place.translation.abs()).max_element();
        let error = rounding(rim.iter().map(size).fold(0.0, f64::max));
        let world = |points: &[DVec3]| -> Vec<DVec3> {
            points
                .iter()
                .map(|p| self.place.transform_point3(*p))
                .collect()
        };
        let rim = world(rim);
        let bounds = widened(&around(&rim), 2.0 * error);
        let outward = normal_matrix(self.place) * outward;
        if let Some(flat) = Flat::new(Rim::Many(rim), world(hole), outward, self.sheet) {
            offer(Face {
                key: self.key(part),
                bounds,
                error,
                form: Form::Flat(flat),
            });
        }
    }

    fn key(&self, part: u32) -> Key {
        Key {
            object: self.number,
            part,
        }
    }
}

/// A piece of a profile at one height.
fn is_level(piece: &Piece) -> bool {
    piece.z[..=piece.degree].iter().all(|z| *z == piece.z[0])
}

fn around(points: &[DVec3]) -> Bounds {
    let one = |p: &DVec3| Bounds { min: *p, max: *p };
    let nothing = Bounds {
        min: DVec3::INFINITY,
        max: DVec3::NEG_INFINITY,
    };
    points.iter().map(one).fold(nothing, |a, b| a.union(&b))
}

fn unit(v: DVec3) -> DVec3 {
    DVec3::from_array(normalize(v.to_array()).0)
}

fn absolute(m: &DMat3) -> DMat3 {
    DMat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs())
}
