//! A projection matrix taken apart: the primary rays that are its inverse. (The rasterizer multiplies by the matrix itself.)
//!
//! In: a GL projection matrix, clip = P eye (GL 2.1 section 2.11). Out: the ray that the matrix sends to a place of the
//! picture, the part of it between the planes z = -w and z = w (section 2.12), and whether the picture is a mirror image.
//! Three forms, so that what glFrustum, gluPerspective and glOrtho make keeps the accuracy of a camera that is described in
//! words: there, depth is the distance along -z and the planes are distances. Every other invertible matrix is `General`.
//!
//! Eye space and f64. Matrices that are singular or not finite have no [`Lens`]: no ray sees anything.

use crate::math::{DMat4, DVec2, DVec3, DVec4};

/// What kind of matrix it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// w is the distance along -z, and depth grows with it: glFrustum, gluPerspective, also off-centre or with an infinite far.
    Perspective,
    /// w is constant, and depth grows along -z: glOrtho, also oblique.
    Orthographic,
    /// Anything else that can be inverted.
    General,
}

/// A projection matrix, scaled so that w is the distance (perspective) or 1 (orthographic).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// The form.
    pub form: Form,
    /// Rows over (x, y, z, 1) that give clip x, y, z and w.
    pub rows: [DVec4; 4],
    /// Distances along -z of the near and the far plane; General: unused.
    pub bounds: [f64; 2],
    /// The picture shows the mirror image.
    pub mirrors: bool,
    inverse: DMat4,
}

impl Lens {
    /// Takes a matrix apart; `None` where it cannot be inverted.
    ///
    /// ```
    /// use rastray::{math::DMat4, scene::projection::{Form, Lens}};
    /// // gluPerspective(90, 1, 2, 6)
    /// let m = DMat4::from_cols_array(&[1., 0., 0., 0.,  0., 1., 0., 0.,  0., 0., -2., -1.,  0., 0., -6., 0.]);
    /// let lens = Lens::new(&m).unwrap();
    /// assert_eq!((lens.form, lens.bounds, lens.mirrors), (Form::Perspective, [2.0, 6.0], false));
    /// assert!(Lens::new(&DMat4::ZERO).is_none());
    /// ```
    pub fn new(clip_from_eye: &DMat4) -> Option<Self> {
        let inverse = clip_from_eye.inverse();
        let det = clip_from_eye.determinant();
        if !(det != 0.0 && inverse.is_finite() && clip_from_eye.is_finite()) {
            return None;
        }
        let rows = clip_from_eye.transpose();
        let rows = [rows.x_axis, rows.y_axis, rows.z_axis, rows.w_axis];
        // The map eye -> ndc keeps or turns orientation as det(P) / w^4 does; ndc is left-handed.
        let mirrors = det > 0.0;
        let general = Self {
            form: Form::General,
            rows,
            bounds: [0.0, f64::INFINITY],
            mirrors,
            inverse,
        };
        Some(
            general
                .perspective()
                .or_else(|| general.orthographic())
                .unwrap_or(general),
        )
    }

    /// Rows divided by the factor of w.
    fn scaled(&self, form: Form, by: f64, bounds: [f64; 2]) -> Option<Self> {
        let usable = bounds[0] < bounds[1] && bounds[0].is_finite();
        usable.then(|| Self {
            form,
            rows: self.rows.map(|row| row / by),
            bounds,
            ..*self
        })
    }

    /// w = c d and z = b - a d with d the distance along -z: planes at d = -b / (c - a) and b / (c + a).
    fn perspective(&self) -> Option<Self> {
        let [_, _, z, w] = self.rows;
        let (a, b, c) = (z.z, z.w, -w.z);
        let only_depth = z.x == 0.0 && z.y == 0.0 && w.x == 0.0 && w.y == 0.0 && w.w == 0.0;
        if !(only_depth && c > 0.0 && c - a > 0.0 && c + a <= 0.0 && b < 0.0) {
            return None;
        }
        let far = if c + a == 0.0 {
            f64::INFINITY
        } else {
            b / (c + a)
        };
        self.scaled(Form::Perspective, c, [-b / (c - a), far])
    }

    /// w = c and z = b - a d: planes at d = (b + c) / a and (b - c) / a.
    fn orthographic(&self) -> Option<Self> {
        let [_, _, z, w] = self.rows;
        let (a, b, c) = (z.z, z.w, w.w);
        let flat = w.truncate() == DVec3::ZERO;
        if !(flat && z.x == 0.0 && z.y == 0.0 && c > 0.0 && a < 0.0) {
            return None;
        }
        self.scaled(Form::Orthographic, c, [(b + c) / a, (b - c) / a])
    }

