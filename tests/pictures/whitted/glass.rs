//! Refraction by one body: slab, ball, prism, and the critical angle on both sides.

use super::*;

/// The way of a ray in a plane layer: sin(r) = sin(i) / n (Snell).
fn inside(sin: f64, n: f64) -> f64 {
    libm::asin(sin / n)
}

/// Offset t sin(i) (1 - cos(i) / sqrt(n^2 - sin(i)^2)), towards the normal for n > 1; exit parallel to entry (whitted.md 5).
#[test]
fn a_slab_displaces_a_ray_and_keeps_its_direction() {
    let t = 1.75;
    for n in [1.0, 1.33, 1.5, 2.4, 0.95] {
        for degrees in [0.0f64, 5.0, 30.0, 60.0, 71.0, 85.0] {
            let (sin, cos) = libm::sincos(degrees.to_radians());
            let along = v(sin, 0.0, -cos);
            let offset = t * sin * (1.0 - cos / (n * n - sin * sin).sqrt());
            // Square to the ray, in the plane of incidence, on the normal's side.
            let aside = v(-cos, 0.0, -sin);
            if n < sin {
                continue; // Total at the first face.
            }
            let text = format!(
                "{}{}{}",
                one_ray(-3.0 * along, along),
                glass("glass", n),
                cuboid("slab", v(-30.0, -30.0, -t), v(30.0, 30.0, 0.0), "glass")
            );
            // Where the planes are met: 1 / cos on both sides of each.
            let cos_r = (1.0 - sin * sin / (n * n)).sqrt();
            let conditioning = 2.0 / (cos * cos).min(cos_r * cos_r);
            let both = [Geometry::Exact, Geometry::Mesh];
            assert_ray_on(&text, &both, offset * aside, along, [conditioning; 2]);
        }
    }
}

/// A plane through a ball's centre: rays at distance b from it, `u` aside, going along `w`.
struct Meridian {
    center: DVec3,
    u: DVec3,
    w: DVec3,
}

const MERIDIAN: Meridian = Meridian {
    center: DVec3::new(0.5, -0.25, 0.125),
    u: DVec3::new(0.48, 0.6, -0.64),
    w: DVec3::new(0.8, 0.0, 0.6),
};

impl Meridian {
    fn incoming(&self, b: f64) -> String {
        one_ray(self.center + b * self.u - 5.0 * self.w, self.w)
    }

    /// The line at distance b from the centre, turned towards the axis by an angle: a point of it, and its direction.
    fn turned(&self, b: f64, angle: f64) -> (DVec3, DVec3) {
        let (sin, cos) = libm::sincos(angle);
        let foot = self.center + b * (cos * self.u + sin * self.w);
        (foot, cos * self.w - sin * self.u)
    }
}

/// Snell on the sphere: sin(i) = b / R, sin(r) = b / (n R); each interface turns the ray by i - r, and the chord makes the
/// same angle with both radii, so it leaves at distance b from the centre, turned by 2 (i - r).
#[test]
fn a_ball_turns_marginal_rays_by_twice_i_minus_r() {
    let radius = 1.5;
    for n in [1.33, 1.5, 2.4] {
        for b in [0.0, 1e-3, 0.2, 0.9, 1.3, 1.49] {
            let (sin_i, sin_r) = (b / radius, b / (n * radius));
            let turn = 2.0 * (libm::asin(sin_i) - libm::asin(sin_r));
            let (foot, along) = MERIDIAN.turned(b, turn);
            let text = format!(
                "{}{}{}",
                MERIDIAN.incoming(b),
                glass("glass", n),
                ball("lens", MERIDIAN.center, radius, "glass")
            );
            // d i / d b = 1 / (R cos(i)), on both sides.
            assert_ray(&text, foot, along, 4.0 / (1.0 - sin_i * sin_i).sqrt());
        }
    }
}

