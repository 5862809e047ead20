//! Pictures of a scene as exact numbers, whatever the precision that they are drawn in.

use rastray::frame::Frame;
use rastray::gl::ShadeModel;
use rastray::render::{Job, Options, Renderer};
use rastray::scene::Scene;

/// The picture of the rasterizer, unclamped, exact.
pub(crate) fn rasterized(scene: &Scene, options: &Options, shading: ShadeModel) -> Frame<f64> {
    let job = Job::with(scene, Renderer::Raster, options).shading(shading);
    job.draw().expect("drawn").picture.to_f64()
}

/// The picture of rays, exact.
pub(crate) fn traced(scene: &Scene, options: &Options, by: Renderer) -> Frame<f64> {
    let job = Job::with(scene, by, options);
    job.draw().expect("drawn").picture.to_f64()
}
