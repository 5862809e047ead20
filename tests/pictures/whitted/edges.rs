//! Where things end: outlines and shadows, to the rounding and to the pixel.

use super::*;

/// How far an edge may lie from where the formula puts it: shadow rays start off the floor by 8 units in the last place
/// of its sides, 20 and 20, and what they meet is rounded in turn.
const HAIR: f64 = 512.0 * UNIT;

/// A parallel view straight down at the origin, `height` units high: pixel (x, y) looks at ((2 x + 1) / n - 1) height / 2,
/// x to the right and z down.
fn from_above(pixels: u32, height: f64) -> String {
    format!(
        "[image]\nwidth = {pixels}\nheight = {pixels}\n[light_model]\nambient = 0\n\
         [camera]\neye = [0, 12, 0]\ntarget = [0, 0, 0]\nup = [0, 0, -1]\northographic = {height:?}\nnear = 1e-3\n"
    )
}

/// Draws a view from above at every scale and shows each pixel's place and grey.
fn each_place(text: &str, pixels: u32, height: f64, mut visit: impl FnMut(f64, f64, f64)) {
    for k in SCALES {
        let frame = draw::<f64>(&stage(text, k), Geometry::Exact, false);
        for row in 0..pixels {
            for column in 0..pixels {
                let at = |n: u32| (f64::from(2 * n + 1) / f64::from(pixels) - 1.0) * height / 2.0;
                let color = frame.color.at(column as usize, row as usize);
                assert!(color[0] == color[1] && color[0] == color[2]);
                visit(at(column), at(row), color[0]);
            }
        }
    }
}

const FLOOR: &str = "[object.floor]\nshape = \"plane\"\nsize = 20\nmaterial = \"white\"\n\
                     [material.white]\nambient = 0\ndiffuse = 0.8\n";
const LAMPSHADE: &str = "[material.shade]\ncolor = 0\nemission = 2\n";

// ---- Outlines ----------------------------------------------------------------------------------------------------------

/// A sphere's outline is seen under the half angle asin(r / d) (whitted.md 5), from near its surface to a million radii away.
#[test]
fn a_sphere_is_seen_under_asin_r_over_d() {
    for (radius, distance) in [(1.25f64, 7.0f64), (2.0, 2.001), (1e-6, 1.0), (0.3, 11.0)] {
        let half = libm::asin(radius / distance);
        for (step, hit) in [(-1.0, 1.0), (1.0, 0.0)] {
            // d sin(angle) = r: the angle's own rounding, of order 1, over the cosine.
            let angle = half + step * 4.0 * UNIT * (half + 1.0 / libm::cos(half));
            let (s, c) = libm::sincos(angle);
            let text = format!(
                "{}{LAMPSHADE}{}",
                one_ray(v(0.0, 0.0, distance), v(s, 0.0, -c)),
                ball("ball", DVec3::ZERO, radius, "shade")
            );
            assert_seen(&text, [2.0 * hit; 3], 0.0);
        }
    }
}

/// In a perspective picture that outline, about the middle, is a circle of radius (h / 2) tan(asin(r / d)) / tan(fovy / 2)
/// pixels: every pixel centre is on the right side of it.
#[test]
fn a_spheres_outline_is_right_in_every_pixel() {
    let (n, fovy, radius, distance) = (75u32, 40.0f64, 1.0, 3.7);
    let text = format!(
        "[image]\nwidth = {n}\nheight = {n}\n[light_model]\nambient = 0\n\
         [camera]\neye = [0, 0, {distance:?}]\ntarget = [0, 0, 0]\nfovy = {fovy:?}\nnear = 1e-3\n{LAMPSHADE}{}",
        ball("ball", DVec3::ZERO, radius, "shade")
    );
    let outline = f64::from(n) / 2.0 * libm::tan(libm::asin(radius / distance))
        / libm::tan(fovy.to_radians() / 2.0);
    for k in SCALES {
        let frame = draw::<f64>(&stage(&text, k), Geometry::Exact, false);
        let mut inside = 0;
        for y in 0..n {
            for x in 0..n {
                let at = |p: u32| f64::from(p) + 0.5 - f64::from(n) / 2.0;
                let from_middle = libm::hypot(at(x), at(y));
                assert!(
                    (from_middle - outline).abs() > 1e-4,
                    "a pixel on the outline tells nothing"
                );
                let seen = frame.color.at(x as usize, y as usize)[0] > 0.0;
                assert_eq!(seen, from_middle < outline, "scale {k}, pixel {x} {y}");
                inside += u32::from(seen);
            }
        }
        assert!(inside > 1000, "{inside}");
    }
}