/// The paraxial effective focal length n D / (4 (n - 1)), from the centre, and how it falls with b.
///
/// The ray crosses the axis at b / sin(2 (i - r)) from the centre. With x = b / R, a = 1 - 1/n, c = 1 - 1/n^3:
/// 2 (i - r) = 2 a x + c x^3 / 3 + O(x^5), so that b / sin = R / (2 a) (1 - x^2 (c - 4 a^3) / (6 a) + O(x^4)), and
/// R / (2 a) = n D / (4 (n - 1)).
#[test]
fn a_ball_lens_focuses_where_it_should() {
    let radius = 1.25;
    for n in [1.33, 1.5, 1.9, 2.4] {
        let focal = n * 2.0 * radius / (4.0 * (n - 1.0));
        let (a, c) = (1.0 - 1.0 / n, 1.0 - 1.0 / (n * n * n));
        for x in [0.01, 0.03] {
            let expected = focal * (1.0 - x * x * (c - 4.0 * a * a * a) / (6.0 * a));
            for k in SCALES {
                let landing = ROOMS.map(|half| {
                    let text = format!(
                        "{}{}{}{}",
                        MERIDIAN.incoming(x * radius),
                        glass("glass", n),
                        ball("lens", MERIDIAN.center, radius, "glass"),
                        room(half)
                    );
                    let p = seen(&text, k) - MERIDIAN.center;
                    [p.dot(MERIDIAN.w), p.dot(MERIDIAN.u)]
                });
                // Where the line through both landings crosses the axis.
                let [[w0, u0], [w1, u1]] = landing;
                let crossing = w0 - u0 * (w1 - w0) / (u1 - u0);
                let off = (crossing / expected - 1.0).abs();
                // The next term, whose factor is below 2 for these n; landings over the slope 2 a x.
                let tolerance = 2.0 * x * x * x * x + 1e-13 / x;
                assert!(
                    off <= tolerance,
                    "n {n}, x {x}, scale {k}: {crossing} {expected} {off:e}"
                );
            }
        }
    }
}

/// A prism with apex angle A, its edge along y: sin(r1) = sin(i1) / n, r2 = A - r1, sin(i2) = n sin(r2), and the ray is
/// deviated by i1 + i2 - A; least where it crosses symmetrically: sin((A + D) / 2) = n sin(A / 2).
#[test]
fn a_prism_deviates_least_where_the_ray_crosses_it_symmetrically() {
    for (n, apex_deg) in [(1.5f64, 60.0f64), (1.33, 45.0), (1.7, 50.0)] {
        let apex = apex_deg.to_radians();
        let least = 2.0 * libm::asin(n * libm::sin(apex / 2.0)) - apex;
        let symmetric = (apex + least) / 2.0;
        let mut deviations = Vec::new();
        for i1 in [symmetric, symmetric - 0.1, symmetric + 0.2] {
            let r1 = inside(libm::sin(i1), n);
            let i2 = libm::asin(n * libm::sin(apex - r1));
            let deviation = i1 + i2 - apex;
            deviations.push(deviation);
            // Faces x = -+ z tan(A/2) from the apex at z = 0 down to z = -8; the first face's outward normal.
            let (sin, cos) = libm::sincos(apex / 2.0);
            let (left, right) = (v(-sin, 0.0, -cos), v(sin, 0.0, -cos));
            let normal = v(-cos, 0.0, sin);
            let turn = |d: DVec3, angle: f64| {
                let (s, c) = libm::sincos(angle);
                v(c * d.x + s * d.z, 0.0, c * d.z - s * d.x)
            };
            // It enters 2 below the apex along the face: from below, so that it turns towards the base.
            let entry = 2.0 * left;
            let along = turn(-normal, -i1);
            let within = turn(-normal, -r1);
            // Where it meets the other face: entry + s within = q right.
            let q = (entry.x * within.z - entry.z * within.x)
                / (right.x * within.z - right.z * within.x);
            let out = turn(along, deviation);
            let positions: Vec<DVec3> = [-4.0, 4.0]
                .iter()
                .flat_map(|y| [DVec3::ZERO, 8.0 * left, 8.0 * right].map(|p| p + v(0.0, *y, 0.0)))
                .collect();
            let faces = "[[0, 2, 1], [3, 4, 5], [0, 1, 4, 3], [1, 2, 5, 4], [2, 0, 3, 5]]";
            let text = format!(
                "{}{}{}",
                one_ray(entry - 3.0 * along, along),
                glass("glass", n),
                mesh("prism", &positions, faces, "glass")
            );
            let conditioning = 4.0 / (libm::cos(i1) * libm::cos(i2));
            let both = [Geometry::Exact, Geometry::Mesh];
            assert_ray_on(
                &text,
                &both,
                q * right,
                out,
                [conditioning, 2.0 * conditioning],
            );
        }
        assert!((deviations[0] - least).abs() < 1e-14);
        assert!(deviations[1..].iter().all(|d| *d > least));
    }
}

