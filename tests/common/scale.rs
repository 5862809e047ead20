//! The same scene at another size.

use std::sync::Arc;

use rastray::scene::{Geometry, LightSpace, Projection, Scene, Shape};

/// Every length of a scene times `k`: shapes, meshes, places, lights, camera. Angles, colours and attenuation stay.
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
    for object in &mut scene.objects {
        object.world_from_object.translation *= k;
        match &mut object.geometry {
            Geometry::Shape(shape) => scale_shape(shape, k),
            Geometry::Mesh(mesh) => {
                let mesh = Arc::make_mut(mesh);
                mesh.positions.iter_mut().for_each(|p| *p *= k);
            }
        }
    }
    for light in &mut scene.lights {
        let position = &mut light.source.position;
        assert!(light.space == LightSpace::World);
        if position[3] != 0.0 {
            position[..3].iter_mut().for_each(|x| *x *= k);
        }
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
        Shape::Revolution { .. } => panic!("tests/revolution.rs scales surfaces of revolution"),
        Shape::Bezier { points, .. } => *points = points.iter().map(|p| *p * k).collect(),
    }
}
