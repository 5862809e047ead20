//! Several media: the list rule. Crossing the surface of an object removes it from the list of media if it is there, else
//! appends it; the index before, and after, is that of the last in the list (whitted.md 2).

use super::*;
use rastray::math::DMat3;

/// A ball of radius R with a ball of radius `inner` about the same centre in it. A ray at distance b from the centre keeps
/// n rho sin = b at every interface (Snell on concentric spheres: Bouguer's law), so it leaves at distance b, turned by twice
/// the sum of i - r.
fn nested_turn(b: f64, radius: f64, n: f64, inner: f64, n_inner: f64) -> f64 {
    let at = |n: f64, rho: f64| libm::asin(b / (n * rho));
    let shell = at(1.0, radius) - at(n, radius);
    if b / n >= inner {
        return 2.0 * shell; // It passes the inner ball by.
    }
    2.0 * (shell + at(n, inner) - at(n_inner, inner))
}

#[test]
fn a_ball_within_a_ball_turns_rays_by_bouguers_law() {
    let (radius, inner) = (1.5, 0.9);
    let (center, u, w) = (v(0.5, -0.25, 0.125), v(0.48, 0.6, -0.64), v(0.8, 0.0, 0.6));
    for (n, n_inner) in [
        (1.5, 1.0),  // hollow
        (1.5, 1.5),  // the inner ball cannot be seen
        (1.0, 1.0),  // straight through
        (1.33, 2.4), // denser inside
        (2.4, 1.33), // less dense inside
    ] {
        for b in [0.0, 0.1, 0.5, 0.85, 1.45] {
            if b / n < inner && b / n_inner > inner {
                continue; // Total at the inner ball.
            }
            let (sin, cos) = libm::sincos(nested_turn(b, radius, n, inner, n_inner));
            let text = format!(
                "{}{}{}{}{}",
                one_ray(center + b * u - 5.0 * w, w),
                glass("glass", n),
                glass("core", n_inner),
                ball("shell", center, radius, "glass"),
                ball("bubble", center, inner, "core")
            );
            let grazing = |x: f64| 1.0 / (1.0 - (x * x).min(0.999)).sqrt();
            let conditioning = grazing(b / radius) * grazing(b / n_inner.min(n) / inner);
            let foot = center + b * (cos * u + sin * w);
            assert_ray(&text, foot, cos * w - sin * u, 16.0 * conditioning);
        }
    }
}

/// Plane layers: the ray leaves parallel, moved along x by the sum of t tan(r), where sin(r) = sin(i) / n in each.
fn layered(order: &[String], i: f64, layers: &[(f64, f64)]) {
    let (sin, cos) = libm::sincos(i);
    let along = v(sin, 0.0, -cos);
    let way = |(t, n): &(f64, f64)| t * libm::tan(libm::asin(sin / n));
    let x: f64 = layers.iter().map(way).sum();
    let depth: f64 = layers.iter().map(|l| l.0).sum();
    let text = format!(
        "{}{}{}{}",
        one_ray(-3.0 * along, along),
        glass("flint", 1.7),
        glass("water", 1.33),
        order.concat()
    );
    let both = [Geometry::Exact, Geometry::Mesh];
    assert_ray_on(
        &text,
        &both,
        v(x, 0.0, -depth),
        along,
        [4.0 / (cos * cos); 2],
    );
}

fn layer(name: &str, top: f64, bottom: f64, material: &str) -> String {
    cuboid(name, v(-15.0, -15.0, bottom), v(15.0, 15.0, top), material)
}

/// Where two solids overlap, the one entered last counts.
#[test]
fn overlapping_media_are_the_one_entered_last() {
    let a = |top: f64| layer("a", top, top - 2.0, "flint");
    let b = |top: f64| layer("b", top, top - 2.0, "water");
    for i in [0.0, 0.4, 1.0] {
        // Flint 0 to -2, water -1.5 to -3.5: the overlap is water's; turned over, it is flint's.
        let first = [(1.5, 1.7), (2.0, 1.33)];
        layered(&[a(0.0), b(-1.5)], i, &first);
        layered(&[b(-1.5), a(0.0)], i, &first);
        layered(&[b(0.0), a(-1.5)], i, &[(1.5, 1.33), (2.0, 1.7)]);
    }
}

/// Two solids that share a face: neither is lost, whichever the file names first.
#[test]
fn touching_media_lose_no_face() {
    let (a, b) = (
        layer("a", 0.0, -1.3, "flint"),
        layer("b", -1.3, -2.1, "water"),
    );
    let c = layer("c", -2.1, -3.2, "flint");
    for i in [0.0, 0.4, 1.0] {
        let two = [(1.3, 1.7), (0.8, 1.33)];
        layered(&[a.clone(), b.clone()], i, &two);
        layered(&[b.clone(), a.clone()], i, &two);
        let three = [(1.3, 1.7), (0.8, 1.33), (1.1, 1.7)];
        layered(&[a.clone(), b.clone(), c.clone()], i, &three);
        layered(&[c.clone(), b.clone(), a.clone()], i, &three);
    }
}

