//! Surfaces of revolution: closed forms, one owner for every crossing, an independent scan, meshes, and bad profiles.

use rastray::gl;
use rastray::math::{DAffine3, DMat3, DVec2, DVec3};
use rastray::scene::profile::{Curve, MAX_POINTS, Piece, Profile};
use rastray::scene::round::Frame;
use rastray::scene::tessellate::{tessellate, triangle_count};
use rastray::scene::{Geometry as Form, Material, Object, Optics, Scene, Shape, fit};
use rastray::trace::Geometry;
use rastray::trace::bvh::Walker;
use rastray::trace::ray::{NO_ITEM, Ray};
use std::collections::HashMap;
use std::sync::Arc;

use crate::common::precise::{assembled, surfaces, tracer};
use crate::common::random::Random;

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

fn turned(base: DVec3, axis: DVec3, curve: Curve, points: &[[f64; 2]]) -> Shape {
    let profile = Arc::new(Profile::new(curve, points).unwrap());
    Shape::Revolution {
        base,
        axis,
        profile,
    }
}

fn parts(shape: &Shape) -> (DVec3, DVec3, &Profile) {
    match shape {
        Shape::Revolution {
            base,
            axis,
            profile,
        } => (*base, axis.normalize(), profile),
        _ => panic!("a surface of revolution"),
    }
}

fn scene_of(shape: &Shape, place: DAffine3) -> Scene {
    let mut scene = Scene::default();
    scene.materials.push(Material {
        name: "m".into(),
        front: gl::Material::default(),
        back: None,
        optics: Optics::default(),
    });
    scene.objects.push(Object {
        priority: 0,
        name: "o".into(),
        geometry: Form::Shape(shape.clone()),
        materials: vec![0],
        world_from_object: place,
        tessellation: Some(3),
    });
    scene
}

/// What a ray meets: t, from behind, point, normal.
type Met = (f64, bool, DVec3, DVec3);

fn with_rays<T>(
    shape: &Shape,
    place: DAffine3,
    work: impl FnOnce(&mut dyn FnMut(DVec3, DVec3) -> Vec<Met>) -> T,
) -> T {
    let scene = scene_of(shape, place);
    let assembly = assembled::<f64>(&scene, None).unwrap();
    let plan = tracer(&scene, &assembly, Geometry::Exact).unwrap();
    let mut walker = Walker::default();
    work(&mut |o, d| {
        let ray = Ray::new(o, d);
        let surfaces = surfaces::<f64>(&plan);
        let found = surfaces.crossings(&ray, &mut walker, |_| true).unwrap();
        let first = surfaces.closest_hit_of_all(&ray);
        assert_eq!(surfaces.closest_hit(&ray, &mut walker), first);
        assert_eq!(found.first().map(|h| h.t), first.map(|h| h.t));
        let met = |hit| {
            let foot = surfaces.site(&ray, hit, None).foot;
            (hit.t, hit.back, foot.point, foot.normal)
        };
        found.iter().map(met).collect()
    })
}

const PAWN: &[[f64; 2]] = &[
    [0.0, -0.5],
    [0.875, -0.5],
    [0.875, -0.25],
    [0.5, 0.0],
    [0.25, 1.0],
    [0.5, 1.125],
    [0.25, 1.25],
    [0.5, 1.5],
    [0.0, 1.875],
];
const BOTTLE: &[[f64; 2]] = &[
    [0.0, 0.0],
    [0.5, 0.0],
    [0.5, 0.0],
    [0.75, 0.5],
    [0.25, 1.25],
    [0.375, 1.75],
    [0.0, 2.0],
];
const RING: &[[f64; 2]] = &[
    [1.0, 0.0],
    [0.75, 0.5],
    [0.5, 0.25],
    [0.625, 0.0],
    [0.5, -0.375],
    [1.0, 0.0],
];
/// Two halves of a lens with an S in its rim.
const LENS: &[[f64; 2]] = &[
    [0.0, -0.5],
    [0.5, -0.5],
    [1.25, -0.5],
    [1.0, 0.0],
    [0.75, 0.5],
    [1.5, 0.75],
    [0.0, 0.5],
];

/// Solids and a point well inside each.
fn solids() -> Vec<(Shape, DVec3)> {
    solids_times(1.0)
}

