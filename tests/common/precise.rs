//! Pictures and plans of the library's one way to draw, as frames of the float that a test is generic over.
//!
//! The one place where tests reach below `render`: [`surfaces`] hands out what rays meet. Vertices beyond the range of the
//! precision are kept, as the renderers have to cope with them.

use rastray::error::Error;
use rastray::frame::Frame;
use rastray::lanes::Real;
use rastray::render::{Assembled, Picture, Precision, Rasterizer, Tracer};
use rastray::scene::Scene;
use rastray::scene::requirements::Model;
use rastray::trace::surface::Surfaces;
use rastray::{raster, trace};

/// A float that pictures are drawn in.
pub(crate) trait Precise: Real {
    /// Its name for `render`.
    const PRECISION: Precision;

    /// The frame of a picture that was drawn in it.
    fn frame(picture: Picture) -> Frame<Self>;

    /// What rays meet in a plan that was made in it.
    fn surfaces<'p, 'a>(plan: &'p Tracer<'a>) -> &'p Surfaces<'a, Self>;
}

macro_rules! precise {
    ($float:ty, $variant:ident) => {
        impl Precise for $float {
            const PRECISION: Precision = Precision::$variant;

            fn frame(picture: Picture) -> Frame<Self> {
                match picture {
                    Picture::$variant(frame) => frame,
                    other => panic!("a picture in {:?}", other.precision()),
                }
            }

            fn surfaces<'p, 'a>(plan: &'p Tracer<'a>) -> &'p Surfaces<'a, Self> {
                match plan {
                    Tracer::$variant(plan) => plan.surfaces(),
                    _ => panic!("a plan in another precision"),
                }
            }
        }
    };
}
precise!(f32, F32);
precise!(f64, F64);

/// The triangles of a scene at a level.
pub(crate) fn assembled<R: Precise>(scene: &Scene, level: Option<u32>) -> Result<Assembled, Error> {
    Assembled::unchecked(scene, level, R::PRECISION)
}

/// A scene planned for the rasterizer, with what it requires.
pub(crate) fn rasterizer<'a>(scene: &'a Scene, assembled: &'a Assembled) -> Rasterizer<'a> {
    Rasterizer::new(scene, assembled, Model::Required)
}

/// A scene planned for the tracer, with what it requires.
pub(crate) fn tracer<'a>(
    scene: &'a Scene,
    assembled: &'a Assembled,
    geometry: trace::Geometry,
) -> Result<Tracer<'a>, Error> {
    Tracer::new(scene, assembled, geometry, Model::Required)
}

/// What rays meet in a plan.
pub(crate) fn surfaces<'p, 'a, R: Precise>(plan: &'p Tracer<'a>) -> &'p Surfaces<'a, R> {
    R::surfaces(plan)
}

/// Draws a plan; the work of it.
pub(crate) fn rasterize<R: Precise>(
    plan: &Rasterizer<'_>,
    options: &raster::Options,
) -> Result<(Frame<R>, raster::Counters), Error> {
    let drawn = plan.draw(options)?;
    let counters = *drawn.counters.raster().expect("the rasterizer drew");
    Ok((R::frame(drawn.picture), counters))
}

/// Traces a plan; the work of it.
pub(crate) fn follow<R: Precise>(
    plan: &Tracer<'_>,
    options: &trace::Options,
) -> Result<(Frame<R>, trace::Counters), Error> {
    let drawn = plan.draw(options)?;
    let counters = *drawn.counters.trace().expect("the tracer drew");
    Ok((R::frame(drawn.picture), counters))
}
