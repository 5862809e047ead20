//! Mirrors: D_R = 2 (N.V) N - V, their series, and what they show.

use super::*;

/// e (1 - k^(m+1)) / (1 - k), or e (m + 1) where k = 1 (whitted.md 5).
fn series(e: f64, k: f64, m: u32) -> f64 {
    if k == 1.0 {
        return e * f64::from(m + 1);
    }
    e * (1.0 - libm::pow(k, f64::from(m + 1))) / (1.0 - k)
}

/// Two facing mirrors at distance 2, seen nearly square so that ten thousand bounces stay on them.
fn facing_mirrors(e: [f64; 3], k: [f64; 3], depth: u32, cutoff: f64) -> String {
    let side = |name: &str, z: f64| {
        let normal = -z;
        format!(
            "[object.{name}]\nshape = \"plane\"\ncenter = [0, 0, {z:?}]\nnormal = [0, 0, {normal:?}]\n\
             size = 2000\nmaterial = \"mirror\"\n"
        )
    };
    format!(
        "{}[trace]\ndepth = {depth}\nweight_cutoff = {cutoff:?}\n\
         [material.mirror]\ncolor = 0\nemission = {}\nreflection = {}\n{}{}",
        one_ray(DVec3::ZERO, v(0.02, 0.007, -1.0)),
        list(e.into()),
        list(k.into()),
        side("front", -1.0),
        side("back", 1.0)
    )
}

/// Every channel has its own series; an emission above 1 shows that no bounce is clamped.
#[test]
fn facing_mirrors_sum_a_geometric_series() {
    let e = [0.25, 3.0, 0.7];
    for k in [[0.5, 0.875, 0.0], [0.9, 0.3, 1.0], [0.99, 0.05, 1.25]] {
        for m in [0, 1, 2, 3, 10, 60] {
            let expected = [0, 1, 2].map(|c| series(e[c], k[c], m));
            // A weight k^j is rounded j times, a sum m times; the formula divides by 1 - k, at least 0.01.
            let tolerance = (2.0 * f64::from(m) + 100.0) * UNIT;
            assert_seen(&facing_mirrors(e, k, m, 0.0), expected, tolerance);
        }
    }
}

#[test]
fn ten_thousand_bounces_are_no_recursion() {
    let (e, k, m) = ([1.0, 0.5, 2.0], [1.0, 0.9999, 0.999], 10_000);
    let expected = [0, 1, 2].map(|c| series(e[c], k[c], m));
    let tolerance = 3.0 * f64::from(m) * UNIT;
    assert_seen(&facing_mirrors(e, k, m, 0.0), expected, tolerance);
}

/// A branch ends where its weight is below the cut-off in every channel, and not where it equals it (whitted.md 4).
#[test]
fn the_weight_cut_off_ends_the_series() {
    let (e, k) = ([1.0, 1.0, 1.0], [0.5, 0.25, 0.125]);
    for (cutoff, generations) in [
        (0.25, 2),
        (0.25f64.next_up(), 1),
        (0.1, 3),
        (1.0, 0),
        (0.5, 1),
        (1e-9, 29), // 2^-29 = 1.86e-9, 2^-30 = 0.93e-9
    ] {
        let expected = [0, 1, 2].map(|c| series(e[c], k[c], generations));
        assert_seen(&facing_mirrors(e, k, 60, cutoff), expected, 4.0 * UNIT);
    }
}

/// Mirrors above a floor of maps: the ray's own line, mirrored at y = 0.
#[test]
fn a_plane_mirrors_the_line() {
    let floor = quad(
        "floor",
        v(-9.0, 0.0, -9.0),
        v(0.0, 0.0, 18.0),
        v(18.0, 0.0, 0.0),
        "mirror",
    );
    for along in [v(0.5, -2.0, 0.3), v(0.0, -1.0, 0.0), v(3.0, -0.1, -4.0)] {
        let eye = v(0.3, 0.02, -0.2) - 0.25 * along;
        let text = format!("{}{MIRROR}{floor}", one_ray(eye, along));
        let flip = v(1.0, -1.0, 1.0);
        // Where it meets the floor depends on the direction over its height: 50 in the flattest case.
        let steepness = along.length() / along.y.abs();
        assert_ray(&text, eye * flip, along * flip, steepness);
    }
}

