//! The scene set up once, and rendered with changes: what a change leaves alone is not made again.

use std::borrow::Cow;

use super::change::{Change, Triangles};
use super::judge::strewn;
use super::lens::smaller;
use super::measure::{Stored, Turn, Values};
use super::mistakes::Mistake;
use super::{Mode, Options};
use crate::error::Error;
use crate::frame::Frame;
use crate::lanes::Real;
use crate::math::float::normalize;
use crate::math::transform::model_matrix_normal;
use crate::math::{DMat3, DVec3};
use crate::scene::Scene;
use crate::scene::assembly::Assembly;
use crate::{raster, trace};

/// What a stage stands on.
pub(super) struct Setup<'a, R> {
    whole: &'a Scene,
    /// The scene as it is rendered: every `step`-th pixel.
    scene: Scene,
    step: u32,
    assembly: Assembly<R>,
    options: &'a Options,
    stored: Stored,
}

impl<'a, R: Real> Setup<'a, R> {
    /// Assembles the scene's triangles, for pictures of every `step`-th pixel.
    pub(super) fn new(
        whole: &'a Scene,
        options: &'a Options,
        stored: Stored,
        step: usize,
    ) -> Result<Self, Error> {
        let step = step as u32;
        let scene = smaller(whole, step);
        let assembly = Assembly::new(&scene, options.level)?;
        assembly.check_range(&scene)?;
        Ok(Self {
            whole,
            scene,
            step,
            assembly,
            options,
            stored,
        })
    }

    /// Sets up both renderers and works with them.
    pub(super) fn with_stage<T>(
        &self,
        work: impl FnOnce(&Stage<'_, R>) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let (scene, model) = (&self.scene, self.options.model);
        work(&Stage {
            setup: self,
            raster: raster::Plan::new(scene, &self.assembly, model),
            trace: trace::Plan::new(scene, &self.assembly, trace::Geometry::Exact, model)?,
        })
    }
}

/// A picture with a mistake in it, as the file would hold it.
pub(super) struct Made {
    pub(super) picture: Values,
    /// It is the right one, turned.
    pub(super) turn: Option<Turn>,
}

/// Both renderers, ready to draw the scene.
pub(super) struct Stage<'a, R> {
    setup: &'a Setup<'a, R>,
    raster: raster::Plan<'a, R>,
    trace: trace::Plan<'a, R>,
}