// ---- Shadows -----------------------------------------------------------------------------------------------------------

/// A quad over a floor: x0..x1, z0..z1 at a height.
const QUAD: [f64; 4] = [-0.53, 1.21, -0.7, 0.37];
const QUAD_HEIGHT: f64 = 2.5;

fn lampshade() -> String {
    let [x0, x1, z0, z1] = QUAD;
    let (u, w) = (v(0.0, 0.0, z1 - z0), v(x1 - x0, 0.0, 0.0));
    quad("quad", v(x0, QUAD_HEIGHT, z0), u, w, "shade")
}

fn within([x0, x1, z0, z1]: [f64; 4], x: f64, z: f64) -> bool {
    x > x0 && x < x1 && z > z0 && z < z1
}

/// The picture of the quad and its shadow: the quad's emission, 0 in its shadow, else K_D (N.L).
fn assert_shadow(light: &str, shadow: [f64; 4], n_dot_l: impl Fn(f64, f64) -> f64) {
    let (pixels, height) = (96, 9.0);
    let text = format!(
        "{}{light}{FLOOR}{LAMPSHADE}{}",
        from_above(pixels, height),
        lampshade()
    );
    let mut kinds = [0; 3];
    each_place(&text, pixels, height, |x, z, seen| {
        let (expected, kind) = match (within(QUAD, x, z), within(shadow, x, z)) {
            (true, _) => (2.0, 0),
            (false, true) => (0.0, 1),
            (false, false) => (0.8 * n_dot_l(x, z), 2),
        };
        kinds[kind] += 1;
        let off = (seen - expected).abs();
        assert!(off <= 16.0 * UNIT, "at {x} {z}: {seen}, not {expected}");
    });
    assert!(kinds.iter().all(|n| *n > 300), "{kinds:?}");
}

/// A point light at height H throws the shadow of x at height h to l + (x - l) H / (H - h).
fn thrown(x: f64, lamp: f64, height: f64) -> f64 {
    lamp + (x - lamp) * height / (height - QUAD_HEIGHT)
}

const LAMP: DVec3 = DVec3::new(0.9, 6.0, -0.4);

fn point_shadow() -> [f64; 4] {
    let [x0, x1, z0, z1] = QUAD;
    let x = |x| thrown(x, LAMP.x, LAMP.y);
    let z = |z| thrown(z, LAMP.z, LAMP.y);
    [x(x0), x(x1), z(z0), z(z1)]
}

#[test]
fn a_point_lights_shadow_of_a_quad_is_right_in_every_pixel() {
    let light = format!("[light.lamp]\nposition = {}\n", list(LAMP));
    assert_shadow(&light, point_shadow(), |x, z| {
        LAMP.y / (LAMP - v(x, 0.0, z)).length()
    });
}

/// Towards a directional light in (a, b, c): the shadow of height h is moved by -h (a, c) / b.
const SUN: DVec3 = DVec3::new(-0.7, 1.3, 0.45);

fn sun_shadow() -> [f64; 4] {
    let [x0, x1, z0, z1] = QUAD;
    let (x, z) = (-QUAD_HEIGHT * SUN.x / SUN.y, -QUAD_HEIGHT * SUN.z / SUN.y);
    [x0 + x, x1 + x, z0 + z, z1 + z]
}

