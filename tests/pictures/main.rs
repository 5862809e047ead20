//! What the renderers draw: pictures, rays and the equation against closed forms, reference data, each other and brute force.

mod agreement;
mod bezier;
mod blend;
mod closed_room;
mod cross;
mod exactness;
mod fuzz;
mod instances;
mod lighting_reference;
mod raster;
mod raster_reference;
mod requirements;
mod revolution;
mod shapes;
mod trace;
mod whitted;

/// Helpers that several tests share.
#[path = "../common"]
mod common {
    pub(crate) mod adapter;
    pub(crate) mod descriptor;
    pub(crate) mod ladder;
    pub(crate) mod precise;
    pub(crate) mod random;
    pub(crate) mod scale;
    pub(crate) mod scenes;
    pub(crate) mod text;
}

/// The conformance adapter's own code, which answers the reference data.
#[path = "../probe"]
#[allow(dead_code, reason = "the adapter uses all of it, these tests a part")]
mod probe {
    pub(crate) mod gl_lights;
    pub(crate) mod gl_scene;
    pub(crate) mod numerics;
    pub(crate) mod rays;
    use crate::common::adapter::{Failure, number};
}
