//! One way to draw a scene: everything about a render that trades speed for accuracy, and nothing else.
//!
//! A [`Setting`] is written as the flags of `rastray render` that ask for it ([`Setting::arguments`]), so that whatever a
//! trade recommends can be typed. Two settings that draw the same picture by the same work are equal: fields that a
//! renderer does not read hold the scene's own value.

use crate::gl::ShadeModel;
use crate::render::{Precision, Renderer, name_of};
use crate::sampling::Pattern;
use crate::scene::requirements::{Feature, Mode, Model, Requirements};
use crate::scene::tessellate::DEFAULT_LEVEL;
use crate::scene::{Geometry, Object, Scene, Shape, Snap};
use crate::trace;

/// One way to draw a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// Who draws.
    pub renderer: Renderer,
    /// Rasterizer: flat, Gouraud, per fragment.
    pub shading: ShadeModel,
    /// Rasterizer, and mesh geometry: slices of a full turn.
    pub level: u32,
    /// Tracer: the true shapes, or the rasterizer's triangles.
    pub geometry: trace::Geometry,
    /// Floats.
    pub precision: Precision,
    /// Samples a pixel.
    pub samples: u32,
    /// How they are spread.
    pub pattern: Pattern,
    /// Tracer: generations of secondary rays.
    pub depth: u32,
    /// Rasterizer: sub-pixel grid.
    pub snap: Snap,
    /// Tracer: secondary rays start this far off the surface, in scene units; `None` = by the bound of the hit's error. A
    /// study only: nothing else in the program offers a fixed distance.
    pub offset: Option<f64>,
}

impl Setting {
    /// What `rastray render SCENE` draws where no shape states a level of its own: the scene's shading at the default
    /// level; one sample at pixel centres.
    pub fn of(scene: &Scene) -> Self {
        Self {
            renderer: Renderer::Raster,
            shading: scene.raster.shading,
            level: DEFAULT_LEVEL,
            geometry: trace::Geometry::Exact,
            precision: Precision::F32,
            samples: 1,
            pattern: Pattern::Grid,
            depth: scene.trace.depth,
            snap: scene.raster.snap,
            offset: None,
        }
    }

    /// [`Self::of`] by another renderer.
    pub fn by(renderer: Renderer, scene: &Scene) -> Self {
        Self {
            renderer,
            ..Self::of(scene)
        }
        .plain(scene)
    }

    /// With a shading and a level.
    #[must_use]
    pub fn shaded(self, shading: ShadeModel, level: u32) -> Self {
        Self {
            shading,
            level,
            ..self
        }
    }

    /// The same work with every field that it does not read at the scene's own value.
    #[must_use]
    pub fn plain(self, scene: &Scene) -> Self {
        let own = Self::of(scene);
        let mut plain = self;
        if !self.reads_level() || !has_curves(scene) {
            plain.level = own.level;
        }
        if self.renderer == Renderer::Raster {
            plain.geometry = own.geometry;
        } else {
            plain.shading = own.shading;
            plain.snap = own.snap;
        }
        if self.renderer != Renderer::Trace {
            (plain.depth, plain.offset) = (own.depth, None);
        }
        if self.samples == 1 && self.pattern == Pattern::Grid {
            plain.pattern = Pattern::Grid;
        }
        plain
    }

    /// Whether triangles are drawn, so that the tessellation matters.
    pub fn reads_level(&self) -> bool {
        self.renderer == Renderer::Raster || self.geometry == trace::Geometry::Mesh
    }

    /// A scene that is drawn as the setting says. A level is that of every curved shape, those with one of their own
    /// included; flat shapes keep theirs, since it makes them no truer.
    pub fn apply(&self, scene: &Scene) -> Scene {
        let mut scene = scene.clone();
        scene.image.samples = self.samples;
        scene.image.pattern = self.pattern;
        scene.raster.shading = self.shading;
        scene.raster.snap = self.snap;
        scene.trace.depth = self.depth;
        for object in scene.objects.iter_mut().filter(|o| is_curved(o)) {
            object.tessellation = None;
        }
        scene
    }

    /// Whether `rastray render` can draw it.
    pub fn is_offered(&self) -> bool {
        self.offset.is_none()
    }

    /// In a few words, such as "raster gouraud 64 snap 8" or "trace depth 3 f64"; no depth where nothing mirrors or transmits.
    pub fn name(&self, scene: &Scene) -> String {
        let mut words = vec![self.renderer.name().to_owned()];
        match self.renderer {
            Renderer::Raster => {
                words.push(shading_name(self.shading).to_owned());
                words.push(self.level.to_string());
                words.push(format!("snap {}", self.snap.name()));
            }
            Renderer::Cast => {}
            Renderer::Trace if bounces(scene) => words.push(format!("depth {}", self.depth)),
            Renderer::Trace => {}
        }
        if self.renderer != Renderer::Raster && self.geometry == trace::Geometry::Mesh {
            words.push(format!("mesh {}", self.level));
        }
        if self.precision == Precision::F64 {
            words.push("f64".to_owned());
        }
        if self.samples != 1 || self.pattern != Pattern::Grid {
            let pattern = name_of(Pattern::NAMES, self.pattern);
            words.push(format!("{} {pattern} samples", self.samples));
        }
        if let Some(offset) = self.offset {
            words.push(format!("offset {offset}"));
        }
        words.join(" ")
    }

