//! How well the rasterizer and a peer agree, pixel by pixel, and why they differ where they do.
//!
//! In: both pictures of one scene at one sample a pixel (the centre), with depths and triangle numbers. Out: counts and
//! errors, unclamped or clamped as the pictures are. Where both show the same triangle, colours are compared. Where they
//! show different triangles, or one shows nothing, the reason is one of
//! - *edge*: the centre lies within a sub-pixel step of the outline of a triangle that either shows. Vertices snap to
//!   sub-pixels and GL leaves open who owns a centre on an edge (GL 2.1 section 3.5.1), so both are right;
//! - *depth tie*: the two window depths differ by less than what a 32-bit depth buffer interpolates exactly;
//! - *unexplained*: neither. That is an error of one of the two.
//!
//! Where the scene blends transmissive surfaces, triangles, edges and depths are those of the opaque ones. Outlines of blended
//! triangles are not set apart, so a colour may be off there.

use serde::Serialize;

use super::opengl::Picture;
use crate::frame::{Frame, NONE};
use crate::gl::ShadeModel;
use crate::render::Rasterizer;
use crate::scene::Scene;

/// Difference of two window depths below which either may win: GL interpolates them in f32 (the bar that recorded pictures
/// of both of Mesa's software drivers keep).
const DEPTH_TIE: f64 = 5e-6;
/// Colour error on the same triangle that is held to be the same: f32 lighting and interpolation.
pub const SAME: f64 = 5e-5;
/// Pixels that are listed one by one.
const LISTED: usize = 32;

/// Both pictures, and what decides how they are judged.
pub struct Pair<'a> {
    /// The scene, one sample a pixel at its centre.
    pub scene: &'a Scene,
    /// The rasterizer's plan of it.
    pub plan: &'a Rasterizer<'a>,
    /// The rasterizer's picture, exact in f64 whatever drew it.
    pub ours: &'a Frame<f64>,
    /// The peer's picture.
    pub peer: &'a Picture,
    /// Where both lit.
    pub shading: ShadeModel,
    /// Distance from an outline, in pixels, that counts as edge: the coarser sub-pixel step of the two.
    pub edge_px: f64,
}

/// Why two pictures do not show the same triangle at a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Reason {
    /// The centre lies on an edge, as far as sub-pixels tell.
    Edge,
    /// Two surfaces at the same depth, as far as the depth buffer tells.
    DepthTie,
    /// An error of one of the two.
    Unexplained,
}

/// Pixels that do not show the same triangle, by reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Reasons {
    /// All of them.
    pub pixels: usize,
    /// At an edge.
    pub edge: usize,
    /// At a tie of depths.
    pub depth_tie: usize,
    /// For no such reason.
    pub unexplained: usize,
}

impl Reasons {
    fn add(&mut self, reason: Reason) {
        self.pixels += 1;
        *match reason {
            Reason::Edge => &mut self.edge,
            Reason::DepthTie => &mut self.depth_tie,
            Reason::Unexplained => &mut self.unexplained,
        } += 1;
    }
}

/// A pixel that does not show the same triangle.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Differing {
    /// X and y, from the top-left.
    pub pixel: [usize; 2],
    /// The rasterizer's triangle.
    pub raster: Option<u32>,
    /// The peer's triangle.
    pub peer: Option<u32>,
    /// Why.
    pub reason: Reason,
}

/// Colours where both show the same triangle, relative to max(1, the larger magnitude), largest channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Colors {
    /// Pixels judged.
    pub pixels: usize,
    /// Largest error.
    pub max: f64,
    /// Where that is.
    pub max_at: Option<[usize; 2]>,
    /// Mean error.
    pub mean: f64,
    /// Pixels whose error exceeds [`SAME`].
    pub over: usize,
    /// Pixels set apart: lit at a discontinuity of the model (specular gate, spot cone).
    pub jump_pixels: usize,
    /// Largest error there.
    pub jump_max: f64,
}

/// Two pictures held against each other.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Agreement {
    /// Pixels that both cover.
    pub both: usize,
    /// Pixels that only the rasterizer covers.
    pub raster_only: usize,
    /// Pixels that only the peer covers.
    pub peer_only: usize,
    /// Why those are covered by one only.
    pub one_only: Reasons,
    /// Pixels that show different triangles, and why.
    pub other_triangle: Reasons,
    /// Colours on the same triangle.
    pub same_triangle: Colors,
    /// Largest difference of window depths on the same triangle.
    pub depth_max: f64,
    /// Largest colour error where neither shows anything.
    pub background_max: f64,
    /// The first pixels that do not show the same triangle.
    pub differing: Vec<Differing>,
}