/// The same, so many times as large.
fn solids_times(k: f64) -> Vec<(Shape, DVec3)> {
    let turned = |base: DVec3, axis, curve, points: &[[f64; 2]]| {
        let points: Vec<_> = points.iter().map(|p| p.map(|x| k * x)).collect();
        turned(k * base, axis, curve, &points)
    };
    let (base, axis) = (v(0.25, -0.5, 0.125), v(-0.25, 1.5, 0.5));
    let n = axis.normalize();
    let across = n.any_orthonormal_vector();
    vec![
        (
            turned(base, axis, Curve::Polyline, PAWN),
            base + 0.375 * n + 0.0625 * across,
        ),
        (
            turned(DVec3::ZERO, DVec3::Y, Curve::Polyline, PAWN),
            v(0.125, 0.25, 0.0),
        ),
        (
            turned(base, axis, Curve::Smooth, BOTTLE),
            base + 0.5 * n + 0.125 * across,
        ),
        (
            turned(DVec3::ZERO, DVec3::Z, Curve::Smooth, BOTTLE),
            v(0.0, 0.25, 0.5),
        ),
        (
            turned(base, axis, Curve::Smooth, RING),
            base + 0.75 * across,
        ),
        (
            turned(DVec3::ZERO, DVec3::Y, Curve::Polyline, RING),
            v(0.0, 0.0, 0.75),
        ),
        (
            turned(DVec3::ZERO, DVec3::NEG_Y, Curve::Bezier, LENS),
            v(0.25, 0.0, 0.125),
        ),
    ]
}

fn places() -> Vec<DAffine3> {
    let skew = DMat3::from_cols(v(1.0, 0.25, 0.0), v(-0.5, 2.0, 0.125), v(0.0, 0.5, 0.75));
    let at = v(3.0, -1.0, 2.0);
    vec![
        DAffine3::IDENTITY,
        DAffine3::from_translation(at),
        DAffine3::from_mat3_translation(skew, at),
        DAffine3::from_mat3_translation(skew, at) * DAffine3::from_scale(v(1.0, -1.0, 1.0)),
    ]
}

/// Points of the circles where pieces meet, of poles and creases.
fn landmarks(shape: &Shape) -> Vec<DVec3> {
    let (base, n, profile) = parts(shape);
    let u = n.any_orthonormal_vector();
    let w = n.cross(u);
    let mut marks = Vec::new();
    for piece in profile.pieces() {
        let p = piece.at(0.0);
        for i in 0..8 {
            let (s, k) = libm::sincos(f64::from(i) * 0.875);
            marks.push(base + p.y * n + p.x * (k * u + s * w));
        }
    }
    marks
}

#[test]
fn straight_profiles_are_cylinders_cones_and_tubes() {
    let (base, top) = (v(0.25, -0.5, 0.125), v(-0.25, 1.5, 0.5));
    let (axis, radius) = (top - base, 0.75);
    let h = axis.length();
    let (caps, cap, apex) = (true, true, top);
    let tube = |caps| Shape::Cylinder {
        base,
        top,
        radius,
        caps,
    };
    let cone = Shape::Cone {
        base,
        apex,
        radius,
        cap,
    };
    let with = |points: &[[f64; 2]]| turned(base, axis, Curve::Polyline, points);
    let pairs = [
        (
            tube(caps),
            with(&[[0.0, 0.0], [0.75, 0.0], [0.75, h], [0.0, h]]),
        ),
        // Told the other way round, it is the same solid.
        (
            tube(caps),
            with(&[[0.0, h], [0.75, h], [0.75, 0.0], [0.0, 0.0]]),
        ),
        (tube(false), with(&[[0.75, 0.0], [0.75, h]])),
        (cone, with(&[[0.0, 0.0], [0.75, 0.0], [0.0, h]])),
    ];
    let mut random = Random(1);
    let mut judged = 0;
    for (known, shape) in pairs {
        for place in places() {
            let center = place.transform_point3(base.lerp(top, 0.5));
            let rays: Vec<_> = (0..600)
                .map(|_| {
                    let o = center + 6.0 * random.direction();
                    (o, center + 1.5 * random.vector() - o)
                })
                .collect();
            let all = |shape: &Shape| {
                with_rays(shape, place, |met| {
                    rays.iter().map(|(o, d)| met(*o, *d)).collect::<Vec<_>>()
                })
            };
            for ((a, b), (_, d)) in all(&known).iter().zip(all(&shape)).zip(&rays) {
                assert_eq!(a.len(), b.len(), "{shape:?}");
                for (a, b) in a.iter().zip(&b) {
                    judged += 1;
                    assert_eq!(a.1, b.1);
                    // A rounded height of the axis counts as much more as the ray is slanted.
                    let room = 8.0 * f64::EPSILON / a.3.dot(*d / d.length()).abs();
                    assert!((a.0 - b.0).abs() <= room, "{} {} {room}", a.0, b.0);
                    assert!((a.2 - b.2).length() < 8.0 * room, "{} {} {room}", a.2, b.2);
                    // Near a tip the way off the axis is short, and its direction as much coarser.
                    assert!((a.3 - b.3).length() < 1e-12, "{} {}", a.3, b.3);
                }
            }
        }
    }
    assert!(judged > 5000, "{judged}");
}

