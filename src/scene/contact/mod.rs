//! Contacts: which surfaces of a scene lie on each other, decided from the shapes.
//!
//! In: a scene's objects, f64. Out: [`Contacts`]: *sets* of faces that lie on one carrier (a plane, a sphere, a tube, a cone, a
//! torus, a turned curve) and overlap there. A ray meets the faces of a set at one place, whatever its own numbers say: that is
//! what DESIGN section 1 "Contact" and "Coplanar opaque surfaces" call one event.
//!
//! Two faces are on one carrier where each lies within the other's carrier by no more than the rounding of their own
//! numbers: of their coordinates, of the transforms that placed them, and of what extrapolating from a small face to a large one
//! makes of it. No length is absolute. Flat faces overlap where their polygons do (separating axes), so tiles side by side
//! are no contact; curved ones where samples of one lie within the other.
//!
//! Faces come in the two geometries of a render: the exact shapes ([`Detail::Exact`]), or the triangles of every object at a
//! level of tessellation. Only objects whose bounds meet are looked at, and only faces near those of the other (`near`), so a
//! scene without neighbours costs a sort of its objects.
//!
//! Left out: curved Bezier patches, and faces of one and the same object.

mod curved;
mod face;
mod flat;
mod near;

use std::collections::{BTreeSet, HashMap};

use super::Scene;
use super::fit::Bounds;
use crate::math::DVec3;
use face::{Face, Form};

/// A face of an object: for shapes a side of a box (-x, +x, -y, ...), the number of a piece of a surface of revolution, the
/// side (0), base (1) and top (2) of cylinders and cones, else 0; for meshes and tessellations the number of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Key {
    /// Index into the scene's objects.
    pub object: u32,
    /// Which face of it.
    pub part: u32,
}

/// What the faces of a scene are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Detail {
    /// The true shapes; meshes have triangles.
    Exact,
    /// The triangles of every object at a tessellation level.
    Triangles(Option<u32>),
}

/// Faces that lie on each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Set {
    /// The carrier is a plane: a ray meets it once.
    pub flat: bool,
    /// The faces are apart by no more than this, world space.
    pub error: f64,
    /// Overlaps lie in this box.
    pub bounds: Bounds,
}

/// Two objects in one plane, of which one is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Coplanar {
    /// The one that owns the plane: the first in the file.
    pub owner: u32,
    /// The other.
    pub other: u32,
}

/// Which faces of a scene lie on each other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contacts {
    /// The sets.
    pub sets: Vec<Set>,
    /// Faces that are in one, and its number, in order.
    pub faces: Vec<(Key, u32)>,
    /// Opaque objects of which parts in one plane could be seen.
    pub coplanar: Vec<Coplanar>,
}

/// The part of an object's size within which faces beside a point are asked for their planes.
const ROOM: f64 = 1.0 / (1 << 20) as f64;

impl Contacts {
    /// Looks at a scene.
    ///
    /// ```
    /// use rastray::scene::contact::{Contacts, Detail};
    /// let scene = rastray::import::load("whitted", &Default::default())?.scene;
    /// assert!(Contacts::of(&scene, Detail::Exact).sets.is_empty());
    /// # Ok::<(), rastray::error::Error>(())
    /// ```
    pub fn of(scene: &Scene, detail: Detail) -> Self {
        let faces = near::faces(&scene.objects, detail);
        let mut joined = Joined::new(faces.len());
        let mut coplanar = BTreeSet::new();
        let mut overlaps: Vec<(usize, Bounds)> = Vec::new();
        each_near_pair(&faces, |i, j| {
            let (a, b) = (&faces[i], &faces[j]);
            if a.key.object == b.key.object || !on_each_other(a, b) {
                return;
            }
            joined.join(i, j);
            overlaps.push((i, common(&a.bounds, &b.bounds)));
            if shows(scene, a, b) {
                let (owner, other) = (
                    a.key.object.min(b.key.object),
                    a.key.object.max(b.key.object),
                );
                coplanar.insert(Coplanar { owner, other });
            }
        });
        let (sets, mut found) = gather(&faces, &mut joined, &overlaps);
        found.sort_unstable();
        Self {
            sets,
            faces: found,
            coplanar: coplanar.into_iter().collect(),
        }
    }
}