/// A ball of index n with a bubble, a box of air whose face z = 0 goes through the ball's centre. A ray aimed at the centre
/// enters the ball square to it, so that it meets the face from within the glass under exactly its own angle.
fn half_ball(i: f64, n: f64, tir: &str) -> String {
    let (sin, cos) = libm::sincos(i);
    let along = v(-sin, 0.0, -cos);
    format!(
        "{}[trace]\ntir = \"{tir}\"\n{}{}{}{}",
        one_ray(-5.0 * along, along),
        glass("glass", n),
        glass("air", 1.0),
        ball("ball", DVec3::ZERO, 2.0, "glass"),
        cuboid("bubble", v(-1.0, -1.0, -1.0), v(1.0, 1.0, 0.0), "air"),
    )
}

/// A ray that gets into the bubble, even along its face, ends on a bright wall inside.
const BRIGHT: &str = "[material.bright]\ncolor = 0\nemission = 1\n[object.end]\nshape = \"box\"\n\
                      min = [-0.95, -0.9, -0.9]\nmax = [-0.9, 0.9, 0]\nmaterial = \"bright\"\n";

/// The sheet's critical angles, decided within 8 units in the last place of the angle.
#[test]
fn total_internal_reflection_starts_at_the_critical_angle() {
    for (n, degrees) in [(1.33f64, 48.7535f64), (1.5, 41.8103), (2.4, 24.6243)] {
        let critical = libm::asin(1.0 / n);
        assert!((critical.to_degrees() - degrees).abs() < 5e-5);
        for step in [1e-15, 1e-12, 1e-6, 0.01] {
            let below = format!("{}{BRIGHT}", half_ball(critical - step, n, "none"));
            assert_seen(&below, [1.0; 3], 0.0);
            let above = format!("{}{BRIGHT}", half_ball(critical + step, n, "none"));
            assert_seen(&above, [0.0; 3], 0.0);
        }
    }
}

/// Total reflection as a mirror: the ray leaves the ball square to it, on the other side.
#[test]
fn a_totally_reflected_ray_is_mirrored() {
    for (n, step) in [(1.33, 1e-12), (1.5, 0.1), (2.4, 0.5)] {
        let i = libm::asin(1.0 / n) + step;
        let (sin, cos) = libm::sincos(i);
        assert_ray(
            &half_ball(i, n, "reflect"),
            DVec3::ZERO,
            v(-sin, 0.0, cos),
            4.0,
        );
    }
}

/// Right-angled, n > sqrt(2): square in, totally reflected at 45 degrees, square out, turned by 90 degrees.
#[test]
fn a_porro_prism_turns_a_ray_by_a_right_angle() {
    let corners = [v(0.0, 0.0, 0.0), v(4.0, 0.0, 0.0), v(0.0, 0.0, 4.0)];
    let positions: Vec<DVec3> = [-2.0, 2.0]
        .iter()
        .flat_map(|y| corners.map(|p| p + v(0.0, *y, 0.0)))
        .collect();
    let prism = mesh(
        "prism",
        &positions,
        "[[0, 1, 2], [3, 5, 4], [0, 3, 4, 1], [1, 4, 5, 2], [2, 5, 3, 0]]",
        "glass",
    );
    let text = format!(
        "{}[trace]\ntir = \"reflect\"\n{}{prism}",
        one_ray(v(1.5, 0.25, -2.0), v(0.0, 0.0, 1.0)),
        glass("glass", 1.5)
    );
    // Into the leg z = 0, off the long side x + z = 4 at (1.5, 2.5), out of the leg x = 0.
    let both = [Geometry::Exact, Geometry::Mesh];
    assert_ray_on(&text, &both, v(0.0, 0.25, 2.5), v(-1.0, 0.0, 0.0), [4.0; 2]);
}

