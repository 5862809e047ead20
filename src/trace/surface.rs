//! The traced scene: triangles and exact shapes under one hierarchy, and what a hit looks like to the equation.
//!
//! World space and f64 inside; `R` is the precision that triangle vertices are stored in. Primitive numbers are those of the
//! assembly in both geometries (an exact shape takes the number of its first triangle), so ties go the same way.
//! Hits come out in eye space: a triangle interpolates the assembly's eye-space positions and normals, the same numbers that
//! the rasterizer interpolates; an exact shape's point has the eye subtracted before it is rotated.

use super::build::Bounds;
use super::bvh::{Bvh, Walker};
use super::exact::unit;
use super::instance::{self, Instance, Shared};
use super::planar::{Shear, normal, precise_weights};
use super::ray::{Foot, Hit, NO_SET, Ray};
use super::solid::Solid;
use super::touch::{FaceItem, Touch};
use crate::lanes::Real;
use crate::math::Each;
use crate::math::{DMat3, DVec3};
use crate::scene::assembly::Assembly;
use crate::scene::contact::{self, Contacts, Detail};
use crate::scene::{self, Scene};

/// Marks the item number of an exact shape.
const SOLID: u32 = 1 << 31;
/// Marks the slot of an instance; hits inside it carry the numbers of its triangles.
const INSTANCE: u32 = 1 << 30;

/// Everything that rays can meet.
#[derive(Clone, Debug)]
pub struct Surfaces<'a, R> {
    scene: &'a Scene,
    assembly: &'a Assembly<R>,
    solids: Vec<Solid>,
    shared: Vec<Shared>,
    /// Per object: how it shows a shared mesh, if it does.
    instances: Vec<Option<Instance>>,
    bvh: Bvh,
    /// Item in each slot: a triangle's number, [`SOLID`] + index, or [`INSTANCE`] + object.
    items: Vec<u32>,
    /// Corners less the eye of the triangle in each slot (zeros for others), so that leaves read memory in order.
    corners: Vec<[[R; 3]; 3]>,
    rotation: DMat3,
    eye: DVec3,
    mirrors: bool,
    /// What faces are: those of the true shapes, or triangles.
    detail: Detail,
    /// Which of them lie on each other.
    touch: Touch,
    /// Where the solids of each object begin, if it has any.
    first_solid: Vec<Option<u32>>,
}

/// What the tracer knows of a hit.
#[derive(Clone, Copy, Debug)]
pub struct Site<R> {
    /// Parameter of the ray that arrived.
    pub t: f64,
    /// The point, its geometric normal, and the bound of its error; world space.
    pub foot: Foot,
    /// The point in eye space.
    pub position_eye: [R; 3],
    /// Shading normal of the front side, eye space, unit (or zero).
    pub normal_eye: [f64; 3],
    /// Vertex colour, where some material of the scene follows it.
    pub color: Option<[R; 3]>,
    /// Index into the scene's objects.
    pub object: u32,
    /// Index into the scene's materials.
    pub material: u32,
    /// Seen from the back.
    pub back: bool,
    /// What a ray that leaves the surface on the outside, and on the inside, need not be tested against.
    pub skip: [u32; 2],
    /// Which set of faces such rays cannot meet again.
    pub set: [u32; 2],
}

