//! The rays of a sample, one a pixel, and the media that they start in.

use super::Tile;
use crate::lanes::Real;
use crate::math::DVec2;
use crate::sampling;
use crate::trace::branch::{Branch, NO_END, Path};
use crate::trace::media::{AIR, MediaId};
use crate::trace::ray::{NO_ITEM, NO_SET, Ray};

impl<'p, 'a, R: Real> Tile<'p, 'a, R> {
    pub(super) fn primary_paths(&mut self, index: u32) -> Vec<Path> {
        self.eye_rays.clear();
        if let Some(ray) = self.start.as_ref().map(|(ray, _)| *ray) {
            return vec![Path {
                media: self.first_media(&ray),
                ray,
                weight: [1.0; 3],
                pixel: 0,
                branch: Branch::Primary,
                end: NO_END,
            }];
        }
        let image = &self.plan.scene.image;
        let camera = &self.plan.scene.camera;
        let world_from_eye = self.rotation.transpose();
        let mut paths = Vec::new();
        for pixel in 0..self.area.width * self.area.height {
            let place = self.sample_place(pixel, index);
            let (origin, direction) = camera.primary_ray(place, image.width, image.height);
            let [t_min, t_max] = camera.ray_range(place, image.width, image.height);
            self.eye_rays.push((origin, direction));
            let ray = Ray {
                origin: camera.eye + world_from_eye * origin,
                direction: world_from_eye * direction,
                t_min,
                t_max,
                skip: NO_ITEM,
                set: NO_SET,
            };
            paths.push(Path {
                media: self.first_media(&ray),
                ray,
                weight: [1.0; 3],
                pixel,
                branch: Branch::Primary,
                end: NO_END,
            });
        }
        paths
    }

    /// The media that a primary ray starts in: air where nothing is transmitted, so that `cast` lights as the rasterizer does.
    fn first_media(&mut self, ray: &Ray) -> MediaId {
        if !self.options.refraction {
            return AIR;
        }
        let plan = self.plan;
        let (walker, media) = (&mut self.walker, &mut self.media);
        let inside = self
            .start
            .as_ref()
            .map_or(&plan.inside, |(_, inside)| inside);
        inside.media(ray, &plan.surfaces, &plan.order, walker, media)
    }

    /// Where a sample of a pixel of the tile lies in the pixel frame.
    fn sample_place(&self, pixel: u32, index: u32) -> DVec2 {
        let image = &self.plan.scene.image;
        let (x, y) = self.pixel_place(pixel);
        let (sx, sy) =
            sampling::seeded_position(image.pattern, image.samples, [x, y], index, image.seed);
        let step = f64::from(sampling::SUBPIXEL);
        DVec2::new(
            f64::from(x) + f64::from(sx) / step,
            f64::from(y) + f64::from(sy) / step,
        )
    }

    pub(super) fn pixel_place(&self, pixel: u32) -> (u32, u32) {
        let (column, row) = (pixel % self.area.width, pixel / self.area.width);
        (self.area.x + column, self.area.y + row)
    }
}