#[test]
fn a_directional_lights_shadow_of_a_quad_is_right_in_every_pixel() {
    let light = format!(
        "[light.sun]\nposition = [{:?}, {:?}, {:?}, 0]\n",
        SUN.x, SUN.y, SUN.z
    );
    assert_shadow(&light, sun_shadow(), |_, _| SUN.y / SUN.length());
    let light = format!("[light.sun]\ndirection = {}\n", list(-SUN));
    assert_shadow(&light, sun_shadow(), |_, _| SUN.y / SUN.length());
}

/// The floor at one place, looked at from just above; whether light gets there.
fn lit_at(k: f64, x: f64, z: f64, rest: &str) -> bool {
    let text = format!("{}{FLOOR}{rest}", one_ray(v(x, 0.5, z), v(0.0, -1.0, 0.0)));
    seen(&text, k).y > 0.0
}

/// The same shadows' edges, to the rounding.
#[test]
fn shadows_of_a_quad_end_within_a_hair() {
    let lamp = format!("[light.lamp]\nposition = {}\n", list(LAMP));
    let sun = format!(
        "[light.sun]\nposition = [{:?}, {:?}, {:?}, 0]\n",
        SUN.x, SUN.y, SUN.z
    );
    for (light, [x0, x1, z0, z1]) in [(lamp, point_shadow()), (sun, sun_shadow())] {
        let rest = format!("{light}{LAMPSHADE}{}", lampshade());
        let (x, z) = (0.3 * x0 + 0.7 * x1, 0.6 * z0 + 0.4 * z1);
        for k in SCALES {
            for (edge, out) in [(x0, -HAIR), (x1, HAIR)] {
                assert!(
                    lit_at(k, edge + out, z, &rest),
                    "scale {k}, beyond x = {edge}"
                );
                assert!(
                    !lit_at(k, edge - out, z, &rest),
                    "scale {k}, within x = {edge}"
                );
            }
            for (edge, out) in [(z0, -HAIR), (z1, HAIR)] {
                assert!(
                    lit_at(k, x, edge + out, &rest),
                    "scale {k}, beyond z = {edge}"
                );
                assert!(
                    !lit_at(k, x, edge - out, &rest),
                    "scale {k}, within z = {edge}"
                );
            }
        }
    }
}

/// A ball's shadow under a point light straight above ends where the tangent cone does; under a directional light, where
/// the tangent cylinder does.
#[test]
fn shadows_of_a_ball_end_within_a_hair() {
    let (height, center, r) = (5.0, 2.0, 1.0);
    let cone = height * libm::tan(libm::asin(r / (height - center)));
    let rest = |light: &str| {
        format!(
            "{light}{LAMPSHADE}{}",
            ball("ball", v(0.0, center, 0.0), r, "shade")
        )
    };
    let lamp = rest("[light.lamp]\nposition = [0, 5, 0]\n");
    let sun = rest("[light.sun]\ndirection = [0, -1, 0]\n");
    for k in SCALES {
        for angle in [0.0f64, 1.0, 4.0] {
            let (s, c) = libm::sincos(angle);
            for (edge, rest) in [(cone, &lamp), (r, &sun)] {
                let at = |rho: f64| lit_at(k, rho * c, rho * s, rest);
                assert!(at(edge + HAIR), "scale {k}: dark beyond {edge}");
                assert!(!at(edge - HAIR), "scale {k}: lit within {edge}");
            }
        }
    }
}

/// Objects beyond the light, at it, or behind the point never block (whitted.md 1).
#[test]
fn only_what_lies_between_blocks() {
    let plate = |y: f64| {
        format!(
            "{LAMPSHADE}{}",
            quad(
                "plate",
                v(-1.0, y, -1.0),
                v(0.0, 0.0, 2.0),
                v(2.0, 0.0, 0.0),
                "shade"
            )
        )
    };
    let lamp = "[light.lamp]\nposition = [0, 4, 0]\n";
    for k in SCALES {
        let lit = |light: &str, y: f64| lit_at(k, 0.0, 0.0, &format!("{light}{}", plate(y)));
        assert!(!lit(lamp, 3.0));
        assert!(!lit(lamp, 4.0f64.next_down()), "just before the light");
        assert!(lit(lamp, 4.0), "a surface at the light is not between");
        assert!(lit(lamp, 4.0f64.next_up()), "just beyond the light");
        assert!(lit(lamp, 5.0));
        assert!(lit(lamp, -1.0), "behind the point");
        assert!(
            !lit("[light.sun]\ndirection = [0, -1, 0]\n", 1e9),
            "anywhere ahead"
        );
        assert!(lit("[light.sun]\ndirection = [0, -1, 0]\n", -1.0));
        assert!(
            !lit("[light.lamp]\nposition = [0, 8, 0, 2]\n", 3.9),
            "w divides"
        );
        assert!(
            lit("[light.lamp]\nposition = [0, 8, 0, 2]\n", 4.1),
            "w divides"
        );
    }
}