impl<'a, R: Real> Surfaces<'a, R> {
    /// Prepares a scene: true shapes where `exact`, else the assembly's triangles alone.
    pub(super) fn new(scene: &'a Scene, assembly: &'a Assembly<R>, exact: bool) -> Self {
        let (shared, instances) = instance::gather(scene, &assembly.triangle_range);
        let (items, solids) = gather(scene, assembly, &instances, exact);
        let mut surfaces = Self {
            scene,
            assembly,
            solids,
            shared,
            instances,
            bvh: Bvh::build(&[]).0,
            items,
            corners: Vec::new(),
            rotation: scene.camera.eye_from_world_rotation(),
            eye: scene.camera.eye,
            mirrors: scene.camera.lens().is_some_and(|lens| lens.mirrors),
            detail: if exact {
                Detail::Exact
            } else {
                Detail::Triangles(assembly.level)
            },
            touch: Touch::default(),
            first_solid: Vec::new(),
        };
        surfaces.find_contacts();
        let bounds: Vec<Bounds> = surfaces
            .items
            .iter()
            .map(|&item| surfaces.bounds(item))
            .collect();
        let (bvh, order) = Bvh::build(&bounds);
        surfaces.bvh = bvh;
        surfaces.items = order
            .into_iter()
            .map(|i| surfaces.items[i as usize])
            .collect();
        surfaces.corners = surfaces
            .items
            .iter()
            .map(|&item| surfaces.corners_of(item))
            .collect();
        surfaces
    }

    /// How many triangles the scene has.
    pub(super) fn triangles(&self) -> usize {
        self.assembly.triangles.len()
    }

    /// Inner nodes and leaves of the hierarchies, shared ones once.
    pub fn hierarchy_size(&self) -> (usize, usize) {
        let shared = self.shared.iter().map(|shared| &shared.bvh);
        std::iter::once(&self.bvh)
            .chain(shared)
            .fold((0, 0), |(nodes, leaves), bvh| {
                (nodes + bvh.node_count(), leaves + bvh.leaf_count())
            })
    }

    /// The nearest hit of a ray; of hits at equal t the lowest primitive number.
    pub fn closest_hit(&self, ray: &Ray, walker: &mut Walker) -> Option<Hit> {
        let mut best = None;
        self.walk(ray, walker, |hit, t_max| {
            if hit.t >= ray.t_min && hit.t <= *t_max && wins(&hit, &best) {
                best = Some(hit);
                *t_max = hit.t;
            }
            false
        });
        best
    }

    /// Whether anything lies on the ray between its ends.
    pub fn any_hit(&self, ray: &Ray, walker: &mut Walker) -> bool {
        self.walk(ray, walker, |hit, _| in_range(ray, &hit))
    }

    /// Every crossing of the ray with a surface between its ends, in order of t, then of primitive number.
    ///
    /// `keep` sees each one first, in no particular order; where it says false, the walk stops and there is no answer.
    pub fn crossings(
        &self,
        ray: &Ray,
        walker: &mut Walker,
        mut keep: impl FnMut(&Hit) -> bool,
    ) -> Option<Vec<Hit>> {
        let mut found = Vec::new();
        let stopped = self.walk(ray, walker, |hit, _| {
            if !in_range(ray, &hit) {
                return false;
            }
            found.push(hit);
            !keep(&hit)
        });
        found.sort_by(along_the_ray);
        (!stopped).then_some(found)
    }

    /// Finds the faces that lie on each other. Where objects are triangles alone, the assembly knows.
    fn find_contacts(&mut self) {
        let (scene, assembly) = (self.scene, self.assembly);
        self.first_solid = vec![None; scene.objects.len()];
        for (i, solid) in self.solids.iter().enumerate().rev() {
            self.first_solid[solid.object as usize] = Some(i as u32);
        }
        let own = (!self.solids.is_empty()).then(|| Contacts::of(scene, self.detail));
        let contacts = own.as_ref().unwrap_or(&assembly.contacts);
        // A corner is stored to half a unit in the last place of each coordinate.
        let stored = |triangle: u32| {
            let corners = assembly.triangles[triangle as usize];
            let from_eye = corners.map(|v| assembly.position_from_eye[v as usize]);
            let largest = from_eye.iter().flatten().map(|x| x.to_f64().abs());
            4.0 * R::ROUNDOFF.to_f64() * largest.fold(0.0, f64::max)
        };
        self.touch = Touch::new(contacts, |key| self.item_of(key), stored);
    }

