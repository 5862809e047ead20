//! Scenes planned for a renderer, in one of the precisions: what the options of a draw do not change, made once.

use std::time::Instant;

use super::{Assembled, Counters, Drawn, Picture, Seconds, each};
use crate::error::Error;
use crate::frame::{Frame, Plane};
use crate::gl::{Material, ShadeModel};
use crate::lanes::Real;
use crate::lighting::{Anatomy, Points, Rounded};
use crate::scene::requirements::{Model, Requirements};
use crate::scene::{Camera, Scene};
use crate::trace::Geometry;
use crate::trace::bvh::Walker;
use crate::trace::ray::{Foot, Ray};
use crate::{raster, trace};

/// A scene planned for the rasterizer ([`raster::Plan`]).
pub enum Rasterizer<'a> {
    /// 32 bits.
    F32(raster::Plan<'a, f32>),
    /// 64 bits.
    F64(raster::Plan<'a, f64>),
}

/// A scene planned for the tracer ([`trace::Plan`]).
#[derive(Clone, Debug)]
pub enum Tracer<'a> {
    /// 32 bits.
    F32(trace::Plan<'a, f32>),
    /// 64 bits.
    F64(trace::Plan<'a, f64>),
}

/// What a ray meets first; world space.
#[derive(Clone, Copy, Debug)]
pub struct Meets {
    /// Parameter of the ray.
    pub t: f64,
    /// Index into the scene's objects.
    pub object: u32,
    /// The point and its geometric normal.
    pub foot: Foot,
}

impl<'a> Rasterizer<'a> {
    /// Sets up the triangles of a scene.
    pub fn new(scene: &'a Scene, assembled: &'a Assembled, model: Model) -> Self {
        match assembled {
            Assembled::F32(a) => Self::F32(raster::Plan::new(scene, a, model)),
            Assembled::F64(a) => Self::F64(raster::Plan::new(scene, a, model)),
        }
    }

    /// [`Self::new`] with requirements of the caller's: what they lack is not evaluated.
    pub fn with_requirements(
        scene: &'a Scene,
        assembled: &'a Assembled,
        needs: &Requirements,
    ) -> Self {
        match assembled {
            Assembled::F32(a) => Self::F32(raster::Plan::with_requirements(scene, a, needs)),
            Assembled::F64(a) => Self::F64(raster::Plan::with_requirements(scene, a, needs)),
        }
    }

    /// The same triangles under a scene that differs in lights, materials or light model alone, and an assembly of the same
    /// precision that differs in normals or the order of corners alone ([`raster::Plan::relit`]).
    ///
    /// # Panics
    /// Where the assembly is of another precision.
    pub fn relit<'b>(&self, scene: &'b Scene, assembled: &'b Assembled) -> Rasterizer<'b> {
        match (self, assembled) {
            (Self::F32(plan), Assembled::F32(a)) => Rasterizer::F32(plan.relit(scene, a)),
            (Self::F64(plan), Assembled::F64(a)) => Rasterizer::F64(plan.relit(scene, a)),
            _ => panic!("a plan is relit in its own precision"),
        }
    }

    /// The same plan with mistakes in it.
    #[must_use]
    pub fn with_faults(self, faults: raster::Faults) -> Self {
        match self {
            Self::F32(plan) => Self::F32(plan.with_faults(faults)),
            Self::F64(plan) => Self::F64(plan.with_faults(faults)),
        }
    }

    /// The same plan with inputs of the equation rounded to f32.
    #[must_use]
    pub fn rounding(self, rounded: Rounded) -> Self {
        match self {
            Self::F32(plan) => Self::F32(plan.rounding(rounded)),
            Self::F64(plan) => Self::F64(plan.rounding(rounded)),
        }
    }

    /// Draws the picture.
    ///
    /// # Errors
    /// As [`raster::Plan::draw`].
    pub fn draw(&self, options: &raster::Options) -> Result<Drawn, Error> {
        let start = Instant::now();
        let (picture, counters) = each!(self, plan => erased(plan.draw(options)?));
        Ok(Drawn {
            picture,
            counters: Counters::Raster(counters),
            triangles: each!(self, plan => plan.triangles()),
            seconds: rendered_in(start),
        })
    }

    /// One pixel of [`Self::draw`]: a picture of that pixel alone, the same bytes.
    ///
    /// # Errors
    /// As [`raster::Plan::draw_pixel`].
    pub fn draw_pixel(&self, options: &raster::Options, pixel: [u32; 2]) -> Result<Picture, Error> {
        Ok(each!(self, plan => plan.draw_pixel(options, pixel)?.into()))
    }

    /// What happens on the way to a pixel of [`Self::draw`].
    ///
    /// # Errors
    /// As [`raster::Plan::record_pixel`].
    pub fn record_pixel(
        &self,
        options: &raster::Options,
        pixel: [u32; 2],
        keep: u32,
    ) -> Result<raster::record::Record<f64>, Error> {
        Ok(each!(self, plan => plan.record_pixel(options, pixel, keep)?.to_f64()))
    }

    /// The material of a surface number.
    pub fn material(&self, surface: usize) -> &Material {
        each!(self, plan => plan.material(surface))
    }

    /// Pixels whose centre lies within a distance of an edge of the triangle given for it ([`raster::Plan::near_edge`]).
    pub fn near_edge(&self, primitives: &Plane<u32>, distance_px: f64) -> Plane<bool> {
        each!(self, plan => plan.near_edge(primitives, distance_px))
    }

    /// Pixels at a discontinuity of the model ([`raster::Plan::near_jump`]).
    pub fn near_jump(&self, primitives: &Plane<u32>, shading: ShadeModel) -> Plane<bool> {
        each!(self, plan => plan.near_jump(primitives, shading))
    }

    /// How many triangles cover each pixel's centre ([`raster::Plan::coverage_counts`]).
    pub fn coverage_counts(&self) -> Plane<u32> {
        each!(self, plan => plan.coverage_counts())
    }

    /// GL's window depth of the primitives that a picture of this plan shows ([`raster::Plan::window_depth`]).
    pub fn window_depth(&self, primitives: &Plane<u32>) -> Plane<f64> {
        each!(self, plan => plan.window_depth(primitives))
    }

    /// The same under another projection of the same view ([`raster::Plan::window_depth_under`]).
    pub fn window_depth_under(&self, camera: &Camera, primitives: &Plane<u32>) -> Plane<f64> {
        each!(self, plan => plan.window_depth_under(camera, primitives))
    }
}

impl<'a> Tracer<'a> {
    /// Builds the hierarchy of a scene.
    ///
    /// # Errors
    /// As [`trace::Plan::new`].
    pub fn new(
        scene: &'a Scene,
        assembled: &'a Assembled,
        geometry: Geometry,
        model: Model,
    ) -> Result<Self, Error> {
        Ok(match assembled {
            Assembled::F32(a) => Self::F32(trace::Plan::new(scene, a, geometry, model)?),
            Assembled::F64(a) => Self::F64(trace::Plan::new(scene, a, geometry, model)?),
        })
    }

    /// [`Self::new`] with requirements of the caller's: what they lack is not evaluated, and rays that they lack not cast.
    ///
    /// # Errors
    /// As [`trace::Plan::new`].
    pub fn with_requirements(
        scene: &'a Scene,
        assembled: &'a Assembled,
        geometry: Geometry,
        needs: Requirements,
    ) -> Result<Self, Error> {
        type Plan<'a, R> = trace::Plan<'a, R>;
        Ok(match assembled {
            Assembled::F32(a) => Self::F32(Plan::with_requirements(scene, a, geometry, needs)?),
            Assembled::F64(a) => Self::F64(Plan::with_requirements(scene, a, geometry, needs)?),
        })
    }

    /// The same surfaces under a scene that differs in lights, materials or settings alone ([`trace::Plan::relit`]).
    pub fn relit<'b>(&self, scene: &'b Scene) -> Tracer<'b>
    where
        'a: 'b,
    {
        match self {
            Self::F32(plan) => Tracer::F32(plan.relit(scene)),
            Self::F64(plan) => Tracer::F64(plan.relit(scene)),
        }
    }

    /// The same plan with mistakes in it.
    #[must_use]
    pub fn with_faults(self, faults: trace::Faults) -> Self {
        match self {
            Self::F32(plan) => Self::F32(plan.with_faults(faults)),
            Self::F64(plan) => Self::F64(plan.with_faults(faults)),
        }
    }

    /// The same plan with inputs of the equation rounded to f32.
    #[must_use]
    pub fn rounding(self, rounded: Rounded) -> Self {
        match self {
            Self::F32(plan) => Self::F32(plan.rounding(rounded)),
            Self::F64(plan) => Self::F64(plan.rounding(rounded)),
        }
    }

    /// Traces the picture.
    ///
    /// # Errors
    /// As [`trace::Plan::draw`].
    pub fn draw(&self, options: &trace::Options) -> Result<Drawn, Error> {
        let start = Instant::now();
        let (picture, counters) = each!(self, plan => erased(plan.draw(options)?));
        Ok(self.drawn(picture, counters, start))
    }

    /// [`Self::draw`], where the layers asked for also hold reflection and refraction split by light.
    ///
    /// # Errors
    /// As [`trace::Plan::draw`].
    pub fn draw_split(&self, options: &trace::Options) -> Result<Drawn, Error> {
        let start = Instant::now();
        let (picture, counters) = each!(self, plan => erased(plan.draw_split(options)?));
        Ok(self.drawn(picture, counters, start))
    }

    /// [`Self::draw`] with another tile size; the bytes are the same.
    ///
    /// # Errors
    /// As [`trace::Plan::draw`].
    pub fn draw_tiles(&self, options: &trace::Options, side: u32) -> Result<Drawn, Error> {
        let start = Instant::now();
        let (picture, counters) = each!(self, plan => erased(plan.draw_tiles(options, side)?));
        Ok(self.drawn(picture, counters, start))
    }

    fn drawn(&self, picture: Picture, counters: trace::Counters, start: Instant) -> Drawn {
        Drawn {
            picture,
            counters: Counters::Trace(counters),
            triangles: each!(self, plan => plan.triangles()),
            seconds: rendered_in(start),
        }
    }

    /// One pixel of [`Self::draw`]: a picture of that pixel alone, the same bytes.
    ///
    /// # Errors
    /// As [`trace::Plan::draw_pixel`].
    pub fn draw_pixel(&self, options: &trace::Options, pixel: [u32; 2]) -> Result<Picture, Error> {
        Ok(each!(self, plan => plan.draw_pixel(options, pixel)?.into()))
    }

    /// What happens on the way to a pixel of [`Self::draw`].
    ///
    /// # Errors
    /// As [`trace::Plan::record_pixel`].
    pub fn record_pixel(
        &self,
        options: &trace::Options,
        pixel: [u32; 2],
        keep: u32,
    ) -> Result<trace::record::Record<f64>, Error> {
        Ok(each!(self, plan => plan.record_pixel(options, pixel, keep)?.to_f64()))
    }

    /// What happens to a ray in world space ([`trace::Plan::record_ray`]).
    ///
    /// # Errors
    /// As [`trace::Plan::record_ray`].
    pub fn record_ray(
        &self,
        options: &trace::Options,
        ray: &Ray,
    ) -> Result<trace::record::Record<f64>, Error> {
        Ok(each!(self, plan => plan.record_ray(options, ray)?.to_f64()))
    }

    /// The first thing that a ray meets.
    pub fn meets(&self, ray: &Ray) -> Option<Meets> {
        each!(self, plan => meets(plan, ray))
    }

    /// Where the enabled lights are.
    pub fn lamps(&self) -> &[trace::Lamp] {
        each!(self, plan => plan.lamps())
    }

    /// The factors of a light at one point of a record, in the arithmetic of this precision.
    pub fn anatomy(&self, light: usize, point: &Points<f64>) -> Anatomy<f64> {
        each!(self, plan => anatomy(plan, light, point))
    }
}

fn meets<R: Real>(plan: &trace::Plan<'_, R>, ray: &Ray) -> Option<Meets> {
    let surfaces = plan.surfaces();
    let hit = surfaces.closest_hit(ray, &mut Walker::default())?;
    Some(Meets {
        t: hit.t,
        object: surfaces.object(&hit),
        foot: surfaces.site(ray, &hit, None).foot,
    })
}

fn anatomy<R: Real>(plan: &trace::Plan<'_, R>, light: usize, point: &Points<f64>) -> Anatomy<f64> {
    // The record's numbers are those of this precision, so that nothing is rounded on the way back.
    plan.rig().anatomy(light, &point.convert(), 0).to_f64()
}

/// A frame and counters without their precision.
fn erased<R, C>((frame, counters): (Frame<R>, C)) -> (Picture, C)
where
    Picture: From<Frame<R>>,
{
    (frame.into(), counters)
}

fn rendered_in(start: Instant) -> Seconds {
    Seconds {
        render: start.elapsed().as_secs_f64(),
        ..Seconds::default()
    }
}
