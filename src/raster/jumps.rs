//! Which pixels show a discontinuity of the lighting model, where two right answers may differ: set apart by comparisons.
//!
//! In: primitive numbers a pixel. Out: whether the place that is lit there lies within 2^-18 (of a cosine) of the specular
//! gate n.l = 0 or of the edge of a spot cone (GL 2.1 section 2.14.1). Eye space, f64.

use rayon::prelude::*;

use super::Plan;
use crate::frame::{NONE, Plane};
use crate::gl::{LightSource, ShadeModel};
use crate::lanes::Real;
use crate::math::float::{dot, normalize};
use crate::math::{DVec2, DVec3};

/// Distance of a cosine from its boundary below which the two sides are both right (2^-18).
const GATE: f64 = 1.0 / 262_144.0;

impl<R: Real> Plan<'_, R> {
    /// For each pixel whose primitive is given: whether what is lit for it under this shading lies at a jump of the
    /// equation: its own place (per fragment), the triangle's vertices (Gouraud) or its provoking vertex (flat). False where
    /// the primitive is [`NONE`].
    ///
    /// `primitives` has the size of the picture and holds primitive numbers of the assembly.
    pub fn near_jump(&self, primitives: &Plane<u32>, shading: ShadeModel) -> Plane<bool> {
        let lights = self.scene.lights_eye();
        let width = primitives.width.max(1);
        let pixels = primitives.data.par_iter().enumerate();
        let data = pixels.map(|(pixel, &primitive)| {
            if primitive == NONE {
                return false;
            }
            let corners = self.assembly.triangles[primitive as usize];
            let at = |(position, normal)| lights.iter().any(|l| at_jump(l, position, normal));
            match shading {
                ShadeModel::Phong => {
                    let place = DVec2::new((pixel % width) as f64, (pixel / width) as f64) + 0.5;
                    at(self.surface(primitive, place))
                }
                ShadeModel::Gouraud => corners.iter().any(|v| at(self.vertex_surface(*v))),
                ShadeModel::Flat => at(self.vertex_surface(corners[2])),
            }
        });
        Plane {
            width: primitives.width,
            height: primitives.height,
            data: data.collect(),
        }
    }

    /// Eye-space position and unit normal of a vertex.
    fn vertex_surface(&self, vertex: u32) -> ([f64; 3], [f64; 3]) {
        let (position, normal) = (
            self.assembly.vertex_eye(vertex),
            self.assembly.vertex_normal(vertex),
        );
        (position.map(Real::to_f64), normal.map(Real::to_f64))
    }

    /// Eye-space point and unit normal of a triangle under a place of the picture, in f64.
    fn surface(&self, primitive: u32, place: DVec2) -> ([f64; 3], [f64; 3]) {
        let image = &self.scene.image;
        let (origin, direction) = self
            .scene
            .camera
            .primary_ray(place, image.width, image.height);
        let corners = self.assembly.triangles[primitive as usize];
        let [a, b, c] = corners
            .map(|v| DVec3::from_array(self.assembly.vertex_eye(v).map(Real::to_f64)) - origin);
        // Cross the ray first: weights relative to a vertex, accurate from afar.
        let weights = [(b, c), (c, a), (a, b)].map(|(p, q)| direction.cross(p).dot(q - p));
        let sum = weights[0] + weights[1] + weights[2];
        let weights = if sum == 0.0 {
            [1.0, 0.0, 0.0]
        } else {
            weights.map(|w| w / sum)
        };
        let position = origin + weights[0] * a + weights[1] * b + weights[2] * c;
        let mut normal = [0.0; 3];
        for (v, w) in corners.into_iter().zip(weights) {
            for (n, x) in normal
                .iter_mut()
                .zip(self.assembly.vertex_normal_weighted(v))
            {
                *n += w * x;
            }
        }
        (position.to_array(), normalize(normal).0)
    }
}

/// Whether a point lies at a jump of one light.
fn at_jump(light: &LightSource, position: [f64; 3], normal: [f64; 3]) -> bool {
    let [x, y, z, w] = light.position;
    let raw = if w == 0.0 {
        [x, y, z]
    } else {
        [
            x / w - position[0],
            y / w - position[1],
            z / w - position[2],
        ]
    };
    let to_light = normalize(raw).0;
    if dot(normal, to_light).abs() < GATE {
        return true;
    }
    if light.spot_cutoff_deg == 180.0 {
        return false;
    }
    let axis = normalize(light.spot_direction).0;
    (-dot(to_light, axis) - libm::cos(light.spot_cutoff_deg.to_radians())).abs() < GATE
}
