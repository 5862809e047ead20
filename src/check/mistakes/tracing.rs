//! Mistakes in the tracer.

use super::{Change, Group, Mistake, Of};
use crate::scene::{Geometry, Scene, Shadow, Tir};

const TRACING: Mistake = Mistake {
    name: "",
    group: Group::Tracing,
    title: "",
    what: "",
    remedy: "",
    of: Of::Trace,
    amount: None,
    make: |_| false,
};

/// The table of this group.
pub(super) fn mistakes() -> Vec<Mistake> {
    let mut all = hits();
    all.extend(shadows());
    all.extend(depth());
    all.extend(refraction());
    all
}

fn hits() -> Vec<Mistake> {
    vec![
        Mistake {
            name: "farther-root",
            title: "The far side of bodies is hit",
            what: "Of the two places where a ray meets a sphere (or another convex body) the farther one is taken: balls look \
                   hollow, and are lit from within.",
            remedy: "Take the smaller root, t = (−b − √D) / 2a, if it is in front of the ray's origin, else the larger one.",
            of: Of::Rays,
            make: |c| {
                c.trace.farther_root = true;
                let shape = |o: &crate::scene::Object| matches!(o.geometry, Geometry::Shape(_));
                c.scene.objects.iter().any(shape)
            },
            ..TRACING
        },
        Mistake {
            name: "first-hit",
            title: "The first object that is hit, not the nearest",
            what: "The search stops at the first object in the file that the ray meets: far things hide near ones.",
            remedy: "Test all objects, and keep the hit with the smallest t.",
            of: Of::Rays,
            make: |c| {
                c.trace.first_hit = true;
                true
            },
            ..TRACING
        },
        Mistake {
            name: "no-ray-offset",
            title: "Rays hit the surface that they start from (acne)",
            what: "Dark specks are strewn over what should be lit: rounding puts some hit points below their surface, and \
                   their shadow rays meet it at once.",
            remedy: "Start secondary rays a little off the surface, on the side that they go to: along the normal, by an \
                     amount that grows with the coordinates. A t_min is weaker, for it does not help grazing rays.",
            make: |c| {
                c.strewn = true;
                let lit = c.lights(|light| {
                    let black = |c: &mut [f64; 3]| std::mem::take(c) != [0.0; 3];
                    black(&mut light.source.diffuse) | black(&mut light.source.specular)
                });
                lit && c.shadows
            },
            ..TRACING
        },
        Mistake {
            name: "offset-too-large",
            title: "Secondary rays start too far off the surface",
            what: "Shadows come loose from what casts them, and light leaks in at corners: the offset of secondary rays is \
                   not small beside the objects.",
            remedy: "Make it as small as rounding allows: some units in the last place of the hit point's coordinates, not a \
                     fixed number.",
            amount: Some(|scene: &Scene| (scene.camera.target - scene.camera.eye).length()),
            make: |c| {
                c.trace.offset = Some(c.amount);
                true
            },
            ..TRACING
        },
    ]
}

