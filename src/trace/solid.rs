//! Exact shapes placed in the world: what a ray meets of them, in f64.
//!
//! Spheres and boxes take the ray to object space without renormalising, so that t is common to all primitives; the
//! difference to the shape's own place is taken in world space first; so do the round shapes of [`super::body`] and the
//! pieces of surfaces of revolution. Patches become parallelograms in the world, Bezier patches pieces of [`super::bezier`];
//! a piece is a solid of its own to the hierarchy.
//! A shape that its transform flattens (singular matrix) encloses nothing and is no hit; a patch without area likewise.

use std::sync::Arc;

use super::bezier::{MAX_CROSSINGS, Sheet};
use super::body::Body;
use super::build::Bounds;
use super::cuboid::{face_normal, slabs};
use super::exact::{Twofold, unit};
use super::planar::Shear;
use super::ray::{Foot, Hit, Ray};
use super::revolution::Band;
use super::span::Spot;
use super::sphere::{Roots, roots};
use crate::math::Each;
use crate::math::transform::{mirrors, normal_matrix};
use crate::math::{DAffine3, DMat3, DVec3};
use crate::scene::profile::{Piece, Profile};
use crate::scene::{Shape, fit, revolution};

/// An exact shape in the world.
#[derive(Clone, Debug)]
pub(super) struct Solid {
    /// Primitive number: that of the shape's first triangle.
    pub(super) primitive: u32,
    /// Index into the scene's objects.
    pub(super) object: u32,
    form: Form,
    /// Linear part of world from object, and its inverse; `None` where it is the identity.
    linear: Option<(DMat3, DMat3)>,
    normal_world: DMat3,
    place: DAffine3,
}

#[derive(Clone, Debug)]
enum Form {
    Sphere {
        center_world: DVec3,
        radius: f64,
        radius_world: f64,
    },
    Cuboid {
        min: DVec3,
        max: DVec3,
        size_world: f64,
    },
    Patch {
        corners_world: [[f64; 3]; 4],
        edges_world: [DVec3; 2],
        normal_world: DVec3,
        mirrored: bool,
        tiles: [u32; 2],
    },
    Round {
        anchor_world: DVec3,
        body: Body,
        size_world: f64,
        bounds: Bounds,
    },
    /// One piece of a surface of revolution.
    Turned {
        anchor_world: DVec3,
        band: Box<Band>,
        /// Number of the piece.
        number: u32,
        /// It lies in a plane.
        level: bool,
        size_world: f64,
        bounds: Bounds,
    },
    /// One piece of a set of patches.
    Piece { sheet: Arc<Sheet>, piece: u32 },
}

/// Crossings of one piece of a surface of revolution that a hit's feature can tell apart.
const PER_PIECE: u32 = 8;
/// Added to the feature where a ray leaves a surface of revolution, so that of equal t the entry comes first.
const LEAVES: u32 = 1 << 31;

impl Solid {
    /// Places a shape: one solid, for surfaces of revolution and Bezier patches one a piece; none where it encloses nothing.
    pub(super) fn all(shape: &Shape, place: &DAffine3, primitive: u32, object: u32) -> Vec<Self> {
        let forms = match shape {
            Shape::Bezier { points, patches } => {
                return pieces(points, patches, place, primitive, object);
            }
            Shape::Revolution {
                base,
                axis,
                profile,
            } => turned(*base, *axis, profile, place),
            _ => form(shape, place).into_iter().collect(),
        };
        let place_one = |form| Self::new(form, place, primitive, object);
        forms.into_iter().filter_map(place_one).collect()
    }

    fn new(form: Form, place: &DAffine3, primitive: u32, object: u32) -> Option<Self> {
        let linear = place.matrix3;
        let inverse = linear.inverse();
        let identity = linear == DMat3::IDENTITY;
        let flat = matches!(form, Form::Patch { .. });
        if !flat && !inverse.is_finite() {
            return None;
        }
        Some(Self {
            primitive,
            object,
            form,
            linear: (!identity).then_some((linear, inverse)),
            normal_world: normal_matrix(place),
            place: *place,
        })
    }