/// Water with a mirror in it, tilted by a / 2: a ray straight down comes up under the angle a and leaves under
/// asin(n sin(a)), at D tan(a) from where it went in.
fn pool(a: f64, depth: f64) -> String {
    let (sin, cos) = libm::sincos(a / 2.0);
    // The mirror's own plane, square to (sin, cos).
    let (u, w) = (v(0.0, 0.0, 2.0), v(2.0 * cos, -2.0 * sin, 0.0));
    format!(
        "{}{}{MIRROR}{}{}",
        one_ray(v(0.0, 3.0, 0.0), v(0.0, -1.0, 0.0)),
        glass("water", 1.33),
        cuboid("water", v(-19.0, -15.0, -19.0), v(19.0, 0.0, 19.0), "water"),
        quad(
            "mirror",
            v(0.0, -depth, 0.0) - (u + w) / 2.0,
            u,
            w,
            "mirror"
        ),
    )
}

/// Snell's window: from under water the whole sky is inside a cone of half angle asin(1 / n), and beyond it the surface
/// reflects.
#[test]
fn the_sky_is_in_snells_window() {
    let (n, depth) = (1.33, 2.0);
    let window = libm::asin(1.0 / n);
    for a in [0.0, 0.2, 0.5, 0.8, window - 1e-4] {
        let sin_out = n * libm::sin(a);
        let cos_out = (1.0 - sin_out * sin_out).sqrt();
        let from = v(depth * libm::tan(a), 0.0, 0.0);
        let out = v(sin_out, cos_out, 0.0);
        // d out / d a = n cos(a) / cos(out).
        assert_ray(&pool(a, depth), from, out, 8.0 / cos_out);
    }
    for step in [1e-14, 1e-9, 0.1] {
        let sky = "[image]\nbackground = 1\n";
        let pool = |a| pool(a, depth).replace("[image]\n", sky);
        assert_seen(&pool(window - step), [1.0; 3], 0.0);
        assert_seen(&pool(window + step), [0.0; 3], 0.0);
    }
}

/// From above, a pool's floor under grazing light: no ray from the air, however flat, goes steeper than the window's edge.
#[test]
fn apparent_depth_is_snells() {
    let (n, depth) = (1.33f64, 4.0);
    for degrees in [0.0f64, 10.0, 45.0, 80.0, 89.0] {
        let (sin, cos) = libm::sincos(degrees.to_radians());
        let along = v(sin, -cos, 0.0);
        let r = inside(sin, n);
        let landed = v(depth * libm::tan(r), -depth, 0.0);
        let text = format!(
            "{}{}{}[material.map]\ncolor = 0\ncolor_material = {{ mode = \"emission\" }}\n{}\
             colors = [[-9, -4, -9], [9, -4, -9], [9, -4, 9], [-9, -4, 9]]\n",
            one_ray(-2.0 * along, along),
            glass("water", n),
            cuboid("water", v(-19.0, -15.0, -19.0), v(19.0, 0.0, 19.0), "water"),
            mesh(
                "floor",
                &[
                    v(-9.0, -4.0, -9.0),
                    v(9.0, -4.0, -9.0),
                    v(9.0, -4.0, 9.0),
                    v(-9.0, -4.0, 9.0)
                ],
                "[[0, 1, 2, 3]]",
                "map"
            )
        );
        for k in SCALES {
            let off = (seen(&text, k) - landed).length();
            assert!(
                off < 9.0 * LANDING / cos,
                "{degrees} degrees, scale {k}: {off:e}"
            );
            assert!(landed.x < depth / (n * n - 1.0).sqrt());
        }
    }
}