/// The same, turned about a skew axis and moved: the two faces are one plane to within rounding only.
#[test]
fn touching_media_lose_no_face_at_any_slant() {
    let (axis, degrees) = (v(1.0, 2.0, -1.5), 40.0f64);
    let turn = DMat3::from_axis_angle(axis.normalize(), degrees.to_radians());
    let place = format!(
        "transform = [{{ rotate = {{ axis = {}, degrees = {degrees:?} }} }}]\n",
        list(axis)
    );
    let (sin, cos) = libm::sincos(0.6);
    let along = v(sin, 0.0, -cos);
    for (t_a, t_b) in [(1.3, 0.8), (0.1, 2.0), (0.7, 0.3)] {
        let a = layer("a", 0.0, -t_a, "flint") + &place;
        let b = layer("b", -t_a, -t_a - t_b, "water") + &place;
        let way = |t: f64, n: f64| t * libm::tan(libm::asin(sin / n));
        let exit = v(way(t_a, 1.7) + way(t_b, 1.33), 0.0, -t_a - t_b);
        for order in [[&a, &b], [&b, &a]] {
            let text = format!(
                "{}{}{}{}{}",
                one_ray(turn * (-3.0 * along), turn * along),
                glass("flint", 1.7),
                glass("water", 1.33),
                order[0],
                order[1]
            );
            let both = [Geometry::Exact, Geometry::Mesh];
            // Meshes' vertices are f32 there: faces 1e-6 apart may leave a gap or an overlap, of no consequence.
            assert_ray_on(&text, &both, turn * exit, turn * along, [8.0; 2]);
        }
    }
}

/// A glass block on an opaque floor, face on face: the floor is seen through it, whichever comes first in the file.
#[test]
fn glass_on_a_floor_shows_the_floor() {
    let floor = quad(
        "floor",
        v(-9.0, 0.0, -9.0),
        v(0.0, 0.0, 18.0),
        v(18.0, 0.0, 0.0),
        "bright",
    );
    let block = cuboid("block", v(-2.0, 0.0, -2.0), v(2.0, 1.0, 2.0), "glass");
    for order in [[&floor, &block], [&block, &floor]] {
        let text = format!(
            "{}{}[material.bright]\ncolor = 0\nemission = [0.25, 0.5, 0.75]\n{}{}",
            one_ray(v(0.3, 4.0, 0.2), v(0.1, -1.0, 0.05)),
            glass("glass", 1.5),
            order[0],
            order[1]
        );
        assert_seen(&text, [0.25, 0.5, 0.75], 0.0);
    }
}

/// Thin surfaces: straight on, no index; and inside a solid they change nothing.
#[test]
fn thin_surfaces_pass_straight_on_and_enter_nothing() {
    let thin = "[material.thin]\ncolor = 0\ntransmission = 1\nior = 2\nthin = true\n";
    let (eye, along) = (v(-2.0, 0.5, 3.0), v(0.55, -0.2, -1.0));
    let text = format!(
        "{}{thin}{}{}",
        one_ray(eye, along),
        ball("bubble", DVec3::ZERO, 0.8, "thin"),
        quad(
            "pane",
            v(-9.0, -9.0, -1.0),
            v(18.0, 0.0, 0.0),
            v(0.0, 18.0, 0.0),
            "thin"
        )
    );
    assert_ray(&text, eye, along, 4.0);
    let sheet = quad(
        "pane",
        v(-9.0, -9.0, -1.0),
        v(18.0, 0.0, 0.0),
        v(0.0, 18.0, 0.0),
        "thin",
    );
    let text = [thin.to_owned(), sheet, layer("a", 0.0, -2.0, "flint")];
    layered(&text, 0.7, &[(2.0, 1.7)]);
}

/// Inside a transmissive solid the normal faces the ray (whitted.md 1): a lamp in a clear box lights its far side from
/// within, and a lamp behind that side does not.
#[test]
fn inside_a_solid_the_normal_faces_the_ray() {
    let (eye, point) = (v(0.3, 0.2, 5.0), v(0.3, 0.2, -1.0));
    for (lamp, lit) in [(v(0.0, 0.0, 0.5), true), (v(0.0, 0.0, -2.0), false)] {
        let to_light = lamp - point;
        let cosine = to_light.z / to_light.length();
        // K_D (N.L) at the far side, through the near one (K_T = 1), whose own N.L towards the lamp is below 0.
        let expected = if lit { 0.8 * cosine } else { 0.0 };
        let text = format!(
            "{}[light.lamp]\nposition = {}\n\
             [material.clear]\ncolor = 0.8\ntransmission = 1\n{}",
            one_ray(eye, v(0.0, 0.0, -1.0)),
            list(lamp),
            cuboid("box", v(-1.0, -1.0, -1.0), v(1.0, 1.0, 1.0), "clear")
        );
        assert_seen(&text, [expected; 3], 8.0 * UNIT);
    }
}
