//! What a render costs, as exact operation counts and as one number made of them.
//!
//! Counts are the renderers' own and equal on every machine. [`work`](Counts::work) weighs them, so that settings of
//! different renderers have an order that does not depend on the clock: the sum over [`WEIGHTS`], times
//! [`F64_FACTOR`] in f64. The weights were fitted once to the fastest runs of 46 settings in f32 on three shipped scenes (2026-11, one
//! x86-64 thread, dev profile), rounded; a unit is about a nanosecond there, and the settings' times follow within a
//! factor of 1.26 (root mean square; 2.2 at most, on a machine with other work). A model: where a time was measured, the time
//! is what counts.

use serde::{Deserialize, Serialize};

use crate::render::Precision;
use crate::{raster, trace};

/// Exact counts of a render.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counts {
    /// Triangles made of the scene.
    pub triangles: u64,
    /// Samples in the boxes around triangles.
    pub fragments_tested: u64,
    /// Evaluations of the equation.
    pub shaded: u64,
    /// Points times lights that needed a power.
    pub pow_calls: u64,
    /// Points times lights whose direction took a square root.
    pub light_vector_roots: u64,
    /// Rays from the eye.
    pub primary: u64,
    /// Rays towards lights.
    pub shadow: u64,
    /// Mirrored rays.
    pub reflection: u64,
    /// Transmitted rays.
    pub refraction: u64,
    /// Boxes tested.
    pub box_tests: u64,
    /// Primitives tested.
    pub primitive_tests: u64,
}

/// A count's name, its value, and its weight in nanoseconds.
type Weighed = (&'static str, fn(&Counts) -> u64, f64);

/// What one of each costs in f32, in units of about a nanosecond.
pub const WEIGHTS: [Weighed; 11] = [
    ("triangles", |c| c.triangles, 130.0),
    ("fragments tested", |c| c.fragments_tested, 30.0),
    ("shaded points", |c| c.shaded, 30.0),
    ("pow calls", |c| c.pow_calls, 10.0),
    ("light-vector roots", |c| c.light_vector_roots, 50.0),
    ("primary rays", |c| c.primary, 100.0),
    ("shadow rays", |c| c.shadow, 200.0),
    ("reflection rays", |c| c.reflection, 150.0),
    ("refraction rays", |c| c.refraction, 150.0),
    ("box tests", |c| c.box_tests, 30.0),
    ("primitive tests", |c| c.primitive_tests, 60.0),
];

/// What f64 costs over f32 (NUMERICS section 6: 1.5 times the instructions).
pub const F64_FACTOR: f64 = 1.5;

impl Counts {
    /// Of the rasterizer.
    pub fn of_raster(counters: &raster::Counters) -> Self {
        Self {
            triangles: counters.triangles_in,
            fragments_tested: counters.fragments_tested,
            shaded: counters.points_shaded,
            pow_calls: counters.lighting.pow_calls,
            light_vector_roots: counters.lighting.light_vector_roots,
            ..Self::default()
        }
    }

    /// Of the tracer over an assembly of so many triangles.
    pub fn of_trace(counters: &trace::Counters, triangles: usize) -> Self {
        Self {
            triangles: triangles as u64,
            shaded: counters.shaded_points,
            pow_calls: counters.lighting.pow_calls,
            light_vector_roots: counters.lighting.light_vector_roots,
            primary: counters.rays.primary,
            shadow: counters.rays.shadow,
            reflection: counters.rays.reflection,
            refraction: counters.rays.refraction,
            box_tests: counters.box_tests,
            primitive_tests: counters.primitive_tests,
            ..Self::default()
        }
    }

    /// All rays.
    pub fn rays(&self) -> u64 {
        self.primary + self.shadow + self.reflection + self.refraction
    }

    /// The work in units of about a nanosecond, by the model of the module's head.
    pub fn work(&self, precision: Precision) -> f64 {
        let sum: f64 = WEIGHTS.iter().map(|(_, n, w)| n(self) as f64 * w).sum();
        match precision {
            Precision::F32 => sum,
            Precision::F64 => sum * F64_FACTOR,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lighting;

    #[test]
    fn work_weighs_every_count() {
        let none = Counts::default();
        assert_eq!(none.work(Precision::F32), 0.0);
        let traced = Counts::of_trace(
            &trace::Counters {
                rays: trace::Rays {
                    primary: 2,
                    shadow: 3,
                    reflection: 5,
                    refraction: 7,
                },
                box_tests: 11,
                primitive_tests: 13,
                shaded_points: 17,
                lighting: lighting::Counters {
                    pow_calls: 23,
                    light_vector_roots: 29,
                    ..lighting::Counters::default()
                },
                ..trace::Counters::default()
            },
            19,
        );
        let sum = [19.0, 0.0, 17.0, 23.0, 29.0, 2.0, 3.0, 5.0, 7.0, 11.0, 13.0];
        let expected: f64 = sum.iter().zip(WEIGHTS).map(|(n, (_, _, w))| n * w).sum();
        assert_eq!(traced.work(Precision::F32), expected);
        assert_eq!(traced.work(Precision::F64), expected * F64_FACTOR);
        assert_eq!(traced.rays(), 17);
    }
}