#[test]
fn a_bezier_circle_is_a_torus_to_three_parts_in_ten_thousand() {
    // A quarter circle's best known cubic: control points 0.5523 of the radius along, out by at most 2.73e-4 of it.
    let (major, minor) = (1.0, 0.5);
    let k = 0.552_284_749_830_793_6 * minor;
    let quarter = [[minor, 0.0], [minor, k], [k, minor], [0.0, minor]];
    let mut points = Vec::new();
    for turn in 0..4 {
        for [x, y] in &quarter[..3] {
            let [x, y] = match turn {
                0 => [*x, *y],
                1 => [-y, *x],
                2 => [-x, -y],
                _ => [*y, -x],
            };
            points.push([major + x, y]);
        }
    }
    points.push(points[0]);
    let shape = turned(DVec3::ZERO, DVec3::Y, Curve::Bezier, &points);
    assert!(parts(&shape).2.is_closed());
    assert_eq!(parts(&shape).2.pieces().len(), 4);
    let torus = Shape::Torus {
        center: DVec3::ZERO,
        axis: DVec3::Y,
        major,
        minor,
    };
    let mut random = Random(2);
    let mut counts = [0; 5];
    with_rays(&shape, DAffine3::IDENTITY, |ours| {
        with_rays(&torus, DAffine3::IDENTITY, |theirs| {
            for _ in 0..2000 {
                let o = 4.0 * random.direction();
                let d = (random.vector() * v(1.4, 0.4, 1.4) - o).normalize();
                let (a, b) = (ours(o, d), theirs(o, d));
                // Out by 2.73e-4 r along the normal: crossings at a slant of more than 1 : 4 differ by four times that.
                let slant = b.iter().map(|m| m.3.dot(d).abs()).fold(1.0, f64::min);
                if slant < 0.25 {
                    continue;
                }
                assert_eq!(a.len(), b.len());
                counts[a.len()] += 1;
                for (a, b) in a.iter().zip(&b) {
                    assert_eq!(a.1, b.1);
                    assert!((a.0 - b.0).abs() < 2.8e-4 * minor / slant, "{a:?} {b:?}");
                    assert!((a.3 - b.3).length() < 4e-3 / slant, "{a:?} {b:?}");
                }
            }
        });
    });
    assert!(counts[2] > 500 && counts[4] > 50, "{counts:?}");
}

#[test]
fn solids_do_not_leak_and_every_crossing_has_one_owner() {
    let mut random = Random(3);
    for (shape, inside) in solids() {
        let (base, n, _) = parts(&shape);
        for place in places() {
            let marks = landmarks(&shape);
            let inside = place.transform_point3(inside);
            let axis = place.transform_vector3(n);
            let on_axis = place.transform_point3(base);
            with_rays(&shape, place, |met| {
                let mut balance = |o: DVec3, d: DVec3| {
                    let found = met(o, d);
                    let sides: i32 = found.iter().map(|m| if m.1 { -1 } else { 1 }).sum();
                    (sides, found.len())
                };
                for i in 0..400 {
                    let mark = place.transform_point3(marks[i % marks.len()]);
                    let aimed = if i % 3 == 0 {
                        random.direction()
                    } else {
                        mark - inside
                    };
                    assert_eq!(balance(inside, aimed).0, -1, "{shape:?} {aimed}");
                    let outside = inside + 20.0 * random.direction();
                    assert_eq!(balance(outside, mark - outside).0, 0, "{shape:?} {outside}");
                    let (sides, count) = balance(outside, inside - outside);
                    assert!(sides == 0 && count >= 2, "{shape:?} {outside}");
                    // Along the axis, in it, across it at a mark's height, and by less than f64 off that.
                    let along = [axis, -axis][i % 2];
                    assert_eq!(balance(mark - 16.0 * along, along).0, 0);
                    assert_eq!(balance(on_axis - 16.0 * along, along).0, 0);
                    let level = axis.cross(random.direction()).normalize();
                    let tilt = [0.0, 1e-300, 1e-40, 1e-20, 1e-17, 1e-12, 1e-8][i % 7];
                    for d in [level + tilt * axis, level - tilt * axis] {
                        let (sides, count) = balance(mark - 16.0 * d, d);
                        assert_eq!(sides, 0, "{shape:?} {mark} {d} {count}");
                        let (sides, count) = balance(inside - 16.0 * d, d);
                        assert!(sides == 0 && count >= 2, "{shape:?} {d} {count}");
                    }
                    // In the plane of the axis.
                    let d = (on_axis + random.next() * axis - mark).normalize_or(along);
                    assert_eq!(balance(mark - 16.0 * d, d).0, 0);
                }
            });
        }
    }
}

