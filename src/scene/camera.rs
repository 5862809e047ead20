//! The camera: one description gives the rasterizer's matrix and the tracer's pixel directions.

use super::projection::Lens;
use crate::math::{DMat3, DMat4, DVec2, DVec3};

/// How eye space becomes a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// gluPerspective: `fovy_deg` is the full vertical angle in degrees, in (0, 180).
    Perspective {
        /// Full vertical angle, degrees.
        fovy_deg: f64,
    },
    /// glOrtho, centred: `height` is the height of the view in scene units.
    Orthographic {
        /// Height of the view, scene units.
        height: f64,
    },
    /// A projection matrix as GL holds it: any that glLoadMatrix could load. Near and far are its planes z = -w and z = w;
    /// the camera's own are not used. The tracer has no ray for one that cannot be inverted, and sees nothing.
    Matrix {
        /// Eye space to clip space.
        clip_from_eye: DMat4,
    },
}

/// Where the picture is taken from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Eye point, world space. Default (0, 0, 5).
    pub eye: DVec3,
    /// The point looked at, world space. Default the origin.
    pub target: DVec3,
    /// Upward direction, world space, any length, not parallel to the view. Default +y.
    pub up: DVec3,
    /// Perspective (45 degrees by default) or orthographic.
    pub projection: Projection,
    /// Near distance, > 0. Importers fit it where the file is silent.
    pub near: f64,
    /// Far distance; `None` = infinite (the default).
    pub far: Option<f64>,
}

impl Default for Camera {
    fn default() -> Self {
        Self {
            eye: DVec3::new(0.0, 0.0, 5.0),
            target: DVec3::ZERO,
            up: DVec3::Y,
            projection: Projection::Perspective { fovy_deg: 45.0 },
            near: 0.05,
            far: None,
        }
    }
}

impl Camera {
    /// Rows s, u, -F of gluLookAt (s = F x up, normalised): world directions to eye space.
    ///
    /// Importers refuse cameras for which s or F is zero.
    pub fn eye_from_world_rotation(&self) -> DMat3 {
        let forward = (self.target - self.eye).normalize();
        // `up` is normalised first: its length carries no meaning and may over- or underflow.
        let side = forward.cross(self.up.normalize()).normalize();
        let up = side.cross(forward);
        DMat3::from_cols(side, up, -forward).transpose()
    }

    /// A world point in eye space: the eye is subtracted before rotating.
    pub fn eye_from_world(&self, point_world: DVec3) -> DVec3 {
        self.eye_from_world_rotation() * (point_world - self.eye)
    }

    /// The projection matrix taken apart, where the camera has one and it can be inverted.
    pub fn lens(&self) -> Option<Lens> {
        match &self.projection {
            Projection::Matrix { clip_from_eye } => Lens::new(clip_from_eye),
            Projection::Perspective { .. } | Projection::Orthographic { .. } => None,
        }
    }

    /// Half extents of the picture: at distance 1 for a perspective view, in scene units for an orthographic one, in
    /// normalized device coordinates, (1, 1), for a matrix.
    pub fn half_extent(&self, aspect: f64) -> DVec2 {
        let half_height = match self.projection {
            Projection::Perspective { fovy_deg } => libm::tan(fovy_deg.to_radians() / 2.0),
            Projection::Orthographic { height } => height / 2.0,
            Projection::Matrix { .. } => return DVec2::ONE,
        };
        DVec2::new(half_height * aspect, half_height)
    }

    /// glFrustum's or glOrtho's matrix for a picture of this width / height. An infinite far plane takes the limit.
    pub fn clip_from_eye(&self, aspect: f64) -> DMat4 {
        if let Projection::Matrix { clip_from_eye } = self.projection {
            return clip_from_eye;
        }
        let half = self.half_extent(aspect);
        let near = self.near;
        let (sx, sy) = (1.0 / half.x, 1.0 / half.y);
        match (self.projection, self.far) {
            (Projection::Perspective { .. }, far) => {
                let (a, b) = match far {
                    Some(far) => (
                        -(far + near) / (far - near),
                        -2.0 * far * near / (far - near),
                    ),
                    None => (-1.0, -2.0 * near),
                };
                DMat4::from_cols_array(&[
                    sx, 0.0, 0.0, 0.0, 0.0, sy, 0.0, 0.0, 0.0, 0.0, a, -1.0, 0.0, 0.0, b, 0.0,
                ])
            }
            (_, far) => {
                // An infinite depth range has no orthographic matrix: z is kept as -1 at near, growing linearly.
                let (a, b) = match far {
                    Some(far) => (-2.0 / (far - near), -(far + near) / (far - near)),
                    None => (-1.0, -1.0 - near),
                };
                DMat4::from_cols_array(&[
                    sx, 0.0, 0.0, 0.0, 0.0, sy, 0.0, 0.0, 0.0, 0.0, a, 0.0, 0.0, 0.0, b, 1.0,
                ])
            }
        }
    }