    /// World bounds.
    pub(super) fn bounds(&self) -> Bounds {
        match &self.form {
            Form::Sphere {
                center_world,
                radius,
                ..
            } => {
                let reach = *radius * spread(&self.place.matrix3);
                Bounds::of([*center_world - reach, *center_world + reach])
            }
            Form::Cuboid { min, max, .. } => Bounds::of((0..8).map(|i| {
                let pick =
                    |bit: u32, low: f64, high: f64| if i >> bit & 1 == 0 { low } else { high };
                let p = [
                    pick(0, min.x, max.x),
                    pick(1, min.y, max.y),
                    pick(2, min.z, max.z),
                ];
                self.place.transform_point3(DVec3::from_array(p))
            })),
            Form::Patch { corners_world, .. } => {
                Bounds::of(corners_world.iter().map(|p| DVec3::from_array(*p)))
            }
            Form::Round { bounds, .. } | Form::Turned { bounds, .. } => *bounds,
            Form::Piece { sheet, piece } => sheet.bounds(*piece),
        }
    }

    /// A planar shape: a ray that leaves it never meets it again.
    pub(super) fn is_planar(&self) -> bool {
        match &self.form {
            Form::Patch { .. } => true,
            Form::Round { body, .. } => body.is_planar(),
            _ => false,
        }
    }

    /// Flat or convex: a ray that leaves it outwards never meets it again.
    pub(super) fn is_convex(&self) -> bool {
        match &self.form {
            Form::Round { body, .. } => body.is_convex(),
            Form::Turned { .. } | Form::Piece { .. } => false,
            _ => true,
        }
    }

    /// Which face of the solid a hit's feature is on, as [`crate::scene::contact::Key`] numbers them.
    pub(super) fn part(&self, feature: u32) -> usize {
        match &self.form {
            Form::Cuboid { .. } => feature as usize,
            Form::Round { body, .. } => body.face(feature) as usize,
            _ => 0,
        }
    }

    /// Whether that face lies in a plane.
    pub(super) fn is_flat(&self, feature: u32) -> bool {
        match &self.form {
            Form::Patch { .. } | Form::Cuboid { .. } => true,
            Form::Round { body, .. } => body.is_planar() || body.face(feature) != 0,
            Form::Turned { level, .. } => *level,
            Form::Sphere { .. } | Form::Piece { .. } => false,
        }
    }

    /// Every place where the ray meets the shape, at any t; `item` is passed on.
    #[inline]
    pub(super) fn hits(&self, item: u32, ray: &Ray, shear: &Shear, visit: &mut impl FnMut(Hit)) {
        let mut hit = |t: f64, feature: u32, back: bool| {
            let (primitive, uv) = (self.primitive, [0.0; 2]);
            visit(Hit {
                t,
                primitive,
                item,
                uv,
                feature,
                back,
            });
        };
        match &self.form {
            Form::Sphere { .. } => {
                if let Some(r) = self.sphere_roots(ray) {
                    hit(r.t[0], 0, false);
                    hit(r.t[1], 1, true);
                }
            }
            Form::Cuboid { min, max, .. } => {
                let (o, d) = self.ray_object(ray);
                if let Some(s) = slabs(o, d, *min, *max) {
                    hit(s.t[0], s.face[0], false);
                    hit(s.t[1], s.face[1], true);
                }
            }
            Form::Round {
                anchor_world, body, ..
            } => {
                let (q, d) = self.ray_about(*anchor_world, ray);
                body.crossings(q, d, hit);
            }
            Form::Turned {
                anchor_world,
                band,
                number,
                ..
            } => {
                let (q, d) = self.ray_about(*anchor_world, ray);
                for (i, crossing) in band.crossings(q, d).iter().enumerate() {
                    let back = crossing.back;
                    let leaves = if back { LEAVES } else { 0 };
                    hit(
                        crossing.t.value(),
                        leaves + number * PER_PIECE + i as u32,
                        back,
                    );
                }
            }
            Form::Piece { sheet, piece } => {
                let (primitive, mut feature) = (self.primitive, piece * MAX_CROSSINGS);
                sheet.crossings(*piece, shear, |c| {
                    let (t, uv, back) = (c.t, c.uv, c.back);
                    visit(Hit {
                        t,
                        primitive,
                        item,
                        uv,
                        feature,
                        back,
                    });
                    feature += 1;
                });
            }
            Form::Patch {
                corners_world,
                mirrored,
                ..
            } => {
                if let Some(p) = shear.parallelogram(*corners_world) {
                    visit(Hit {
                        t: p.t,
                        primitive: self.primitive,
                        item,
                        uv: p.uv,
                        feature: 0,
                        back: p.back != *mirrored,
                    });
                }
            }
        }
    }

