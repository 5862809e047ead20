//! What a mistake changes: the scene, switches of the renderers, or the finished picture.

use super::measure::{Finish, Turn};
use super::{Mode, Options};
use crate::scene::{Light, Scene};
use crate::{gl, raster, trace};

/// What is done to the triangles before they are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Triangles {
    /// Nothing.
    #[default]
    Right,
    /// The first corner gives a flat triangle its colour, not the last.
    FirstProvokes,
    /// Normals are transformed by the model matrix.
    NormalsByModelMatrix,
}

/// A render with something wrong.
#[derive(Clone, Debug)]
pub(super) struct Change {
    /// The scene to render, at the picture's own size.
    pub(super) scene: Scene,
    pub(super) mode: Mode,
    /// How much of it is wrong, for mistakes that have an amount.
    pub(super) amount: f64,
    pub(super) trace: trace::Faults,
    pub(super) raster: raster::Faults,
    pub(super) triangles: Triangles,
    /// GL's clamps are made where GL makes them.
    pub(super) clamp: bool,
    pub(super) shadows: bool,
    pub(super) finish: Finish,
    pub(super) turn: Option<Turn>,
    /// Only the finished picture differs: `finish` or `turn` say how.
    pub(super) finished: bool,
    /// The picture is the right one with pixels of this one strewn in.
    pub(super) strewn: bool,
}

impl Change {
    /// Nothing wrong yet.
    pub(super) fn none(scene: &Scene, mode: Mode, options: &Options, clamp: bool) -> Self {
        Self {
            scene: scene.clone(),
            mode,
            amount: 1.0,
            trace: trace::Faults::default(),
            raster: raster::Faults::default(),
            triangles: Triangles::default(),
            clamp,
            shadows: options.render.shadows && mode == Mode::Trace,
            finish: Finish::Right,
            turn: None,
            finished: false,
            strewn: false,
        }
    }

    /// Makes the finished picture alone wrong.
    pub(super) fn only(&mut self, finish: Finish, turn: Option<Turn>) {
        (self.finish, self.turn, self.finished) = (finish, turn, true);
    }

    /// Puts a mistake into the lighting equation of both renderers.
    pub(super) fn lighting(&mut self, put: impl Fn(&mut crate::lighting::Faults)) {
        put(&mut self.trace.lighting);
        put(&mut self.raster.lighting);
    }

    /// Changes the enabled lights; says whether any was changed.
    pub(super) fn lights(&mut self, change: impl Fn(&mut Light) -> bool) -> bool {
        let enabled = self.scene.lights.iter_mut().filter(|light| light.enabled);
        enabled
            .filter_map(|light| change(light).then_some(()))
            .count()
            > 0
    }

    /// Changes both sides of all materials; says whether any was changed.
    pub(super) fn sides(&mut self, change: impl Fn(&mut gl::Material) -> bool) -> bool {
        let materials = self.scene.materials.iter_mut();
        let sides = materials.flat_map(|m| std::iter::once(&mut m.front).chain(&mut m.back));
        sides.filter_map(|side| change(side).then_some(())).count() > 0
    }
}
