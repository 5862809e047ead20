//! The named mistakes: what each one is, how to put it right, and how to make it.
//!
//! The usual ones of `opengl-lighting.md` section 7 and `whitted.md` section 6, and those of cameras and files. Each is
//! single: it changes one thing, and the picture is right in all else.

mod camera;
mod lighting;
mod output;
mod tracing;

use std::sync::LazyLock;

use super::Mode;
use super::change::Change;
use crate::scene::Scene;

/// What a mistake is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// The equation and what goes into it.
    Lighting,
    /// Triangles to pixels.
    Raster,
    /// Where the picture is taken from.
    Camera,
    /// Rays.
    Tracing,
    /// Values on their way into the file.
    Output,
}

impl Group {
    /// The one table of names.
    pub const NAMES: &[(&'static str, Self)] = &[
        ("lighting", Self::Lighting),
        ("raster", Self::Raster),
        ("camera", Self::Camera),
        ("tracing", Self::Tracing),
        ("output", Self::Output),
    ];

    /// Its name in the table.
    pub fn name(self) -> &'static str {
        let found = Self::NAMES.iter().find(|(_, group)| *group == self);
        found.map_or("", |(name, _)| name)
    }
}

/// The pictures that a mistake can be in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Of {
    /// All.
    Any,
    /// The rasterizer's.
    Raster,
    /// The rasterizer's, of one shading.
    Only(Mode),
    /// Those by rays.
    Rays,
    /// The tracer's.
    Trace,
}

impl Of {
    pub(super) fn includes(self, mode: Mode) -> bool {
        match self {
            Self::Any => true,
            Self::Raster => mode.shading().is_some(),
            Self::Only(one) => mode == one,
            Self::Rays => mode.shading().is_none(),
            Self::Trace => mode == Mode::Trace,
        }
    }
}

/// A single named mistake.
#[derive(Debug)]
pub struct Mistake {
    /// Short name, for programs.
    pub name: &'static str,
    /// What it is about.
    pub group: Group,
    /// A heading.
    pub title: &'static str,
    /// What is done wrong, and what that looks like.
    pub what: &'static str,
    /// How to put it right.
    pub remedy: &'static str,
    /// The pictures that it can be in.
    pub(super) of: Of,
    /// The amounts to try where there is more than one: the scene's length that they are parts of.
    amount: Option<fn(&Scene) -> f64>,
    /// Makes it; says whether the scene has a place for it.
    pub(super) make: fn(&mut Change) -> bool,
}

/// Amounts that are tried, as parts of the scene's length; neighbours differ by [`AMOUNT_STEP`].
const AMOUNTS: [f64; 5] = [1e-3, 4e-3, 1.6e-2, 6.4e-2, 2.56e-1];
/// Ratio of neighbouring amounts.
pub(super) const AMOUNT_STEP: f64 = 4.0;

impl Mistake {
    /// It can be made more or less.
    pub(super) fn has_amount(&self) -> bool {
        self.amount.is_some()
    }

    /// The amounts to try on a scene.
    pub(super) fn amounts(&self, scene: &Scene) -> Vec<f64> {
        match self.amount {
            None => vec![1.0],
            Some(length) => AMOUNTS.map(|part| part * length(scene)).to_vec(),
        }
    }
}

/// All mistakes, in the order in which equal ones are named.
pub fn all() -> &'static [Mistake] {
    static ALL: LazyLock<Vec<Mistake>> = LazyLock::new(|| {
        let mut all = lighting::mistakes();
        all.extend(camera::mistakes());
        all.extend(tracing::mistakes());
        all.extend(output::mistakes());
        all
    });
    &ALL
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_everything_is_said() {
        let mut names: Vec<&str> = all().iter().map(|m| m.name).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), all().len());
        for m in all() {
            assert!(
                m.what.ends_with('.') && m.remedy.ends_with('.'),
                "{}",
                m.name
            );
            assert!(m.title.len() < 60 && !m.title.ends_with('.'), "{}", m.name);
            assert!(
                m.name
                    .chars()
                    .all(|c| c.is_ascii_lowercase() || c == '-' || c.is_ascii_digit())
            );
        }
    }
}