impl Agreement {
    /// Compares a pair of pictures.
    pub fn of(pair: &Pair<'_>) -> Self {
        let (ours, theirs) = (&pair.ours.primitive, &pair.peer.primitive);
        let edges = [ours, theirs].map(|p| pair.plan.near_edge(p, pair.edge_px));
        let jumps = pair.plan.near_jump(ours, pair.shading);
        let depths = pair.depth_errors();
        let mut found = Self::default();
        let mut sum = 0.0;
        for (pixel, depth_error) in depths.into_iter().enumerate() {
            let (a, b) = (ours.data[pixel], theirs.data[pixel]);
            let place = [pixel % ours.width, pixel / ours.width];
            let error = pair.error(pixel);
            if a == NONE && b == NONE {
                found.background_max = found.background_max.max(error);
                continue;
            }
            match [a, b].map(|p| p != NONE) {
                [true, false] => found.raster_only += 1,
                [false, true] => found.peer_only += 1,
                _ => found.both += 1,
            }
            if a != b {
                let edge = edges[0].data[pixel] || edges[1].data[pixel];
                found.differ(pair.reason(pixel, edge, depth_error), [a, b], place);
            } else if jumps.data[pixel] {
                found.same_triangle.jump_pixels += 1;
                found.same_triangle.jump_max = found.same_triangle.jump_max.max(error);
            } else {
                sum += error;
                found.same_triangle.add(error, place);
            }
            if a == b {
                found.depth_max = found.depth_max.max(depth_error);
            }
        }
        let judged = found.same_triangle.pixels;
        found.same_triangle.mean = if judged > 0 { sum / judged as f64 } else { 0.0 };
        found
    }

    fn differ(&mut self, reason: Reason, seen: [u32; 2], pixel: [usize; 2]) {
        if seen.contains(&NONE) {
            self.one_only.add(reason);
        } else {
            self.other_triangle.add(reason);
        }
        if self.differing.len() < LISTED {
            let [raster, peer] = seen.map(|p| (p != NONE).then_some(p));
            self.differing.push(Differing {
                pixel,
                raster,
                peer,
                reason,
            });
        }
    }
}

impl Colors {
    fn add(&mut self, error: f64, place: [usize; 2]) {
        self.pixels += 1;
        self.over += usize::from(error > SAME);
        if error > self.max {
            self.max = error;
            self.max_at = Some(place);
        }
    }
}

impl Pair<'_> {
    /// Largest error of a pixel's channels. Equal infinities agree; a number and none do not.
    fn error(&self, pixel: usize) -> f64 {
        let (a, b) = (self.ours.color.data[pixel], self.peer.color.data[pixel]);
        let errors = [0, 1, 2].map(|c| {
            let (a, b) = (a[c], f64::from(b[c]));
            match (a - b).abs() / a.abs().max(b.abs()).max(1.0) {
                _ if a == b => 0.0,
                error if error.is_nan() => f64::INFINITY,
                error => error,
            }
        });
        errors.into_iter().fold(0.0, f64::max)
    }

    fn reason(&self, pixel: usize, edge: bool, depth_error: f64) -> Reason {
        let covered =
            self.ours.primitive.data[pixel] != NONE && self.peer.primitive.data[pixel] != NONE;
        // Without a depth test the last triangle wins, and depths say nothing.
        let tested = self.scene.raster.depth_test;
        if edge {
            Reason::Edge
        } else if covered && tested && depth_error <= DEPTH_TIE {
            Reason::DepthTie
        } else {
            Reason::Unexplained
        }
    }

    /// Differences of the window depths under the peer's projection, whatever its form.
    fn depth_errors(&self) -> Vec<f64> {
        let ours = self
            .plan
            .window_depth_under(&self.peer.camera, &self.ours.primitive);
        let theirs = &self.peer.window_depth.data;
        let pairs = ours.data.iter().zip(theirs);
        pairs.map(|(a, b)| (a - f64::from(*b)).abs()).collect()
    }
}