/// Three mirrors at right angles: the ray returns the way it came, on the line inverted in the corner.
#[test]
fn a_corner_of_mirrors_sends_every_ray_back() {
    let (x, y, z) = (v(9.0, 0.0, 0.0), v(0.0, 9.0, 0.0), v(0.0, 0.0, 9.0));
    let corner = [
        quad("x", DVec3::ZERO, y, z, "mirror"),
        quad("y", DVec3::ZERO, z, x, "mirror"),
        quad("z", DVec3::ZERO, x, y, "mirror"),
    ]
    .concat();
    for along in [v(-1.0, -2.0, -1.5), v(-3.0, -1.0, -2.0)] {
        let eye = v(1.0, 1.25, 1.5) - along;
        let text = format!("{}{MIRROR}{corner}", one_ray(eye, along));
        assert_ray(&text, -eye, -along, 1.0);
    }
}

/// A ray at distance b from the centre meets a ball where sin(p) = b / R, and is turned to 2 p from the way it came.
#[test]
fn a_mirror_ball_turns_a_ray_by_twice_the_angle() {
    let (center, radius) = (v(0.5, -0.25, 0.125), 1.5);
    let (u, w) = (v(0.48, 0.6, -0.64), v(0.8, 0.0, 0.6)); // unit, at right angles
    for b in [0.0, 0.1, 0.75, 1.2, 1.499] {
        let p = libm::asin(b / radius);
        let (sin2, cos2) = libm::sincos(2.0 * p);
        let touched = center + b * u - radius * libm::cos(p) * w;
        let text = format!(
            "{}{MIRROR}{}",
            one_ray(center + b * u - 4.0 * w, w),
            ball("ball", center, radius, "mirror")
        );
        // d p / d b = 1 / (R cos p).
        assert_ray(&text, touched, sin2 * u - cos2 * w, 4.0 / libm::cos(p));
    }
}

/// What a plane mirror shows is what an eye at the mirrored place sees, the picture turned round: lit, shadowed, with
/// the highlight where that eye sees it (V is the way back along the mirrored ray).
#[test]
fn a_mirror_shows_what_the_mirrored_eye_sees() {
    let scene = |eye_z: f64| {
        format!(
            "[image]\nwidth = 40\nheight = 30\nbackground = [0.1, 0.2, 0.4]\n\
             [camera]\neye = [0.25, 0.5, {eye_z:?}]\ntarget = [0.25, 0.5, 0]\nfovy = 30\nnear = 1e-3\n\
             [light.key]\nposition = [2, 5, 4]\n[light.sky]\ndirection = [0.3, -1, -0.2]\ndiffuse = 0.3\n\
             [material.red]\ncolor = [0.8, 0.1, 0.1]\nspecular = 0.5\nshininess = 30\n\
             [material.white]\ncolor = 0.7\n{}{}",
            ball("ball", v(0.5, 0.5, 9.0), 1.0, "red"),
            quad(
                "floor",
                v(-6.0, -0.75, 2.0),
                v(0.0, 0.0, 12.0),
                v(12.0, 0.0, 0.0),
                "white"
            ),
        )
    };
    let wall = quad(
        "wall",
        v(-50.0, -50.0, 0.0),
        v(100.0, 0.0, 0.0),
        v(0.0, 100.0, 0.0),
        "mirror",
    );
    for k in SCALES {
        let mirrored = stage(&format!("{}{MIRROR}{wall}", scene(1.5)), k);
        let direct = stage(&scene(-1.5), k);
        let mirrored = draw::<f64>(&mirrored, Geometry::Exact, false).color;
        let direct = draw::<f64>(&direct, Geometry::Exact, false).color;
        let mut kinds = [0; 2];
        for y in 0..30 {
            for x in 0..40 {
                let (a, b) = (mirrored.at(x, y), direct.at(39 - x, y));
                let off = (0..3).fold(0.0f64, |most, c| most.max((a[c] - b[c]).abs()));
                assert!(off < 1e-13, "scale {k}, pixel {x} {y}: {a:?} {b:?}");
                kinds[usize::from(a[0] > 2.0 * a[1])] += 1;
            }
        }
        assert!(kinds[0] > 300 && kinds[1] > 50, "{kinds:?}");
    }
}
