//! Renderers of others, to be held against: drawn from the same scene, through libraries that the system has or lacks.
//!
//! Each is a feature of its own, off by default. Foreign calls need `unsafe`; it stands in the files named here alone,
//! behind safe functions.
//!
//! - [`agreement`]: the rasterizer's picture held against a peer's.
//! - [`opengl`] (feature `opengl`): the system's fixed-function OpenGL; `unsafe` in its `api` and `egl`.

pub mod agreement;
pub mod opengl;
