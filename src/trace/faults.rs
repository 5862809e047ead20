//! Mistakes that people make in a tracer: what `crate::check` holds pictures against.
//!
//! None unless asked for ([`super::Plan::with_faults`]); then asked once a ray or a hit, never inside the hierarchy, the
//! intersections or the equation, which stand once and are right.
//!
//! What a right picture pays: one test of a flag at each of these places; what a mistake does is out of line. As calls, with
//! shadow rays passed by value, the places had up to 1.6 % of the instructions of `render whitted --mode trace`, the work of the
//! right answers in the same lines included (`valgrind --tool=callgrind` by source line, 2026-12). A type parameter would take
//! that to 0, and compile the tracer twice in every build.

use super::bvh::Walker;
use super::optics::reflect;
use super::ray::{Foot, Hit, NO_ITEM, NO_SET, Ray};
use super::shadow::Lamp;
use super::surface::{Site, Surfaces};
use crate::lanes::Real;
use crate::lighting;
use crate::math::transform::model_matrix_normal;
use crate::math::{DMat3, DVec3};

/// Mistakes of a tracer; none by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Faults {
    /// Mistakes in the lighting equation.
    pub lighting: lighting::Faults,
    /// Secondary rays start this far off the surface (scene units), whatever the scale of the scene; `None` = by the bound
    /// of the point's error, as they should.
    pub offset: Option<f64>,
    /// Shadow rays are not cut off at the light: what lies behind it blocks it.
    pub endless_shadow_rays: bool,
    /// Directional lights are never blocked.
    pub directional_unblocked: bool,
    /// The normal faces outwards inside a body, too.
    pub normal_kept_inside: bool,
    /// The ratio of the indices is that of entering when a ray leaves, too.
    pub ratio_kept_inside: bool,
    /// Of a convex body the far root is taken.
    pub farther_root: bool,
    /// The first object in the file that is hit is taken, not the nearest.
    pub first_hit: bool,
    /// What normals the equation is given.
    pub normals: Normals,
}

/// What normals the equation is given.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Normals {
    /// Transformed by the inverse transpose, of unit length.
    #[default]
    Right,
    /// Transformed by the model matrix itself.
    ByModelMatrix,
    /// Of the length that the shape, the transform and interpolation leave.
    Unnormalized,
}

impl Faults {
    /// Makes of the ray from a hit towards a light, which is right as it comes, the one that is cast.
    #[inline(always)]
    pub(super) fn shadow_ray(&self, ray: &mut Ray, foot: &Foot, lamp: Lamp) {
        if self.offset.is_some() || self.endless_shadow_rays {
            self.wrong_shadow_ray(ray, foot, lamp);
        }
    }

    #[cold]
    #[inline(never)]
    fn wrong_shadow_ray(&self, ray: &mut Ray, foot: &Foot, lamp: Lamp) {
        if let (Some(length), Lamp::Point(p)) = (self.offset, lamp) {
            ray.origin = pushed(foot, p - foot.point, length);
            ray.direction = p - ray.origin;
        } else if let (Some(length), Lamp::Direction(d)) = (self.offset, lamp) {
            ray.origin = pushed(foot, d, length);
        }
        if self.offset.is_some() {
            (ray.skip, ray.set) = (NO_ITEM, NO_SET);
        }
        if self.endless_shadow_rays {
            ray.t_max = f64::INFINITY;
        }
    }

    /// A light that no shadow ray is cast for.
    pub(super) fn never_blocks(&self, lamp: Lamp) -> bool {
        self.directional_unblocked && matches!(lamp, Lamp::Direction(_))
    }

    /// Where a reflected or refracted ray starts.
    pub(super) fn spawn(&self, foot: &Foot, direction: DVec3) -> DVec3 {
        match self.offset {
            None => foot.spawn(direction),
            Some(length) => pushed(foot, direction, length),
        }
    }

    /// Indices before and after an interface; `outward` is the front normal there.
    pub(super) fn indices(&self, arriving: DVec3, outward: DVec3, eta: [f64; 2]) -> [f64; 2] {
        let [before, after] = eta;
        if self.ratio_kept_inside && arriving.dot(outward) > 0.0 {
            [after, before]
        } else {
            eta
        }
    }

