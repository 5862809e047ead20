//! All objects as one list of triangles, in file order: what the rasterizer draws and `--geometry mesh` traces.
//!
//! A triangle's place in the list is its primitive number. World positions feed the BVH; eye-space positions and
//! normals feed lighting in BOTH renderers, so that the two interpolate the same numbers. Points are transformed in f64
//! (the eye subtracted before rotating) and rounded once to `R`. World positions are kept from the eye on, too: so both
//! renderers see equally fine places however far the scene lies from the origin.

use std::sync::Arc;

use super::contact::{Contacts, Detail};
use super::shape::Mesh;
use super::tessellate::{DEFAULT_LEVEL, tessellate};
use super::{Geometry, Object, Scene};
use crate::error::Error;
use crate::gl;
use crate::lanes::Real;
use crate::math::float::normalize;
use crate::math::transform::{mirrors, normal_matrix, rescale_factor};
use crate::math::{DAffine3, DMat3, DVec3};

/// The most triangles a render accepts.
pub const MAX_TRIANGLES: usize = 1 << 28;

/// The triangles of a scene, vertices in structure-of-arrays form.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Assembly<R> {
    /// Positions of the vertices less the eye, world directions.
    pub position_from_eye: Vec<[R; 3]>,
    /// Eye-space x, y, z of the vertices.
    pub position_eye: [Vec<R>; 3],
    /// Eye-space unit normals of the vertices (zero where the normal is zero or not finite).
    pub normal_eye: [Vec<R>; 3],
    /// Length that each normal enters per-vertex lighting with; empty = 1 for all (`normalize = true`).
    pub normal_length: Vec<R>,
    /// Vertex colours; empty where no material follows them. Objects without colours are white.
    pub color: [Vec<R>; 3],
    /// Vertex numbers of each triangle; the last is the provoking vertex.
    pub triangles: Vec<[u32; 3]>,
    /// Index into [`Scene::materials`] of each triangle.
    pub material: Vec<u32>,
    /// Index into [`Scene::objects`] of each triangle.
    pub object: Vec<u32>,
    /// Per object: its triangles.
    pub triangle_range: Vec<std::ops::Range<u32>>,
    /// The tessellation level that was asked for.
    pub level: Option<u32>,
    /// Which triangles lie on each other, decided on the scene's own numbers; a face's part is its number in the object.
    pub contacts: Contacts,
}

impl<R: Real> Assembly<R> {
    /// Assembles the scene's triangles at a tessellation level (64 where `None`; objects may state their own).
    ///
    /// # Errors
    /// [`Error::Limit`] where the scene would exceed [`MAX_TRIANGLES`].
    pub fn new(scene: &Scene, level: Option<u32>) -> Result<Self, Error> {
        let mut assembly = Self {
            level,
            contacts: Contacts::of(scene, Detail::Triangles(level)),
            ..Self::default()
        };
        let colored = scene.has_vertex_colors();
        for (index, object) in scene.objects.iter().enumerate() {
            let first = assembly.triangles.len() as u32;
            let mesh = object_mesh(object, level);
            if assembly.triangles.len() + mesh.triangles.len() > MAX_TRIANGLES {
                return Err(Error::limit(format!(
                    "object {}: the scene has more than {MAX_TRIANGLES} triangles",
                    object.name
                ))
                .with_help("lower the tessellation"));
            }
            let keeps_outward = matches!(object.geometry, Geometry::Shape(_));
            assembly.add(scene, object, index as u32, &mesh, keeps_outward);
            if colored {
                assembly.add_colors(&mesh);
            }
            assembly
                .triangle_range
                .push(first..assembly.triangles.len() as u32);
        }
        Ok(assembly)
    }

    /// Eye-space position of a vertex.
    pub fn vertex_eye(&self, vertex: u32) -> [R; 3] {
        let v = vertex as usize;
        [
            self.position_eye[0][v],
            self.position_eye[1][v],
            self.position_eye[2][v],
        ]
    }

    /// Eye-space unit normal of a vertex.
    pub fn vertex_normal(&self, vertex: u32) -> [R; 3] {
        let v = vertex as usize;
        [
            self.normal_eye[0][v],
            self.normal_eye[1][v],
            self.normal_eye[2][v],
        ]
    }

    /// Eye-space normal of a vertex as per-fragment lighting interpolates it: with the length that per-vertex lighting
    /// would give it (unit under `normalize`).
    pub fn vertex_normal_weighted(&self, vertex: u32) -> [f64; 3] {
        let length = self.normal_length.get(vertex as usize);
        let length = length.map_or(1.0, |length| length.to_f64());
        self.vertex_normal(vertex).map(|x| x.to_f64() * length)
    }

    /// Colour of a vertex; `None` where no material follows vertex colours.
    #[inline]
    pub fn vertex_color(&self, vertex: u32) -> Option<[R; 3]> {
        let v = vertex as usize;
        let [r, g, b] = &self.color;
        Some([*r.get(v)?, g[v], b[v]])
    }