/// N.L <= 0: the whole term is 0, highlight included, whatever stands where (whitted.md 1).
#[test]
fn a_light_behind_the_surface_gives_nothing() {
    for y in [-1.0, -1e-9] {
        let text = format!(
            "{}[light.lamp]\nposition = [0.3, {y:?}, 0.2]\n\
             [material.white]\ncolor = 0.8\nspecular = 1\n[object.floor]\nshape = \"plane\"\nmaterial = \"white\"\n",
            one_ray(v(0.0, 1.0, 0.0), v(0.1, -1.0, 0.0))
        );
        assert_seen(&text, [0.0; 3], 0.0);
    }
}

// ---- Filtered shadows --------------------------------------------------------------------------------------------------

/// `shadow = "filtered"`: blockers multiply by their K_T once a crossing, straight through; `opaque`: any object blocks.
#[test]
fn filtered_shadows_multiply_k_t_once_a_crossing() {
    let (k_t, k_u) = ([0.5, 0.25, 1.0], [0.3, 0.9, 0.0]);
    let pane = |name: &str, y: f64| {
        quad(
            name,
            v(-1.0, y, -1.0),
            v(0.0, 0.0, 2.0),
            v(2.0, 0.0, 0.0),
            "tinted",
        )
    };
    let text = |mode: &str, rest: &str| {
        format!(
            "{}[trace]\nshadow = \"{mode}\"\n{FLOOR}[light.lamp]\nposition = [0, 9, 0]\n\
             [material.tinted]\ncolor = 0\ntransmission = {}\nior = 1.5\n\
             [material.core]\ncolor = 0\ntransmission = {}\nior = 2\n\
             [material.thin]\ncolor = 0\ntransmission = {}\nthin = true\n\
             [material.solid]\ncolor = 0\n{rest}",
            one_ray(v(0.0, 0.5, 0.0), v(0.0, -1.0, 0.0)),
            list(k_t.into()),
            list(k_u.into()),
            list(k_t.into())
        )
    };
    let shell = ball("shell", v(0.0, 3.0, 0.0), 1.0, "tinted");
    let core = ball("core", v(0.0, 3.0, 0.0), 0.5, "core");
    let film = ball("film", v(0.0, 6.0, 0.0), 0.5, "thin");
    let stone = ball("stone", v(0.0, 7.5, 0.0), 0.25, "solid");
    let expect = |panes: i32, cores: i32| {
        [0, 1, 2].map(|c| {
            0.8 * libm::pow(k_t[c], f64::from(panes)) * libm::pow(k_u[c], f64::from(cores))
        })
    };
    for (rest, expected) in [
        (pane("a", 2.0), expect(1, 0)),
        ([pane("a", 2.0), pane("b", 2.5)].concat(), expect(2, 0)),
        (shell.clone(), expect(2, 0)),
        (format!("{shell}{core}"), expect(2, 2)),
        (format!("{shell}{core}{film}"), expect(4, 2)),
        (format!("{shell}{stone}"), [0.0; 3]),
        (String::new(), expect(0, 0)),
    ] {
        assert_seen(&text("filtered", &rest), expected, 8.0 * UNIT);
        if !rest.is_empty() {
            assert_seen(&text("opaque", &rest), [0.0; 3], 0.0);
        }
    }
}
