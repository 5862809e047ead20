//! Round shapes: closed forms, independent references, parity, and both renderers on a scene that has them all.

use rastray::math::{DAffine3, DMat3, DVec3};
use rastray::render::Precision;
use rastray::scene::{Geometry as Form, Material, Object, Optics, Scene, Shape};
use rastray::trace::Geometry;
use rastray::trace::bvh::Walker;
use rastray::trace::exact::{Twofold, dot2, pairs};
use rastray::trace::ray::Ray;
use rastray::trace::torus::Torus;
use rastray::{gl, scene::fit};

/// Every shape, each lit, one material shiny and one clear.
const ALL_SHAPES: &str = include_str!("../data/shapes.toml");

use crate::common::precise::{assembled, surfaces, tracer};
use crate::common::random::Random;
use crate::common::{ladder, scenes};

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

fn exact(a: DVec3, b: DVec3) -> [Twofold; 3] {
    [0, 1, 2].map(|k| Twofold::difference(a[k], b[k]))
}

fn hits(torus: &Torus, o: DVec3, d: DVec3) -> Vec<f64> {
    let found = torus.crossings(exact(DVec3::ZERO, o), d);
    found.iter().flatten().map(|t| t.value()).collect()
}

#[test]
fn torus_closed_forms() {
    let ring = Torus {
        axis: DVec3::Y,
        major: 5.0,
        minor: 4.0,
    };
    assert_eq!(
        hits(&ring, v(-16.0, 0.0, 0.0), DVec3::X),
        [7.0, 15.0, 17.0, 25.0]
    );
    assert!(hits(&ring, v(0.0, 9.0, 0.0), DVec3::NEG_Y).is_empty());
    // Along the axis' direction at a distance of 5 + 2.4 from it: heights +-3.2.
    let t = hits(&ring, v(7.4, 8.0, 0.0), v(0.0, -2.0, 0.0));
    assert!(
        (t[0] - 2.4).abs() < 1e-15 && (t[1] - 5.6).abs() < 2e-15,
        "{t:?}"
    );
    // Inside all the way past the innermost circle, which it touches: 2 z^2 = (R + r)^2 - (R - r)^2.
    let reach = 2.0 * 20f64.sqrt();
    let t = hits(&ring, v(1.0, 0.0, -16.0), DVec3::Z);
    assert_eq!(t.len(), 2);
    assert!((t[0] - 16.0 + reach).abs() < 4e-15 && (t[1] - 16.0 - reach).abs() < 4e-15);
    // Touching the top circle: along its tangent, and across it. The next ray above misses.
    for d in [DVec3::Z, DVec3::X] {
        let from = |y: f64| v(5.0, y, 0.0) - 32.0 * d;
        let t = hits(&ring, from(4.0), d);
        let here: Vec<_> = t.iter().filter(|t| (**t - 32.0).abs() < 1e-7).collect();
        assert_eq!(here.len(), 2, "{t:?}");
        assert!(hits(&ring, from(4.0f64.next_up()), d).is_empty());
    }
    // The outermost circle.
    let t = hits(&ring, v(9.0, 0.0, -8.0), DVec3::Z);
    assert_eq!(t, [8.0, 8.0]);
    assert!(hits(&ring, v(9.0f64.next_up(), 0.0, -8.0), DVec3::Z).is_empty());
}

/// Signed distance from a torus about the y axis, plain f64.
fn tube(torus: &Torus, p: DVec3) -> f64 {
    let across = (p.x * p.x + p.z * p.z).sqrt() - torus.major;
    (across * across + p.y * p.y).sqrt() - torus.minor
}