#[test]
fn rays_across_the_axis_meet_what_is_at_their_height() {
    // Radius 1 + y on the piece from (1, 0) to (2, 1), and the flat top at y = 1.
    let cup = &[[0.0, 0.0], [1.0, 0.0], [2.0, 1.0], [0.0, 1.0]];
    let shape = turned(DVec3::ZERO, DVec3::Y, Curve::Polyline, cup);
    with_rays(&shape, DAffine3::IDENTITY, |met| {
        for y in [0.25, 0.5, 0.875] {
            for x in [0.0, 0.5, 1.0] {
                for tilt in [0.0, 1e-30, -1e-30, 1e-18, -1e-18] {
                    let found = met(v(x, y, -8.0), v(0.0, tilt, 1.0));
                    let half = ((1.0 + y) * (1.0 + y) - x * x).sqrt();
                    let t: Vec<_> = found.iter().map(|m| (m.0, m.1)).collect();
                    assert_eq!(t.len(), 2);
                    assert!((t[0].0 - (8.0 - half)).abs() < 2e-15 && !t[0].1, "{t:?}");
                    assert!((t[1].0 - (8.0 + half)).abs() < 4e-15 && t[1].1, "{t:?}");
                }
            }
        }
        // In the plane of the top: as one that rises by nothing, it enters by the side and leaves at the middle.
        let found = met(v(0.5, 1.0, -8.0), DVec3::Z);
        assert_eq!((found.len(), found[0].1, found[1].1), (2, false, true));
        assert!((found[0].0 - (8.0 - 3.75f64.sqrt())).abs() < 2e-15);
        assert!((found[1].0 - 8.0).abs() < 1e-7, "{}", found[1].0);
        assert!(met(v(0.5, 1.0f64.next_up(), -8.0), DVec3::Z).is_empty());
        // The rim is touched, and the next ray out misses.
        let found = met(v(2.0, 1.0, -8.0), DVec3::Z);
        assert!(found.len() == 2 && found.iter().all(|m| (m.0 - 8.0).abs() < 1e-7));
        assert!(met(v(2.0f64.next_up(), 1.0, -8.0), DVec3::Z).is_empty());
    });
}

/// A closed polygon close to a profile: what the pieces say at many parameters.
fn polygon(profile: &Profile, steps: usize) -> Vec<DVec2> {
    let at = |piece: &Piece| {
        let piece = *piece;
        let steps = if piece.degree == 1 { 1 } else { steps };
        (0..steps).map(move |i| piece.at(i as f64 / steps as f64))
    };
    let mut points: Vec<_> = profile.pieces().iter().flat_map(at).collect();
    points.extend(profile.pieces().last().map(|p| p.at(1.0)));
    points
}

/// Whether a point of the half plane is inside the polygon: crossings of a line to the right.
fn is_inside(polygon: &[DVec2], p: DVec2) -> bool {
    let mut inside = false;
    for i in 0..polygon.len() {
        let (a, b) = (polygon[i], polygon[(i + 1) % polygon.len()]);
        if (a.y > p.y) != (b.y > p.y) {
            let x = a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x);
            inside ^= p.x < x;
        }
    }
    inside
}