fn shadows() -> Vec<Mistake> {
    vec![
        Mistake {
            name: "shadow-ray-endless",
            title: "Shadow rays do not end at the light",
            what: "Whatever lies in the direction of a light blocks it, also what lies behind it: inside a room with walls \
                   everything is in shadow.",
            remedy: "A hit blocks the light only if it is nearer than the light: 0 < t < distance.",
            make: |c| {
                c.trace.endless_shadow_rays = true;
                c.shadows
                    && c.scene
                        .enabled_lights()
                        .any(|light| light.source.position[3] != 0.0)
            },
            ..TRACING
        },
        Mistake {
            name: "directional-unblocked",
            title: "Directional lights cast no shadows",
            what: "Shadow rays are cast to point lights only, or end at the length of the direction: directional lights are \
                   never blocked.",
            remedy: "A directional light is infinitely far: any hit ahead blocks it.",
            make: |c| {
                c.trace.directional_unblocked = true;
                c.shadows
                    && c.scene
                        .enabled_lights()
                        .any(|light| light.source.position[3] == 0.0)
            },
            ..TRACING
        },
        Mistake {
            name: "shadows-missing",
            title: "No shadows",
            what: "Lights shine through everything: no shadow rays are cast.",
            remedy: "Leave out diffuse and specular of a light that something stands before (S_L = 0).",
            make: |c| std::mem::take(&mut c.shadows),
            ..TRACING
        },
        Mistake {
            name: "clear-blockers",
            title: "Clear objects do not block light",
            what: "Light goes through transparent objects, weakened by K_T. In this scene every object blocks it.",
            remedy: "Let any hit block the light, as in the lecture, or set trace.shadow = \"filtered\".",
            make: |c| {
                std::mem::replace(&mut c.scene.trace.shadow, Shadow::Filtered) == Shadow::Opaque
                    && c.shadows
                    && transmits(c)
            },
            ..TRACING
        },
        Mistake {
            name: "opaque-blockers",
            title: "Clear objects block light",
            what: "Transparent objects cast black shadows, where the scene asks for filtered ones.",
            remedy: "Multiply the light by K_T of each surface on its way, or set trace.shadow = \"opaque\".",
            make: |c| {
                std::mem::replace(&mut c.scene.trace.shadow, Shadow::Opaque) == Shadow::Filtered
                    && c.shadows
                    && transmits(c)
            },
            ..TRACING
        },
    ]
}

fn depth() -> Vec<Mistake> {
    vec![
        Mistake {
            name: "reflection-not-recursive",
            title: "Mirrors in mirrors are dull",
            what: "One generation of secondary rays is traced: what a reflected or refracted ray hits is lit, but neither \
                   mirrors nor transmits.",
            remedy: "Shade the hit of a secondary ray with the same function that shades those of primary rays, with one \
                     generation less to go.",
            make: |c| c.scene.trace.depth > 1 && secondary(c, 1),
            ..TRACING
        },
        Mistake {
            name: "depth-one-less",
            title: "One generation of rays too few",
            what: "The recursion ends one generation early: depth m means m generations of secondary rays, and the primary \
                   ray is not one of them.",
            remedy: "Start with m for the primary ray, and cast secondary rays while the number is above 0.",
            make: |c| {
                let depth = c.scene.trace.depth;
                depth > 2 && secondary(c, depth - 1)
            },
            ..TRACING
        },
        Mistake {
            name: "depth-one-more",
            title: "One generation of rays too many",
            what: "The recursion ends one generation late: depth m means m generations of secondary rays, and the primary \
                   ray is not one of them.",
            remedy: "Start with m for the primary ray, and cast secondary rays while the number is above 0.",
            make: |c| {
                let depth = c.scene.trace.depth;
                secondary(c, depth.saturating_add(1))
            },
            ..TRACING
        },
        Mistake {
            name: "no-secondary-rays",
            title: "Neither reflection nor refraction",
            what: "Mirrors and glass show their own colour alone: no secondary rays are cast, only shadow rays.",
            remedy: "Add K_S I_R and K_T I_T, traced along the mirrored and the refracted ray.",
            make: |c| c.scene.trace.depth > 0 && secondary(c, 0),
            ..TRACING
        },
    ]
}

