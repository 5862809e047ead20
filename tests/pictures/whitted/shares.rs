//! How much of the light: K_T per interface, Fresnel's shares, generations, misses.

use super::*;

const SKY: [f64; 3] = [3.0, 0.5, 0.125];

/// One ray under a sky that is 3 in red: nothing is clamped on the way.
fn under_the_sky(eye: DVec3, along: DVec3) -> String {
    let sky = format!("[image]\nbackground = {}\n", list(SKY.into()));
    one_ray(eye, along).replace("[image]\n", &sky)
}

// ---- K_T ---------------------------------------------------------------------------------------------------------------

/// K_T once an interface, not once an object: a slab weighs K_T^2, a ball in it another K_U^2.
#[test]
fn k_t_counts_once_an_interface() {
    let (k_t, k_u) = ([0.9, 0.5, 0.25], [0.7, 0.3, 1.0]);
    let materials = format!(
        "[material.a]\ncolor = 0\ntransmission = {}\nior = 1.5\n\
         [material.b]\ncolor = 0\ntransmission = {}\nior = 1.2\n",
        list(k_t.into()),
        list(k_u.into())
    );
    let slab = cuboid("slab", v(-2.0, -2.0, -1.0), v(2.0, 2.0, 1.0), "a");
    let inner = ball("inner", DVec3::ZERO, 0.5, "b");
    let ray = under_the_sky(v(0.1, 0.05, 4.0), v(0.0, 0.0, -1.0));
    let weighed = |a: i32, b: i32| {
        let weight = |c: usize| libm::pow(k_t[c], a.into()) * libm::pow(k_u[c], b.into());
        [0, 1, 2].map(|c| weight(c) * SKY[c])
    };
    assert_seen(
        &format!("{ray}{materials}{slab}"),
        weighed(2, 0),
        8.0 * UNIT,
    );
    assert_seen(
        &format!("{ray}{materials}{slab}{inner}"),
        weighed(2, 2),
        8.0 * UNIT,
    );
}

/// Total internal reflection: I_T = 0 and nothing else changes; `tir = "reflect"` gives the mirror ray K_T's weight.
///
/// Into the top of a block of index 1.2 at 30 degrees from the top's normal, then against its side: sin(i) there is
/// cos(asin(0.5 / 1.2)) = 0.909 > 1 / 1.2. Reflected, the ray leaves by the bottom.
#[test]
fn total_reflection_leaves_only_the_other_terms() {
    let (sin, cos) = libm::sincos(30f64.to_radians());
    let (emission, k_r, k_t) = ([0.5, 0.25, 2.0], [0.0, 0.125, 0.5], [0.75, 0.5, 0.25]);
    let text = |tir: &str, depth: u32| {
        format!(
            "{}[trace]\ntir = \"{tir}\"\ndepth = {depth}\n\
             [material.glass]\ncolor = 0\nemission = {}\nreflection = {}\ntransmission = {}\nior = 1.2\n{}",
            under_the_sky(v(-0.1 - sin, cos, 0.0), v(sin, -cos, 0.0)),
            list(emission.into()),
            list(k_r.into()),
            list(k_t.into()),
            cuboid("block", v(-9.0, -9.0, -9.0), v(0.0, 0.0, 9.0), "glass")
        )
    };
    // Top: emission, the mirrored sky, and K_T times what is inside.
    let top = |c: usize, inside: f64| emission[c] + k_r[c] * SKY[c] + k_t[c] * inside;
    // Depth 1 sees the side's own emission; depth 2 the bottom's, by the mirror weight alone or with K_T's.
    let one = [0, 1, 2].map(|c| top(c, emission[c]));
    let lecture = [0, 1, 2].map(|c| top(c, emission[c] * (1.0 + k_r[c])));
    let reflect = [0, 1, 2].map(|c| top(c, emission[c] * (1.0 + k_r[c] + k_t[c])));
    assert_seen(&text("none", 1), one, 8.0 * UNIT);
    assert_seen(&text("reflect", 1), one, 8.0 * UNIT);
    assert_seen(&text("none", 2), lecture, 8.0 * UNIT);
    assert_seen(&text("reflect", 2), reflect, 8.0 * UNIT);
}

// ---- Fresnel -----------------------------------------------------------------------------------------------------------