    /// Where a face of the shapes is among the items; `None` where the shape is no hit.
    fn item_of(&self, key: contact::Key) -> Option<FaceItem> {
        let object = key.object as usize;
        match (&self.scene.objects[object].geometry, self.detail) {
            (scene::Geometry::Shape(shape), Detail::Exact) => {
                let first = self.first_solid[object]?;
                let pieces = matches!(shape, scene::Shape::Revolution { .. });
                let (solid, part) = if pieces {
                    (first + key.part, 0)
                } else {
                    (first, key.part)
                };
                Some(FaceItem::Solid { solid, part })
            }
            _ => {
                let range = self.assembly.triangle_range.get(object)?;
                Some(FaceItem::Triangle(range.start + key.part))
            }
        }
    }

    /// Which faces lie on each other.
    #[inline]
    pub(super) fn touch(&self) -> &Touch {
        &self.touch
    }

    /// The set of the face that a hit is on.
    #[inline]
    pub(super) fn set_of(&self, hit: &Hit) -> u32 {
        if self.touch.is_empty() {
            NO_SET
        } else if hit.item & SOLID == 0 {
            self.touch.of_triangle(hit.item)
        } else {
            let part = self.solid(hit.item).part(hit.feature);
            self.touch.of_solid(hit.item & !SOLID, part)
        }
    }

    /// A face in a plane.
    pub(super) fn is_flat(&self, hit: &Hit) -> bool {
        hit.item & SOLID == 0 || self.solid(hit.item).is_flat(hit.feature)
    }

    /// Item and part of a face in a plane.
    pub(super) fn face(&self, hit: &Hit) -> (u32, u32) {
        if hit.item & SOLID == 0 {
            return (hit.item, 0);
        }
        let part = self.solid(hit.item).part(hit.feature);
        (hit.item, part as u32)
    }

    /// The faces whose planes hold a point, as [`Self::face`] tells them: decided from the shapes.
    pub(super) fn planes_through(&self, point: DVec3) -> Vec<(u32, u32)> {
        let keys = contact::planes_through(self.scene, self.detail, point);
        let face = |key| match self.item_of(key)? {
            FaceItem::Solid { solid, part } => Some((SOLID | solid, part)),
            FaceItem::Triangle(triangle) => Some((triangle, 0)),
        };
        let mut faces: Vec<_> = keys.into_iter().filter_map(face).collect();
        faces.sort_unstable();
        faces
    }

    /// The nearest hit found by testing every primitive: what the hierarchy is held to.
    pub fn closest_hit_of_all(&self, ray: &Ray) -> Option<Hit> {
        let shear = Shear::new(ray.origin, ray.direction)?;
        let mut best = None;
        let mut keep = |hit: Hit| {
            let left = ray.set != NO_SET && self.set_of(&hit) == ray.set;
            if !left && in_range(ray, &hit) && wins(&hit, &best) {
                best = Some(hit);
            }
        };
        for slot in 0..self.items.len() {
            let Some((instance, shared)) = self.instance(self.items[slot]) else {
                self.hits(slot, ray, &shear, &mut keep);
                continue;
            };
            let inner = instance.ray_object(ray);
            if let Some(shear) = Shear::new(inner.origin, inner.direction) {
                let hits =
                    (0..shared.len()).filter_map(|s| instance.hit(shared, s, ray.skip, &shear));
                hits.for_each(&mut keep);
            }
        }
        best
    }

    /// Shows `visit` every hit that the hierarchy cannot rule out, at any t, with the bound on t, which it may lower; it
    /// returns true to stop. Returns whether it did.
    #[inline]
    pub(super) fn walk(
        &self,
        ray: &Ray,
        walker: &mut Walker,
        mut visit: impl FnMut(Hit, &mut f64) -> bool,
    ) -> bool {
        let Some(shear) = Shear::new(ray.origin, ray.direction) else {
            return false;
        };
        let mut visit = |hit: Hit, t_max: &mut f64| {
            let left = ray.set != NO_SET && self.set_of(&hit) == ray.set;
            !left && visit(hit, t_max)
        };
        self.bvh.traverse(ray, walker, |slot, t_max, walker| {
            if let Some((instance, shared)) = self.instance(self.items[slot]) {
                let mut inner = instance.ray_object(ray);
                inner.t_max = *t_max;
                let Some(shear) = Shear::new(inner.origin, inner.direction) else {
                    return false;
                };
                return shared.bvh.traverse(&inner, walker, |slot, inner_t_max, _| {
                    let Some(hit) = instance.hit(shared, slot, ray.skip, &shear) else {
                        return false;
                    };
                    let stop = visit(hit, t_max);
                    *inner_t_max = *t_max;
                    stop
                });
            }
            let mut stop = false;
            self.hits(slot, ray, &shear, |hit| stop = stop || visit(hit, t_max));
            stop
        })
    }