#[test]
fn crossings_are_those_of_a_scan_of_the_ray_through_random_solids() {
    const STEPS: usize = 1200;
    let mut random = Random(4);
    let (mut counts, mut doubtful) = ([0; 13], 0);
    for i in 0..60 {
        // Heights grow, so that the profile does not cross itself.
        let n = 4 + i % 5;
        let mut points = vec![[0.0, 0.0]];
        for k in 0..n {
            let height = (k as f64 + 0.5 + 0.4 * random.next()) / n as f64;
            points.push([0.5 + 0.4 * random.next(), 2.0 * height]);
        }
        points.push([0.0, 2.0]);
        let curve = [Curve::Polyline, Curve::Smooth][i % 2];
        let shape = turned(v(0.0, -1.0, 0.0), DVec3::Y, curve, &points);
        let outline = polygon(parts(&shape).2, 200);
        with_rays(&shape, DAffine3::IDENTITY, |met| {
            for k in 0..12 {
                let d = random.direction() * v(1.0, [1.0, 0.0, 0.01, 5.0][k % 4], 1.0);
                let d = d.normalize();
                let o = random.vector() * v(0.8, 0.9, 0.8) - 3.0 * d;
                let at = |t: f64| {
                    let p = o + t * d;
                    is_inside(&outline, DVec2::new(p.x.hypot(p.z), p.y + 1.0))
                };
                let step = 6.0 / STEPS as f64;
                let samples: Vec<bool> = (0..=STEPS).map(|k| at(k as f64 * step)).collect();
                let mut expected = Vec::new();
                for k in 1..samples.len() {
                    if samples[k] != samples[k - 1] {
                        let (mut low, mut high) = ((k - 1) as f64 * step, k as f64 * step);
                        for _ in 0..40 {
                            let middle = 0.5 * (low + high);
                            if at(middle) == samples[k - 1] {
                                low = middle;
                            } else {
                                high = middle;
                            }
                        }
                        expected.push(low);
                    }
                }
                let found = met(o, d);
                for (j, m) in found.iter().enumerate() {
                    assert_eq!(m.1, j % 2 == 1, "{shape:?} {o} {d}");
                }
                if found.len() != expected.len() {
                    // Only where two crossings lie within a step of the scan.
                    let close = |t: &[f64]| t.windows(2).any(|p| p[1] - p[0] < 2.0 * step);
                    let t: Vec<f64> = found.iter().map(|m| m.0).collect();
                    assert!(close(&t) || close(&expected), "{t:?} {expected:?}");
                    doubtful += 1;
                    continue;
                }
                counts[found.len()] += 1;
                for (m, t) in found.iter().zip(&expected) {
                    let slant = m.3.dot(d).abs();
                    assert!((m.0 - t).abs() * slant < 2e-5, "{} {t} {slant}", m.0);
                }
            }
        });
    }
    println!("crossings 0, 1, 2 ...: {counts:?}; left open {doubtful}");
    assert!(counts[2] > 200 && counts[4] > 40 && doubtful < 20);
}

/// Distance from a point of the half plane to a profile, by search.
fn distance(profile: &Profile, p: DVec2) -> f64 {
    let mut best = f64::INFINITY;
    for piece in profile.pieces() {
        let off = |s: f64| (piece.at(s) - p).length();
        let near = (0..=32)
            .map(|i| f64::from(i) / 32.0)
            .min_by(|a, b| off(*a).total_cmp(&off(*b)))
            .unwrap();
        let (mut low, mut high) = ((near - 1.0 / 32.0).max(0.0), (near + 1.0 / 32.0).min(1.0));
        for _ in 0..100 {
            let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if off(a) < off(b) {
                high = b;
            } else {
                low = a;
            }
        }
        best = best.min(off(low)).min(off(near));
    }
    best
}

fn in_half_plane(shape: &Shape, p: DVec3) -> DVec2 {
    let (base, n, _) = parts(shape);
    let h = (p - base).dot(n);
    DVec2::new((p - base - h * n).length(), h)
}

