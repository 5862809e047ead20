//! rastray: one scene, two renderers, every difference explained.
//!
//! A rasterizer that reproduces OpenGL fixed-function lighting and a Whitted ray tracer call *one* lighting equation on
//! *one* scene, so whatever differs between their pictures has a cause with a name.
#![deny(unsafe_code)]

pub mod check;
pub mod context;
pub mod decompose;
pub mod error;
pub mod explain;
pub mod frame;
pub mod gl;
pub mod import;
pub mod lanes;
pub mod lighting;
pub mod math;
#[cfg(feature = "opengl")]
pub mod peers;
pub mod raster;
pub mod render;
pub mod report;
pub mod sampling;
pub mod scene;
pub mod trace;
pub mod trade;

/// The README's program, compiled and run as a doc test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