    /// What is at a hit. `eye_ray` is the same ray in eye space where it is a primary one: a triangle's weights are then
    /// taken from the eye-space numbers that the rasterizer uses, too.
    pub fn site(&self, ray: &Ray, hit: &Hit, eye_ray: Option<(DVec3, DVec3)>) -> Site<R> {
        self.site_with(ray, hit, eye_ray, true)
    }

    /// [`Self::site`], its shading normal zero where nothing asks for it.
    pub(super) fn site_with(
        &self,
        ray: &Ray,
        hit: &Hit,
        eye_ray: Option<(DVec3, DVec3)>,
        normal: bool,
    ) -> Site<R> {
        if hit.item & SOLID == 0 {
            self.triangle_site(ray, hit, eye_ray, normal)
        } else {
            self.solid_site(ray, hit, normal)
        }
    }

    /// The material of a hit.
    pub fn material(&self, ray: &Ray, hit: &Hit) -> u32 {
        if hit.item & SOLID == 0 {
            return self.assembly.material[hit.item as usize];
        }
        let solid = self.solid(hit.item);
        self.solid_material(solid, solid.foot(ray, hit).1)
    }

    /// Object of a hit.
    pub fn object(&self, hit: &Hit) -> u32 {
        if hit.item & SOLID == 0 {
            self.assembly.object[hit.item as usize]
        } else {
            self.solid(hit.item).object
        }
    }

    /// A ray enters a convex body there, and leaves it elsewhere.
    pub(super) fn enters_convex(&self, hit: &Hit) -> bool {
        let convex = |solid: &Solid| solid.is_convex() && !solid.is_planar();
        hit.item & SOLID != 0 && !hit.back && convex(self.solid(hit.item))
    }

    /// Linear part of world from object, of the object hit.
    pub(super) fn model_matrix(&self, hit: &Hit) -> DMat3 {
        let object = &self.scene.objects[self.object(hit) as usize];
        object.world_from_object.matrix3
    }

    /// Length of a triangle's normal as its vertices' weigh it; `None` for exact shapes.
    pub(super) fn length_left(&self, hit: &Hit) -> Option<f64> {
        if hit.item & SOLID != 0 {
            return None;
        }
        let triangle = self.assembly.triangles[hit.item as usize];
        let [a, b, c] =
            triangle.each(|v| DVec3::from_array(self.assembly.vertex_normal_weighted(v)));
        let [u, v] = hit.uv;
        Some(((1.0 - u - v) * a + u * b + v * c).length())
    }

    /// Length of the object normal that an exact shape's own formula leaves: P - C of a sphere has that of its radius.
    pub(super) fn length_of_shape(&self, hit: &Hit) -> f64 {
        match &self.scene.objects[self.object(hit) as usize].geometry {
            scene::Geometry::Shape(scene::Shape::Sphere { radius, .. }) => *radius,
            _ => 1.0,
        }
    }

    /// Shows every hit of a slot, at any t.
    #[inline]
    fn hits(&self, slot: usize, ray: &Ray, shear: &Shear, mut visit: impl FnMut(Hit)) {
        let item = self.items[slot];
        if item == ray.skip {
            return;
        }
        if item & SOLID != 0 {
            self.solid(item).hits(item, ray, shear, &mut visit);
            return;
        }
        let [a, b, c] = self.corners[slot];
        let corners = [self.world(a), self.world(b), self.world(c)];
        if let Some(p) = shear.triangle(corners) {
            visit(Hit {
                t: p.t,
                primitive: item,
                item,
                uv: p.uv,
                feature: 0,
                back: p.back,
            });
        }
    }

