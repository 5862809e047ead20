//! Which faces of two objects may lie on each other: those in the cells of a grid that both have faces in.
//!
//! The grid spans the part of space where the bounds of both are. A flat face is in the cells that its plane passes through, so
//! that a turned floor does not gather a whole mesh; flat and curved faces never lie on each other and are kept apart.

use super::face::{Face, Form, each, object_rounding, widened};
use super::{Detail, common, meet};
use crate::math::DVec3;
use crate::scene::fit::Bounds;
use crate::scene::{Geometry, Object, Shape};

/// Cells along each axis.
const SIDE: usize = 16;
/// Objects with no more faces than this are compared without a grid.
const FEW: usize = 64;

/// Cells of a grid, those with flat and those with curved faces.
struct Cells {
    bounds: Bounds,
    taken: [Vec<bool>; 2],
}

impl Cells {
    fn new(bounds: Bounds) -> Self {
        let none = || vec![false; SIDE * SIDE * SIDE];
        let taken = [none(), none()];
        Self { bounds, taken }
    }

    /// Shows the cells of a face; stops where `visit` says true, and says whether it did.
    fn any_cell(&self, face: &Face, mut visit: impl FnMut(usize) -> bool) -> bool {
        let size = (self.bounds.max - self.bounds.min) / SIDE as f64;
        let place = |p: DVec3| {
            let cell = (p - self.bounds.min) / size;
            // A grid without extent along an axis has one cell there: 0 / 0 is taken for 0.
            cell.to_array().map(|x| (x as usize).min(SIDE - 1))
        };
        let (low, high) = (place(face.bounds.min), place(face.bounds.max));
        let half = 0.5 * size.length() + 2.0 * face.error;
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                for x in low[0]..=high[0] {
                    if let Form::Flat(flat) = &face.form {
                        let middle = DVec3::new(x as f64, y as f64, z as f64) + 0.5;
                        let middle = self.bounds.min + middle * size;
                        if flat.distance(middle) > half + flat.doubt(middle, face.error) {
                            continue;
                        }
                    }
                    if visit((z * SIDE + y) * SIDE + x) {
                        return true;
                    }
                }
            }
        }
        false
    }

    fn add(&mut self, face: &Face) {
        let mut found = Vec::new();
        self.any_cell(face, |cell| {
            found.push(cell);
            false
        });
        let taken = &mut self.taken[kind(face)];
        found.into_iter().for_each(|cell| taken[cell] = true);
    }

    fn holds(&self, face: &Face) -> bool {
        let taken = &self.taken[kind(face)];
        self.any_cell(face, |cell| taken[cell])
    }
}

fn kind(face: &Face) -> usize {
    usize::from(matches!(face.form, Form::Curved(_)))
}

/// The faces of objects, by object, that may lie on one of another object.
pub(super) fn faces(objects: &[Object], detail: Detail) -> Vec<Face> {
    let wide = |object: &Object| {
        let bounds = Bounds::of_object(object)?;
        Some(widened(&bounds, object_rounding(&bounds)))
    };
    let bounds: Vec<Option<Bounds>> = objects.iter().map(wide).collect();
    let known: Vec<usize> = (0..objects.len())
        .filter(|i| bounds[*i].is_some())
        .collect();
    let mut found: Vec<Face> = Vec::new();
    super::sweep(
        &known,
        |i| bounds[*i].unwrap_or(NOWHERE),
        |a, b| {
            let (a, b) = (known[a], known[b]);
            let (Some(x), Some(y)) = (&bounds[a], &bounds[b]) else {
                return;
            };
            pair(objects, [a, b], common(x, y), detail, &mut found);
        },
    );
    // A face may have several neighbours.
    found.sort_by_key(|face| face.key);
    found.dedup_by_key(|face| face.key);
    found
}

const NOWHERE: Bounds = Bounds {
    min: DVec3::INFINITY,
    max: DVec3::NEG_INFINITY,
};

fn has_few(object: &Object, detail: Detail) -> bool {
    match &object.geometry {
        Geometry::Mesh(mesh) => mesh.triangles.len() <= FEW,
        Geometry::Shape(Shape::Revolution { profile, .. }) if detail == Detail::Exact => {
            profile.pieces().len() <= FEW
        }
        Geometry::Shape(shape) => detail == Detail::Exact || shape.is_flat(),
    }
}

/// Adds the faces of two objects that share a cell.
fn pair(
    objects: &[Object],
    [a, b]: [usize; 2],
    shared: Bounds,
    detail: Detail,
    found: &mut Vec<Face>,
) {
    let reaches = |bounds: &Bounds| meet(&shared, bounds);
    if [a, b].iter().all(|i| has_few(&objects[*i], detail)) {
        for i in [a, b] {
            each(&objects[i], i as u32, detail, &reaches, &mut |face| {
                found.push(face);
            });
        }
        return;
    }
    let mut cells = Cells::new(shared);
    each(&objects[a], a as u32, detail, &reaches, &mut |face| {
        cells.add(&face);
    });
    let mut both = Cells::new(shared);
    let before = found.len();
    each(&objects[b], b as u32, detail, &reaches, &mut |face| {
        if cells.holds(&face) {
            both.add(&face);
            found.push(face);
        }
    });
    if found.len() > before {
        each(&objects[a], a as u32, detail, &reaches, &mut |face| {
            if both.holds(&face) {
                found.push(face);
            }
        });
    }
}
