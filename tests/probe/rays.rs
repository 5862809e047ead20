//! The cases for numerical stability that rays decide, kinds `ray`, `mesh`, `shadow`, `refr` and `chain`: answered by the
//! routines that the tracer calls.
//!
//! Geometry in f64; in f32 the vertices of meshes are stored, and the answers rounded, in f32, as the tracer does.

use std::sync::Arc;

use rastray::lanes::Real;
use rastray::math::{DAffine3, DVec3};
use rastray::scene::assembly::Assembly;
use rastray::scene::requirements::Model;
use rastray::scene::{Geometry as Form, Mesh, Object, Scene, Shape};
use rastray::trace::bvh::Walker;
use rastray::trace::cone::Cone;
use rastray::trace::cylinder::Cylinder;
use rastray::trace::disk::Disk;
use rastray::trace::exact::Twofold;
use rastray::trace::optics::{Transmission, reflect, refract};
use rastray::trace::planar::{Shear, normal, precise_weights};
use rastray::trace::ray::Ray;
use rastray::trace::span::{Span, Spot};
use rastray::trace::sphere::roots;
use rastray::trace::{Geometry, Plan};
use serde::Deserialize;
use serde_json::{Value, json};

use super::Failure;

/// A ray against one shape.
#[derive(Deserialize)]
struct RayCase {
    o: [f64; 3],
    d: [f64; 3],
    prim: Primitive,
}

#[derive(Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
enum Primitive {
    Sphere {
        c: [f64; 3],
        r: f64,
    },
    Plane {
        p: [f64; 3],
        n: [f64; 3],
    },
    Cyl {
        p0: [f64; 3],
        p1: [f64; 3],
        r: f64,
    },
    Cone {
        apex: [f64; 3],
        base: [f64; 3],
        r: f64,
    },
    Tri {
        v: [[f64; 3]; 3],
    },
}

#[derive(Deserialize)]
struct MeshCase {
    v: Vec<[f64; 3]>,
    f: Vec<[u32; 3]>,
    rays: Vec<Aim>,
}

#[derive(Deserialize)]
struct Aim {
    o: [f64; 3],
    d: [f64; 3],
}

#[derive(Deserialize)]
struct ShadowCase {
    o: [f64; 3],
    d: [f64; 3],
    light: [f64; 3],
    prims: Vec<Primitive>,
}

#[derive(Deserialize)]
struct Interface {
    d: [f64; 3],
    n: [f64; 3],
    eta_i: f64,
    eta_t: f64,
}

#[derive(Deserialize)]
struct Chain {
    d: [f64; 3],
    ops: Vec<Step>,
}

#[derive(Deserialize)]
#[serde(tag = "op", rename_all = "lowercase")]
enum Step {
    Reflect { n: [f64; 3] },
    Refract { n: [f64; 3], eta_i: f64, eta_t: f64 },
}

/// The answer to a case of one of the kinds above; `None` for other kinds.
pub(crate) fn answer<R: Real>(kind: &str, case: Value) -> Result<Option<Value>, Failure> {
    Ok(Some(match kind {
        "ray" => ray::<R>(case)?,
        "mesh" => mesh::<R>(case)?,
        "shadow" => shadow::<R>(case)?,
        "refr" => refr::<R>(case)?,
        "chain" => chain::<R>(case)?,
        _ => return Ok(None),
    }))
}

/// A vector in the precision of the render.
fn stored<R: Real>(x: DVec3) -> [f64; 3] {
    x.to_array().map(|x| R::from_f64(x).to_f64())
}

/// The nearest hit with t > 0.
fn ray<R: Real>(case: Value) -> Result<Value, Failure> {
    let case: RayCase = serde_json::from_value(case)?;
    let found = meet(
        DVec3::from_array(case.o),
        DVec3::from_array(case.d),
        &case.prim,
    );
    Ok(match found {
        None => json!({ "hit": false }),
        Some((t, p, n)) => json!({
            "hit": true,
            "t": R::from_f64(t).to_f64(),
            "p": stored::<R>(p),
            "n": stored::<R>(n),
        }),
    })
}