    /// The instance of a slot's item, and its mesh.
    #[inline]
    fn instance(&self, item: u32) -> Option<(&Instance, &Shared)> {
        if item & (SOLID | INSTANCE) != INSTANCE {
            return None;
        }
        self.instance_of((item & !INSTANCE) as usize)
    }

    /// How an object shows a shared mesh.
    fn instance_of(&self, object: usize) -> Option<(&Instance, &Shared)> {
        let instance = self.instances.get(object)?.as_ref()?;
        Some((instance, &self.shared[instance.shared]))
    }

    fn solid(&self, item: u32) -> &Solid {
        &self.solids[(item & !SOLID) as usize]
    }

    fn corners_of(&self, item: u32) -> [[R; 3]; 3] {
        if item & (SOLID | INSTANCE) != 0 {
            return [[R::ZERO; 3]; 3];
        }
        let triangle = self.assembly.triangles[item as usize];
        triangle.each(|v| self.assembly.position_from_eye[v as usize])
    }

    /// A place less the eye, in world space: the eye is added in f64, equally for every triangle that shares the vertex.
    #[inline]
    fn world(&self, [x, y, z]: [R; 3]) -> [f64; 3] {
        let eye = self.eye;
        [x.to_f64() + eye.x, y.to_f64() + eye.y, z.to_f64() + eye.z]
    }

    /// World corners of a triangle as rays meet it, and the error that an instance's transform adds to the hit.
    fn corners_world(&self, triangle: u32) -> ([DVec3; 3], f64) {
        let object = self.assembly.object[triangle as usize] as usize;
        match self.instance_of(object) {
            Some((instance, shared)) => instance.corners_world(shared, triangle),
            None => {
                let corners = self.corners_of(triangle);
                (corners.each(|p| DVec3::from_array(self.world(p))), 0.0)
            }
        }
    }

    fn bounds(&self, item: u32) -> Bounds {
        if item & SOLID != 0 {
            return self.solid(item).bounds();
        }
        if let Some((instance, shared)) = self.instance(item) {
            return instance.bounds(shared);
        }
        let corners = self.corners_of(item);
        Bounds::of(corners.each(|p| DVec3::from_array(self.world(p))))
    }

    /// Seen along the ray: a picture that shows the mirror image turns windings round.
    fn front_is_clockwise(&self) -> bool {
        (self.scene.raster.front_face == scene::FrontFace::Cw) != self.mirrors
    }

    fn solid_material(&self, solid: &Solid, tile: u32) -> u32 {
        let materials = &self.scene.objects[solid.object as usize].materials;
        materials[tile as usize % materials.len()] as u32
    }

    fn solid_site(&self, ray: &Ray, hit: &Hit, normal: bool) -> Site<R> {
        let solid = self.solid(hit.item);
        let (foot, tile) = solid.foot(ray, hit);
        let eye = self.rotation * (foot.point - self.eye);
        // A convex solid cannot be met again on the outside, a planar one on neither side.
        let skip_if = |never_again: bool| {
            if never_again {
                hit.item
            } else {
                super::ray::NO_ITEM
            }
        };
        Site {
            t: hit.t,
            foot,
            position_eye: eye.to_array().each(R::from_f64),
            normal_eye: if normal {
                unit(self.rotation * foot.normal).to_array()
            } else {
                [0.0; 3]
            },
            color: (!self.assembly.color[0].is_empty()).then_some([R::ONE; 3]),
            object: solid.object,
            material: self.solid_material(solid, tile),
            back: hit.back != self.front_is_clockwise(),
            skip: [skip_if(solid.is_convex()), skip_if(solid.is_planar())],
            set: self.sets_left(hit, solid.is_convex()),
        }
    }