#[test]
fn points_lie_on_the_shape_normals_lead_out_and_spawned_rays_do_not_meet_it() {
    let mut random = Random(5);
    for (shape, _) in solids() {
        let profile = parts(&shape).2;
        let outline = polygon(profile, 400);
        for place in places() {
            let scene = scene_of(&shape, place);
            let assembly = assembled::<f64>(&scene, None).unwrap();
            let plan = tracer(&scene, &assembly, Geometry::Exact).unwrap();
            let (surfaces, mut walker) = (surfaces::<f64>(&plan), Walker::default());
            let object = place.inverse();
            let bounds = fit::of_shape(&shape, &place).unwrap();
            let size = bounds.max - bounds.min;
            let mut judged = 0;
            for _ in 0..400 {
                let target = bounds.center() + 0.5 * size * random.vector();
                let o = bounds.center() + 9.0 * random.direction();
                let ray = Ray::new(o, target - o);
                let all = surfaces.crossings(&ray, &mut walker, |_| true).unwrap();
                for hit in &all {
                    judged += 1;
                    let foot = surfaces.site(&ray, hit, None).foot;
                    let (p, n) = (foot.point, foot.normal);
                    assert!((n.length() - 1.0).abs() < 1e-15);
                    assert_eq!(n.dot(ray.direction) > 0.0, hit.back);
                    let along = ray.origin + hit.t * ray.direction;
                    assert!((p - along).length() < 1e-13);
                    assert!((p - p.clamp(bounds.min, bounds.max)).length() < 1e-14);
                    let plane = |x: DVec3| in_half_plane(&shape, object.transform_point3(x));
                    // The search itself ends at the square root of the rounding along the curve.
                    assert!(distance(profile, plane(p)) < 4e-15, "{shape:?} {p}");
                    // Beside a crease another piece is as near.
                    let q = plane(p);
                    let mut creases = profile.pieces().iter().filter(|c| c.degree == 1);
                    if creases.any(|c| (c.at(0.0) - q).length() < 0.02) {
                        continue;
                    }
                    assert!(
                        !is_inside(&outline, plane(p + 1e-3 * n)),
                        "{shape:?} {p} {n}"
                    );
                    assert!(
                        is_inside(&outline, plane(p - 1e-3 * n)),
                        "{shape:?} {p} {n}"
                    );
                    // Within a cone about the normal nothing is met at once; the other way it is left again.
                    for d in [n, n + 0.5 * random.direction()] {
                        let near = Ray {
                            skip: NO_ITEM,
                            t_max: 1e-3,
                            ..Ray::new(foot.spawn(d), d)
                        };
                        assert!(!surfaces.any_hit(&near, &mut walker), "{shape:?} {p} {n}");
                        let back = Ray::new(foot.spawn(-d), -d);
                        let found = surfaces.crossings(&back, &mut walker, |_| true).unwrap();
                        assert!(found.len() % 2 == 1 && found[0].back, "{shape:?} {p} {n}");
                    }
                }
            }
            assert!(judged > 150, "{judged}");
        }
    }
}

#[test]
fn powers_of_two_change_nothing_but_the_lengths() {
    let mut random = Random(6);
    for (i, (shape, inside)) in solids().iter().enumerate() {
        let rays: Vec<_> = (0..200)
            .map(|_| {
                let o = inside + 9.0 * random.direction();
                (o, inside + 0.75 * random.vector() - o)
            })
            .collect();
        let hits = |shape: &Shape, k: f64| {
            with_rays(shape, DAffine3::IDENTITY, |met| {
                let met = |(o, d): &(DVec3, DVec3)| met(k * *o, k * *d);
                rays.iter().map(met).collect::<Vec<_>>()
            })
        };
        let one = hits(shape, 1.0);
        assert!(one.iter().map(Vec::len).sum::<usize>() > 100);
        for k in [1.0 / (1u64 << 40) as f64, (1u64 << 40) as f64] {
            let (shape, _) = &solids_times(k)[i];
            for (a, b) in one.iter().zip(hits(shape, k)) {
                assert_eq!(a.len(), b.len());
                for (a, b) in a.iter().zip(&b) {
                    assert_eq!((a.0, a.1, k * a.2, a.3), *b);
                }
            }
        }
    }
}

#[test]
fn open_profiles_have_their_front_to_the_right() {
    let up = &[[0.5, 0.0], [0.5, 0.0], [1.0, 2.0]][1..];
    let down: Vec<_> = up.iter().rev().copied().collect();
    for (points, outside_is_back) in [(up, false), (&down[..], true)] {
        let shape = turned(DVec3::ZERO, DVec3::Y, Curve::Polyline, points);
        assert!(!parts(&shape).2.is_closed());
        with_rays(&shape, DAffine3::IDENTITY, |met| {
            let found = met(v(-8.0, 1.0, 0.0), DVec3::X);
            let sides: Vec<_> = found.iter().map(|m| (m.0, m.1)).collect();
            assert_eq!(sides, [(7.25, outside_is_back), (8.75, !outside_is_back)]);
            // Through the open top, on the inside.
            let found = met(v(0.75, 8.0, 0.0), DVec3::NEG_Y);
            assert_eq!(
                (found.len(), found[0].0, found[0].1),
                (1, 7.0, !outside_is_back)
            );
        });
    }
}

