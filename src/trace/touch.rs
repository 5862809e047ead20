//! Surfaces that touch: solids face on face, a drink in its glass, a block on a floor.
//!
//! A transmitted ray starts off the surface that it left by the bound of its error, and so beyond whatever touches that
//! surface there. So what touches a transmissive hit is looked for along the arriving ray, and all of it is passed at once:
//! K_T of each, the media before and behind all of them by the list rule, direction and Fresnel's share at the first,
//! which alone is shaded. The transmitted ray starts beyond the last. An opaque surface that a solid stands on is what a ray
//! inside the solid meets, whichever of the two the file names first.
//! Left out: an opaque surface in the plane of a clear one that is met from outside shows if the file names it first, as in the
//! rasterizer; else the ray passes both.

use super::branch::{Branch, Fork};
use super::media::{Crossing, Media};
use super::ray::Foot;
use crate::math::Each;
use crate::math::color::Rgb;
use crate::scene::Optics;

/// A transmissive surface that touches the one that a ray met.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touching<'s> {
    /// Its object.
    pub(super) object: u32,
    pub(super) optics: &'s Optics,
    /// Where the ray crosses it.
    pub(super) foot: Foot,
    /// Items that rays leaving outwards, and inwards, cannot meet.
    pub(super) skip: [u32; 2],
}

impl Fork<'_> {
    /// K_T of every surface passed, multiplied.
    pub(super) fn transmission(&self) -> Rgb {
        let own = self.optics.transmission;
        self.touching.iter().fold(own, |k, next| {
            [0, 1, 2].each(|c| k[c] * next.optics.transmission[c])
        })
    }

    /// Crosses every solid passed: the index before the first, and what is behind the last.
    pub(super) fn cross(&self, media: &mut Media) -> Crossing {
        let ior = media.ior(self.path.media);
        let nothing = Crossing {
            media: self.path.media,
            eta_i: ior,
            eta_t: ior,
        };
        let others = self.touching.iter().map(|t| (t.object, t.optics));
        std::iter::once((self.object, self.optics))
            .chain(others)
            .filter(|(_, optics)| !optics.thin)
            .fold(nothing, |so_far, (object, optics)| Crossing {
                eta_i: so_far.eta_i,
                ..media.cross(so_far.media, object, optics.ior)
            })
    }

    /// Where a secondary ray starts, with the errors of all that it passed.
    pub(super) fn start(&self, branch: Branch) -> (Foot, [u32; 2]) {
        let passed = match branch {
            Branch::Refraction => self.touching,
            Branch::Primary | Branch::Reflection => &[],
        };
        passed
            .iter()
            .fold((*self.foot, self.skip), |(foot, _), next| {
                let scale = foot.scale + next.foot.scale;
                (Foot { scale, ..next.foot }, next.skip)
            })
    }
}
