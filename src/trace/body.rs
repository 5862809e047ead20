//! The round shapes with one interface: crossings of a ray, and what is there. Object space, f64 and pairs.
//!
//! `q` leads from the ray's origin to the shape's anchor, a fixed point of the shape; hit points come out relative to it.
//! A hit's feature names the crossing. For a solid between two ends it is the face, plus [`EXIT`] where the ray leaves, so
//! that of two faces at equal t the entry comes first.

use super::cone::{self, Cone};
use super::cylinder::{self, Cylinder};
use super::disk::Disk;
use super::exact::{Twofold, unit};
use super::span::{Span, Spot};
use super::torus::Torus;
use crate::math::DVec3;
use crate::math::Each;
use crate::scene::Shape;

/// Added to the face number where a ray leaves.
pub(super) const EXIT: u32 = 4;

/// A round shape about its anchor.
#[derive(Clone, Copy, Debug)]
pub(super) enum Body {
    Disk(Disk),
    /// Closed, or the side alone.
    Cylinder(Cylinder, bool),
    /// Closed, or the side alone.
    Cone(Cone, bool),
    Torus(Torus),
}

impl Body {
    /// A shape's anchor and its body; `None` where it is none of these.
    pub(super) fn of(shape: &Shape) -> Option<(DVec3, Self)> {
        let between = |from: DVec3, to: DVec3| {
            let (a, b) = (to.to_array(), from.to_array());
            [0, 1, 2].each(|k| Twofold::difference(a[k], b[k]))
        };
        match *shape {
            Shape::Disk {
                center,
                normal,
                radius,
            } => Some((center, Self::Disk(Disk { normal, radius }))),
            Shape::Cylinder {
                base,
                top,
                radius,
                caps,
            } => {
                let axis = between(base, top);
                Some((base, Self::Cylinder(Cylinder { axis, radius }, caps)))
            }
            Shape::Cone {
                base,
                apex,
                radius,
                cap,
            } => {
                let axis = between(apex, base);
                Some((apex, Self::Cone(Cone { axis, radius }, cap)))
            }
            Shape::Torus {
                center,
                axis,
                major,
                minor,
            } => {
                let axis = unit(axis);
                let torus = Torus { axis, major, minor };
                Some((center, Self::Torus(torus)))
            }
            _ => None,
        }
    }

    /// The largest length of the shape, in the two forms that a transform stretches: along an axis, and in all directions.
    pub(super) fn lengths(&self) -> (DVec3, f64) {
        match self {
            Self::Disk(disk) => (DVec3::ZERO, disk.radius),
            Self::Cylinder(c, _) => (super::exact::values(c.axis), c.radius),
            Self::Cone(c, _) => (super::exact::values(c.axis), c.radius),
            Self::Torus(t) => (DVec3::ZERO, t.major + t.minor),
        }
    }

    /// The face of a hit's feature: 0 but for the ends of cylinders and cones.
    pub(super) fn face(&self, feature: u32) -> u32 {
        match self {
            Self::Cylinder(..) | Self::Cone(..) => feature % EXIT,
            Self::Disk(_) | Self::Torus(_) => 0,
        }
    }

    /// A ray that leaves it never meets it again, on either side.
    pub(super) fn is_planar(&self) -> bool {
        matches!(self, Self::Disk(_))
    }

    /// A ray that leaves it outwards never meets it again.
    pub(super) fn is_convex(&self) -> bool {
        !matches!(self, Self::Torus(_))
    }

    /// Every crossing: (t, feature, from behind).
    pub(super) fn crossings(
        &self,
        q: [Twofold; 3],
        d: DVec3,
        mut visit: impl FnMut(f64, u32, bool),
    ) {
        let mut ends = |span: Option<Span>, closed: bool, side: u32| {
            let Some(span) = span else { return };
            for (t, face, back) in [
                (span.t[0], span.face[0], false),
                (span.t[1], span.face[1], true),
            ] {
                if closed || face == side {
                    visit(t.value(), face + if back { EXIT } else { 0 }, back);
                }
            }
        };
        match self {
            Self::Cylinder(c, closed) => ends(c.span(q, d), *closed, cylinder::SIDE),
            Self::Cone(c, closed) => ends(c.span(q, d), *closed, cone::SIDE),
            Self::Disk(disk) => {
                if let Some((t, back)) = disk.hit(q, d) {
                    visit(t, 0, back);
                }
            }
            Self::Torus(torus) => {
                for (i, t) in torus.crossings(q, d).iter().enumerate() {
                    if let Some(t) = t {
                        visit(t.value(), i as u32, i % 2 == 1);
                    }
                }
            }
        }
    }

    /// The point of a crossing, and its normal.
    pub(super) fn spot(&self, q: [Twofold; 3], d: DVec3, feature: u32) -> Option<Spot> {
        let end = usize::from(feature >= EXIT);
        match self {
            Self::Disk(disk) => disk.spot(q, d),
            Self::Cylinder(c, _) => c.spot(q, d, end),
            Self::Cone(c, _) => c.spot(q, d, end),
            Self::Torus(torus) => torus.spot(q, d, feature as usize),
        }
    }
}