    /// The flags of `rastray render` that ask for it, for a scene as its file has it.
    pub fn arguments(&self, scene: &Scene) -> String {
        let mut words = vec![format!("--mode {}", self.renderer.name())];
        if self.renderer == Renderer::Raster {
            words.push(format!("--shading {}", shading_name(self.shading)));
            if self.snap != scene.raster.snap {
                words.push(format!("--snap {}", self.snap.name()));
            }
        } else if self.geometry == trace::Geometry::Mesh {
            words.push("--geometry mesh".to_owned());
        }
        if self.renderer == Renderer::Trace && self.depth != scene.trace.depth {
            words.push(format!("--depth {}", self.depth));
        }
        if self.reads_level() && has_curves(scene) {
            if self.level != DEFAULT_LEVEL {
                words.push(format!("--tessellation {}", self.level));
            }
            let stubborn = scene.objects.iter().filter(|o| is_curved(o));
            let stubborn = stubborn.filter(|o| o.tessellation.is_some_and(|own| own != self.level));
            words.extend(stubborn.map(|o| own_level(&o.name, self.level)));
        }
        if self.precision == Precision::F64 {
            words.push("--precision f64".to_owned());
        }
        if self.samples != scene.image.samples {
            words.push(format!("--samples {}", self.samples));
        }
        if self.pattern != scene.image.pattern {
            let pattern = name_of(Pattern::NAMES, self.pattern);
            words.push(format!("--set image.pattern={pattern}"));
        }
        words.join(" ")
    }
}

/// The flag that gives one object a level.
fn own_level(name: &str, level: u32) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if name.chars().all(plain) {
        format!("--set object.{name}.tessellation={level}")
    } else {
        format!("--set 'object.\"{name}\".tessellation={level}'")
    }
}

/// The name of a shading, which is that of `--shading`.
pub fn shading_name(shading: ShadeModel) -> &'static str {
    name_of(ShadeModel::NAMES, shading)
}

/// Whether an object is a shape that triangles only come near to.
pub fn is_curved(object: &Object) -> bool {
    match &object.geometry {
        Geometry::Mesh(_) => false,
        Geometry::Shape(shape) => !matches!(shape, Shape::Patch { .. } | Shape::Box { .. }),
    }
}

/// Whether a scene has secondary rays: something mirrors or transmits.
pub fn bounces(scene: &Scene) -> bool {
    let needs = Requirements::plan(scene, Mode::Trace, Model::Required);
    needs.has(Feature::ReflectionRays) || needs.has(Feature::RefractionRays)
}

/// Whether the tessellation of a scene matters.
pub fn has_curves(scene: &Scene) -> bool {
    scene.objects.iter().any(is_curved)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::{LoadOptions, load};

    fn scene(name: &str) -> Scene {
        load(name, &LoadOptions::default()).expect("shipped").scene
    }

    #[test]
    fn arguments_name_what_differs_from_the_scene() {
        let scene = scene("highlight");
        let plain = Setting::of(&scene);
        // The ball states 12 slices of its own, so that the default level has to be said for it.
        let ball = "--set object.ball.tessellation=64";
        let expected = format!("--mode raster --shading gouraud {ball}");
        assert_eq!(plain.arguments(&scene), expected);
        let fine = Setting {
            precision: Precision::F64,
            snap: Snap::Bits12,
            samples: 4,
            ..plain.shaded(ShadeModel::Phong, 12)
        };
        let expected =
            "--mode raster --shading phong --snap 12 --tessellation 12 --precision f64 --samples 4";
        assert_eq!(fine.arguments(&scene), expected);
        let cast = Setting::by(Renderer::Cast, &scene);
        assert_eq!(cast.arguments(&scene), "--mode cast");
    }

    #[test]
    fn fields_that_are_not_read_make_no_difference() {
        let scene = scene("whitted");
        let trace = Setting::by(Renderer::Trace, &scene);
        let odd = Setting {
            level: 7,
            snap: Snap::Exact,
            shading: ShadeModel::Flat,
            ..trace
        };
        assert_eq!(odd.plain(&scene), trace);
        let mesh = Setting {
            geometry: trace::Geometry::Mesh,
            ..odd
        };
        assert_eq!(mesh.plain(&scene).level, 7);
    }

    #[test]
    fn names_with_spaces_are_quoted() {
        let flag = own_level("left pane", 8);
        assert_eq!(flag, "--set 'object.\"left pane\".tessellation=8'");
    }
}