#[test]
fn torus_crossings_are_those_of_a_scan_of_the_distance() {
    const STEPS: u32 = 4000;
    let mut random = Random(1);
    let (mut counts, mut doubtful) = ([0; 5], 0);
    for i in 0..4000 {
        let minor = [0.9, 0.5, 0.25, 0.05][i % 4];
        let torus = Torus {
            axis: DVec3::Y,
            major: 1.0,
            minor,
        };
        let through = v(random.next(), random.next() * minor, random.next()) * 1.5;
        let d = random.direction() * [1.0, 1e-3, 40.0][i % 3];
        let o = through - d * (4.0 / d.length());
        let at = |s: f64| tube(&torus, o + s * d);
        let step = 8.0 / d.length() / f64::from(STEPS);
        // The distance changes by at most the way: a sample this near 0 with no change of sign may hide two crossings.
        let samples: Vec<f64> = (0..=STEPS).map(|k| at(f64::from(k) * step)).collect();
        let mut expected = Vec::new();
        let mut clear = true;
        for k in 1..samples.len() {
            let (a, b) = (samples[k - 1], samples[k]);
            if (a <= 0.0) != (b <= 0.0) {
                let (mut low, mut high) = ((k - 1) as f64 * step, k as f64 * step);
                for _ in 0..80 {
                    let middle = 0.5 * (low + high);
                    if (at(middle) <= 0.0) == (a <= 0.0) {
                        low = middle;
                    } else {
                        high = middle;
                    }
                }
                expected.push(low);
            } else {
                clear &= a.abs().min(b.abs()) > step * d.length();
            }
        }
        let found = hits(&torus, o, d);
        assert!(found.len().is_multiple_of(2));
        if !clear && found.len() != expected.len() {
            doubtful += 1;
            continue;
        }
        counts[found.len()] += 1;
        assert_eq!(found.len(), expected.len(), "{torus:?} {o} {d}");
        for (a, b) in found.iter().zip(&expected) {
            assert!((a - b).abs() * d.length() < 1e-6, "{a} {b}");
        }
    }
    println!("crossings 0, 2, 4: {counts:?}; left open {doubtful}");
    assert!(
        counts[2] > 1000 && counts[4] > 150 && doubtful < 40,
        "{counts:?} {doubtful}"
    );
}

#[test]
fn torus_points_lie_on_it_at_every_distance_and_thickness() {
    let mut random = Random(2);
    let mut judged = 0;
    for i in 0..2000 {
        let minor = [0.5, 1e-3, 1e-6][i % 3];
        let far = [2.0, 1e4, 1e8][i / 3 % 3];
        let torus = Torus {
            axis: DVec3::Y,
            major: 1.0,
            minor,
        };
        // Aimed at the middle of the tube.
        let angle = random.next() * 3.0;
        let target = v(libm::cos(angle), 0.0, libm::sin(angle));
        let d = random.direction();
        let o = target - far * d;
        let q = exact(DVec3::ZERO, o);
        for (k, t) in torus.crossings(q, d).iter().flatten().enumerate() {
            judged += 1;
            // (sqrt(x^2 + z^2) - R)^2 + y^2 - r^2 at o + t d in pairs, by its own formula.
            let p = [0, 1, 2].map(|k| Twofold::from(d[k]) * *t - q[k]);
            let across = (p[0] * p[0] + p[2] * p[2]).sqrt() - Twofold::from(1.0);
            let square = across * across + p[1] * p[1];
            let off = (square.sqrt() - Twofold::from(minor)).value();
            // Rounding of d and o leaves far * 2^-53; only t is judged, so nothing of that shows.
            assert!(off.abs() < 1e-13 * minor, "{minor} {far} {off:e}");
            let spot = torus.spot(q, d, k).unwrap();
            let point = p.map(Twofold::value);
            let error = (spot.offset - DVec3::from_array(point)).length();
            assert!(error < 4e-16, "{error:e}");
            let out = [across.value(), p[1].value()].map(|x| x / minor);
            let ring = v(point[0], 0.0, point[2]).normalize();
            let expected = ring * out[0] + DVec3::Y * out[1];
            assert!((spot.normal - expected.normalize()).length() < 1e-14);
        }
    }
    assert!(judged > 1500, "{judged}");
}

