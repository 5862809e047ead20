//! The tracer's rays as JSON: each in the `reflection` or `refraction` of the hit that it leaves, 64 levels deep; deeper rays
//! in a flat list `deeper` with the number of their parent.

use serde::{Serialize, Serializer};

use super::value::{Hit, Ray, Terms, Trace, Vector};
use crate::math::color::Rgb;
use crate::trace::record::Kind;

/// Levels of rays that are nested; the primary ray is the first.
pub const LEVELS: u32 = 64;

/// A ray with those that follow from it.
#[derive(Serialize)]
struct Nested<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    parent: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    kind: Option<Kind>,
    color: Rgb,
    #[serde(skip_serializing_if = "Option::is_none")]
    stored: Option<[u8; 3]>,
    terms: &'a Terms,
    hit: &'a Option<Hit>,
    reflection: Option<Mirrored<'a>>,
    refraction: Option<Transmitted<'a>>,
    id: usize,
    origin: Vector,
    direction: Vector,
    path_weight: Rgb,
    contribution: Rgb,
    inside: bool,
    ior: f64,
    depth_reached: bool,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    deeper: Vec<Nested<'a>>,
}

#[derive(Serialize)]
struct Mirrored<'a> {
    weight: Rgb,
    color: Rgb,
    contribution: Rgb,
    ray: Option<Box<Nested<'a>>>,
}

#[derive(Serialize)]
struct Transmitted<'a> {
    weight: Rgb,
    eta: [f64; 2],
    fresnel: f64,
    direction: Option<Vector>,
    angle_deg: Option<f64>,
    tir: bool,
    color: Rgb,
    contribution: Rgb,
    ray: Option<Box<Nested<'a>>>,
}

impl Serialize for Trace {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut root = nested(&self.rays, 0);
        (root.color, root.stored) = (self.color, Some(self.stored));
        let deeper = (0..self.rays.len()).filter(|id| self.rays[*id].generation >= LEVELS);
        root.deeper = deeper.map(|id| flat(&self.rays, id)).collect();
        root.serialize(serializer)
    }
}

/// A ray of the flat list.
fn flat(rays: &[Ray], id: usize) -> Nested<'_> {
    let ray = &rays[id];
    Nested {
        parent: ray.parent,
        kind: Some(ray.kind),
        ..nested(rays, id)
    }
}

/// A ray and, above the last level, its children.
fn nested(rays: &[Ray], id: usize) -> Nested<'_> {
    let ray = &rays[id];
    let child = |id: Option<usize>| {
        id.filter(|_| ray.generation + 1 < LEVELS)
            .map(|id| Box::new(nested(rays, id)))
    };
    Nested {
        parent: None,
        kind: None,
        color: ray.color,
        stored: None,
        terms: &ray.terms,
        hit: &ray.hit,
        reflection: ray.reflection.map(|r| Mirrored {
            weight: r.weight,
            color: r.color,
            contribution: r.contribution,
            ray: child(r.ray),
        }),
        refraction: ray.refraction.map(|r| Transmitted {
            weight: r.weight,
            eta: r.eta,
            fresnel: r.fresnel,
            direction: r.direction,
            angle_deg: r.angle_deg,
            tir: r.tir,
            color: r.color,
            contribution: r.contribution,
            ray: child(r.ray),
        }),
        id,
        origin: ray.origin,
        direction: ray.direction,
        path_weight: ray.weight,
        contribution: ray.contribution,
        inside: ray.inside,
        ior: ray.ior,
        depth_reached: ray.depth_reached,
        deeper: Vec::new(),
    }
}
