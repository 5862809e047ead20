//! Cameras as matrices: a part of the picture, a shifted one, another shape of it.

use crate::math::{DMat4, DVec2, DVec4};
use crate::scene::{Camera, Projection, Scene};

/// How far a matrix reaches where an orthographic camera has no far plane, in distances from eye to target.
const REACH: f64 = 1e6;

/// The camera through a matrix: its picture of this aspect (width / height), scaled about its centre and then shifted, in
/// normalized device coordinates (y up).
pub(super) fn through(camera: &Camera, aspect: f64, scale: DVec2, shift: DVec2) -> Camera {
    let mut bounded = *camera;
    if matches!(camera.projection, Projection::Orthographic { .. }) && camera.far.is_none() {
        let distance = (camera.target - camera.eye).length();
        bounded.far = Some(camera.near.abs() + REACH * distance);
    }
    let place = DMat4::from_cols(
        DVec4::new(scale.x, 0.0, 0.0, 0.0),
        DVec4::new(0.0, scale.y, 0.0, 0.0),
        DVec4::Z,
        DVec4::new(shift.x, shift.y, 0.0, 1.0),
    );
    let clip_from_eye = place * bounded.clip_from_eye(aspect);
    Camera {
        projection: Projection::Matrix { clip_from_eye },
        ..*camera
    }
}

/// Width over height.
pub(super) fn aspect(scene: &Scene) -> f64 {
    f64::from(scene.image.width) / f64::from(scene.image.height)
}

/// The scene whose pixel centres are the middle pixels of blocks of `step` x `step` (odd), one sample each; what fills no
/// block at the right and lower rim is left out.
pub(super) fn smaller(scene: &Scene, step: u32) -> Scene {
    let mut small = scene.clone();
    if step == 1 {
        return small;
    }
    let size = [scene.image.width, scene.image.height];
    let [width, height] = size.map(|n| (n / step).max(1));
    (small.image.width, small.image.height, small.image.samples) = (width, height, 1);
    let scale = |whole: u32, part: u32| f64::from(whole) / f64::from(part * step);
    let scale = DVec2::new(scale(size[0], width), scale(size[1], height));
    if scale != DVec2::ONE {
        // The left and the upper rim stay.
        let shift = DVec2::new(scale.x - 1.0, 1.0 - scale.y);
        small.camera = through(&scene.camera, aspect(scene), scale, shift);
    }
    small
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DVec2;

    /// Rays of the smaller picture are those of the middle pixels, for both kinds of camera and sizes that do not divide.
    #[test]
    fn smaller_pictures_keep_their_rays() {
        for projection in [
            Projection::Perspective { fovy_deg: 50.0 },
            Projection::Orthographic { height: 3.0 },
        ] {
            for (width, height) in [(320, 240), (45, 33), (17, 50)] {
                let mut scene = Scene::default();
                scene.camera.projection = projection;
                (scene.image.width, scene.image.height) = (width, height);
                let small = smaller(&scene, 3);
                let (w, h) = (small.image.width, small.image.height);
                for (x, y) in [(0, 0), (w - 1, h - 1), (w / 2, 1)] {
                    let place = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
                    let whole = place * 3.0;
                    let (o, d) = small.camera.primary_ray(place, w, h);
                    let (p, e) = scene.camera.primary_ray(whole, width, height);
                    assert!((o - p).length() < 1e-12 && (d - e).length() < 1e-12);
                }
            }
        }
    }
}