    /// Refuses vertices that rounding to `R` made infinite: the renderers leave their triangles out.
    ///
    /// # Errors
    /// [`Error::Limit`] that names the first such object.
    pub fn check_range(&self, scene: &Scene) -> Result<(), Error> {
        let finite = |v: u32| {
            let from_eye = self.position_from_eye[v as usize];
            let eye = self.vertex_eye(v);
            from_eye.iter().chain(&eye).all(|x| x.is_finite())
        };
        let found = self
            .triangles
            .iter()
            .position(|t| !t.iter().all(|v| finite(*v)));
        let Some(triangle) = found else {
            return Ok(());
        };
        let object = &scene.objects[self.object[triangle] as usize].name;
        let message = format!(
            "object {object}: reaches farther than {:.1e} from the eye, the range of this precision",
            R::MAX.to_f64()
        );
        Err(Error::limit(message).with_help("scale the scene down, or use --precision f64"))
    }

    fn add(&mut self, scene: &Scene, object: &Object, index: u32, mesh: &Mesh, outward: bool) {
        let place = Placement::new(scene, &object.world_from_object);
        let flip = outward && mirrors(&object.world_from_object);
        let flat = mesh.normals.is_empty();
        let base = self.position_from_eye.len() as u32;
        if !flat {
            for (i, p) in mesh.positions.iter().enumerate() {
                self.push_vertex(&place, *p, mesh.normals[i]);
            }
        }
        for (i, triangle) in mesh.triangles.iter().enumerate() {
            let corners = if flat {
                let first = self.position_from_eye.len() as u32;
                let points = triangle.map(|v| mesh.positions[v as usize]);
                let normal = (points[1] - points[0]).cross(points[2] - points[0]);
                let normal = DVec3::from_array(normalize(normal.to_array()).0);
                for p in points {
                    self.push_vertex(&place, p, normal);
                }
                [first, first + 1, first + 2]
            } else {
                triangle.map(|v| base + v)
            };
            // A mirrored shape keeps its outward side: the first two corners change places, the provoking one stays.
            let [a, b, c] = corners;
            self.triangles.push(if flip { [b, a, c] } else { corners });
            let slot = mesh.slot(i) % object.materials.len();
            self.material.push(object.materials[slot] as u32);
            self.object.push(index);
        }
    }

    /// The colours of the vertices that [`Self::add`] made of a mesh, in the same order.
    fn add_colors(&mut self, mesh: &Mesh) {
        // A quarter of the range: differences of two colours stay finite.
        let most = R::MAX.to_f64() / 4.0;
        let limited = |x: f64| {
            R::from_f64(if x.is_nan() {
                0.0
            } else {
                x.clamp(-most, most)
            })
        };
        let mut push = |vertex: usize| {
            let color = mesh
                .colors
                .get(vertex)
                .copied()
                .unwrap_or(gl::CURRENT_COLOR);
            for (list, c) in self.color.iter_mut().zip(color) {
                list.push(limited(c));
            }
        };
        if mesh.normals.is_empty() {
            mesh.triangles
                .iter()
                .flatten()
                .for_each(|v| push(*v as usize));
        } else {
            (0..mesh.positions.len()).for_each(push);
        }
    }

    fn push_vertex(&mut self, place: &Placement, p: DVec3, n: DVec3) {
        let world = place.world_from_object.transform_point3(p);
        let from_eye = world - place.eye;
        let eye = place.rotation * from_eye;
        let raw = place.normal_eye_from_object * n;
        let (unit, length) = normalize(raw.to_array());
        self.position_from_eye
            .push(from_eye.to_array().map(R::from_f64));
        for (axis, (x, n)) in eye.to_array().into_iter().zip(unit).enumerate() {
            self.position_eye[axis].push(R::from_f64(x));
            self.normal_eye[axis].push(R::from_f64(n));
        }
        if let Some(factor) = place.length_factor {
            self.normal_length.push(R::from_f64(length * factor));
        }
    }
}

/// How one object's vertices reach world and eye space.
struct Placement {
    world_from_object: DAffine3,
    eye: DVec3,
    rotation: DMat3,
    normal_eye_from_object: DMat3,
    /// `None` = normals are normalised; else the factor of GL_RESCALE_NORMAL (1 where that is off).
    length_factor: Option<f64>,
}

impl Placement {
    fn new(scene: &Scene, world_from_object: &DAffine3) -> Self {
        let rotation = scene.camera.eye_from_world_rotation();
        let model = &scene.light_model;
        let length_factor = (!model.normalize).then(|| {
            let eye_from_object = rotation * world_from_object.matrix3;
            if model.rescale_normal {
                rescale_factor(&eye_from_object)
            } else {
                1.0
            }
        });
        Self {
            world_from_object: *world_from_object,
            eye: scene.camera.eye,
            rotation,
            normal_eye_from_object: rotation * normal_matrix(world_from_object),
            length_factor,
        }
    }
}

/// The object-space mesh of an object at a level.
pub fn object_mesh(object: &Object, level: Option<u32>) -> Arc<Mesh> {
    match &object.geometry {
        Geometry::Mesh(mesh) => Arc::clone(mesh),
        Geometry::Shape(shape) => {
            let turn = object.tessellation.or(level).unwrap_or(DEFAULT_LEVEL);
            let cells = object.tessellation.unwrap_or(1);
            Arc::new(tessellate(shape, turn, cells))
        }
    }
}
