//! The scene set up once, and rendered with changes: what a change leaves alone is not made again.

use std::borrow::Cow;

use super::change::{Change, Triangles};
use super::judge::strewn;
use super::lens::smaller;
use super::measure::{Stored, Turn, Values};
use super::mistakes::Mistake;
use super::{Mode, Options};
use crate::error::Error;
use crate::math::float::normalize;
use crate::math::transform::model_matrix_normal;
use crate::math::{DMat3, DVec3};
use crate::render::{Assembled, Picture, Rasterizer, Renderer, Tracer};
use crate::scene::Scene;
use crate::trace;

/// What a stage stands on.
pub(super) struct Setup<'a> {
    whole: &'a Scene,
    /// The scene as it is rendered: every `step`-th pixel.
    scene: Scene,
    step: u32,
    assembled: Assembled,
    options: &'a Options,
    stored: Stored,
}

impl<'a> Setup<'a> {
    /// Assembles the scene's triangles, for pictures of every `step`-th pixel.
    pub(super) fn new(
        whole: &'a Scene,
        options: &'a Options,
        stored: Stored,
        step: usize,
    ) -> Result<Self, Error> {
        let step = step as u32;
        let scene = smaller(whole, step);
        let asked = &options.render;
        let assembled = Assembled::new(&scene, asked.level, asked.precision)?;
        Ok(Self {
            whole,
            scene,
            step,
            assembled,
            options,
            stored,
        })
    }

    /// Sets up both renderers and works with them.
    pub(super) fn with_stage<T>(
        &self,
        work: impl FnOnce(&Stage<'_>) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let (scene, asked) = (&self.scene, &self.options.render);
        work(&Stage {
            setup: self,
            raster: Rasterizer::new(scene, &self.assembled, asked.model),
            trace: Tracer::new(scene, &self.assembled, asked.geometry, asked.model)?,
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
pub(super) struct Stage<'a> {
    setup: &'a Setup<'a>,
    raster: Rasterizer<'a>,
    trace: Tracer<'a>,
}

impl Stage<'_> {
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
        let assembled = if kept {
            Cow::Borrowed(&self.setup.assembled)
        } else {
            let asked = &self.setup.options.render;
            let assembled = Assembled::unchecked(&scene, asked.level, asked.precision)?;
            Cow::Owned(change.triangles.put(&scene, assembled))
        };
        let picture = match change.mode.shading() {
            Some(shading) => self.rasterize(change, &scene, &assembled, shading)?,
            None => self.trace(change, &scene, &assembled, kept)?,
        };
        Ok(picture.color_f32())
    }

    fn rasterize(
        &self,
        change: &Change,
        scene: &Scene,
        assembled: &Assembled,
        shading: crate::gl::ShadeModel,
    ) -> Result<Picture, Error> {
        let (base, asked) = (&self.setup.scene, &self.setup.options.render);
        let same_view = scene.camera == base.camera && scene.raster == base.raster;
        let plan = if same_view {
            self.raster.relit(scene, assembled)
        } else {
            Rasterizer::new(scene, assembled, asked.model)
        };
        let options = asked.raster(shading, change.clamp, false);
        Ok(plan.with_faults(change.raster).draw(&options)?.picture)
    }

    fn trace(
        &self,
        change: &Change,
        scene: &Scene,
        assembled: &Assembled,
        kept: bool,
    ) -> Result<Picture, Error> {
        let asked = &self.setup.options.render;
        let plan = if kept && scene.raster.front_face == self.setup.scene.raster.front_face {
            self.trace.relit(scene)
        } else {
            Tracer::new(scene, assembled, asked.geometry, asked.model)?
        };
        let options = match change.mode.renderer() {
            Renderer::Trace => trace::Options {
                shadows: change.shadows,
                ..asked.trace(scene)
            },
            Renderer::Raster | Renderer::Cast => asked.cast(),
        };
        Ok(plan.with_faults(change.trace).draw(&options)?.picture)
    }
}

impl Triangles {
    /// Puts the mistake into the triangles.
    fn put(self, scene: &Scene, assembled: Assembled) -> Assembled {
        match self {
            Self::Right => assembled,
            Self::FirstProvokes => assembled.with_turned_corners(),
            Self::NormalsByModelMatrix => with_bent_normals(scene, assembled),
        }
    }
}

/// Gives every vertex the normal that its object's model matrix would have made.
fn with_bent_normals(scene: &Scene, mut assembled: Assembled) -> Assembled {
    let eye_from_world = scene.camera.eye_from_world_rotation();
    let mut done = vec![false; assembled.vertices()];
    for (object, shown) in scene.objects.iter().enumerate() {
        let model = model_matrix_normal(&shown.world_from_object.matrix3);
        let bend: DMat3 = eye_from_world * model * eye_from_world.transpose();
        let range = assembled.ranges()[object].clone();
        for triangle in range.start as usize..range.end as usize {
            for v in assembled.triangles()[triangle] {
                if std::mem::replace(&mut done[v as usize], true) {
                    continue;
                }
                let normal = DVec3::from_array(assembled.vertex_normal(v));
                let (unit, _) = normalize((bend * normal).to_array());
                assembled.set_normal(v, unit);
            }
        }
    }
    assembled
}