/// (t, p, n) of the nearest hit with t > 0.
fn meet(o: DVec3, d: DVec3, shape: &Primitive) -> Option<(f64, DVec3, DVec3)> {
    let from = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|k| Twofold::difference(a[k], b[k]));
    let (start, point) = (o.to_array(), DVec3::from_array);
    match *shape {
        Primitive::Sphere { c, r } => {
            let found = roots(from(c, start), d, r)?;
            let root = (0..2).find(|&k| found.t[k] > 0.0)?;
            let n = found.normal(root);
            Some((found.t[root], point(c) + r * n, n))
        }
        Primitive::Tri { v } => {
            let hit = Shear::new(o, d)?.triangle(v).filter(|hit| hit.t > 0.0)?;
            let [a, b, c] = v.map(point);
            let [u, w] = precise_weights(o, d, [a, b, c]).unwrap_or(hit.uv);
            Some((hit.t, a + u * (b - a) + w * (c - a), normal([a, b, c])))
        }
        Primitive::Cyl { p0, p1, r } => {
            let q = from(p0, start);
            let solid = Cylinder {
                axis: from(p1, p0),
                radius: r,
            };
            first(solid.span(q, d), |end| solid.spot(q, d, end), point(p0))
        }
        Primitive::Cone { apex, base, r } => {
            let q = from(apex, start);
            let solid = Cone {
                axis: from(base, apex),
                radius: r,
            };
            first(solid.span(q, d), |end| solid.spot(q, d, end), point(apex))
        }
        // A disk that reaches beyond everything.
        Primitive::Plane { p, n } => {
            let q = from(p, start);
            let disk = Disk {
                normal: point(n),
                radius: 1e60,
            };
            let t = disk.hit(q, d)?.0;
            let spot = disk.spot(q, d).filter(|_| t > 0.0)?;
            Some((t, point(p) + spot.offset, spot.normal))
        }
    }
}

/// The first end of a span with t > 0, and what is there.
fn first(
    span: Option<Span>,
    spot: impl Fn(usize) -> Option<Spot>,
    anchor: DVec3,
) -> Option<(f64, DVec3, DVec3)> {
    let span = span?;
    let end = (0..2).find(|&end| span.t[end].value() > 0.0)?;
    let spot = spot(end)?;
    Some((span.t[end].value(), anchor + spot.offset, spot.normal))
}

/// Every crossing of each ray with the mesh: t, and +1 where it enters, -1 where it leaves.
fn mesh<R: Real>(case: Value) -> Result<Value, Failure> {
    let case: MeshCase = serde_json::from_value(case)?;
    let mesh = Mesh {
        positions: case.v.into_iter().map(DVec3::from_array).collect(),
        triangles: case.f,
        ..Mesh::default()
    };
    let mut scene = empty();
    add(&mut scene, Form::Mesh(Arc::new(mesh)));
    let assembly = Assembly::<R>::new(&scene, None)?;
    let plan = Plan::new(&scene, &assembly, Geometry::Mesh, Model::Required)?;
    let mut walker = Walker::default();
    let mut answer = |aim: Aim| {
        let ray = Ray::new(DVec3::from_array(aim.o), DVec3::from_array(aim.d));
        let hits = plan.surfaces().crossings(&ray, &mut walker, |_| true);
        let hits = hits.unwrap_or_default();
        let one = |t: f64, back: bool| json!([R::from_f64(t).to_f64(), if back { -1 } else { 1 }]);
        let hits: Vec<Value> = hits.iter().map(|hit| one(hit.t, hit.back)).collect();
        json!({ "hits": hits })
    };
    Ok(case.rays.into_iter().map(&mut answer).collect())
}

/// A scene whose eye is the origin, so that stored places keep the numbers of the case.
fn empty() -> Scene {
    let mut scene = Scene::default();
    (scene.camera.eye, scene.camera.target) = (DVec3::ZERO, DVec3::NEG_Z);
    scene.materials.push(rastray::scene::Material {
        name: "any".into(),
        front: rastray::gl::Material::default(),
        back: None,
        optics: rastray::scene::Optics::default(),
    });
    scene
}