/// Every edge is used once in each direction; vertices are told apart by their bits alone.
fn is_closed(mesh: &rastray::scene::Mesh) -> bool {
    let key = |i: u32| {
        (mesh.positions[i as usize] + DVec3::ZERO)
            .to_array()
            .map(f64::to_bits)
    };
    let mut edges = HashMap::new();
    for &[a, b, c] in &mesh.triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *edges.entry((key(from), key(to))).or_insert(0) += 1;
            *edges.entry((key(to), key(from))).or_insert(0) -= 1;
        }
    }
    edges.values().all(|n| *n == 0)
}

#[test]
fn meshes_are_closed_and_within_the_documented_chord_error() {
    for (shape, _) in solids() {
        let profile = parts(&shape).2;
        let curved = profile.pieces().iter().any(|p| p.degree > 1);
        let (base, n, _) = parts(&shape);
        let frame = Frame::about(n);
        let mut errors = Vec::new();
        for level in [3u32, 8, 16, 64] {
            let mesh = tessellate(&shape, level, 1);
            assert_eq!(
                mesh.triangles.len() as u64,
                triangle_count(&shape, level, 1)
            );
            assert_eq!(mesh.positions.len(), mesh.normals.len());
            assert_eq!(mesh.positions.len(), mesh.texcoords.len());
            assert!(is_closed(&mesh), "{shape:?} {level}");
            for n in &mesh.normals {
                assert!((n.length() - 1.0).abs() < 1e-15);
            }
            let half = std::f64::consts::PI / f64::from(level);
            let share = profile.radius() * (1.0 - libm::cos(half));
            let bound = if curved { 2.0 * share } else { share };
            let mut worst = 0.0f64;
            for t in &mesh.triangles {
                let corners = t.map(|i| mesh.positions[i as usize]);
                let [a, b, c] = corners;
                let face = (b - a).cross(c - a);
                let normal: DVec3 = t.iter().map(|i| mesh.normals[*i as usize]).sum();
                assert!(level < 16 || face.dot(normal) > 0.0, "{shape:?} {t:?}");
                // All slices are alike: the first stands for them.
                let middle = (a + b + c) / 3.0 - base;
                let angle = libm::atan2(middle.dot(frame.v), middle.dot(frame.u));
                if !(0.0..2.0 * half).contains(&angle) {
                    continue;
                }
                for i in 0..=4 {
                    for j in 0..=4 - i {
                        let (a, b) = (f64::from(i) / 4.0, f64::from(j) / 4.0);
                        let p = (1.0 - a - b) * corners[0] + a * corners[1] + b * corners[2];
                        worst = worst.max(distance(profile, in_half_plane(&shape, p)));
                    }
                }
            }
            assert!(
                worst <= bound * (1.0 + 1e-9),
                "{shape:?} {level}: {worst} {bound}"
            );
            assert!(
                level < 16 || worst > 0.2 * bound,
                "{shape:?} {level}: {worst} {bound}"
            );
            errors.push(worst);
        }
        // Eight times the level, 64 times less; the whole number of stacks makes it uneven.
        let gain = errors[1] / errors[3];
        assert!(gain > 32.0 && gain < 128.0, "{shape:?}: {errors:?}");
    }
}

#[test]
fn bounds_are_those_of_a_fine_mesh() {
    for (shape, _) in solids() {
        for place in places() {
            let bounds = fit::of_shape(&shape, &place).unwrap();
            let mesh = tessellate(&shape, 256, 1);
            let points = mesh.positions.iter().map(|p| place.transform_point3(*p));
            let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            for p in points {
                (low, high) = (low.min(p), high.max(p));
            }
            let size = (bounds.max - bounds.min).max_element();
            assert!((low - bounds.min).min_element() > -1e-14, "{shape:?}");
            assert!((bounds.max - high).min_element() > -1e-14, "{shape:?}");
            assert!((low - bounds.min).max_element() < 1e-3 * size, "{shape:?}");
            assert!((bounds.max - high).max_element() < 1e-3 * size, "{shape:?}");
        }
    }
}