/// Fresnel's equations for unpolarised light, in the angles' form: half of sin^2(i - r) / sin^2(i + r) plus half of
/// tan^2(i - r) / tan^2(i + r); at i = 0, ((n1 - n2) / (n1 + n2))^2.
fn dielectric(i: f64, n1: f64, n2: f64) -> f64 {
    if i == 0.0 {
        let q = (n1 - n2) / (n1 + n2);
        return q * q;
    }
    let r = libm::asin(n1 * libm::sin(i) / n2);
    let s = libm::sin(i - r) / libm::sin(i + r);
    let p = libm::tan(i - r) / libm::tan(i + r);
    (s * s + p * p) / 2.0
}

/// R0 + (1 - R0) (1 - cos)^5, with the cosine on the less dense side (whitted.md 5).
fn schlick(i: f64, n1: f64, n2: f64) -> f64 {
    let q = (n1 - n2) / (n1 + n2);
    let thin_side = if n1 > n2 {
        libm::asin(n1 * libm::sin(i) / n2)
    } else {
        i
    };
    q * q + (1.0 - q * q) * libm::pow(1.0 - libm::cos(thin_side), 5.0)
}

const K_T: f64 = 0.8;
/// The mirror ray sees a red sky, the transmitted one a blue wall: the pixel's channels are the two weights.
const RED: &str = "[image]\nbackground = [1, 0, 0]\n";
const BLUE: &str = "[material.blue]\ncolor = 0\nemission = [0, 0, 1]\n";

/// From air into a block of index n, whose inside is a blue wall.
fn entering(i: f64, n: f64, model: &str) -> String {
    let (sin, cos) = libm::sincos(i);
    let along = v(sin, 0.0, -cos);
    format!(
        "{}[trace]\ndepth = 1\n{BLUE}\
         [material.glass]\ncolor = 0\ntransmission = {K_T:?}\nior = {n:?}\nfresnel = \"{model}\"\n{}{}",
        one_ray(-2.0 * along, along).replace("[image]\n", RED),
        cuboid("block", v(-99.0, -99.0, -99.0), v(99.0, 99.0, 0.0), "glass"),
        quad(
            "wall",
            v(-50.0, -50.0, -1.0),
            v(100.0, 0.0, 0.0),
            v(0.0, 100.0, 0.0),
            "blue"
        )
    )
}

/// From glass of index n into air: a clear ball, entered square, with a bubble whose face goes through the centre. Only the
/// bubble has Fresnel's shares.
fn leaving(i: f64, n: f64, model: &str) -> String {
    let (sin, cos) = libm::sincos(i);
    let along = v(-sin, 0.0, -cos);
    format!(
        "{}[trace]\ndepth = 3\n{BLUE}{}\
         [material.air]\ncolor = 0\ntransmission = {K_T:?}\nior = 1\nfresnel = \"{model}\"\n{}{}{}{}",
        one_ray(-5.0 * along, along).replace("[image]\n", RED),
        glass("glass", n),
        ball("ball", DVec3::ZERO, 2.0, "glass"),
        cuboid("bubble", v(-1.0, -1.0, -1.0), v(1.0, 1.0, 0.0), "air"),
        cuboid("floor", v(-0.99, -0.99, -0.99), v(0.99, 0.99, -0.5), "blue"),
        cuboid("side", v(-0.99, -0.99, -0.99), v(-0.9, 0.99, -1e-9), "blue"),
    )
}

/// Mirror weight K_T F, transmission K_T (1 - F), together K_T; at total reflection F = 1.
fn assert_shares(text: &str, fresnel: f64, tolerance: f64) {
    for k in SCALES {
        let [red, green, blue] = seen(text, k).to_array();
        assert_eq!(green, 0.0);
        assert!(
            (red - K_T * fresnel).abs() <= tolerance
                && (blue - K_T * (1.0 - fresnel)).abs() <= tolerance,
            "scale {k}: {red} {blue}, not {} {}\n{text}",
            K_T * fresnel,
            K_T * (1.0 - fresnel)
        );
        assert!(
            (red + blue - K_T).abs() <= 2.0 * UNIT,
            "scale {k}: {red} + {blue}"
        );
    }
}

/// Share of the mirror at an angle, from one index into another.
type Fresnel = fn(f64, f64, f64) -> f64;