    /// A transmitted direction. With N outwards inside, N.V is negative, and the sheet's formula
    /// `T = (eta N.V - c_r) N - eta V` turns the part along N round (whitted.md section 2).
    pub(super) fn transmitted(&self, direction: DVec3, arriving: DVec3, outward: DVec3) -> DVec3 {
        if self.normal_kept_inside && arriving.dot(outward) > 0.0 {
            reflect(direction, outward)
        } else {
            direction
        }
    }

    /// What a ray is said to meet.
    #[inline(always)]
    pub(super) fn closest_hit<R: Real>(
        &self,
        surfaces: &Surfaces<'_, R>,
        ray: &Ray,
        walker: &mut Walker,
    ) -> Option<Hit> {
        if self.misses_the_nearest() {
            self.wrong_hit(surfaces, ray, walker)
        } else {
            surfaces.closest_hit(ray, walker)
        }
    }

    #[cold]
    #[inline(never)]
    fn wrong_hit<R: Real>(
        &self,
        surfaces: &Surfaces<'_, R>,
        ray: &Ray,
        walker: &mut Walker,
    ) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        surfaces.walk(ray, walker, |hit, _| {
            let better = |b: &Hit| {
                if self.first_hit {
                    (hit.primitive, hit.t) < (b.primitive, b.t)
                } else {
                    hit.t < b.t
                }
            };
            if self.counts(surfaces, ray, &hit) && best.as_ref().is_none_or(better) {
                best = Some(hit);
            }
            false
        });
        best
    }

    /// Whether something is said to lie on a ray.
    #[inline(always)]
    pub(super) fn any_hit<R: Real>(
        &self,
        surfaces: &Surfaces<'_, R>,
        ray: &Ray,
        walker: &mut Walker,
        blocks: impl Fn(&Hit) -> bool,
    ) -> bool {
        surfaces.walk(ray, walker, |hit, _| {
            self.counts(surfaces, ray, &hit) && blocks(&hit)
        })
    }

    /// The hit that a ray is said to have may be another than the nearest.
    pub(super) fn misses_the_nearest(&self) -> bool {
        self.farther_root || self.first_hit
    }

    fn counts<R: Real>(&self, surfaces: &Surfaces<'_, R>, ray: &Ray, hit: &Hit) -> bool {
        let in_range = hit.t >= ray.t_min && hit.t <= ray.t_max;
        in_range && !(self.farther_root && surfaces.enters_convex(hit))
    }

    /// Gives a hit the normal that the mistake leaves, and returns the length that it enters the equation with.
    #[cold]
    #[inline(never)]
    pub(super) fn bend_normal<R: Real>(
        &self,
        surfaces: &Surfaces<'_, R>,
        hit: &Hit,
        site: &mut Site<R>,
        eye_from_world: &DMat3,
    ) -> f64 {
        let normal = DVec3::from_array(site.normal_eye);
        let model = surfaces.model_matrix(hit);
        match self.normals {
            Normals::Right => 1.0,
            Normals::ByModelMatrix => {
                let world = model_matrix_normal(&model) * (eye_from_world.transpose() * normal);
                let bent = (*eye_from_world * world).normalize_or_zero();
                site.normal_eye = bent.to_array();
                1.0
            }
            // |M^-T n| of the unit object normal n: its world direction w is M^-T n / |M^-T n|, so M^T w has length 1 / |M^-T n|.
            Normals::Unnormalized => match surfaces.length_left(hit) {
                Some(length) => length,
                None => {
                    let object = model.transpose() * (eye_from_world.transpose() * normal);
                    surfaces.length_of_shape(hit) / object.length().max(f64::MIN_POSITIVE)
                }
            },
        }
    }
}

/// A point moved off its surface, to the side that a direction goes to.
fn pushed(foot: &Foot, direction: DVec3, length: f64) -> DVec3 {
    let side = if foot.normal.dot(direction) < 0.0 {
        -1.0
    } else {
        1.0
    };
    foot.point + foot.normal * (side * length)
}