    fn triangle_site(
        &self,
        ray: &Ray,
        hit: &Hit,
        eye_ray: Option<(DVec3, DVec3)>,
        with_normal: bool,
    ) -> Site<R> {
        let a = self.assembly;
        let triangle = a.triangles[hit.item as usize];
        let (world, error) = self.corners_world(hit.item);
        let eye = triangle.each(|v| a.vertex_eye(v).each(Real::to_f64));
        let normals = triangle.each(|v| a.vertex_normal_weighted(v));
        let (ab, ac) = (world[1] - world[0], world[2] - world[0]);
        // f64 vertices seen from afar deserve better weights than those that decided; f32 ones cannot tell.
        let [u, v] = if R::ROUNDOFF.to_f64() < 1e-10 {
            precise_weights(ray.origin, ray.direction, world).unwrap_or(hit.uv)
        } else {
            hit.uv
        };
        let foot = Foot {
            point: world[0] + u * ab + v * ac,
            normal: normal(world),
            scale: ab.abs().max_element() + ac.abs().max_element() + error,
        };
        let [u, v] = eye_ray
            .and_then(|(o, d)| {
                let shear = Shear::new(o, d)?;
                Some(shear.weights(eye.each(|p| shear.vertex(p)))?.1)
            })
            .unwrap_or(hit.uv);
        let blend = |x: [[f64; 3]; 3]| {
            [0, 1, 2].each(|k| (1.0 - u - v) * x[0][k] + u * x[1][k] + v * x[2][k])
        };
        Site {
            t: hit.t,
            foot,
            position_eye: blend(eye).map(R::from_f64),
            normal_eye: if with_normal {
                unit(DVec3::from_array(blend(normals))).to_array()
            } else {
                [0.0; 3]
            },
            color: a.vertex_color(triangle[0]).map(|first| {
                let corner = |v: u32| a.vertex_color(v).unwrap_or(first);
                blend(triangle.each(corner).map(|c| c.each(Real::to_f64))).map(R::from_f64)
            }),
            object: a.object[hit.item as usize],
            material: a.material[hit.item as usize],
            back: hit.back != self.front_is_clockwise(),
            skip: [hit.item; 2],
            set: self.sets_left(hit, false),
        }
    }
}

/// The items of a scene in file order, and its exact shapes.
fn gather<R>(
    scene: &Scene,
    assembly: &Assembly<R>,
    instances: &[Option<Instance>],
    exact: bool,
) -> (Vec<u32>, Vec<Solid>) {
    let mut items = Vec::with_capacity(assembly.triangles.len());
    let mut solids = Vec::new();
    for (index, object) in scene.objects.iter().enumerate() {
        let range = assembly.triangle_range.get(index).cloned().unwrap_or(0..0);
        match &object.geometry {
            scene::Geometry::Shape(shape) if exact => {
                let place = &object.world_from_object;
                for solid in Solid::all(shape, place, range.start, index as u32) {
                    items.push(SOLID + solids.len() as u32);
                    solids.push(solid);
                }
            }
            _ if instances.get(index).is_some_and(Option::is_some) => {
                items.push(INSTANCE + index as u32)
            }
            _ => items.extend(range),
        }
    }
    (items, solids)
}

pub(super) fn in_range(ray: &Ray, hit: &Hit) -> bool {
    hit.t >= ray.t_min && hit.t <= ray.t_max
}

/// Order of hits along a ray; of those at one place, that of their numbers.
pub(super) fn along_the_ray(a: &Hit, b: &Hit) -> std::cmp::Ordering {
    let by_number = (a.primitive, a.feature).cmp(&(b.primitive, b.feature));
    a.t.total_cmp(&b.t).then(by_number)
}

/// Nearer, or as near with a lower primitive number (and feature).
fn wins(hit: &Hit, best: &Option<Hit>) -> bool {
    best.is_none_or(|b| {
        let number = (hit.primitive, hit.feature);
        hit.t < b.t || (hit.t == b.t && number < (b.primitive, b.feature))
    })
}