fn scene_of(shapes: &[(Shape, DAffine3)]) -> Scene {
    let mut scene = Scene::default();
    scene.materials.push(Material {
        name: "m".into(),
        front: gl::Material::default(),
        back: None,
        optics: Optics::default(),
    });
    for (i, (shape, place)) in shapes.iter().enumerate() {
        scene.objects.push(Object {
            priority: 0,
            name: format!("o{i}"),
            geometry: Form::Shape(shape.clone()),
            materials: vec![0],
            world_from_object: *place,
            tessellation: Some(3),
        });
    }
    scene
}

fn solids() -> Vec<Shape> {
    let (base, top, radius) = (v(0.25, -0.5, 0.125), v(-0.25, 1.5, 0.5), 0.75);
    vec![
        Shape::Cylinder {
            base,
            top,
            radius,
            caps: true,
        },
        Shape::Cone {
            base,
            apex: top,
            radius,
            cap: true,
        },
        Shape::Torus {
            center: base,
            axis: top - base,
            major: 1.0,
            minor: 0.375,
        },
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

/// Points of a solid's rims, apex and axis, and one well inside; object space.
fn landmarks(shape: &Shape) -> (Vec<DVec3>, DVec3) {
    let circle = |c: DVec3, axis: DVec3, r: f64| {
        let u = axis.any_orthogonal_vector().normalize();
        let w = axis.cross(u).normalize();
        (0..12).map(move |i| {
            let (s, k) = libm::sincos(f64::from(i) * 0.5);
            c + r * (k * u + s * w)
        })
    };
    match *shape {
        Shape::Cylinder {
            base, top, radius, ..
        } => {
            let mut points: Vec<_> = circle(base, top - base, radius).collect();
            points.extend(circle(top, top - base, radius));
            points.extend([base, top]);
            (points, base.lerp(top, 0.375))
        }
        Shape::Cone {
            base, apex, radius, ..
        } => {
            let mut points: Vec<_> = circle(base, apex - base, radius).collect();
            points.extend([base, apex]);
            (points, base.lerp(apex, 0.25))
        }
        Shape::Torus {
            center,
            axis,
            major,
            minor,
        } => {
            let n = axis.normalize();
            let mut points: Vec<_> = circle(center, n, major + minor).collect();
            points.extend(circle(center, n, major - minor));
            points.extend(circle(center + minor * n, n, major));
            let inside = circle(center, n, major).next().unwrap_or(center);
            (points, inside)
        }
        _ => (Vec::new(), DVec3::ZERO),
    }
}

#[test]
fn closed_shapes_do_not_leak_and_every_crossing_has_one_owner() {
    let mut random = Random(3);
    for shape in solids() {
        for place in places() {
            let scene = scene_of(&[(shape.clone(), place)]);
            let assembly = assembled::<f64>(&scene, None).unwrap();
            let plan = tracer(&scene, &assembly, Geometry::Exact).unwrap();
            let mut walker = Walker::default();
            let (marks, inside) = landmarks(&shape);
            let inside = place.transform_point3(inside);
            let mut balance = |o: DVec3, d: DVec3| {
                let ray = Ray::new(o, d);
                let found = surfaces::<f64>(&plan)
                    .crossings(&ray, &mut walker, |_| true)
                    .unwrap();
                let sides: i32 = found.iter().map(|h| if h.back { -1 } else { 1 }).sum();
                (sides, found.len())
            };
            for i in 0..3000 {
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
            }
        }
    }
}

/// Signed, scaled implicit function of a shape in object space: 0 on it, growing outwards.
fn implicit(shape: &Shape, p: DVec3) -> f64 {
    let parts = |from: DVec3, axis: DVec3| {
        let n = axis.normalize();
        let h = (p - from).dot(n);
        (h, (p - from - h * n).length())
    };
    match *shape {
        Shape::Cylinder {
            base, top, radius, ..
        } => {
            let (h, across) = parts(base, top - base);
            (across - radius).max(-h).max(h - (top - base).length())
        }
        Shape::Cone {
            base, apex, radius, ..
        } => {
            let (h, across) = parts(base, apex - base);
            let length = (apex - base).length();
            let slope = length.hypot(radius);
            ((across * length + (h - length) * radius) / slope).max(-h)
        }
        Shape::Torus {
            center,
            axis,
            major,
            minor,
        } => {
            let (h, across) = parts(center, axis);
            (across - major).hypot(h) - minor
        }
        _ => 0.0,
    }
}

#[test]
fn points_lie_on_the_shape_normals_lead_out_and_spawned_rays_do_not_meet_it() {
    let mut random = Random(4);
    for shape in solids() {
        for place in places() {
            let scene = scene_of(&[(shape.clone(), place)]);
            let assembly = assembled::<f64>(&scene, None).unwrap();
            let plan = tracer(&scene, &assembly, Geometry::Exact).unwrap();
            let (surfaces, mut walker) = (surfaces::<f64>(&plan), Walker::default());
            let object = place.inverse();
            let bounds = fit::of_shape(&shape, &place).unwrap();
            let mut judged = 0;
            for _ in 0..2000 {
                let o = bounds.center() + 9.0 * random.direction();
                let ray = Ray::new(o, bounds.center() + 0.8 * random.vector() - o);
                let all = surfaces.crossings(&ray, &mut walker, |_| true).unwrap();
                for hit in &all {
                    judged += 1;
                    let site = surfaces.site(&ray, hit, None);
                    let (p, n) = (site.foot.point, site.foot.normal);
                    assert!((n.length() - 1.0).abs() < 1e-15);
                    assert_eq!(n.dot(ray.direction) > 0.0, hit.back);
                    let along = ray.origin + hit.t * ray.direction;
                    assert!((p - along).length() < 1e-13);
                    let value = |x: DVec3| implicit(&shape, object.transform_point3(x));
                    assert!(value(p).abs() < 1e-14);
                    assert!(value(p + 1e-3 * n) > 0.0 && value(p - 1e-5 * n) < 0.0);
                    // Leaving outwards, near the tangent plane and straight up: nothing is met at once.
                    for d in [n, n + 0.5 * random.direction()] {
                        let skip = site.skip[0];
                        let away = Ray {
                            skip,
                            ..Ray::new(site.foot.spawn(d), d)
                        };
                        let near = Ray {
                            t_max: 1e-3,
                            ..away
                        };
                        assert!(!surfaces.any_hit(&near, &mut walker), "{shape:?} {p} {n}");
                        // Without the help of skipping, too.
                        let bare = Ray {
                            skip: rastray::trace::ray::NO_ITEM,
                            ..near
                        };
                        assert!(!surfaces.any_hit(&bare, &mut walker), "{shape:?} {p} {n}");
                        let back = Ray::new(site.foot.spawn(-d), -d);
                        let found = surfaces.crossings(&back, &mut walker, |_| true).unwrap();
                        assert!(found.len() % 2 == 1 && found[0].back, "{shape:?} {p} {n}");
                    }
                }
                for p in &all {
                    let p = ray.origin + p.t * ray.direction;
                    let room = 1e-12;
                    assert!((p - p.clamp(bounds.min, bounds.max)).length() < room);
                }
            }
            assert!(judged > 1000, "{judged}");
        }
    }
}

#[test]
fn open_shapes_show_their_inside_through_the_ends() {
    let (base, top, radius) = (DVec3::ZERO, v(0.0, 2.0, 0.0), 1.0);
    let tube = |caps| Shape::Cylinder {
        base,
        top,
        radius,
        caps,
    };
    let funnel = |cap| Shape::Cone {
        base: top,
        apex: base,
        radius,
        cap,
    };
    let crossings = |shape: Shape, o: DVec3, d: DVec3| {
        let scene = scene_of(&[(shape, DAffine3::IDENTITY)]);
        let assembly = assembled::<f64>(&scene, None).unwrap();
        let plan = tracer(&scene, &assembly, Geometry::Exact).unwrap();
        let mut walker = Walker::default();
        let ray = Ray::new(o, d);
        let found = surfaces::<f64>(&plan)
            .crossings(&ray, &mut walker, |_| true)
            .unwrap();
        found.iter().map(|h| (h.t, h.back)).collect::<Vec<_>>()
    };
    let (o, d) = (v(-0.5, 4.0, 0.0), v(0.5, -1.0, 0.0));
    assert_eq!(crossings(tube(true), o, d), [(2.0, false), (3.0, true)]);
    assert_eq!(crossings(tube(false), o, d), [(3.0, true)]);
    let o = v(0.25, 4.0, 0.0);
    assert_eq!(crossings(tube(false), o, DVec3::NEG_Y), []);
    assert_eq!(
        crossings(funnel(true), o, DVec3::NEG_Y),
        [(2.0, false), (3.5, true)]
    );
    assert_eq!(crossings(funnel(false), o, DVec3::NEG_Y), [(3.5, true)]);
}

#[test]
fn the_hierarchy_equals_brute_force_on_round_shapes() {
    let mut random = Random(5);
    let mut shapes = Vec::new();
    for i in 0..60 {
        let mut shape = solids()[i % 3].clone();
        if i % 5 == 0 {
            shape = Shape::Disk {
                center: v(0.5, 0.0, 0.0),
                normal: v(0.0, 1.0, 0.25),
                radius: 1.0,
            };
        }
        let at = DAffine3::from_translation(6.0 * random.vector());
        shapes.push((shape, at * places()[i % 4]));
    }
    let scene = scene_of(&shapes);
    let assembly = assembled::<f32>(&scene, None).unwrap();
    let plan = tracer(&scene, &assembly, Geometry::Exact).unwrap();
    let mut walker = Walker::default();
    let mut met = 0;
    for i in 0..20_000 {
        let axis = [DVec3::X, DVec3::Y, DVec3::NEG_Z][i % 3];
        let d = if i % 7 == 0 { axis } else { random.direction() };
        let ray = Ray::new(8.0 * random.vector(), d);
        let found = surfaces::<f32>(&plan).closest_hit(&ray, &mut walker);
        assert_eq!(found, surfaces::<f32>(&plan).closest_hit_of_all(&ray));
        met += usize::from(found.is_some());
    }
    assert!(met > 4000, "{met}");
}

fn all_shapes(width: u32, height: u32) -> Scene {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/shapes.toml");
    scenes::scene(path, [width, height], &[])
}

fn both_agree(scene: &Scene, precision: Precision) {
    let ladder = ladder::climb(scene, &ladder::options(precision));
    assert_eq!(ladder.residual_max, 0.0);
    let agreement = ladder.agreement;
    println!("{agreement:?}");
    assert!(agreement.interior_max <= 1e-5, "{agreement:?}");
    assert_eq!(agreement.coverage.raster_only, 0);
    assert_eq!(agreement.coverage.trace_only, 0);
    assert!(
        agreement.coverage.both > 20 * agreement.edge_pixels,
        "{agreement:?}"
    );
}

#[test]
fn a_scene_of_all_shapes_is_explained_without_residual() {
    for name in [
        "sphere",
        "plane",
        "quad",
        "disk",
        "box",
        "cylinder",
        "cone",
        "torus",
        "revolution",
        "checkered floor",
    ] {
        assert!(
            ALL_SHAPES.contains(&format!("shape = \"{name}\"")),
            "{name}"
        );
    }
    let scene = all_shapes(320, 240);
    both_agree(&scene, Precision::F32);
    both_agree(&scene, Precision::F64);
}

#[test]
fn pairs_are_exact_enough_for_these_tests() {
    let x = pairs(v(1.0, 1e-9, 1e-18));
    assert!((dot2(x, x).value() - 1.0).abs() < 1e-17);
}