fn add(scene: &mut Scene, geometry: Form) {
    scene.objects.push(Object {
        name: format!("object {}", scene.objects.len()),
        geometry,
        materials: vec![0],
        world_from_object: DAffine3::IDENTITY,
        tessellation: None,
        priority: 0,
    });
}

/// The shape as the tracer has it; an infinite plane is a disk that reaches far beyond `reach`.
fn form(shape: &Primitive, reach: f64) -> Form {
    let point = DVec3::from_array;
    Form::Shape(match *shape {
        Primitive::Sphere { c, r } => Shape::Sphere {
            center: point(c),
            radius: r,
        },
        Primitive::Plane { p, n } => Shape::Disk {
            center: point(p),
            normal: point(n),
            radius: 1024.0 * reach,
        },
        Primitive::Cyl { p0, p1, r } => Shape::Cylinder {
            base: point(p0),
            top: point(p1),
            radius: r,
            caps: true,
        },
        Primitive::Cone { apex, base, r } => Shape::Cone {
            base: point(base),
            apex: point(apex),
            radius: r,
            cap: true,
        },
        Primitive::Tri { v } => {
            return Form::Mesh(Arc::new(Mesh {
                positions: v.map(point).to_vec(),
                triangles: vec![[0, 1, 2]],
                ..Mesh::default()
            }));
        }
    })
}

/// Whether the nearest hit is lit by a point light, on the side that the ray sees.
fn shadow<R: Real>(case: Value) -> Result<Value, Failure> {
    let case: ShadowCase = serde_json::from_value(case)?;
    let [o, d, light] = [case.o, case.d, case.light].map(DVec3::from_array);
    let mut scene = empty();
    let reach = (o.abs() + light.abs()).max_element();
    for shape in &case.prims {
        add(&mut scene, form(shape, reach));
    }
    let assembly = Assembly::<R>::new(&scene, Some(4))?;
    let plan = Plan::new(&scene, &assembly, Geometry::Exact, Model::Required)?;
    let (surfaces, mut walker) = (plan.surfaces(), Walker::default());
    let ray = Ray::new(o, d);
    let lit = surfaces.closest_hit(&ray, &mut walker).is_some_and(|hit| {
        let site = surfaces.site(&ray, &hit, None);
        let towards = light - site.foot.point;
        let seen_side = site.foot.normal.dot(ray.direction) < 0.0;
        let light_side = site.foot.normal.dot(towards) > 0.0;
        let to_light = Ray {
            skip: site.skip[usize::from(!light_side)],
            ..Ray::towards(site.foot.spawn(towards), light)
        };
        seen_side == light_side && !surfaces.any_hit(&to_light, &mut walker)
    });
    Ok(json!({ "lit": lit }))
}

/// Mirrored and transmitted directions at an interface.
fn refr<R: Real>(case: Value) -> Result<Value, Failure> {
    let case: Interface = serde_json::from_value(case)?;
    let [d, n] = [case.d, case.n].map(DVec3::from_array);
    let refl = stored::<R>(reflect(d, n));
    Ok(match refract(d, n, case.eta_i, case.eta_t) {
        Transmission::Total => json!({ "tir": true, "refl": refl, "refr": [0.0, 0.0, 0.0] }),
        Transmission::Through { direction, .. } => {
            json!({ "tir": false, "refl": refl, "refr": stored::<R>(direction) })
        }
    })
}

/// A direction pushed through a list of interfaces.
fn chain<R: Real>(case: Value) -> Result<Value, Failure> {
    let case: Chain = serde_json::from_value(case)?;
    let mut d = DVec3::from_array(case.d);
    for step in case.ops {
        d = match step {
            Step::Reflect { n } => reflect(d, DVec3::from_array(n)),
            Step::Refract { n, eta_i, eta_t } => {
                let n = DVec3::from_array(n);
                match refract(d, n, eta_i, eta_t) {
                    Transmission::Through { direction, .. } => direction,
                    Transmission::Total => reflect(d, n),
                }
            }
        };
    }
    Ok(json!({ "dir": stored::<R>(d) }))
}