impl<R: Real> Stage<'_, R> {
    /// The scene at the picture's own size.
    pub(super) fn scene(&self) -> &Scene {
        self.setup.whole
    }

    /// The right picture of a mode, linear.
    pub(super) fn right(&self, mode: Mode) -> Result<Values, Error> {
        self.render(&self.unchanged(mode))
    }

    fn unchanged(&self, mode: Mode) -> Change {
        let Setup {
            whole,
            options,
            stored,
            ..
        } = self.setup;
        Change::none(whole, mode, options, stored.clamp)
    }

    /// The stored picture with a mistake; `None` where the scene has no place for it. `right` is the linear right picture
    /// of the mode, `given` the one that is checked.
    pub(super) fn mistaken(
        &self,
        mistake: &Mistake,
        mode: Mode,
        amount: f64,
        right: &Values,
        given: &Values,
    ) -> Result<Option<Made>, Error> {
        let stored = &self.setup.stored;
        let mut change = self.unchanged(mode);
        change.amount = amount;
        if !(mistake.make)(&mut change) {
            return Ok(None);
        }
        let linear = if change.finished {
            Cow::Borrowed(right)
        } else {
            Cow::Owned(self.render(&change)?)
        };
        let mut picture = stored.finish(&linear, change.finish);
        if let Some(turn) = change.turn {
            picture = turn.of(&picture);
        }
        if change.strewn {
            // Where they make regions, all of them are wrong, or something else is.
            picture = strewn(given, &stored.apply(right), &picture).unwrap_or(picture);
        }
        let turn = change.turn;
        Ok(Some(Made { picture, turn }))
    }

    /// The linear picture of a change: clamped as GL does in the rasterizer, unclamped by rays.
    fn render(&self, change: &Change) -> Result<Values, Error> {
        let scene = smaller(&change.scene, self.setup.step);
        let base = &self.setup.scene;
        let model = (&scene.light_model, &base.light_model);
        let kept = scene.camera.eye == base.camera.eye
            && change.triangles == Triangles::Right
            && model.0.normalize == model.1.normalize
            && model.0.rescale_normal == model.1.rescale_normal;
        let assembly = if kept {
            Cow::Borrowed(&self.setup.assembly)
        } else {
            let mut assembly = Assembly::new(&scene, self.setup.options.level)?;
            change.triangles.put(&scene, &mut assembly);
            Cow::Owned(assembly)
        };
        let frame = match change.mode.shading() {
            Some(shading) => self.rasterize(change, &scene, &assembly, shading)?,
            None => self.trace(change, &scene, &assembly, kept)?,
        };
        Ok(frame.color_f32())
    }

    fn rasterize(
        &self,
        change: &Change,
        scene: &Scene,
        assembly: &Assembly<R>,
        shading: crate::gl::ShadeModel,
    ) -> Result<Frame<R>, Error> {
        let base = &self.setup.scene;
        let same_view = scene.camera == base.camera && scene.raster == base.raster;
        let plan = if same_view {
            self.raster.relit(scene, assembly)
        } else {
            raster::Plan::new(scene, assembly, self.setup.options.model)
        };
        let options = raster::Options {
            shading,
            clamp: change.clamp,
            layers: false,
            isa: self.setup.options.isa,
        };
        Ok(plan.with_faults(change.raster).draw(&options)?.0)
    }

    fn trace(
        &self,
        change: &Change,
        scene: &Scene,
        assembly: &Assembly<R>,
        kept: bool,
    ) -> Result<Frame<R>, Error> {
        let asked = self.setup.options;
        let plan = if kept && scene.raster.front_face == self.setup.scene.raster.front_face {
            self.trace.relit(scene)
        } else {
            trace::Plan::new(scene, assembly, trace::Geometry::Exact, asked.model)?
        };
        let options = if change.mode == Mode::Cast {
            trace::Options::cast(asked.isa)
        } else {
            trace::Options {
                shadows: change.shadows,
                reflection: asked.reflection,
                refraction: asked.refraction,
                ..trace::Options::of(scene, asked.isa)
            }
        };
        Ok(plan.with_faults(change.trace).draw(&options)?.0)
    }
}

impl Triangles {
    /// Puts the mistake into the triangles.
    fn put<R: Real>(self, scene: &Scene, assembly: &mut Assembly<R>) {
        match self {
            Self::Right => {}
            Self::FirstProvokes => {
                for corners in &mut assembly.triangles {
                    corners.rotate_left(1);
                }
            }
            Self::NormalsByModelMatrix => bend_normals(scene, assembly),
        }
    }
}

/// Gives every vertex the normal that its object's model matrix would have made.
fn bend_normals<R: Real>(scene: &Scene, assembly: &mut Assembly<R>) {
    let eye_from_world = scene.camera.eye_from_world_rotation();
    let mut done = vec![false; assembly.position_from_eye.len()];
    let triangles = std::mem::take(&mut assembly.triangles);
    for (range, object) in assembly.triangle_range.iter().zip(&scene.objects) {
        let model = model_matrix_normal(&object.world_from_object.matrix3);
        let bend: DMat3 = eye_from_world * model * eye_from_world.transpose();
        for v in triangles[range.start as usize..range.end as usize]
            .iter()
            .flatten()
        {
            let v = *v as usize;
            if std::mem::replace(&mut done[v], true) {
                continue;
            }
            let normal = [0, 1, 2].map(|axis: usize| assembly.normal_eye[axis][v].to_f64());
            let (unit, _) = normalize((bend * DVec3::from_array(normal)).to_array());
            for (list, n) in assembly.normal_eye.iter_mut().zip(unit) {
                list[v] = R::from_f64(n);
            }
        }
    }
    assembly.triangles = triangles;
}