#[test]
fn smooth_profiles_pass_through_their_points_without_creases() {
    let profile = Profile::new(Curve::Smooth, BOTTLE).unwrap();
    let pieces = profile.pieces();
    for point in BOTTLE {
        let p = DVec2::from_array(*point);
        assert!(
            pieces.iter().any(|x| x.at(0.0) == p || x.at(1.0) == p),
            "{p}"
        );
    }
    let mut creases = Vec::new();
    for pair in pieces.windows(2) {
        assert_eq!(pair[0].at(1.0), pair[1].at(0.0));
        let (a, b) = (
            pair[0].tangent(1.0).normalize(),
            pair[1].tangent(0.0).normalize(),
        );
        if (a - b).length() > 1e-12 {
            creases.push(pair[1].at(0.0).to_array());
        }
    }
    // The point written twice, and no other.
    assert_eq!(creases, [[0.5, 0.0]]);
    // Poles are round, control points in order.
    assert_eq!(pieces[0].tangent(0.0).y, 0.0);
    assert_eq!(pieces[pieces.len() - 1].tangent(1.0).y, 0.0);
    for piece in pieces {
        for c in [piece.r, piece.z] {
            let c = &c[..=piece.degree];
            assert!(c.is_sorted() || c.iter().rev().is_sorted(), "{piece:?}");
            assert!(piece.r.iter().all(|r| *r >= 0.0));
        }
    }
    let ring = Profile::new(Curve::Smooth, RING).unwrap();
    let (first, last) = (ring.pieces()[0], ring.pieces()[ring.pieces().len() - 1]);
    let (a, b) = (
        last.tangent(1.0).normalize(),
        first.tangent(0.0).normalize(),
    );
    assert!((a - b).length() < 1e-12);
}

#[test]
fn bad_profiles_are_refused_where_they_are_bad() {
    let flaw = |curve, points: &[[f64; 2]]| Profile::new(curve, points).unwrap_err().point;
    for curve in [Curve::Polyline, Curve::Smooth] {
        assert_eq!(flaw(curve, &[]), None);
        assert_eq!(flaw(curve, &[[1.0, 0.0]]), None);
        assert_eq!(flaw(curve, &[[0.0, 0.0], [0.0, 1.0], [0.0, 2.0]]), None);
        assert_eq!(flaw(curve, &[[1.0, 0.0], [f64::NAN, 1.0]]), Some(1));
        assert_eq!(flaw(curve, &[[1.0, 0.0], [1.0, f64::INFINITY]]), Some(1));
        assert_eq!(
            flaw(curve, &[[1.0, 0.0], [2.0, 0.0], [-1e-300, 1.0]]),
            Some(2)
        );
        assert_eq!(flaw(curve, &[[1.0, 0.0], [0.0, 1.0], [0.0, 2.0]]), Some(2));
        assert_eq!(flaw(curve, &[[1.0, 0.0], [1.0, 0.0], [2.0, 1.0]]), Some(1));
        assert_eq!(flaw(curve, &[[0.0, 0.0], [1.0, 0.0], [0.0, 0.0]]), None);
        assert_eq!(flaw(curve, &vec![[1.0, 0.0]; MAX_POINTS + 1]), None);
    }
    let twice = [[1.0, 0.0], [2.0, 1.0], [2.0, 1.0], [1.0, 2.0]];
    assert_eq!(flaw(Curve::Polyline, &twice), Some(2));
    assert!(Profile::new(Curve::Smooth, &twice).is_ok());
    let thrice = [[1.0, 0.0], [2.0, 1.0], [2.0, 1.0], [2.0, 1.0], [1.0, 2.0]];
    assert_eq!(flaw(Curve::Smooth, &thrice), Some(2));
    assert_eq!(flaw(Curve::Bezier, &LENS[..5]), None);
    assert_eq!(flaw(Curve::Bezier, &[[1.0, 2.0]; 4]), Some(3));
    let axis = [
        [1.0, 0.0],
        [1.0, 1.0],
        [1.0, 1.0],
        [0.0, 2.0],
        [0.0, 3.0],
        [0.0, 4.0],
        [0.0, 5.0],
    ];
    assert_eq!(flaw(Curve::Bezier, &axis), Some(6));
}
