//! Scanned faces to meshes: triangles, normals, one vertex for each different corner, one mesh for each part.
//!
//! Normals by precedence: the corner's `vn`; else its smoothing group's, the normalised sum of the area vectors of the
//! faces that share position and group (whole faces, so that the cut into triangles does not matter); else the
//! triangle's own, and so it is where a group's normals cancel. `smooth` overrides: `true` puts all faces into one group, `false` makes all flat. A part without any
//! vertex normal keeps `Mesh::normals` empty.

use std::collections::HashMap;
use std::sync::Arc;

use super::scan::{Attributes, NONE, Scan};
use super::smooth::{Smoothed, group};
use crate::error::{Error, Note};
use crate::import::polygon::{self, Crossing, Cut, Doubts};
use crate::import::text::decode;
use crate::import::tiny;
use crate::math::float::normalize;
use crate::math::{DVec2, DVec3};
use crate::scene::Mesh;

/// The most triangles of one file.
const MAX_TRIANGLES: usize = 1 << 27;

/// A mesh with its name and the names of its materials.
#[derive(Debug)]
pub(super) struct Built {
    /// `o` or `g`; `None` where the file is one part.
    pub(super) name: Option<String>,
    pub(super) mesh: Arc<Mesh>,
    /// Number of the `usemtl` name of each slot; [`NONE`] = none.
    pub(super) materials: Vec<u32>,
}

/// Builds the meshes; `split` makes one of each object (or group, where the file has no objects).
pub(super) fn build(
    mut scan: Scan,
    smooth: Option<bool>,
    split: bool,
    notes: &mut Vec<Note>,
) -> Result<Vec<Built>, Error> {
    let part_of_run = parts(&scan, split);
    let names = part_of_run.names;
    settle_normals(&mut scan, smooth, notes);
    let smoothed = Smoothed::new(&scan, smooth, notes);
    let mut builder = Builder {
        scan: &scan,
        smooth,
        smoothed: &smoothed,
        parts: names.into_iter().map(Part::new).collect(),
        heads: vec![NONE; scan.positions.len()],
        vertices: Vec::new(),
        doubts: Doubts::default(),
    };
    for_each_face(&scan, |run, attributes, corners| {
        let part = part_of_run.of_run[run];
        builder.parts[part as usize].has_normals |= builder.has_normal(attributes, corners);
    });
    let mut count = 0;
    let mut number = 0;
    for_each_face(&scan, |run, attributes, corners| {
        number += 1;
        if count <= MAX_TRIANGLES {
            count += builder.face(part_of_run.of_run[run], attributes, corners, number);
        }
    });
    if count > MAX_TRIANGLES {
        return Err(Error::limit(format!(
            "the mesh has more than {MAX_TRIANGLES} triangles"
        )));
    }
    for (message, first) in builder.doubts.messages() {
        let message = format!("{message} (face {first} of the file)");
        notes.push(Note {
            place: None,
            message,
        });
    }
    let parts = builder
        .parts
        .into_iter()
        .filter(|p| !p.mesh.triangles.is_empty());
    let built: Vec<Built> = parts.map(Part::finish).collect();
    for part in &built {
        notes.extend(tiny::note(&part.mesh, part.name.as_deref()));
    }
    Ok(built)
}

/// Calls with the run number, the attributes and the corners (a range) of each face.
pub(super) fn for_each_face(
    scan: &Scan,
    mut call: impl FnMut(usize, Attributes, std::ops::Range<usize>),
) {
    let mut first = 0;
    for (number, run) in scan.runs.iter().enumerate() {
        let next = scan.runs.get(number + 1);
        let end = next.map_or(scan.faces.len(), |r| r.first_face as usize);
        for face in &scan.faces[run.first_face as usize..end] {
            call(number, run.attributes, first..face.end as usize);
            first = face.end as usize;
        }
    }
}

