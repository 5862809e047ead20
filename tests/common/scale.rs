//! The same scene at another size.

use std::sync::Arc;

use rastray::scene::{Geometry, Mesh, Projection, Scene, Shape};

/// Every length of a scene times `k`: shapes, meshes, places, lights and their attenuation, camera. Angles and colours stay.
pub(crate) fn scaled(scene: &Scene, k: f64) -> Scene {
    let mut scene = scene.clone();
    let camera = &mut scene.camera;
    camera.eye *= k;
    camera.target *= k;
    camera.near *= k;
    camera.far = camera.far.map(|far| far * k);
    if let Projection::Orthographic { height } = &mut camera.projection {
        *height *= k;
    }
    // Objects that share a mesh share the scaled one.
    let mut meshes: Vec<(Arc<Mesh>, Arc<Mesh>)> = Vec::new();
    for object in &mut scene.objects {
        object.world_from_object.translation *= k;
        match &mut object.geometry {
            Geometry::Shape(shape) => scale_shape(shape, k),
            Geometry::Mesh(mesh) => {
                let known = meshes.iter().find(|(old, _)| Arc::ptr_eq(old, mesh));
                let scaled = known.map(|(_, new)| Arc::clone(new));
                let scaled = scaled.unwrap_or_else(|| {
                    let mut new = (**mesh).clone();
                    new.positions.iter_mut().for_each(|p| *p *= k);
                    let new = Arc::new(new);
                    meshes.push((Arc::clone(mesh), Arc::clone(&new)));
                    new
                });
                *mesh = scaled;
            }
        }
    }
    for light in &mut scene.lights {
        let source = &mut light.source;
        if source.position[3] != 0.0 {
            source.position[..3].iter_mut().for_each(|x| *x *= k);
        }
        source.attenuation[1] /= k;
        source.attenuation[2] /= k * k;
    }
    scene
}

fn scale_shape(shape: &mut Shape, k: f64) {
    match shape {
        Shape::Sphere { center, radius } | Shape::Disk { center, radius, .. } => {
            *center *= k;
            *radius *= k;
        }
        Shape::Box { min, max } => {
            *min *= k;
            *max *= k;
        }
        Shape::Patch {
            corner,
            edge_u,
            edge_v,
            ..
        } => [corner, edge_u, edge_v].into_iter().for_each(|x| *x *= k),
        Shape::Cylinder {
            base, top, radius, ..
        } => {
            *base *= k;
            *top *= k;
            *radius *= k;
        }
        Shape::Cone {
            base, apex, radius, ..
        } => {
            *base *= k;
            *apex *= k;
            *radius *= k;
        }
        Shape::Torus {
            center,
            major,
            minor,
            ..
        } => {
            *center *= k;
            *major *= k;
            *minor *= k;
        }
        Shape::Revolution { .. } => {
            panic!("tests/pictures/revolution.rs scales surfaces of revolution")
        }
        Shape::Bezier { points, .. } => *points = points.iter().map(|p| *p * k).collect(),
    }
}
