//! Where the driver draws: a framebuffer of 32-bit floats, whose rows are turned to ours.
//!
//! In: a size. Out: an RGBA32F colour buffer and a depth buffer (32-bit float where the driver has one, else 24 bits); what
//! is read back has the top row first, as all pictures here.

use super::api::{self, Gl};
use crate::frame::Plane;

/// A framebuffer, bound from its making to its end.
pub(super) struct Target<'a> {
    gl: &'a Gl,
    framebuffer: u32,
    color: u32,
    depth: u32,
    width: usize,
    height: usize,
}

impl<'a> Target<'a> {
    /// Makes and binds a framebuffer.
    ///
    /// # Errors
    /// A sentence, where the driver cannot draw on one of this kind or size.
    pub(super) fn new(gl: &'a Gl, width: u32, height: u32) -> Result<Self, String> {
        let limit = gl.integer(api::MAX_RENDERBUFFER_SIZE).max(1) as u32;
        let limit = limit.min(gl.integer(api::MAX_VIEWPORT_DIMS).max(1) as u32);
        if width > limit || height > limit {
            return Err(format!(
                "the driver draws at most {limit}x{limit} pixels, not {width}x{height}"
            ));
        }
        let target = Self {
            gl,
            framebuffer: gl.new_framebuffer(),
            color: gl.new_renderbuffer(),
            depth: gl.new_renderbuffer(),
            width: width as usize,
            height: height as usize,
        };
        gl.bind_framebuffer(api::FRAMEBUFFER, target.framebuffer);
        target.attach(target.color, api::RGBA32F, api::COLOR_ATTACHMENT0);
        for format in [api::DEPTH_COMPONENT32F, api::DEPTH_COMPONENT24] {
            target.attach(target.depth, format, api::DEPTH_ATTACHMENT);
            let status = gl.check_framebuffer_status(api::FRAMEBUFFER);
            let refused = gl.get_error() != 0;
            if status == api::FRAMEBUFFER_COMPLETE && !refused {
                return Ok(target);
            }
        }
        Err("the driver cannot draw on a framebuffer of 32-bit floats".to_owned())
    }

    fn attach(&self, buffer: u32, format: u32, place: u32) {
        let (gl, w, h) = (self.gl, self.width as i32, self.height as i32);
        gl.bind_renderbuffer(api::RENDERBUFFER, buffer);
        gl.renderbuffer_storage(api::RENDERBUFFER, format, w, h);
        gl.framebuffer_renderbuffer(api::FRAMEBUFFER, place, api::RENDERBUFFER, buffer);
    }

    /// The colours, top row first.
    pub(super) fn colors(&self) -> Plane<[f32; 4]> {
        self.upright(self.gl.read_colors(self.width, self.height))
    }

    /// GL's window depths (0 to 1), top row first.
    pub(super) fn depths(&self) -> Plane<f32> {
        self.upright(self.gl.read_depths(self.width, self.height))
    }

    /// GL's rows count from the bottom, ours from the top.
    fn upright<T: Copy>(&self, bottom_first: Vec<T>) -> Plane<T> {
        let rows = bottom_first.chunks_exact(self.width).rev();
        Plane {
            width: self.width,
            height: self.height,
            data: rows.flatten().copied().collect(),
        }
    }
}

impl Drop for Target<'_> {
    fn drop(&mut self) {
        self.gl.bind_framebuffer(api::FRAMEBUFFER, 0);
        self.gl.delete_framebuffer(self.framebuffer);
        self.gl.delete_renderbuffer(self.color);
        self.gl.delete_renderbuffer(self.depth);
    }
}