#[test]
fn fresnel_shares_k_t_between_mirror_and_glass() {
    let models: [(&str, Fresnel); 2] = [("dielectric", dielectric), ("schlick", schlick)];
    for n in [1.33f64, 1.5, 2.4] {
        for (model, formula) in models {
            for degrees in [0.0f64, 1.0, 20.0, 45.0, 56.3, 75.0, 88.0] {
                let i = degrees.to_radians();
                // The angle form divides two small sines near i = 0; both grow steep towards 90 degrees.
                let tolerance = 32.0 * UNIT / libm::cos(i) / if i > 0.0 { i.min(1.0) } else { 1.0 };
                assert_shares(&entering(i, n, model), formula(i, 1.0, n), tolerance);
            }
            let critical = libm::asin(1.0 / n);
            for part in [0.0, 0.1, 0.5, 0.9, 0.999] {
                let i = part * critical;
                let r = libm::asin(n * libm::sin(i));
                let tolerance = 64.0 * UNIT / libm::cos(r) / if i > 0.0 { i.min(1.0) } else { 1.0 };
                assert_shares(&leaving(i, n, model), formula(i, n, 1.0), tolerance);
            }
            for step in [1e-12, 0.1] {
                assert_shares(&leaving(critical + step, n, model), 1.0, 2.0 * UNIT);
            }
        }
        assert_shares(&entering(0.5, n, "off"), 0.0, 0.0);
    }
}

/// Brewster's angle atan(n): no parallel part, so that half of ((n^2 - 1) / (n^2 + 1))^2 is left.
#[test]
fn brewsters_angle_loses_the_parallel_part() {
    for n in [1.33f64, 1.5, 2.4] {
        let s = (n * n - 1.0) / (n * n + 1.0);
        assert_shares(
            &entering(libm::atan(n), n, "dielectric"),
            s * s / 2.0,
            32.0 * UNIT,
        );
    }
}

// ---- Generations and misses --------------------------------------------------------------------------------------------

/// Depth m sees m generations beyond the first hit: thin plates that emit 1, 1/2, 1/4 ... one behind the other, then the sky.
#[test]
fn depth_counts_generations() {
    let plates = 9;
    let mut rest = String::new();
    for j in 0..plates {
        let (e, z) = (libm::exp2(-f64::from(j)), -f64::from(j));
        rest += &format!(
            "[material.m{j}]\ncolor = 0\nemission = {e:?}\ntransmission = 1\nthin = true\n"
        );
        let name = format!("plate{j}");
        rest += &quad(
            &name,
            v(-1.0, -1.0, z),
            v(2.0, 0.0, 0.0),
            v(0.0, 2.0, 0.0),
            &format!("m{j}"),
        );
    }
    for depth in 0..plates + 2 {
        let ray = under_the_sky(v(0.1, 0.2, 3.0), v(0.0, 0.0, -1.0));
        let text = format!("{ray}[trace]\ndepth = {depth}\n{rest}");
        // 1 + 1/2 + ... over depth + 1 plates at most; the generation after the last plate is the sky's.
        let sum = 2.0 - libm::exp2(-f64::from(depth.min(plates - 1)));
        let sky = |c: usize| if depth >= plates { SKY[c] } else { 0.0 };
        assert_seen(&text, [0, 1, 2].map(|c| sum + sky(c)), 0.0);
    }
}

/// A miss returns the background: neither lit, nor shadowed, nor clamped, straight on or by a mirror (whitted.md 4).
#[test]
fn a_miss_shows_the_background_unlit() {
    let lights =
        "[light.lamp]\nposition = [0, 3, 0]\nambient = 0.5\n[light.sun]\ndirection = [0, -1, 0]\n";
    let ray =
        under_the_sky(v(0.0, 2.0, 2.0), v(0.5, -2.0, -2.0)).replace("ambient = 0", "ambient = 0.7");
    let shade = quad(
        "shade",
        v(-9.0, 8.0, -9.0),
        v(0.0, 0.0, 18.0),
        v(18.0, 0.0, 0.0),
        "mirror",
    );
    let stone = ball("stone", v(50.0, 0.0, 0.0), 1.0, "mirror");
    assert_seen(&format!("{ray}{lights}{MIRROR}{stone}"), SKY, 0.0);
    let half = MIRROR.replace("reflection = 1", "reflection = [0.5, 0.25, 1]");
    let floor = quad(
        "floor",
        v(-9.0, 0.0, -9.0),
        v(0.0, 0.0, 18.0),
        v(18.0, 0.0, 0.0),
        "mirror",
    );
    let expected = [0.5 * SKY[0], 0.25 * SKY[1], SKY[2]];
    assert_seen(&format!("{ray}{lights}{half}{floor}"), expected, 0.0);
    // The shade keeps the lights from everything and the sky from nothing: its other side is met only from above.
    let around = under_the_sky(v(0.0, 9.0, 2.0), v(0.5, 2.0, -2.0));
    assert_seen(&format!("{around}{lights}{MIRROR}{shade}"), SKY, 0.0);
}
