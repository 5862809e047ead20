//! What a draw leaves: the picture, and what it took.

use serde::Serialize;

use super::Picture;
use crate::{raster, trace};

/// A picture with its work and time.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// The picture.
    pub picture: Picture,
    /// The work.
    pub counters: Counters,
    /// Triangles of the scene, drawn or not.
    pub triangles: usize,
    /// Wall time.
    pub seconds: Seconds,
}

/// The work of whoever drew.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Counters {
    /// The rasterizer.
    Raster(raster::Counters),
    /// The tracer.
    Trace(trace::Counters),
}

/// Wall time in seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Seconds {
    /// Triangles of the scene; 0 where they were there.
    pub assemble: f64,
    /// Set-up of triangles and lights, or hierarchy; 0 where the plan was there.
    pub plan: f64,
    /// Pixels.
    pub render: f64,
}

impl Drawn {
    /// With the time that the plan took.
    pub(super) fn planned_in(mut self, seconds: f64) -> Self {
        self.seconds.plan = seconds;
        self
    }
}

impl Counters {
    /// The rasterizer's, if it drew.
    pub fn raster(&self) -> Option<&raster::Counters> {
        match self {
            Self::Raster(counters) => Some(counters),
            Self::Trace(_) => None,
        }
    }

    /// The tracer's, if it drew.
    pub fn trace(&self) -> Option<&trace::Counters> {
        match self {
            Self::Raster(_) => None,
            Self::Trace(counters) => Some(counters),
        }
    }
}