    /// The ray of all points that the matrix sends to a place of the picture (ndc), eye space.
    ///
    /// Perspective and orthographic: the direction's z is -1. General: from the near plane to the far one.
    pub fn ray(&self, ndc: DVec2) -> (DVec3, DVec3) {
        let [x, y, ..] = self.rows;
        let solve = |p: f64, q: f64| {
            let det = x.x * y.y - x.y * y.x;
            DVec2::new(p * y.y - x.y * q, x.x * q - p * y.x) / det
        };
        match self.form {
            // At distance t the clip coordinates are t (X, Y).
            Form::Perspective => {
                let origin = solve(-x.w, -y.w);
                let along = solve(ndc.x + x.z, ndc.y + y.z);
                (origin.extend(0.0), along.extend(-1.0))
            }
            Form::Orthographic => {
                let origin = solve(ndc.x - x.w, ndc.y - y.w).extend(0.0);
                let along = solve(x.z, y.z).extend(-1.0);
                // A near plane behind the eye: the ray starts there, so that its parameter is never negative.
                (origin + along * self.bounds[0].min(0.0), along)
            }
            Form::General => {
                let near = self.inverse * ndc.extend(-1.0).extend(1.0);
                let far = self.inverse * ndc.extend(1.0).extend(1.0);
                // far.xyz / far.w - near.xyz / near.w, times a positive factor: the far end may be at infinity.
                let along = far.truncate() * near.w - near.truncate() * far.w;
                (near.truncate() / near.w, along * near.w.signum())
            }
        }
    }

    /// The least and the largest parameter of [`Lens::ray`] between the planes.
    pub fn ray_range(&self, ndc: DVec2) -> [f64; 2] {
        let [near, far] = self.bounds;
        match self.form {
            Form::Perspective => [near, far],
            Form::Orthographic => [near.max(0.0), far - near.min(0.0)],
            Form::General => {
                let near = self.inverse * ndc.extend(-1.0).extend(1.0);
                let far = self.inverse * ndc.extend(1.0).extend(1.0);
                // The whole way is 1 / (w_near w_far) of the direction; beyond infinity where the signs differ.
                let whole = 1.0 / (near.w.abs() * far.w * near.w.signum());
                [0.0, if whole > 0.0 { whole } else { f64::INFINITY }]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matrices() -> Vec<(DMat4, Form)> {
        let frustum = DMat4::from_cols_array(&[
            1.5, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.25, -0.5, -1.5, -1.0, 0.0, 0.0, -5.0, 0.0,
        ]);
        let infinite = DMat4::from_cols_array(&[
            1.5, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, -1.0, -1.0, 0.0, 0.0, -1.0, 0.0,
        ]);
        let ortho = DMat4::from_cols_array(&[
            0.5, 0.0, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.125, 0.0, -0.125, 0.0, 0.25, 0.0, -0.5, 1.0,
        ]);
        let turned = frustum * DMat4::from_rotation_y(0.3) * DMat4::from_rotation_x(-0.2);
        vec![
            (frustum, Form::Perspective),
            (frustum * 3.0, Form::Perspective),
            (infinite, Form::Perspective),
            (ortho, Form::Orthographic),
            (
                ortho * DMat4::from_translation(DVec3::Z * 20.0),
                Form::Orthographic,
            ),
            (turned, Form::General),
            // Depth reversed: the plane that GL calls near is the farther one.
            (
                DMat4::from_scale(DVec3::new(1.0, 1.0, -1.0)) * frustum,
                Form::General,
            ),
            (infinite * DMat4::from_rotation_x(0.4), Form::General),
        ]
    }

    #[test]
    fn rays_are_the_inverse_of_the_matrix_and_end_at_its_planes() {
        for (m, form) in matrices() {
            let lens = Lens::new(&m).unwrap();
            assert_eq!(lens.form, form);
            for ndc in [DVec2::ZERO, DVec2::new(0.5, -0.75), DVec2::new(-0.9, 0.3)] {
                let (origin, along) = lens.ray(ndc);
                let [start, end] = lens.ray_range(ndc);
                assert!(start >= 0.0 && end > start);
                let finite = if end.is_finite() { end } else { start + 1e9 };
                for (t, z) in [(start, -1.0), (0.5 * (start + finite), 0.0), (finite, 1.0)] {
                    let p = origin + along * t;
                    let clip = m * p.extend(1.0);
                    assert!(clip.w > 0.0, "{form:?}");
                    let found = clip.truncate() / clip.w;
                    let error = (found.truncate() - ndc).abs().max_element();
                    assert!(error < 1e-12, "{form:?} {ndc}: {found}");
                    if z != 0.0 {
                        assert!(
                            (found.z - z).abs() < 1e-8,
                            "{form:?} {ndc}: {found} for {z}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn mirrors_and_singular_matrices_are_seen() {
        let (m, _) = matrices()[0];
        assert!(!Lens::new(&m).unwrap().mirrors);
        let flip = DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0));
        assert!(Lens::new(&(flip * m)).unwrap().mirrors);
        assert!(Lens::new(&(DMat4::from_scale(DVec3::new(1.0, 0.0, 1.0)) * m)).is_none());
        assert!(Lens::new(&DMat4::from_cols_array(&[f64::NAN; 16])).is_none());
    }
}