/// The flat faces of a scene whose planes hold a point: a ray to that point meets them there or nowhere.
pub fn planes_through(scene: &Scene, detail: Detail, point: DVec3) -> Vec<Key> {
    let mut found = Vec::new();
    let error = face::rounding(point.abs().max_element());
    for (index, object) in scene.objects.iter().enumerate() {
        let Some(bounds) = Bounds::of_object(object) else {
            continue;
        };
        // Faces that f32 may move to the point belong to the same plane: what is looked at may be wide.
        let room = error + bounds.diagonal() * ROOM + face::object_rounding(&bounds);
        let place = Bounds {
            min: point - room,
            max: point + room,
        };
        if !meet(&bounds, &place) {
            continue;
        }
        let near = |bounds: &Bounds| meet(bounds, &place);
        face::each(object, index as u32, detail, &near, &mut |face| {
            if let Form::Flat(flat) = &face.form
                && flat.distance(point) <= flat.doubt(point, face.error) + error
            {
                found.push(face.key);
            }
        });
    }
    found.sort_unstable();
    found
}

fn each_near_pair(faces: &[Face], visit: impl FnMut(usize, usize)) {
    sweep(faces, |face| face.bounds, visit);
}

/// Shows every pair of items whose boxes meet: sorted along the axis that their centres spread along most.
fn sweep<T>(items: &[T], bounds: impl Fn(&T) -> Bounds, mut visit: impl FnMut(usize, usize)) {
    let boxes: Vec<Bounds> = items.iter().map(bounds).collect();
    let Some(all) = boxes.iter().copied().reduce(|a, b| a.union(&b)) else {
        return;
    };
    let size = (all.max - all.min).to_array();
    let axis = (0..3).fold(0, |best, k| if size[k] > size[best] { k } else { best });
    let low = |i: usize| boxes[i].min.to_array()[axis];
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    order.sort_by(|a, b| low(*a).total_cmp(&low(*b)));
    for (place, &i) in order.iter().enumerate() {
        let end = boxes[i].max.to_array()[axis];
        for &j in order[place + 1..].iter().take_while(|j| low(**j) <= end) {
            if meet(&boxes[i], &boxes[j]) {
                visit(i.min(j), i.max(j));
            }
        }
    }
}

fn on_each_other(a: &Face, b: &Face) -> bool {
    match (&a.form, &b.form) {
        (Form::Flat(x), Form::Flat(y)) => flat::on_each_other((x, a.error), (y, b.error)),
        (Form::Curved(x), Form::Curved(y)) => curved::on_each_other(x, y, a.error + b.error),
        _ => false,
    }
}

/// Whether the two could be seen to fight: both opaque, flat, and neither hidden by the solid that it belongs to.
fn shows(scene: &Scene, a: &Face, b: &Face) -> bool {
    let opaque = |face: &Face| {
        let mut materials = scene.objects[face.key.object as usize].materials.iter();
        !materials.any(|m| scene.materials[*m].optics.is_transmissive())
    };
    let (Form::Flat(x), Form::Flat(y)) = (&a.form, &b.form) else {
        return false;
    };
    let same_side = x.outward.dot(y.outward) > 0.0;
    opaque(a) && opaque(b) && (same_side || (x.sheet && y.sheet))
}

/// The sets, and the faces in them.
fn gather(
    faces: &[Face],
    joined: &mut Joined,
    overlaps: &[(usize, Bounds)],
) -> (Vec<Set>, Vec<(Key, u32)>) {
    let mut sets: Vec<Set> = Vec::new();
    let mut number: HashMap<usize, u32> = HashMap::new();
    for (face, bounds) in overlaps {
        let root = joined.root(*face);
        match number.get(&root) {
            Some(&set) => {
                let set = &mut sets[set as usize];
                set.bounds = set.bounds.union(bounds);
            }
            None => {
                number.insert(root, sets.len() as u32);
                sets.push(Set {
                    flat: matches!(faces[root].form, Form::Flat(_)),
                    error: 0.0,
                    bounds: *bounds,
                });
            }
        }
    }
    let mut found = Vec::new();
    for (i, face) in faces.iter().enumerate() {
        if let Some(&set) = number.get(&joined.root(i)) {
            let error = &mut sets[set as usize].error;
            *error = error.max(2.0 * face.error);
            found.push((face.key, set));
        }
    }
    (sets, found)
}

/// Faces joined to sets (Tarjan's union-find, paths halved).
struct Joined(Vec<usize>);

impl Joined {
    fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    fn root(&mut self, mut i: usize) -> usize {
        while self.0[i] != i {
            self.0[i] = self.0[self.0[i]];
            i = self.0[i];
        }
        i
    }

    fn join(&mut self, i: usize, j: usize) {
        let (i, j) = (self.root(i), self.root(j));
        self.0[i.max(j)] = i.min(j);
    }
}

fn meet(a: &Bounds, b: &Bounds) -> bool {
    a.min.cmple(b.max).all() && b.min.cmple(a.max).all()
}

fn common(a: &Bounds, b: &Bounds) -> Bounds {
    Bounds {
        min: a.min.max(b.min),
        max: a.max.min(b.max),
    }
}