    /// The hit point, its outward normal and error scale, and the number of the tile (0 but for patches).
    pub(super) fn foot(&self, ray: &Ray, hit: &Hit) -> (Foot, u32) {
        match &self.form {
            Form::Sphere {
                center_world,
                radius,
                radius_world,
            } => {
                let n = self
                    .sphere_roots(ray)
                    .map_or(DVec3::ZERO, |r| r.normal(hit.feature as usize));
                let reach = *radius * n;
                let reach = self.linear.map_or(reach, |(linear, _)| linear * reach);
                let foot = Foot {
                    point: *center_world + reach,
                    normal: self.normal(n),
                    scale: *radius_world,
                };
                (foot, 0)
            }
            Form::Cuboid {
                min,
                max,
                size_world,
            } => (self.cuboid_foot(ray, hit, [*min, *max], *size_world), 0),
            Form::Patch {
                corners_world,
                edges_world: [edge_u, edge_v],
                normal_world,
                tiles,
                ..
            } => {
                let [u, v] = hit.uv;
                let foot = Foot {
                    point: DVec3::from_array(corners_world[0]) + u * *edge_u + v * *edge_v,
                    normal: *normal_world,
                    scale: edge_u.abs().max_element() + edge_v.abs().max_element(),
                };
                (foot, tile(u, tiles[0]) + tile(v, tiles[1]))
            }
            Form::Piece { sheet, piece } => (sheet.foot(*piece, ray, hit.uv), 0),
            Form::Round {
                anchor_world,
                body,
                size_world,
                ..
            } => {
                let (q, d) = self.ray_about(*anchor_world, ray);
                let spot = body.spot(q, d, hit.feature);
                (self.spot_foot(spot, *anchor_world, *size_world), 0)
            }
            Form::Turned {
                anchor_world,
                band,
                size_world,
                ..
            } => {
                let (q, d) = self.ray_about(*anchor_world, ray);
                let spot = band.spot(q, d, (hit.feature % PER_PIECE) as usize);
                (self.spot_foot(spot, *anchor_world, *size_world), 0)
            }
        }
    }

    /// A spot about an anchor in the world.
    fn spot_foot(&self, spot: Option<Spot>, anchor_world: DVec3, scale: f64) -> Foot {
        let spot = spot.unwrap_or(Spot {
            offset: DVec3::ZERO,
            normal: DVec3::ZERO,
        });
        let reach = self
            .linear
            .map_or(spot.offset, |(linear, _)| linear * spot.offset);
        Foot {
            point: anchor_world + reach,
            normal: self.normal(spot.normal),
            scale,
        }
    }

    fn cuboid_foot(&self, ray: &Ray, hit: &Hit, [min, max]: [DVec3; 2], scale: f64) -> Foot {
        let (o, d) = self.ray_object(ray);
        let mut p = (o + hit.t * d).clamp(min, max).to_array();
        // Exactly on its face, whatever t lost.
        let axis = (hit.feature / 2) as usize % 3;
        let face = if hit.feature.is_multiple_of(2) {
            min
        } else {
            max
        };
        p[axis] = face.to_array()[axis];
        Foot {
            point: self.place.transform_point3(DVec3::from_array(p)),
            normal: self.normal(face_normal(hit.feature)),
            scale,
        }
    }

    fn sphere_roots(&self, ray: &Ray) -> Option<Roots> {
        let Form::Sphere {
            center_world,
            radius,
            ..
        } = &self.form
        else {
            return None;
        };
        let (q, d) = self.ray_about(*center_world, ray);
        roots(q, d, *radius)
    }

    /// From the ray's origin to a point of the shape, and the ray's direction, in object space.
    fn ray_about(&self, anchor_world: DVec3, ray: &Ray) -> ([Twofold; 3], DVec3) {
        let (c, o) = (anchor_world.to_array(), ray.origin.to_array());
        let q = [0, 1, 2].each(|k| Twofold::difference(c[k], o[k]));
        match &self.linear {
            None => (q, ray.direction),
            Some((_, inverse)) => {
                let q = *inverse * DVec3::from_array(q.each(Twofold::value));
                (q.to_array().each(Twofold::from), *inverse * ray.direction)
            }
        }
    }