struct Parts {
    names: Vec<Option<String>>,
    of_run: Vec<u32>,
}

/// Which part each run belongs to: parts are named alike, in order of first face.
fn parts(scan: &Scan, split: bool) -> Parts {
    let (by_object, list) = match (scan.objects.list.is_empty(), split) {
        (_, false) => (None, &[][..]),
        (false, true) => (Some(true), &scan.objects.list[..]),
        (true, true) => (Some(false), &scan.groups.list[..]),
    };
    let mut number_of = vec![NONE; list.len() + 1];
    let mut names = Vec::new();
    let mut of_run = Vec::with_capacity(scan.runs.len());
    for run in &scan.runs {
        let key = match by_object {
            None => NONE,
            Some(true) => run.attributes.object,
            Some(false) => run.attributes.group,
        };
        let slot = (key as usize).min(list.len());
        if number_of[slot] == NONE {
            number_of[slot] = names.len() as u32;
            let name = list.get(slot).filter(|name| !name.is_empty());
            names.push(name.map(|name| decode(name).into_owned()));
        }
        of_run.push(number_of[slot]);
    }
    if names.len() == 1 {
        names = vec![None];
    }
    Parts { names, of_run }
}

/// Drops normals that `smooth` overrides, and those of no length.
fn settle_normals(scan: &mut Scan, smooth: Option<bool>, notes: &mut Vec<Note>) {
    if smooth.is_some() {
        scan.corner_normals.clear();
        return;
    }
    let mut unusable = 0;
    for index in &mut scan.corner_normals {
        if *index != NONE && scan.normals[*index as usize] == DVec3::ZERO {
            *index = NONE;
            unusable += 1;
        }
    }
    if unusable > 0 {
        let message = format!("{unusable} corners have a normal of no length: computed instead");
        notes.push(Note {
            place: None,
            message,
        });
    }
}

/// Where a corner's normal comes from. Part of what makes two corners the same vertex.
#[derive(Clone, Copy, PartialEq)]
enum Origin {
    File(u32),
    Group(u32),
    /// The triangle's own: the part has no vertex normals.
    None,
}

/// A vertex made so far: next of the same position, its part, what it came from, its number in the part.
struct Vertex {
    next: u32,
    part: u32,
    texcoord: u32,
    origin: Origin,
    number: u32,
}

struct Part {
    name: Option<String>,
    mesh: Mesh,
    has_normals: bool,
    has_texcoords: bool,
    materials: Vec<u32>,
    slots: HashMap<u32, u32>,
    last_slot: Option<(u32, u32)>,
}

impl Part {
    fn new(name: Option<String>) -> Self {
        Self {
            name,
            mesh: Mesh::default(),
            has_normals: false,
            has_texcoords: false,
            materials: Vec::new(),
            slots: HashMap::new(),
            last_slot: None,
        }
    }

    /// The slot of a material; slots are counted in order of first use.
    fn slot(&mut self, material: u32) -> u32 {
        // Faces of one material mostly follow each other.
        if let Some((last, slot)) = self.last_slot
            && last == material
        {
            return slot;
        }
        let materials = &mut self.materials;
        let slot = *self.slots.entry(material).or_insert_with(|| {
            materials.push(material);
            materials.len() as u32 - 1
        });
        self.last_slot = Some((material, slot));
        slot
    }

    fn finish(self) -> Built {
        let mut mesh = self.mesh;
        if !self.has_texcoords {
            mesh.texcoords = Vec::new();
        }
        if self.materials.len() == 1 {
            mesh.slots = Vec::new();
        }
        mesh.positions.shrink_to_fit();
        mesh.triangles.shrink_to_fit();
        mesh.normals.shrink_to_fit();
        Built {
            name: self.name,
            mesh: Arc::new(mesh),
            materials: self.materials,
        }
    }
}

