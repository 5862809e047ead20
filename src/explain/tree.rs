//! The tracer's record as the weighted ray tree.

use super::local::{Local, Place, Shadows, angle_deg, local_sum};
use super::value::{Hit, Ray, Reflection, Refraction};
use crate::math::DVec3;
use crate::math::color::Rgb;
use crate::trace::record::{ForkRecord, Meeting, Record, Traced};

/// The rays of the kept sample, in the order of the record.
pub(super) fn rays(local: &Local<'_>, record: &Record<f64>, depth: u32) -> Vec<Ray> {
    let mut rays: Vec<Ray> = Vec::with_capacity(record.rays.len());
    for traced in &record.rays {
        let generation = traced.parent.map_or(0, |p| rays[p].generation + 1);
        rays.push(ray(local, traced, generation, depth));
    }
    sum_up(&mut rays);
    let kept = record.kept();
    if let (Some(root), Some((color, [mirrored, passed]))) = (rays.first_mut(), kept) {
        // What the picture holds, instead of the same sum in f64.
        root.color = *color;
        root.contribution = root.color;
        if let Some(reflection) = &mut root.reflection {
            reflection.contribution = *mirrored;
        }
        if let Some(refraction) = &mut root.refraction {
            refraction.contribution = *passed;
        }
    }
    rays
}

fn ray(local: &Local<'_>, traced: &Traced<f64>, generation: u32, depth: u32) -> Ray {
    let mut ray = Ray {
        kind: traced.kind,
        parent: traced.parent,
        generation,
        origin: traced.ray.origin.to_array(),
        direction: traced.ray.direction.to_array(),
        weight: traced.weight,
        inside: traced.inside,
        ior: traced.ior,
        color: [0.0; 3],
        contribution: [0.0; 3],
        terms: local.sums(&[]),
        hit: None,
        reflection: None,
        refraction: None,
        depth_reached: false,
    };
    let Some(meeting) = &traced.meeting else {
        ray.terms.emission = local.background();
        return ray;
    };
    let scene = local.scene;
    let material = &scene.materials[meeting.material as usize];
    let side = match &material.back {
        Some(back) if meeting.surface % 2 == 1 => back,
        _ => &material.front,
    };
    let shadows = Shadows::Cast(&meeting.shadows);
    ray.terms = local.terms(side, &meeting.point, &meeting.terms, &shadows);
    ray.hit = Some(hit(local, traced, meeting));
    let optics = &material.optics;
    ray.depth_reached = meeting.fork.is_none()
        && generation >= depth
        && (optics.is_mirror() || optics.is_transmissive());
    if let Some(fork) = &meeting.fork {
        branches(local, meeting, fork, &mut ray);
    }
    ray
}

fn hit(local: &Local<'_>, traced: &Traced<f64>, meeting: &Meeting<f64>) -> Hit {
    let normal = local.normal(&meeting.point);
    let normal = if normal == [0.0; 3] {
        meeting.foot.normal.to_array()
    } else {
        normal
    };
    local.hit(&Place {
        t: meeting.t,
        direction: traced.ray.direction,
        point: meeting.foot.point.to_array(),
        normal,
        inside: traced.inside,
        back: meeting.back,
        object: meeting.object,
        material: meeting.material,
        triangle: None,
    })
}

fn branches(local: &Local<'_>, meeting: &Meeting<f64>, fork: &ForkRecord, ray: &mut Ray) {
    let black = [0.0; 3];
    ray.reflection = (fork.mirror != black).then_some(Reflection {
        weight: fork.mirror,
        color: black,
        contribution: black,
        ray: fork.reflection,
    });
    ray.refraction = fork.passage.as_ref().map(|passage| {
        let normal = local.world_from_eye * meeting.normal_eye;
        let normal = if normal == DVec3::ZERO {
            meeting.foot.normal
        } else {
            normal
        };
        Refraction {
            weight: passage.weight,
            eta: passage.eta,
            fresnel: passage.reflected,
            direction: passage.direction.map(|d| d.to_array()),
            angle_deg: passage.direction.map(|d| angle_deg(d, normal)),
            tir: passage.direction.is_none(),
            color: black,
            contribution: black,
            ray: passage.refraction,
        }
    });
}

/// Colours and contributions, from the last ray to the first: children stand behind their parents.
fn sum_up(rays: &mut [Ray]) {
    for id in (0..rays.len()).rev() {
        let (head, children) = rays.split_at_mut(id + 1);
        let ray = &mut head[id];
        let child = |number: Option<usize>| {
            let found = number.and_then(|n| children.get(n - id - 1));
            found.map_or(([0.0; 3], [0.0; 3]), |ray| (ray.color, ray.contribution))
        };
        ray.color = local_sum(&ray.terms);
        ray.contribution = times(ray.weight, ray.color);
        if let Some(reflection) = &mut ray.reflection {
            (reflection.color, reflection.contribution) = child(reflection.ray);
            add(&mut ray.color, times(reflection.weight, reflection.color));
            add(&mut ray.contribution, reflection.contribution);
        }
        if let Some(refraction) = &mut ray.refraction {
            (refraction.color, refraction.contribution) = child(refraction.ray);
            add(&mut ray.color, times(refraction.weight, refraction.color));
            add(&mut ray.contribution, refraction.contribution);
        }
    }
}

/// Infinity times 0 is 0, as in the tracer's sums.
fn times(a: Rgb, b: Rgb) -> Rgb {
    [0, 1, 2].map(|c| match a[c] * b[c] {
        x if x.is_nan() => 0.0,
        x => x,
    })
}

fn add(sum: &mut Rgb, more: Rgb) {
    for (sum, x) in sum.iter_mut().zip(more) {
        let next = *sum + x;
        if !next.is_nan() {
            *sum = next;
        }
    }
}