    fn ray_object(&self, ray: &Ray) -> (DVec3, DVec3) {
        let o = ray.origin - self.place.translation;
        match &self.linear {
            None => (o, ray.direction),
            Some((_, inverse)) => (*inverse * o, *inverse * ray.direction),
        }
    }

    fn normal(&self, object: DVec3) -> DVec3 {
        match self.linear {
            None => object,
            Some(_) => unit(self.normal_world * object),
        }
    }
}

/// The form of a shape that is one solid.
fn form(shape: &Shape, place: &DAffine3) -> Option<Form> {
    Some(match *shape {
        Shape::Sphere { center, radius } => Form::Sphere {
            center_world: place.transform_point3(center),
            radius,
            radius_world: radius * spread(&place.matrix3).max_element(),
        },
        Shape::Box { min, max } => Form::Cuboid {
            min,
            max,
            size_world: (place.matrix3 * (max - min)).abs().max_element(),
        },
        Shape::Patch {
            corner,
            edge_u,
            edge_v,
            tiles,
        } => patch(place, corner, edge_u, edge_v, tiles)?,
        _ => round(shape, place)?,
    })
}

/// The forms of a surface of revolution, one a piece of its profile.
fn turned(base: DVec3, axis: DVec3, profile: &Profile, place: &DAffine3) -> Vec<Form> {
    let [low, high] = profile.heights();
    let reach = profile.radius() + low.abs().max(high.abs());
    let size_world = reach * spread(&place.matrix3).max_element();
    let bands = Band::all(axis, profile).into_iter();
    let form = |(number, (band, piece)): (usize, (Band, &Piece))| {
        let bounds = revolution::bounds(base, axis, piece, place);
        Form::Turned {
            anchor_world: place.transform_point3(base),
            band: Box::new(band),
            number: number as u32,
            level: piece.z[..=piece.degree].iter().all(|z| *z == piece.z[0]),
            size_world,
            bounds: Bounds::of([bounds.min, bounds.max]),
        }
    };
    bands.zip(profile.pieces()).enumerate().map(form).collect()
}

/// The pieces of a set of patches, in world space.
fn pieces(
    points: &[DVec3],
    patches: &[[u32; 16]],
    place: &DAffine3,
    primitive: u32,
    object: u32,
) -> Vec<Solid> {
    let Some(sheet) = Sheet::new(points, patches, place).map(Arc::new) else {
        return Vec::new();
    };
    let solid = |piece: u32| Solid {
        primitive,
        object,
        form: Form::Piece {
            sheet: Arc::clone(&sheet),
            piece,
        },
        linear: None,
        normal_world: DMat3::IDENTITY,
        place: DAffine3::IDENTITY,
    };
    (0..sheet.len() as u32).map(solid).collect()
}

fn patch(place: &DAffine3, corner: DVec3, u: DVec3, v: DVec3, tiles: [u32; 2]) -> Option<Form> {
    let corners = [corner, corner + u, corner + u + v, corner + v];
    let normal_world = unit(normal_matrix(place) * u.cross(v));
    (normal_world != DVec3::ZERO).then(|| Form::Patch {
        corners_world: corners.each(|p| place.transform_point3(p).to_array()),
        edges_world: [place.transform_vector3(u), place.transform_vector3(v)],
        normal_world,
        mirrored: mirrors(place),
        tiles,
    })
}

fn round(shape: &Shape, place: &DAffine3) -> Option<Form> {
    let (anchor, body) = Body::of(shape)?;
    let (axis, radius) = body.lengths();
    let linear = &place.matrix3;
    let bounds = fit::of_shape(shape, place)?;
    Some(Form::Round {
        anchor_world: place.transform_point3(anchor),
        body,
        size_world: (*linear * axis).abs().max_element() + radius * spread(linear).max_element(),
        bounds: Bounds::of([bounds.min, bounds.max]),
    })
}

/// Tile that a coordinate in 0..=1 falls into.
fn tile(x: f64, tiles: u32) -> u32 {
    ((x * f64::from(tiles)).max(0.0) as u32).min(tiles.max(1) - 1)
}

/// Half extents of the image of the unit ball: lengths of the rows.
fn spread(m: &DMat3) -> DVec3 {
    let t = m.transpose();
    DVec3::new(t.x_axis.length(), t.y_axis.length(), t.z_axis.length())
}
