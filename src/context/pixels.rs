//! Reading the framebuffer (GL 2.1 section 4.3.2): rectangles of the window from its lower left, bottom row first.
//!
//! Colours are the fragments', clamped; around the viewport, and where nothing was drawn, they are the clear colour. Alpha is
//! that of the diffuse material, the current colour's where that follows it or lighting is off (sections 2.14.1 and 2.14.3);
//! it is drawn like a colour, in a pass of its own, when somebody asks. Depth is window depth; 1, the cleared value, where
//! nothing was drawn, and everywhere without the depth test, which then writes no depth (section 4.1.6).

use std::sync::Arc;

use super::{Context, Viewport};
use crate::error::Error;
use crate::frame::Frame;
use crate::gl;
use crate::math::color::quantize8;
use crate::render::{Assembled, Precision, Rasterizer};
use crate::scene::requirements::Model;
use crate::scene::{Geometry, Scene};

/// The most pixels that one read returns.
const MAX_READ: u64 = 1 << 27;

/// Which components of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// GL_RGB.
    Rgb,
    /// GL_RGBA.
    Rgba,
}

/// What a component is read as: f32 (0 to 1) or u8 (0 to 255, rounded as GL does: section 2.14.9).
pub trait Component: Copy {
    /// From a clamped value.
    fn from_unit(x: f32) -> Self;
}

impl Component for f32 {
    fn from_unit(x: f32) -> Self {
        x
    }
}

impl Component for u8 {
    fn from_unit(x: f32) -> Self {
        quantize8(x)
    }
}

/// A rectangle of the window.
#[derive(Clone, Copy)]
struct Area {
    x: i32,
    y: i32,
    width: u32,
    height: u32,
}

impl Area {
    fn new(x: i32, y: i32, width: u32, height: u32) -> Result<Self, Error> {
        let pixels = u64::from(width) * u64::from(height);
        if pixels > MAX_READ {
            let message = format!("{width}x{height} are {pixels} pixels, more than {MAX_READ}");
            return Err(Error::limit(message).with_help("read it in parts"));
        }
        Ok(Self {
            x,
            y,
            width,
            height,
        })
    }

    /// For each pixel, bottom row first: its place in the frame of the viewport, counted from the top-left.
    fn places(self, viewport: Viewport) -> impl Iterator<Item = Option<[u32; 2]>> {
        let inside = |at: i64, origin: i32, size: u32| {
            u32::try_from(at - i64::from(origin))
                .ok()
                .filter(|p| *p < size)
        };
        (0..self.height).flat_map(move |row| {
            (0..self.width).map(move |column| {
                let x = inside(
                    i64::from(self.x) + i64::from(column),
                    viewport.x,
                    viewport.width,
                )?;
                let y = inside(
                    i64::from(self.y) + i64::from(row),
                    viewport.y,
                    viewport.height,
                )?;
                Some([x, viewport.height - 1 - y])
            })
        })
    }
}

impl Context {
    /// glReadPixels of colours: `width` x `height` pixels from (x, y), bottom row first, components side by side.
    ///
    /// # Errors
    /// As [`Context::draw`]; [`Error::Limit`] for more than 2^27 pixels; [`Error::Parameter`], and `InvalidOperation`, between
    /// begin and end.
    pub fn read_pixels<T: Component>(
        &mut self,
        x: i32,
        y: i32,
        width: u32,
        height: u32,
        format: Format,
    ) -> Result<Vec<T>, Error> {
        self.check_closed()?;
        let area = Area::new(x, y, width, height)?;
        let (viewport, background) = (self.drawn_viewport(), self.recorded.background);
        let alpha = match format {
            Format::Rgba if viewport.width > 0 && viewport.height > 0 => {
                Some(self.rasterize(&self.alpha_scene()?)?)
            }
            Format::Rgb | Format::Rgba => None,
        };
        let frame = self.drawn(viewport)?;
        let mut pixels = Vec::new();
        for place in area.places(viewport) {
            let seen = place
                .zip(frame)
                .map(|([x, y], f)| *f.color.at(x as usize, y as usize));
            let rgb = seen.unwrap_or([0, 1, 2].map(|c| background[c] as f32));
            pixels.extend(rgb.map(T::from_unit));
            if format == Format::Rgba {
                let a = place.zip(alpha.as_ref());
                let a = a.map(|([x, y], f)| f.color.at(x as usize, y as usize)[0]);
                pixels.push(T::from_unit(a.unwrap_or(background[3] as f32)));
            }
        }
        Ok(pixels)
    }

    /// glReadPixels of GL_DEPTH_COMPONENT: window depth, bottom row first.
    ///
    /// # Errors
    /// As [`Context::read_pixels`].
    pub fn read_depth(
        &mut self,
        x: i32,
        y: i32,
        width: u32,
        height: u32,
    ) -> Result<Vec<f32>, Error> {
        self.check_closed()?;
        let area = Area::new(x, y, width, height)?;
        let viewport = self.drawn_viewport();
        let scene = self.scene()?;
        let assembled = Assembled::unchecked(&scene, None, Precision::F32)?;
        let plan = Rasterizer::new(&scene, &assembled, Model::Required);
        let frame = self.drawn(viewport)?;
        let window = frame.map(|frame| plan.window_depth(&frame.primitive));
        let mut depths = Vec::new();
        for place in area.places(viewport) {
            let depth = place.zip(window.as_ref());
            let depth = depth.map_or(1.0, |([x, y], z)| *z.at(x as usize, y as usize));
            depths.push(depth as f32);
        }
        Ok(depths)
    }

    /// Reading is refused between begin and end (section 2.6.3).
    fn check_closed(&mut self) -> Result<(), Error> {
        if self.outside() {
            return Ok(());
        }
        let message = "not allowed between begin and end";
        Err(Error::parameter("read", message).with_help("call end first"))
    }

    /// The viewport that the picture was drawn with.
    fn drawn_viewport(&self) -> Viewport {
        self.recorded.viewport().unwrap_or(self.viewport)
    }

    /// The frame, where the viewport has pixels.
    fn drawn(&mut self, viewport: Viewport) -> Result<Option<&Frame<f32>>, Error> {
        if viewport.width == 0 || viewport.height == 0 {
            return Ok(None);
        }
        self.draw().map(Some)
    }

    /// The scene with alpha in the place of colour: emitted as it is, interpolated as vertex colours are.
    fn alpha_scene(&self) -> Result<Scene, Error> {
        let mut scene = self.scene()?;
        scene.image.background = [self.recorded.background[3]; 3];
        scene.lights.clear();
        let alpha = |material: &gl::Material| gl::Material {
            emission: [material.alpha; 3],
            ambient: [0.0; 3],
            diffuse: [0.0; 3],
            specular: [0.0; 3],
            tracked: gl::Tracked {
                emission: material.tracked.any(),
                ..gl::Tracked::default()
            },
            ..material.clone()
        };
        for material in &mut scene.materials {
            material.front = alpha(&material.front);
            material.back = material.back.as_ref().map(alpha);
        }
        for object in &mut scene.objects {
            if let Geometry::Mesh(mesh) = &mut object.geometry
                && !mesh.colors.is_empty()
            {
                let mesh = Arc::make_mut(mesh);
                mesh.colors.iter_mut().for_each(|c| *c = [c[3]; 4]);
            }
        }
        Ok(scene)
    }
}