    /// The primary ray through a place of the pixel frame (x right, y down, in pixels), in eye space.
    ///
    /// The one function that both renderers take a pixel's ray from. The direction is not normalised: its z is -1, so
    /// that the parameter t of a hit is its distance from the eye plane along -z (but for matrices that are neither a frustum
    /// nor a box: [`Lens::ray`]). No direction where a matrix has no inverse.
    pub fn primary_ray(&self, place: DVec2, width: u32, height: u32) -> (DVec3, DVec3) {
        let size = DVec2::new(f64::from(width), f64::from(height));
        let half = self.half_extent(size.x / size.y);
        let x = (2.0 * place.x / size.x - 1.0) * half.x;
        let y = (1.0 - 2.0 * place.y / size.y) * half.y;
        match self.projection {
            Projection::Perspective { .. } => (DVec3::ZERO, DVec3::new(x, y, -1.0)),
            Projection::Orthographic { .. } => (DVec3::new(x, y, 0.0), DVec3::NEG_Z),
            Projection::Matrix { .. } => self.lens().map_or((DVec3::ZERO, DVec3::ZERO), |lens| {
                lens.ray(DVec2::new(x, y))
            }),
        }
    }

    /// The least and the largest parameter of [`Self::primary_ray`]: the near and the far plane.
    pub fn ray_range(&self, place: DVec2, width: u32, height: u32) -> [f64; 2] {
        match self.lens() {
            None => [self.near, self.far.unwrap_or(f64::INFINITY)],
            Some(lens) => {
                let x = 2.0 * place.x / f64::from(width) - 1.0;
                let y = 1.0 - 2.0 * place.y / f64::from(height);
                lens.ray_range(DVec2::new(x, y))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn matrix_and_ray_agree() {
        let camera = Camera {
            far: Some(40.0),
            ..Camera::default()
        };
        for (px, py) in [(0.5, 0.5), (320.0, 240.0), (600.25, 17.75)] {
            let (_, d) = camera.primary_ray(DVec2::new(px, py), 640, 480);
            let clip = camera.clip_from_eye(640.0 / 480.0) * (d * 7.0).extend(1.0);
            let x = (clip.x / clip.w + 1.0) / 2.0 * 640.0;
            let y = (1.0 - clip.y / clip.w) / 2.0 * 480.0;
            assert!((x - px).abs() < 1e-10 && (y - py).abs() < 1e-10);
        }
    }

    #[test]
    fn near_maps_to_minus_one_and_far_to_one() {
        for far in [Some(10.0), None] {
            let camera = Camera {
                near: 2.0,
                far,
                ..Camera::default()
            };
            let m = camera.clip_from_eye(1.0);
            let ndc = |z: f64| {
                let c = m * DVec3::new(0.0, 0.0, z).extend(1.0);
                c.z / c.w
            };
            assert!((ndc(-2.0) + 1.0).abs() < 1e-15);
            let far_ndc = ndc(-far.unwrap_or(1e12));
            assert!((far_ndc - 1.0).abs() < 1e-10);
        }
    }

    #[test]
    fn look_at_is_glus() {
        let camera = Camera {
            eye: DVec3::new(1.0, 2.0, 3.0),
            ..Camera::default()
        };
        let p = camera.eye_from_world(DVec3::ZERO);
        assert!(p.x.abs() < 1e-15 && p.y.abs() < 1e-15);
        assert!((p.z + 14.0f64.sqrt()).abs() < 1e-14);
    }
}