struct Builder<'a> {
    scan: &'a Scan,
    smooth: Option<bool>,
    smoothed: &'a Smoothed,
    parts: Vec<Part>,
    /// First vertex of each position; the chain goes on in [`Vertex::next`].
    heads: Vec<u32>,
    vertices: Vec<Vertex>,
    doubts: Doubts,
}

impl Builder<'_> {
    fn has_normal(&self, attributes: Attributes, mut corners: std::ops::Range<usize>) -> bool {
        let given = |c: usize| self.scan.corner_normals.get(c).is_some_and(|n| *n != NONE);
        group(attributes, self.smooth) != 0 || corners.any(given)
    }

    /// Adds a face, the file's `number`-th, and says of how many triangles it is.
    fn face(
        &mut self,
        part: u32,
        attributes: Attributes,
        corners: std::ops::Range<usize>,
        number: usize,
    ) -> usize {
        let scan = self.scan;
        let slot = self.parts[part as usize].slot(attributes.material);
        let first = corners.start as u32;
        if corners.len() == 3 {
            self.triangle(part, attributes, slot, [first, first + 1, first + 2]);
            return 1;
        }
        // The corners' numbers are cut, not their positions: two corners may share a position.
        let position = |i: usize| scan.positions[scan.corners[corners.start + i] as usize];
        let cut = polygon::triangulate(corners.len(), position);
        self.doubts.add(cut.doubt, number);
        if cut.crossings.is_empty() {
            for triangle in &cut.triangles {
                self.triangle(part, attributes, slot, triangle.map(|i| first + i));
            }
        } else {
            self.crossed(part, attributes, slot, corners, &cut);
        }
        cut.triangles.len()
    }

    /// A face with new corners, where it crosses itself.
    fn crossed(
        &mut self,
        part: u32,
        attributes: Attributes,
        slot: u32,
        corners: std::ops::Range<usize>,
        cut: &Cut,
    ) {
        let (scan, first) = (self.scan, corners.start as u32);
        let count = corners.len();
        let position = |i: u32| scan.positions[scan.corners[(first + i) as usize] as usize];
        let at = |i: u32| match cut.crossings.get((i as usize).wrapping_sub(count)) {
            Some(crossing) => crossing.between(position),
            None => position(i),
        };
        let mut number_of = vec![NONE; cut.crossings.len()];
        for triangle in &cut.triangles {
            let [a, b, c] = triangle.map(at);
            let normal = DVec3::from_array(normalize((b - a).cross(c - a).to_array()).0);
            let triangle = triangle.map(|i| {
                let Some(index) = (i as usize).checked_sub(count) else {
                    return self.vertex(part, attributes, first + i, normal);
                };
                if number_of[index] == NONE {
                    let crossing = &cut.crossings[index];
                    let at = at(i);
                    number_of[index] =
                        self.new_corner(part, attributes, first, crossing, at, normal);
                }
                number_of[index]
            });
            let mesh = &mut self.parts[part as usize].mesh;
            mesh.triangles.push(triangle);
            mesh.slots.push(slot);
        }
    }

    /// The vertex of a new corner: what its edge's ends have, in between.
    fn new_corner(
        &mut self,
        part: u32,
        attributes: Attributes,
        first: u32,
        crossing: &Crossing,
        position: DVec3,
        face_normal: DVec3,
    ) -> u32 {
        let scan = self.scan;
        let normal = crossing.between(|i| match self.origin(attributes, first + i) {
            Origin::File(normal) => scan.normals[normal as usize],
            Origin::Group(group) => {
                let position = scan.corners[(first + i) as usize];
                self.smoothed.normal(position, group)
            }
            Origin::None => face_normal,
        });
        let texcoord = |i: u32| {
            let number = scan.corner_texcoords.get((first + i) as usize).copied();
            let texcoord = number.and_then(|n| scan.texcoords.get(n as usize));
            texcoord.copied().unwrap_or(DVec2::ZERO).extend(0.0)
        };
        let texcoord = crossing.between(texcoord).truncate();
        self.push(part, position, Some(texcoord), normal)
    }

    fn triangle(&mut self, part: u32, attributes: Attributes, slot: u32, corners: [u32; 3]) {
        let flat = corners.map(|c| self.origin(attributes, c) == Origin::None);
        let owns_normals = self.parts[part as usize].has_normals;
        let face_normal = if owns_normals && flat.contains(&true) {
            let [a, b, c] =
                corners.map(|c| self.scan.positions[self.scan.corners[c as usize] as usize]);
            DVec3::from_array(normalize((b - a).cross(c - a).to_array()).0)
        } else {
            DVec3::ZERO
        };
        let mut triangle = [0; 3];
        for (vertex, corner) in triangle.iter_mut().zip(corners) {
            *vertex = self.vertex(part, attributes, corner, face_normal);
        }
        let mesh = &mut self.parts[part as usize].mesh;
        mesh.triangles.push(triangle);
        mesh.slots.push(slot);
    }

    fn origin(&self, attributes: Attributes, corner: u32) -> Origin {
        let given = self.scan.corner_normals.get(corner as usize).copied();
        match (given, group(attributes, self.smooth)) {
            (Some(normal), _) if normal != NONE => Origin::File(normal),
            (_, 0) => Origin::None,
            (_, group)
                if self
                    .smoothed
                    .cancels(self.scan.corners[corner as usize], group) =>
            {
                Origin::None
            }
            (_, group) => Origin::Group(group),
        }
    }

    /// The number of a corner's vertex, made where the part has none like it.
    fn vertex(
        &mut self,
        part: u32,
        attributes: Attributes,
        corner: u32,
        face_normal: DVec3,
    ) -> u32 {
        let scan = self.scan;
        let position = scan.corners[corner as usize];
        let texcoord = scan
            .corner_texcoords
            .get(corner as usize)
            .copied()
            .unwrap_or(NONE);
        let origin = self.origin(attributes, corner);
        // A flat corner beside smooth ones has a vertex of its own: no other has its normal.
        let own = self.parts[part as usize].has_normals && origin == Origin::None;
        if !own && let Some(number) = self.find(part, position, texcoord, origin) {
            return number;
        }
        let normal = match origin {
            Origin::File(normal) => scan.normals[normal as usize],
            Origin::Group(group) => self.smoothed.normal(position, group),
            Origin::None => face_normal,
        };
        let coordinates = scan.texcoords.get(texcoord as usize).copied();
        let number = self.push(part, scan.positions[position as usize], coordinates, normal);
        if !own {
            let next = self.heads[position as usize];
            self.heads[position as usize] = self.vertices.len() as u32;
            self.vertices.push(Vertex {
                next,
                part,
                texcoord,
                origin,
                number,
            });
        }
        number
    }

    /// The part's vertex of this position, texture coordinate and origin.
    fn find(&self, part: u32, position: u32, texcoord: u32, origin: Origin) -> Option<u32> {
        let mut at = self.heads[position as usize];
        while at != NONE {
            let v = &self.vertices[at as usize];
            if v.part == part && v.texcoord == texcoord && v.origin == origin {
                return Some(v.number);
            }
            at = v.next;
        }
        None
    }

    /// Adds a vertex to a part's mesh.
    fn push(&mut self, part: u32, position: DVec3, texcoord: Option<DVec2>, normal: DVec3) -> u32 {
        let with_texcoords = !self.scan.corner_texcoords.is_empty();
        let part = &mut self.parts[part as usize];
        part.mesh.positions.push(position);
        if part.has_normals {
            part.mesh.normals.push(normal);
        }
        if with_texcoords {
            part.has_texcoords |= texcoord.is_some();
            part.mesh.texcoords.push(texcoord.unwrap_or(DVec2::ZERO));
        }
        part.mesh.positions.len() as u32 - 1
    }
}
