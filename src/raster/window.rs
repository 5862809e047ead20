//! What OpenGL's own buffers hold beside the colour: window depth, and how many triangles cover a pixel.
//!
//! In: a plan, and for the depth the primitives of a frame that it drew. Out: planes like the frame's, top row first; whoever faces OpenGL
//! turns them over. Both are of the first sample. GL 2.1 sections 2.11.1 and 4.1.6.

use rayon::prelude::*;

use super::attribute::Weights;
use super::bin::TILE;
use super::tile::{Planes, Samples, Visibility};
use super::{Counters, Plan};
use crate::frame::{NONE, Plane};
use crate::lanes::Real;
use crate::math::DVec3;
use crate::math::color::clamp01;
use crate::sampling::SUBPIXEL;
use crate::scene::Camera;

impl<R: Real> Plan<'_, R> {
    /// Window depth of the primitives that a frame of this plan shows, after the scene's depth range: 1, GL's clear value,
    /// where nothing is seen or nothing wrote depth.
    pub fn window_depth(&self, primitives: &Plane<u32>) -> Plane<f64> {
        self.window_depth_under(&self.scene.camera, primitives)
    }

    /// The same under another projection of the same view, such as one with a far plane where the scene's has none.
    pub fn window_depth_under(&self, camera: &Camera, primitives: &Plane<u32>) -> Plane<f64> {
        let width = primitives.width.max(1);
        let [w, h] = self.grid.size.map(|n| n as f64);
        let clip_from_eye = camera.clip_from_eye(w / h);
        // glDepthRange clamps (GL 2.1 section 2.11.1).
        let [near, far] = self.scene.raster.depth_range.map(clamp01);
        let depth = |(pixel, &primitive): (usize, &u32)| {
            if primitive == NONE || !self.scene.raster.depth_test {
                return 1.0;
            }
            let eye = self.seen_at(primitive, [pixel % width, pixel / width]);
            let clip = clip_from_eye * eye.extend(1.0);
            let ndc = (clip.z / clip.w).clamp(-1.0, 1.0);
            (far - near) / 2.0 * ndc + (near + far) / 2.0
        };
        Plane {
            width: primitives.width,
            height: primitives.height,
            data: primitives.data.par_iter().enumerate().map(depth).collect(),
        }
    }

    /// The eye-space point of a primitive under the first sample of a pixel.
    fn seen_at(&self, primitive: u32, [x, y]: [usize; 2]) -> DVec3 {
        let [dx, dy] = self.sample_offset(x as u32, y as u32, 0);
        let unit = f64::from(SUBPIXEL);
        let ray = self.ray(x as f64 + dx as f64 / unit, y as f64 + dy as f64 / unit);
        let vertices = self.corners(primitive);
        let range = [self.view.near, self.view.far];
        let weights = Weights::new(vertices.map(|v| v.homogeneous()));
        let weights = weights.between(ray, vertices.map(|v| v.distance), range);
        let corners = self.assembly.triangles[primitive as usize];
        let corners = corners.map(|v| self.assembly.vertex_eye(v).map(Real::to_f64));
        DVec3::from_array(super::attribute::mix3(weights, corners))
    }

    /// How many triangles cover each pixel's first sample, whichever is nearest; culled ones do not count.
    pub fn coverage_counts(&self) -> Plane<u32> {
        let [width, height] = self.grid.size;
        let mut counts = Plane::filled(width, height, 0);
        let tiles = (0..self.grid.count()).into_par_iter();
        let tiles: Vec<Vec<u32>> = tiles.map(|index| self.count_tile(index)).collect();
        for (index, tile) in tiles.iter().enumerate() {
            let area = self.grid.tile(index);
            for y in 0..area.size[1] {
                let row = (area.corner[1] + y) * width + area.corner[0];
                let from = y * TILE..y * TILE + area.size[0];
                counts.data[row..row + area.size[0]].copy_from_slice(&tile[from]);
            }
        }
        counts
    }

    /// The counts of one tile, row-major with stride [`TILE`].
    fn count_tile(&self, index: usize) -> Vec<u32> {
        let area = self.grid.tile(index);
        let mut counts = vec![0u32; TILE * TILE];
        let mut visibility = Visibility::new(Planes::default());
        let (mut offset, mut ray) = (vec![[0; 2]; TILE * TILE], vec![[0.0; 2]; TILE * TILE]);
        for y in 0..area.size[1] {
            for x in 0..area.size[0] {
                let pixel = [area.corner[0] + x, area.corner[1] + y];
                let place = self.sample_offset(pixel[0] as u32, pixel[1] as u32, 0);
                let unit = f64::from(SUBPIXEL);
                let at = |axis: usize| pixel[axis] as f64 + place[axis] as f64 / unit;
                offset[y * TILE + x] = place;
                ray[y * TILE + x] = self.ray(at(0), at(1));
            }
        }
        let samples = Samples::Each {
            offset: &offset,
            ray: &ray,
        };
        for triangle in self.chunks.iter().flat_map(|chunk| chunk.of_tile(index)) {
            visibility.clear();
            let counters = &mut Counters::default();
            visibility.draw(&area, &samples, self.view.bits, triangle, counters);
            for (count, primitive) in counts.iter_mut().zip(&visibility.primitive) {
                *count += u32::from(*primitive != NONE);
            }
        }
        counts
    }
}