fn refraction() -> Vec<Mistake> {
    vec![
        Mistake {
            name: "eta-inverted",
            title: "The ratio of the indices is inverted",
            what: "Rays bend the wrong way: eta is n_r / n_i. Glass looks like a bubble of air in glass.",
            remedy: "eta = n_i / n_r, the index that the ray comes from over the one that it goes into.",
            make: |c| {
                let mut bends = false;
                for material in &mut c.scene.materials {
                    let optics = &mut material.optics;
                    bends |= optics.is_transmissive() && !optics.thin && optics.ior != 1.0;
                    optics.ior = 1.0 / optics.ior;
                }
                bends
            },
            ..TRACING
        },
        Mistake {
            name: "normal-kept-inside",
            title: "The normal is not turned round inside",
            what: "Inside a clear body the normal still faces outwards. N·V is negative there, and the refracted ray is \
                   thrown back into the body.",
            remedy: "If N·V < 0, use −N, before N·V goes into the formula.",
            make: |c| {
                c.trace.normal_kept_inside = true;
                bends(c)
            },
            ..TRACING
        },
        Mistake {
            name: "ratio-kept-inside",
            title: "The same ratio of indices going in and coming out",
            what: "The ratio is 1 / n at every surface, also where a ray leaves the body: it bends the same way twice.",
            remedy: "Leaving, the ratio is n / 1: exchange the two indices where the ray comes from within (N·V < 0).",
            make: |c| {
                c.trace.ratio_kept_inside = true;
                bends(c)
            },
            ..TRACING
        },
        Mistake {
            name: "leaving-as-entering",
            title: "Entering and leaving are not told apart",
            what: "Where a ray leaves a clear body, neither is the normal turned round nor are the indices exchanged.",
            remedy: "If N·V < 0, the ray comes from within: use −N, and exchange the two indices.",
            make: |c| {
                (c.trace.normal_kept_inside, c.trace.ratio_kept_inside) = (true, true);
                bends(c)
            },
            ..TRACING
        },
        Mistake {
            name: "transmission-once-a-body",
            title: "K_T once a body, not once a surface",
            what: "What is seen through a clear body is weakened once. K_T belongs to each interface: a ball is two.",
            remedy: "Multiply by K_T at every surface that a ray crosses.",
            make: |c| {
                let mut weakens = false;
                for material in &mut c.scene.materials {
                    let optics = &mut material.optics;
                    let closed = optics.is_transmissive() && !optics.thin;
                    weakens |= closed && optics.transmission != [1.0; 3];
                    if closed {
                        optics.transmission = optics.transmission.map(|k| k.max(0.0).sqrt());
                    }
                }
                weakens
            },
            ..TRACING
        },
        Mistake {
            name: "total-reflection-added",
            title: "Total reflection mirrors",
            what: "Where no refracted ray exists, its weight goes to the mirrored one. In this scene it is lost (I_T = 0).",
            remedy: "Leave out K_T I_T at total internal reflection, or set trace.tir = \"reflect\".",
            make: |c| {
                std::mem::replace(&mut c.scene.trace.tir, Tir::Reflect) == Tir::None && bends(c)
            },
            ..TRACING
        },
        Mistake {
            name: "total-reflection-missing",
            title: "Total reflection is black",
            what: "Where no refracted ray exists, nothing takes its place, where the scene asks for the mirrored ray.",
            remedy: "Give K_T to the mirrored ray at total internal reflection, or set trace.tir = \"none\".",
            make: |c| {
                std::mem::replace(&mut c.scene.trace.tir, Tir::None) == Tir::Reflect && bends(c)
            },
            ..TRACING
        },
    ]
}

/// Sets the depth; says whether some material casts secondary rays.
fn secondary(c: &mut Change, depth: u32) -> bool {
    c.scene.trace.depth = depth;
    let mut materials = c.scene.materials.iter();
    materials.any(|m| m.optics.is_mirror() || m.optics.is_transmissive())
}

/// Some material transmits.
fn transmits(c: &Change) -> bool {
    c.scene.materials.iter().any(|m| m.optics.is_transmissive())
}

/// Some material bends rays.
fn bends(c: &Change) -> bool {
    let bends = |m: &crate::scene::Material| {
        m.optics.is_transmissive() && !m.optics.thin && m.optics.ior != 1.0
    };
    c.scene.trace.depth > 0 && c.scene.materials.iter().any(bends)
}
