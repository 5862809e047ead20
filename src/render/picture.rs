//! A finished picture in one of the precisions.

use super::{Precision, each};
use crate::frame::{Frame, Layers, Plane};
use crate::lanes::Real;
use crate::math::color::{clamp_rgb, quantize8};

/// A [`Frame`] of f32 or f64: colours linear, row 0 on top.
#[derive(Clone, Debug, PartialEq)]
pub enum Picture {
    /// 32 bits.
    F32(Frame<f32>),
    /// 64 bits.
    F64(Frame<f64>),
}

impl From<Frame<f32>> for Picture {
    fn from(frame: Frame<f32>) -> Self {
        Self::F32(frame)
    }
}

impl From<Frame<f64>> for Picture {
    fn from(frame: Frame<f64>) -> Self {
        Self::F64(frame)
    }
}

impl Picture {
    /// In which precision it was drawn.
    pub fn precision(&self) -> Precision {
        match self {
            Self::F32(_) => Precision::F32,
            Self::F64(_) => Precision::F64,
        }
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [usize; 2] {
        each!(self, frame => [frame.color.width, frame.color.height])
    }

    /// The colours as float files hold them: f64 is rounded once.
    pub fn color_f32(&self) -> Plane<[f32; 3]> {
        each!(self, frame => frame.color_f32())
    }

    /// The colours, exact.
    pub fn color_f64(&self) -> Plane<[f64; 3]> {
        each!(self, frame => wide(&frame.color))
    }

    /// The colours that an 8-bit file holds, over 255: clamped and rounded in the picture's own precision.
    pub fn stored(&self) -> Plane<[f64; 3]> {
        each!(self, frame => frame.color.map(|c| c.map(|x| f64::from(quantize8(x)) / 255.0)))
    }

    /// The same picture with its colours clamped to [0, 1], as GL clamps them last.
    #[must_use]
    pub fn clamped(mut self) -> Self {
        each!(&mut self, frame => frame.color.data.iter_mut().for_each(|c| *c = clamp_rgb(*c)));
        self
    }

    /// Distance from the eye along -z of what the first sample sees, exact; +infinity where it sees nothing.
    pub fn depth(&self) -> Plane<f64> {
        each!(self, frame => frame.depth.map(|z| z.to_f64()))
    }

    /// Number of the primitive that the first sample sees; `frame::NONE` where it sees none.
    pub fn primitive(&self) -> &Plane<u32> {
        each!(self, frame => &frame.primitive)
    }

    /// Number of the object that the first sample sees; `frame::NONE` where it sees none.
    pub fn object(&self) -> &Plane<u32> {
        each!(self, frame => &frame.object)
    }

    /// The layers as float files hold them, if they were asked for.
    pub fn layers_f32(&self) -> Option<Layers<f32>> {
        each!(self, frame => frame.layers.as_ref().map(Layers::to_f32))
    }

    /// The layers, exact, if they were asked for.
    pub fn layers_f64(&self) -> Option<Layers<f64>> {
        each!(self, frame => frame.layers.as_ref().map(Layers::to_f64))
    }

    /// The whole picture, exact.
    pub fn to_f64(&self) -> Frame<f64> {
        each!(self, frame => Frame {
            color: wide(&frame.color),
            depth: self.depth(),
            primitive: frame.primitive.clone(),
            object: frame.object.clone(),
            layers: self.layers_f64(),
        })
    }

    /// The whole picture as float files hold it.
    pub fn into_f32(self) -> Frame<f32> {
        match self {
            Self::F32(frame) => frame,
            Self::F64(frame) => Frame {
                color: frame.color_f32(),
                depth: frame.depth.map(|z| z.to_f32()),
                layers: frame.layers.as_ref().map(Layers::to_f32),
                primitive: frame.primitive,
                object: frame.object,
            },
        }
    }
}

fn wide<R: Real>(color: &Plane<[R; 3]>) -> Plane<[f64; 3]> {
    color.map(|c| c.map(Real::to_f64))
}
