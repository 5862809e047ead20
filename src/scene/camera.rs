//! The camera: one description gives the rasterizer's matrix and the tracer's pixel directions.

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
    /// Any matrix that glLoadMatrix could load under GL_PROJECTION: off-centre, sheared or mirrored views.
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
    /// Near distance, > 0. Importers fit it where the file is silent. [`Projection::Matrix`] states its own planes.
    pub near: f64,
    /// Far distance; `None` = infinite (the default). [`Projection::Matrix`] states its own planes.
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
        let half = self.half_extent(aspect);
        let near = self.near;
        let (sx, sy) = (1.0 / half.x, 1.0 / half.y);
        match (self.projection, self.far) {
            (Projection::Matrix { clip_from_eye }, _) => clip_from_eye,
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
            (Projection::Orthographic { .. }, far) => {
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
    /// that the parameter t of a hit is its distance from the eye plane along -z.
    pub fn primary_ray(&self, place: DVec2, width: u32, height: u32) -> (DVec3, DVec3) {
        let size = DVec2::new(f64::from(width), f64::from(height));
        let half = self.half_extent(size.x / size.y);
        let x = (2.0 * place.x / size.x - 1.0) * half.x;
        let y = (1.0 - 2.0 * place.y / size.y) * half.y;
        match self.projection {
            Projection::Perspective { .. } => (DVec3::ZERO, DVec3::new(x, y, -1.0)),
            Projection::Orthographic { .. } => (DVec3::new(x, y, 0.0), DVec3::NEG_Z),
            Projection::Matrix { clip_from_eye } => matrix_ray(&clip_from_eye, x, y),
        }
    }

    /// Whether the picture is turned over, as by a mirror: windings change with it. Only a matrix does that.
    pub fn mirrors(&self) -> bool {
        let Projection::Matrix { clip_from_eye } = self.projection else {
            return false;
        };
        // In the picture a triangle of normal n winds as the sign of n . (p x q) says, p and q the planes of `matrix_ray`;
        // along the ray d as that of -n . d. They agree where p x q points against d, whose z is -1.
        let (p, q) = (clip_from_eye.row(0), clip_from_eye.row(1));
        p.x * q.y - p.y * q.x < 0.0
    }

    /// The parameters t between which a point of a primary ray lies between the near and the far plane; the first is the
    /// larger one where no point does.
    pub fn ray_range(&self, origin: DVec3, direction: DVec3) -> [f64; 2] {
        let Projection::Matrix { clip_from_eye } = self.projection else {
            return [self.near, self.far.unwrap_or(f64::INFINITY)];
        };
        // z + w >= 0 and w - z >= 0 (GL 2.1 section 2.12), each linear in t; their sum says w >= 0.
        let (from, along) = (
            clip_from_eye * origin.extend(1.0),
            clip_from_eye * direction.extend(0.0),
        );
        let mut range = [f64::NEG_INFINITY, f64::INFINITY];
        for (start, slope) in [
            (from.w + from.z, along.w + along.z),
            (from.w - from.z, along.w - along.z),
        ] {
            let at = -start / slope;
            if slope > 0.0 {
                range[0] = range[0].max(at);
            } else if slope < 0.0 {
                range[1] = range[1].min(at);
            } else if start < 0.0 {
                range[1] = f64::NEG_INFINITY;
            }
        }
        range
    }
}

/// The line of eye-space points that a matrix takes to the normalized device coordinates (x, y): where the planes
/// row 0 = x row 3 and row 1 = y row 3 meet. It starts at z = 0 and its direction has z = -1, as the other rays do; a
/// view across the z axis, which no such line shows, gives a ray that is not finite and meets nothing.
fn matrix_ray(clip_from_eye: &DMat4, x: f64, y: f64) -> (DVec3, DVec3) {
    let last = clip_from_eye.row(3);
    let p = clip_from_eye.row(0) - x * last;
    let q = clip_from_eye.row(1) - y * last;
    let d = p.truncate().cross(q.truncate());
    let origin = DVec3::new(
        (p.y * q.w - q.y * p.w) / d.z,
        (q.x * p.w - p.x * q.w) / d.z,
        0.0,
    );
    (origin, DVec3::new(-d.x / d.z, -d.y / d.z, -1.0))
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
    fn the_ray_of_a_matrix_is_the_cameras_own() {
        for projection in [
            Projection::Perspective { fovy_deg: 50.0 },
            Projection::Orthographic { height: 3.0 },
        ] {
            let camera = Camera {
                projection,
                near: 0.5,
                far: Some(40.0),
                ..Camera::default()
            };
            let clip_from_eye = camera.clip_from_eye(1.5);
            let general = Camera {
                projection: Projection::Matrix { clip_from_eye },
                ..camera
            };
            for (px, py) in [(0.5, 0.5), (31.25, 17.75), (59.5, 39.5)] {
                let (o, d) = camera.primary_ray(DVec2::new(px, py), 60, 40);
                let (p, e) = general.primary_ray(DVec2::new(px, py), 60, 40);
                assert!((o - p).length() < 1e-14 && (d - e).length() < 1e-14);
                let [near, far] = general.ray_range(p, e);
                assert!((near - 0.5).abs() < 1e-14 && (far - 40.0).abs() < 1e-12);
            }
            let mirror = DMat4::from_scale(DVec3::new(1.0, -1.0, 1.0));
            let over = Camera {
                projection: Projection::Matrix {
                    clip_from_eye: mirror * clip_from_eye,
                },
                ..camera
            };
            assert!(!camera.mirrors() && !general.mirrors() && over.mirrors());
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
