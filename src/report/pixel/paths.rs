//! Ray paths: each ray of the tree and each shadow ray as a line in world space, and all of them as a Wavefront OBJ.

use super::pick::Picked;
use crate::explain::{Explanation, Kind, LightTerms, Ray, Vector};
use crate::math::DVec3;

/// What a line of the figure or of the OBJ stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Line {
    /// From the eye.
    Primary,
    /// Mirrored.
    Reflection,
    /// Transmitted.
    Refraction,
    /// Towards a light that is seen.
    Shadow,
    /// Towards a light that is blocked, as far as the blocker.
    Blocked,
}

impl Line {
    /// Each with its name: groups of the OBJ, classes of the figure.
    pub(super) const ALL: [(Self, &'static str); 5] = [
        (Self::Primary, "primary"),
        (Self::Reflection, "reflection"),
        (Self::Refraction, "refraction"),
        (Self::Shadow, "shadow"),
        (Self::Blocked, "blocked"),
    ];

    pub(super) fn name(self) -> &'static str {
        let found = Self::ALL.iter().find(|(line, _)| *line == self);
        found.map_or("", |(_, name)| name)
    }
}

/// A line from a point to a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    pub(super) line: Line,
    pub(super) from: DVec3,
    pub(super) to: DVec3,
    /// It goes on without end: `to` is only as far as is drawn.
    pub(super) open: bool,
}

/// The lines of the rays that are shown, rays before shadow rays.
pub(super) fn segments(e: &Explanation, shown: impl Fn(usize) -> bool) -> Vec<Segment> {
    let rays = &e.trace.rays;
    let reach = reach(rays);
    let ids = || (0..rays.len()).filter(|id| shown(*id));
    let own = ids().map(|id| along(&rays[id], reach));
    let shadows = ids().flat_map(|id| {
        let lights = rays[id].terms.lights.iter().enumerate();
        lights.filter_map(move |(light, terms)| shadow(e, id, light, terms, reach))
    });
    own.chain(shadows).collect()
}

/// How far rays without end are drawn: twice the longest of those that have one.
fn reach(rays: &[Ray]) -> f64 {
    let hits = rays.iter().filter_map(|ray| ray.hit.as_ref());
    let longest = hits.map(|hit| hit.distance).fold(0.0, f64::max);
    if longest > 0.0 && longest.is_finite() {
        2.0 * longest
    } else {
        1.0
    }
}

fn along(ray: &Ray, reach: f64) -> Segment {
    let from = DVec3::from_array(ray.origin);
    let direction = DVec3::from_array(ray.direction).normalize_or_zero();
    let end = ray.hit.as_ref().map(|hit| DVec3::from_array(hit.point));
    Segment {
        line: match ray.kind {
            Kind::Primary => Line::Primary,
            Kind::Reflection => Line::Reflection,
            Kind::Refraction => Line::Refraction,
        },
        from,
        to: end.unwrap_or(from + reach * direction),
        open: end.is_none(),
    }
}

fn shadow(
    e: &Explanation,
    id: usize,
    light: usize,
    terms: &LightTerms,
    reach: f64,
) -> Option<Segment> {
    let factors = terms.factors.as_ref()?;
    factors.shadow?;
    let point = |v: Vector| DVec3::from_array(v);
    let from = point(e.trace.rays[id].hit.as_ref()?.point);
    let source = e.lights.get(light)?.position;
    let blocked = factors.blocked_at.map(point);
    let to = blocked.or(source.map(point));
    Some(Segment {
        line: if blocked.is_some() {
            Line::Blocked
        } else {
            Line::Shadow
        },
        from,
        to: to.unwrap_or(from + reach * point(factors.to_light)),
        open: to.is_none(),
    })
}

/// The paths as OBJ: a group for each kind of ray, a line element for each ray. World space.
pub fn paths(e: &Explanation) -> String {
    let segments = segments(e, |_| true);
    let [x, y] = e.pixel;
    let mut text = format!(
        "# The rays of pixel {x} {y} of {}, world space. Groups: what kind of ray; rays that meet nothing end somewhere.\n",
        e.scene.replace(['\n', '\r'], " ")
    );
    for segment in &segments {
        for p in [segment.from, segment.to] {
            text += &format!("v {} {} {}\n", p.x, p.y, p.z);
        }
    }
    for (line, name) in Line::ALL {
        let mut group = String::new();
        for (i, _) in segments.iter().enumerate().filter(|(_, s)| s.line == line) {
            group += &format!("l {} {}\n", 2 * i + 1, 2 * i + 2);
        }
        if !group.is_empty() {
            text += &format!("g {name}\n{group}");
        }
    }
    text
}

/// Segments of the picked rays.
pub(super) fn picked(e: &Explanation, picked: &Picked) -> Vec<Segment> {
    segments(e, |id| picked.shown[id])
}
