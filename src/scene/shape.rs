//! What objects are made of: exact shapes and indexed meshes, in object space.

use std::collections::HashMap;
use std::sync::Arc;

use super::profile::Profile;
use crate::math::{DVec2, DVec3};

/// An exact shape. Outward is the front side, under any transform.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A sphere; the tessellation's poles lie on the y axis.
    Sphere {
        /// Centre.
        center: DVec3,
        /// Radius, > 0.
        radius: f64,
    },
    /// A parallelogram, cut into `tiles` that take the object's materials in turn: tile (i, j) has slot (i + j) mod n.
    /// The front side is that of `edge_u` x `edge_v`.
    Patch {
        /// A corner.
        corner: DVec3,
        /// The side that u runs along.
        edge_u: DVec3,
        /// The side that v runs along.
        edge_v: DVec3,
        /// Tiles along u and v, at least 1 each.
        tiles: [u32; 2],
    },
    /// An axis-aligned box.
    Box {
        /// Lowest corner.
        min: DVec3,
        /// Highest corner.
        max: DVec3,
    },
    /// A flat disk.
    Disk {
        /// Centre.
        center: DVec3,
        /// Its front side, any length but 0.
        normal: DVec3,
        /// Radius, > 0.
        radius: f64,
    },
    /// A circular cylinder.
    Cylinder {
        /// Middle of one end.
        base: DVec3,
        /// Middle of the other end, != base.
        top: DVec3,
        /// Radius, > 0.
        radius: f64,
        /// Both ends are closed; else it is a tube without thickness, front outside.
        caps: bool,
    },
    /// A circular cone.
    Cone {
        /// Middle of the round end.
        base: DVec3,
        /// The tip, != base.
        apex: DVec3,
        /// Radius at the base, > 0.
        radius: f64,
        /// The round end is closed; else it is a funnel without thickness, front outside.
        cap: bool,
    },
    /// A ring torus.
    Torus {
        /// Centre.
        center: DVec3,
        /// Axis of the ring, any length but 0.
        axis: DVec3,
        /// Distance of the tube's middle from the centre, > `minor`.
        major: f64,
        /// Radius of the tube, > 0.
        minor: f64,
    },
    /// A surface of revolution. A closed profile makes a solid, front outside; an open one a sheet without thickness, its
    /// front to the right of the profile's way (radius to the right, axis up).
    Revolution {
        /// The point of the axis where heights are 0.
        base: DVec3,
        /// The way heights count, any length but 0; heights are in scene units all the same.
        axis: DVec3,
        /// What is turned about the axis.
        profile: Arc<Profile>,
    },
    /// Bicubic Bezier patches, a surface without thickness: front is the side of du x dv ([`super::bezier`]).
    Bezier {
        /// Control points.
        points: Arc<[DVec3]>,
        /// Sixteen control points each, by number from 0: four rows (v) of four (u).
        patches: Arc<[[u32; 16]]>,
    },
}

/// An indexed triangle mesh. Counter-clockwise from outside = front; the provoking vertex is the last of a triangle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions.
    pub positions: Vec<DVec3>,
    /// Vertex normals, any length, one a position; empty = every triangle is flat, with its geometric normal.
    pub normals: Vec<DVec3>,
    /// Texture coordinates, one a position; empty = none.
    pub texcoords: Vec<DVec2>,
    /// Vertex colours (red, green, blue, alpha), one a position, for materials that track them
    /// ([`crate::gl::Material::tracked`]); empty = white, GL's current colour by default.
    pub colors: Vec<[f64; 4]>,
    /// Triangles in file order.
    pub triangles: Vec<[u32; 3]>,
    /// Material slot of each triangle; empty = slot 0 for all.
    pub slots: Vec<u32>,
}

impl Mesh {
    /// The material slot of a triangle.
    pub fn slot(&self, triangle: usize) -> usize {
        self.slots.get(triangle).map_or(0, |s| *s as usize)
    }

    /// Whether it encloses solids: every edge, told by the places of its ends, is a side of an even number of triangles,
    /// and there is one.
    ///
    /// ```
    /// use rastray::math::DVec3;
    /// use rastray::scene::Mesh;
    /// let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    /// let triangles = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
    /// let mut tetrahedron = Mesh { positions, triangles, ..Mesh::default() };
    /// assert!(tetrahedron.is_closed());
    /// tetrahedron.triangles.pop();
    /// assert!(!tetrahedron.is_closed());
    /// ```
    pub fn is_closed(&self) -> bool {
        let mut places = HashMap::with_capacity(self.positions.len());
        // Adding 0 makes one of 0 and -0.
        let place_of = |p: &DVec3| {
            let next = places.len();
            *places
                .entry((*p + DVec3::ZERO).to_array().map(f64::to_bits))
                .or_insert(next)
        };
        let place: Vec<usize> = self.positions.iter().map(place_of).collect();
        let sides = self.triangles.iter().flat_map(|&[a, b, c]| {
            [(a, b), (b, c), (c, a)].map(|(a, b)| {
                let (a, b) = (place[a as usize], place[b as usize]);
                (a.min(b), a.max(b))
            })
        });
        let mut sides: Vec<_> = sides.filter(|(a, b)| a != b).collect();
        sides.sort_unstable();
        let mut runs = sides.chunk_by(|a, b| a == b);
        !sides.is_empty() && runs.all(|run| run.len() % 2 == 0)
    }

    /// Area-weighted vertex normals: the normalised sum of (b - a) x (c - a) over the incident triangles.
    pub fn area_weighted_normals(&self) -> Vec<DVec3> {
        let mut normals = vec![DVec3::ZERO; self.positions.len()];
        for &[a, b, c] in &self.triangles {
            let [pa, pb, pc] = [a, b, c].map(|i| self.positions[i as usize]);
            let n = (pb - pa).cross(pc - pa);
            for i in [a, b, c] {
                normals[i as usize] += n;
            }
        }
        normals
            .into_iter()
            .map(|n| DVec3::from_array(crate::math::float::normalize(n.to_array()).0))
            .collect()
    }
}

impl Shape {
    /// Whether flat polygons are the exact shape (so tessellation changes nothing but the vertices). A disk is flat, but no
    /// polygon.
    pub fn is_flat(&self) -> bool {
        matches!(self, Self::Patch { .. } | Self::Box { .. })
    }

    /// Whether it encloses a solid; else it is a surface without thickness. A set of Bezier patches counts as open: whether its
    /// borders meet is not looked at.
    pub fn is_closed(&self) -> bool {
        match self {
            Self::Sphere { .. } | Self::Box { .. } | Self::Torus { .. } => true,
            Self::Cylinder { caps, .. } => *caps,
            Self::Cone { cap, .. } => *cap,
            Self::Revolution { profile, .. } => profile.is_closed(),
            Self::Patch { .. } | Self::Disk { .. } | Self::Bezier { .. } => false,
        }
    }
}
