//! Bicubic Bezier patches: closed forms, dense meshes, parity through borders and corners, accuracy in pairs, the teapot's figures.

use rastray::gl;
use rastray::math::{DAffine3, DMat3, DVec3};
use rastray::render::Tracer;
use rastray::scene::bezier::{Net, chord_error, jet, net, normal};
use rastray::scene::tessellate::tessellate;
use rastray::scene::{Geometry as Form, Material, Object, Optics, Scene, Shape, fit, teapot};
use rastray::trace::Geometry;
use rastray::trace::bvh::Walker;
use rastray::trace::exact::{Twofold, add_scaled, dot2, pairs, values};
use rastray::trace::ray::{Hit, Ray};

use crate::common::precise::{assembled, surfaces, tracer};
use crate::common::random::Random;

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
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
            name: format!("o{i}"),
            geometry: Form::Shape(shape.clone()),
            materials: vec![0],
            world_from_object: *place,
            tessellation: None,
            priority: 0,
        });
    }
    scene
}

/// Makes a scene of one shape and hands its plan on.
fn with_plan<T>(
    shape: &Shape,
    place: DAffine3,
    geometry: Geometry,
    level: u32,
    work: impl FnOnce(&Tracer<'_>, &mut Walker) -> T,
) -> T {
    let scene = scene_of(&[(shape.clone(), place)]);
    let assembly = assembled::<f64>(&scene, Some(level)).unwrap();
    let plan = tracer(&scene, &assembly, geometry).unwrap();
    work(&plan, &mut Walker::default())
}

fn exact<T>(shape: &Shape, work: impl FnOnce(&Tracer<'_>, &mut Walker) -> T) -> T {
    with_plan(shape, DAffine3::IDENTITY, Geometry::Exact, 3, work)
}

fn all(plan: &Tracer<'_>, walker: &mut Walker, ray: &Ray) -> Vec<Hit> {
    surfaces::<f64>(plan)
        .crossings(ray, walker, |_| true)
        .unwrap()
}

/// A ray to both sides of its origin: a start so far back that all of the line ahead of it counts.
fn line(through: DVec3, d: DVec3, back: f64) -> Ray {
    Ray::new(through - back * d, d)
}

fn sheet(points: Vec<DVec3>) -> Shape {
    let count = points.len() as u32 / 16;
    let patch = |k: u32| std::array::from_fn(|i| 16 * k + i as u32);
    Shape::Bezier {
        points: points.into(),
        patches: (0..count).map(patch).collect(),
    }
}

/// The patch whose coordinates are polynomials with the coefficients c[a][b] of u^a v^b, a and b up to 3.
fn polynomial(c: [[DVec3; 4]; 4]) -> Shape {
    // u^a has the Bernstein coefficients binomial(j, a) / binomial(3, a).
    const POWER: [[f64; 4]; 4] = [
        [1.0, 1.0, 1.0, 1.0],
        [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0],
        [0.0, 0.0, 1.0 / 3.0, 1.0],
        [0.0, 0.0, 0.0, 1.0],
    ];
    let point = |i: usize, j: usize| {
        let mut p = DVec3::ZERO;
        for (a, row) in c.iter().enumerate() {
            for (b, coefficient) in row.iter().enumerate() {
                p += POWER[a][j] * POWER[b][i] * *coefficient;
            }
        }
        p
    };
    sheet((0..16).map(|k| point(k / 4, k % 4)).collect())
}

/// (x, y, x^2 + k y^2) over -2..2, times a scale.
fn paraboloid(k: f64, scale: f64) -> Shape {
    // x = 4 u - 2, so x^2 = 4 - 16 u + 16 u^2.
    let mut c = [[DVec3::ZERO; 4]; 4];
    c[0][0] = v(-2.0, -2.0, 4.0 + 4.0 * k);
    c[1][0] = v(4.0, 0.0, -16.0);
    c[2][0] = v(0.0, 0.0, 16.0);
    c[0][1] = v(0.0, 4.0, -16.0 * k);
    c[0][2] = v(0.0, 0.0, 16.0 * k);
    polynomial(c.map(|row| row.map(|x| x * scale)))
}

/// A closed surface like a pillow or a ball: the six faces of a cube of 4 x 4 x 4 points, moved outwards to `shape`d places.
fn closed(shape: impl Fn(DVec3) -> DVec3) -> Shape {
    let mut points = Vec::new();
    for k in 0..64 {
        let at = |k: usize| (k % 4) as f64 / 1.5 - 1.0;
        points.push(shape(v(at(k), at(k / 4), at(k / 16))));
    }
    let number = |x: usize, y: usize, z: usize| (x + 4 * y + 16 * z) as u32;
    let face = |place: &dyn Fn(usize, usize) -> u32| -> [u32; 16] {
        std::array::from_fn(|k| place(k % 4, k / 4))
    };
    let patches = [
        face(&|u, v| number(3, u, v)),
        face(&|u, v| number(0, v, u)),
        face(&|u, v| number(v, 3, u)),
        face(&|u, v| number(u, 0, v)),
        face(&|u, v| number(u, v, 3)),
        face(&|u, v| number(v, u, 0)),
    ];
    Shape::Bezier {
        points: points.into(),
        patches: patches.to_vec().into(),
    }
}

fn ball() -> Shape {
    closed(|p| p.normalize() * 1.5)
}

fn bumpy() -> Shape {
    let mut random = Random(77);
    let bumps: Vec<f64> = (0..64).map(|_| 1.0 + 0.6 * random.next()).collect();
    closed(|p| {
        let index = |x: f64| ((x + 1.0) * 1.5).round() as usize;
        p.normalize() * 1.5 * bumps[index(p.x) + 4 * index(p.y) + 16 * index(p.z)]
    })
}

fn nets(shape: &Shape) -> Vec<Net> {
    let Shape::Bezier { points, patches } = shape else {
        panic!("no patches")
    };
    patches.iter().map(|patch| net(points, patch)).collect()
}

fn places() -> Vec<DAffine3> {
    let skew = DMat3::from_cols(v(1.0, 0.25, 0.0), v(-0.5, 2.0, 0.125), v(0.0, 0.5, 0.75));
    let at = v(3.0, -1.0, 2.0);
    vec![
        DAffine3::IDENTITY,
        DAffine3::from_mat3_translation(skew, at),
        DAffine3::from_mat3_translation(skew, at) * DAffine3::from_scale(v(1.0, -1.0, 1.0)),
    ]
}

#[test]
fn a_flat_patch_is_the_parallelogram() {
    let (corner, edge_u, edge_v) = (v(-1.0, 0.5, 2.0), v(3.0, 0.0, -0.75), v(0.5, 1.0, 1.5));
    let quad = Shape::Patch {
        corner,
        edge_u,
        edge_v,
        tiles: [1, 1],
    };
    let mut c = [[DVec3::ZERO; 4]; 4];
    (c[0][0], c[1][0], c[0][1]) = (corner, edge_u, edge_v);
    let patch = polynomial(c);
    let mut random = Random(1);
    let mut hits = 0;
    for place in places() {
        with_plan(&quad, place, Geometry::Exact, 3, |flat, w1| {
            with_plan(&patch, place, Geometry::Exact, 3, |curved, w2| {
                for _ in 0..2000 {
                    let (s, t) = (random.next(), random.next());
                    let target = corner + (0.5 + 0.6 * s) * edge_u + (0.5 + 0.6 * t) * edge_v;
                    let o = 5.0 * random.direction() + place.transform_point3(target);
                    let ray = Ray::new(o, place.transform_point3(target) - o);
                    let (a, b) = (all(flat, w1, &ray), all(curved, w2, &ray));
                    assert_eq!(a.len(), b.len(), "{s} {t}");
                    for (a, b) in a.iter().zip(&b) {
                        hits += 1;
                        assert_eq!(a.back, b.back);
                        let (p, q) = (
                            surfaces::<f64>(flat).site(&ray, a, None).foot,
                            surfaces::<f64>(curved).site(&ray, b, None).foot,
                        );
                        let slant = p.normal.dot(ray.direction.normalize()).abs();
                        assert!((a.t - b.t).abs() * slant < 1e-14);
                        assert!((p.point - q.point).length() * slant < 1e-14);
                        assert!((p.normal - q.normal).length() < 1e-14);
                    }
                }
            });
        });
    }
    assert!(hits > 3000, "{hits}");
}

#[test]
fn a_parabolic_sheet_is_crossed_where_its_equation_says() {
    let mut random = Random(2);
    let mut counts = [0; 3];
    for k in [1.0, 0.0, -0.5] {
        for scale in [1.0, 1e-6, 1e8] {
            exact(&paraboloid(k, scale), |plan, walker| {
                for _ in 0..3000 {
                    let at = random.vector() * 1.5;
                    let through = v(at.x, at.y, at.x * at.x + k * at.y * at.y);
                    let d = random.direction();
                    let back = 16.0;
                    let o = through - back * d;
                    // z - x^2 - k y^2 along o + t d: a quadratic in t, one root of which is `back`.
                    let a = -(d.x * d.x + k * d.y * d.y);
                    let b = d.z - 2.0 * (through.x * d.x + k * through.y * d.y);
                    let mut expected = vec![0.0, -b / a];
                    expected.retain(|s| {
                        let p = through + *s * d;
                        s.is_finite() && *s > -back && p.x.abs() < 2.0 && p.y.abs() < 2.0
                    });
                    expected.sort_by(f64::total_cmp);
                    let edge = |s: f64| {
                        let p = through + s * d;
                        (p.x.abs() - 2.0).abs() < 1e-9 || (p.y.abs() - 2.0).abs() < 1e-9
                    };
                    if expected.iter().any(|s| edge(*s)) || (b / a).abs() < 1e-6 {
                        continue;
                    }
                    let ray = Ray::new(o * scale, d * scale);
                    let found = all(plan, walker, &ray);
                    assert_eq!(found.len(), expected.len(), "{k} {through} {d}");
                    counts[found.len()] += 1;
                    for (hit, s) in found.iter().zip(&expected) {
                        // A root is the worse known the more slanted the ray is: |F'| = |b| there.
                        let slack = 1e-14 * (back + 8.0 / b.abs()) / d.length();
                        assert!(
                            (hit.t - back - s).abs() < 4.0 * slack,
                            "{} {s}",
                            hit.t - back
                        );
                        let foot = surfaces::<f64>(plan).site(&ray, hit, None).foot;
                        let p = foot.point / scale;
                        let off = p.z - p.x * p.x - k * p.y * p.y;
                        assert!(off.abs() < 8e-15, "{off:e}");
                        // Front is the side of du x dv: towards +z.
                        let n = v(-2.0 * p.x, -2.0 * k * p.y, 1.0).normalize();
                        assert!((foot.normal - n).length() < 4e-15);
                        assert_eq!(hit.back, n.dot(d) > 0.0);
                    }
                }
            });
        }
    }
    assert!(counts[1] > 8000 && counts[2] > 2000, "{counts:?}");
}

#[test]
fn random_patches_are_crossed_as_often_as_their_dense_meshes() {
    let mut random = Random(3);
    let (mut counts, mut differ) = ([0u32; 20], 0);
    for _ in 0..6 {
        // A wavy sheet over a square, and a crumpled one.
        let amount = 0.4 + 0.4 * random.next().abs();
        let points = (0..16).map(|k| {
            let grid = v(f64::from(k % 4) - 1.5, f64::from(k / 4) - 1.5, 0.0);
            grid + amount * 3.0 * random.vector()
        });
        let shape = sheet(points.collect());
        with_plan(
            &shape,
            DAffine3::IDENTITY,
            Geometry::Mesh,
            512,
            |mesh, w1| {
                exact(&shape, |plan, w2| {
                    for _ in 0..1500 {
                        let ray = line(random.vector() * 1.2, random.direction(), 10.0);
                        let (a, b) = (all(mesh, w1, &ray), all(plan, w2, &ray));
                        counts[b.len()] += 1;
                        if a.len() != b.len() {
                            // The mesh may miss a touching ray or one past its border: off by a chord.
                            differ += 1;
                            continue;
                        }
                        for (a, b) in a.iter().zip(&b) {
                            assert!((a.t - b.t).abs() < 0.02, "{} {}", a.t, b.t);
                        }
                        let closest = surfaces::<f64>(plan).closest_hit(&ray, w2);
                        assert_eq!(closest, surfaces::<f64>(plan).closest_hit_of_all(&ray));
                        assert_eq!(closest, b.first().copied());
                        assert_eq!(surfaces::<f64>(plan).any_hit(&ray, w2), !b.is_empty());
                    }
                });
            },
        );
    }
    println!("crossings: {counts:?}, other counts than the mesh: {differ}");
    assert!(differ < 45, "{differ}");
    assert!(counts[1] > 1000 && counts[2] > 200 && counts[3..].iter().sum::<u32>() > 30);
}

#[test]
fn closed_sets_do_not_leak_through_borders_corners_and_poles() {
    let mut random = Random(4);
    for shape in [ball(), bumpy()] {
        let nets = nets(&shape);
        for place in places() {
            with_plan(&shape, place, Geometry::Exact, 3, |plan, walker| {
                let inside = place.transform_point3(DVec3::ZERO);
                let mut balance = |ray: Ray| {
                    let found = all(plan, walker, &ray);
                    let sides: i32 = found.iter().map(|h| if h.back { -1 } else { 1 }).sum();
                    (sides, found.len())
                };
                for i in 0..4000 {
                    // Corners, borders of patches, borders of their pieces.
                    let eighth = |k: usize| (k % 9) as f64 / 8.0;
                    let other = [eighth(i / 7), 0.5 + 0.5 * random.next()][i % 2];
                    let (s, t) = [(eighth(i), other), (other, eighth(i))][i / 2 % 2];
                    let mark = jet(&nets[i % nets.len()], s, t).point;
                    let mark = place.transform_point3(mark);
                    assert_eq!(balance(Ray::new(inside, mark - inside)).0, -1, "{s} {t}");
                    let outside = inside + 20.0 * random.direction();
                    assert_eq!(balance(Ray::new(outside, mark - outside)).0, 0, "{s} {t}");
                    let (sides, count) = balance(Ray::new(outside, inside - outside));
                    assert!(sides == 0 && count >= 2, "{outside}");
                }
            });
        }
    }
}

#[test]
fn a_ray_through_a_convex_set_enters_once_and_leaves_once() {
    let mut random = Random(5);
    let nets = nets(&ball());
    exact(&ball(), |plan, walker| {
        for i in 0..4000 {
            let (s, t) = ((i % 5) as f64 / 4.0, (i / 5 % 5) as f64 / 4.0);
            let mark = jet(&nets[i % 6], s, t).point;
            let from = mark + mark.normalize() + 0.5 * random.vector();
            let found = all(plan, walker, &Ray::new(from, mark - from));
            assert!(
                found.len() == 2 && !found[0].back && found[1].back,
                "{found:?}"
            );
            assert!((found[0].t - 1.0).abs() < 1e-14);
        }
    });
}

#[test]
fn normals_have_their_limits_where_control_points_coincide() {
    // Plane patches, front +z: a row of one point, two rows in one, two columns in one, three corners in one, at each end.
    let (x, y) = ([0.0, 1.0, 2.0, 3.0], [0.0, 1.5, 2.0, 3.0]);
    let plane = |move_to: &dyn Fn(usize, usize) -> (usize, usize)| {
        let point = |k: usize| {
            let (i, j) = move_to(k / 4, k % 4);
            v(x[j], y[i], 0.0) + v(5.0, -3.0, 2.0)
        };
        sheet((0..16).map(point).collect())
    };
    let shapes = [
        plane(&|i, j| if i == 0 { (0, 0) } else { (i, j) }),
        plane(&|i, j| if i == 3 { (3, 3) } else { (i, j) }),
        plane(&|i, j| if j == 0 { (2, 0) } else { (i, j) }),
        plane(&|i, j| if j == 3 { (1, 3) } else { (i, j) }),
        plane(&|i, j| (if i == 1 { 0 } else { i }, j)),
        plane(&|i, j| (i, if j == 2 { 3 } else { j })),
        plane(&|i, j| if i + j < 2 { (0, 0) } else { (i, j) }),
        plane(&|i, j| if i + j > 4 { (3, 3) } else { (i, j) }),
    ];
    for (k, shape) in shapes.iter().enumerate() {
        let net = nets(shape)[0];
        for (s, t) in (0..81).map(|k| (f64::from(k % 9) / 8.0, f64::from(k / 9) / 8.0)) {
            let n = normal(&net, s, t);
            assert!((n - DVec3::Z).length() < 1e-15, "{k} {s} {t}: {n}");
        }
    }
    // Nothing but a line: no normal, no hit, no NaN.
    let line_only = sheet((0..16).map(|k| v(f64::from(k), 0.0, 0.0)).collect());
    assert_eq!(normal(&nets(&line_only)[0], 0.25, 0.5), DVec3::ZERO);
    exact(&line_only, |plan, walker| {
        assert!(all(plan, walker, &Ray::new(v(7.0, 0.0, 4.0), DVec3::NEG_Z)).is_empty());
    });
    let one_point = sheet(vec![DVec3::ONE; 16]);
    exact(&one_point, |plan, walker| {
        assert!(all(plan, walker, &Ray::new(v(1.0, 1.0, 4.0), DVec3::NEG_Z)).is_empty());
    });
}

#[test]
fn rays_along_the_surface_end_and_lose_crossings_in_pairs_only() {
    // A quarter of a tube with straight rulings along z, met along them, and a flat patch met edge-on.
    let mut c = [[DVec3::ZERO; 4]; 4];
    (c[1][0], c[2][0], c[0][1]) = (v(2.0, 0.0, 0.0), v(-1.0, 1.0, 0.0), v(0.0, 0.0, 4.0));
    let mut flat = [[DVec3::ZERO; 4]; 4];
    (flat[1][0], flat[0][1]) = (v(3.0, 0.0, 0.0), v(0.0, 0.0, 3.0));
    let mut random = Random(6);
    for (shape, side) in [(polynomial(c), DVec3::Y), (polynomial(flat), DVec3::Y)] {
        exact(&shape, |plan, walker| {
            for i in 0..300 {
                let x = 0.5 + 0.4 * random.next();
                let slip = [0.0, 1e-17, 1e-12, -1e-9, 1e-5, -1e-3][i % 6];
                let u = 1.0 - (1.0 - x).sqrt();
                let y = if shape == polynomial(flat) {
                    0.0
                } else {
                    u * u
                };
                let ray = Ray::new(v(x, y, -3.0) + slip * side, v(0.0, slip, 1.0));
                assert!(all(plan, walker, &ray).len() <= 8);
            }
        });
    }
    // Touching planes of a closed set: whatever is found is even.
    let nets = nets(&ball());
    exact(&ball(), |plan, walker| {
        for i in 0..2000 {
            let net = &nets[i % 6];
            let (s, t) = (0.5 + 0.5 * random.next(), (i % 5) as f64 / 4.0);
            let at = jet(net, s, t);
            let d = (random.next() * at.du + random.next() * at.dv).normalize();
            let found = all(plan, walker, &line(at.point, d, 8.0));
            let sides: i32 = found.iter().map(|h| if h.back { -1 } else { 1 }).sum();
            assert_eq!(sides, 0, "{found:?}");
        }
    });
}

#[test]
fn points_lie_on_the_ray_however_far_it_comes() {
    let mut random = Random(7);
    let pot = teapot::teapot(DVec3::ZERO, 1.0);
    let mut worst = [0.0f64; 3];
    let mut judged = [0; 3];
    exact(&pot, |plan, walker| {
        for i in 0..6000 {
            let far = [0usize, 1, 2][i % 3];
            let distance = [10.0, 1e3, f64::from(1 << 20) * 6.0][far];
            let target = v(0.5, 1.2, 0.0) + v(2.5, 1.2, 1.5) * random.vector();
            let ray = Ray::new(target + distance * random.direction(), DVec3::ZERO);
            let ray = Ray {
                direction: target - ray.origin,
                ..ray
            };
            for hit in all(plan, walker, &ray) {
                let foot = surfaces::<f64>(plan).site(&ray, &hit, None).foot;
                let slant = foot.normal.dot(ray.direction.normalize()).abs();
                // Distance of the point from the ray, in pairs.
                let d = pairs(ray.direction);
                let (p, o) = (foot.point.to_array(), ray.origin.to_array());
                let w = [0, 1, 2].map(|k| Twofold::difference(p[k], o[k]));
                let off = values(add_scaled(w, -(dot2(w, d) / dot2(d, d)), d)).length();
                worst[far] = worst[far].max(off * slant);
                judged[far] += 1;
            }
        }
    });
    let ulp = 8.0 * f64::EPSILON;
    println!(
        "off the ray, in ulp of the size, by distance: {:?}",
        worst.map(|w| w / ulp)
    );
    assert!(judged.iter().all(|n| *n > 1500), "{judged:?}");
    assert!(worst.iter().all(|w| *w < ulp), "{worst:?}");
}

#[test]
fn scaling_by_a_power_of_two_changes_no_bit() {
    let mut random = Random(8);
    let size = |k: i32| libm::exp2(f64::from(k));
    for power in [-300, -40, 37, 250] {
        let k = size(power);
        let (one, other) = (
            teapot::teapot(DVec3::ZERO, 1.0),
            teapot::teapot(DVec3::ZERO, k),
        );
        exact(&one, |a, w1| {
            exact(&other, |b, w2| {
                for _ in 0..400 {
                    let o = v(0.0, 1.0, 0.0) + 7.0 * random.direction();
                    let d = v(3.0, 2.5, 1.5) * random.vector() + v(0.0, 1.2, 0.0) - o;
                    let (p, q) = (Ray::new(o, d), Ray::new(o * k, d * k));
                    let (x, y) = (all(a, w1, &p), all(b, w2, &q));
                    assert_eq!(x, y);
                    for (x, y) in x.iter().zip(&y) {
                        let x = surfaces::<f64>(a).site(&p, x, None).foot;
                        let y = surfaces::<f64>(b).site(&q, y, None).foot;
                        assert_eq!((x.point * k, x.normal), (y.point, y.normal));
                    }
                }
            });
        });
    }
}

#[test]
fn transforms_keep_the_crossings_and_the_outward_side() {
    let mut random = Random(9);
    let shape = bumpy();
    for place in places() {
        let back = place.inverse();
        exact(&shape, |a, w1| {
            with_plan(&shape, place, Geometry::Exact, 3, |b, w2| {
                for _ in 0..1500 {
                    let (o, d) = (6.0 * random.direction(), random.vector());
                    let d = 1.4 * d - o;
                    let p = Ray::new(o, d);
                    let q = Ray::new(place.transform_point3(o), place.transform_vector3(d));
                    let (x, y) = (all(a, w1, &p), all(b, w2, &q));
                    if x.len() != y.len() {
                        // A touching ray: the rounded transform may part it from the surface.
                        let pair = |h: &[Hit]| h.windows(2).any(|w| w[1].t - w[0].t < 1e-6);
                        assert!(pair(&x) || pair(&y), "{o} {d}");
                        continue;
                    }
                    for (x, y) in x.iter().zip(&y) {
                        let fx = surfaces::<f64>(a).site(&p, x, None).foot;
                        let fy = surfaces::<f64>(b).site(&q, y, None).foot;
                        assert_eq!(x.back, y.back);
                        let slant = fx.normal.dot(d.normalize()).abs();
                        assert!((x.t - y.t).abs() * slant < 1e-13);
                        assert!(
                            (back.transform_point3(fy.point) - fx.point).length() * slant < 1e-13
                        );
                        let n = place.matrix3.inverse().transpose() * fx.normal;
                        assert!((n.normalize() - fy.normal).length() * slant < 1e-12);
                        assert_eq!(fy.normal.dot(q.direction) > 0.0, y.back);
                    }
                }
            });
        });
    }
}

#[test]
fn spawned_rays_do_not_meet_the_surface_they_leave() {
    let mut random = Random(10);
    let mut judged = 0;
    for scale in [1.0, 1e-5, 1e6] {
        // Bent away from its front: nothing above the tangent plane.
        let mut dome = paraboloid(0.5, scale);
        let Shape::Bezier { points, .. } = &mut dome else {
            panic!("no patches")
        };
        *points = points
            .iter()
            .map(|p| v(p.x, p.y, -p.z) + v(0.0, 3e3, 0.0) * scale)
            .collect();
        exact(&dome, |plan, walker| {
            for _ in 0..2000 {
                let at = random.vector();
                let target = v(at.x, at.y + 3e3, -0.7) * scale;
                let o = target + v(random.next(), random.next(), 4.0 * random.next()) * 3.0 * scale;
                let ray = Ray::new(o, target - o);
                for hit in all(plan, walker, &ray) {
                    let foot = surfaces::<f64>(plan).site(&ray, &hit, None).foot;
                    let n = foot.normal;
                    assert!(n.z > 0.0, "{n}");
                    let along = n.cross(random.direction()).normalize();
                    for rise in [1.0, 1e-3, 1e-8, 1e-12, 0.0] {
                        let d = along + rise * n;
                        if d.dot(n) < 0.0 {
                            continue;
                        }
                        judged += 1;
                        let away = Ray::new(foot.spawn(d), d);
                        assert!(
                            !surfaces::<f64>(plan).any_hit(&away, walker),
                            "{scale} {rise} {d}"
                        );
                    }
                    // Through it, and nothing but it: the other side has no second sheet straight down.
                    let down = Ray::new(foot.spawn(-n), -n);
                    let near = Ray {
                        t_max: 1e-6 * scale,
                        ..down
                    };
                    assert!(!surfaces::<f64>(plan).any_hit(&near, walker));
                }
            }
        });
    }
    assert!(judged > 15000, "{judged}");
}

#[test]
fn meshes_stay_within_their_chord_error_which_falls_with_the_square() {
    for shape in [teapot::teapot(DVec3::ZERO, 1.0), bumpy()] {
        let nets = nets(&shape);
        let mut last = f64::INFINITY;
        for n in [2u32, 4, 8, 16, 32] {
            let mesh = tessellate(&shape, 4 * n, 1);
            let per_patch = ((n + 1) * (n + 1)) as usize;
            let mut largest = 0.0f64;
            for t in &mesh.triangles {
                let net = &nets[t[0] as usize / per_patch];
                let bound = chord_error(net, n);
                let corners = t.map(|i| mesh.positions[i as usize]);
                let places = t.map(|i| mesh.texcoords[i as usize]);
                for k in 0..9 {
                    let (b, c) = (f64::from(k % 3) / 3.0, f64::from(k / 3) / 3.0);
                    let a = 1.0 - b - c;
                    if a < 0.0 {
                        continue;
                    }
                    let p = a * corners[0] + b * corners[1] + c * corners[2];
                    let uv = a * places[0] + b * places[1] + c * places[2];
                    let off = (jet(net, uv.x, uv.y).point - p).length();
                    assert!(off <= bound * (1.0 + 1e-12), "{n}: {off} {bound}");
                    largest = largest.max(off);
                }
            }
            assert!(n < 16 || largest < last / 3.5, "{n}: {largest} {last}");
            last = largest;
        }
    }
}

#[test]
fn bounds_hold_the_surface_and_little_more() {
    let pot = teapot::teapot(v(1.0, 2.0, 3.0), 2.0);
    for place in places() {
        let found = fit::of_shape(&pot, &place).unwrap();
        let mesh = tessellate(&pot, 512, 1);
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for p in &mesh.positions {
            let p = place.transform_point3(*p);
            (low, high) = (low.min(p), high.max(p));
        }
        assert!(found.min.cmple(low + 1e-12).all() && found.max.cmpge(high - 1e-12).all());
        let room = 0.004 * (high - low).max_element();
        assert!((low - found.min).max_element() < room && (found.max - high).max_element() < room);
    }
}

/// Points of the published teapot that no patch uses, from 0.
const SPARE: [u16; 4] = [204, 205, 215, 222];

#[test]
fn the_teapots_figures_are_newells() {
    let mut used = [0; 306];
    for i in teapot::PATCHES.iter().flatten() {
        used[*i as usize] += 1;
    }
    let spare: Vec<u16> = (0..306).filter(|i| used[*i as usize] == 0).collect();
    assert_eq!(spare, SPARE);
    let pot = Shape::Bezier {
        points: teapot::POINTS.map(DVec3::from_array).to_vec().into(),
        patches: teapot::PATCHES.map(|p| p.map(u32::from)).to_vec().into(),
    };
    let nets = nets(&pot);
    // Mirror images: y -> -y for all, x -> -x too for what is turned; and quarter turns within a control point's rounding.
    let key = |net: &Net, f: &dyn Fn(DVec3) -> DVec3| {
        let mut all: Vec<[i64; 3]> = net
            .iter()
            .flatten()
            .map(|p| f(*p).to_array().map(|x| (x * 1e5).round() as i64))
            .collect();
        all.sort_unstable();
        all
    };
    let same: Vec<_> = nets.iter().map(|net| key(net, &|p| p)).collect();
    for (k, net) in nets.iter().enumerate() {
        assert!(same.contains(&key(net, &|p| v(p.x, -p.y, p.z))), "{k}");
        let turned = !(12..20).contains(&k);
        assert_eq!(
            same.contains(&key(net, &|p| v(-p.y, p.x, p.z))),
            turned,
            "{k}"
        );
        assert_eq!(
            same.contains(&key(net, &|p| v(-p.x, p.y, p.z))),
            turned,
            "{k}"
        );
    }
    // Borders: four patches around, each ends where the next begins; rows of patches follow each other.
    let column = |net: &Net, j: usize| net.map(|row| row[j]);
    for (first, around) in [0, 4, 8, 20, 24, 28]
        .map(|k| (k, 4))
        .into_iter()
        .chain([12, 14, 16, 18].map(|k| (k, 2)))
    {
        for k in 0..around {
            let (this, next) = (&nets[first + k], &nets[first + (k + 1) % around]);
            assert_eq!(column(this, 3), column(next, 0), "{first} {k}");
        }
    }
    for (upper, lower) in [(0, 4), (4, 8), (12, 14), (16, 18), (20, 24)] {
        let around = if (12..20).contains(&upper) { 2 } else { 4 };
        for k in 0..around {
            assert_eq!(nets[upper + k][3], nets[lower + k][0], "{upper} {k}");
        }
    }
    // The bottom hangs on the body's last row, the other way round.
    for (body, bottom) in [(8, 31), (9, 30), (10, 29), (11, 28)] {
        let mut row = nets[bottom][3];
        row.reverse();
        assert_eq!(nets[body][3], row);
    }
    // Extent of the surface: spout, handle, body, knob.
    let bounds = fit::of_shape(&pot, &DAffine3::IDENTITY).unwrap();
    let mesh = tessellate(&pot, 512, 1);
    let reach = |of: &dyn Fn(&DVec3) -> f64| mesh.positions.iter().map(of).fold(0.0, f64::max);
    let found = [
        reach(&|p| p.x),
        reach(&|p| -p.x),
        reach(&|p| p.y),
        reach(&|p| p.z),
    ];
    println!("spout, handle, half width, height: {found:?} {bounds:?}");
    for (found, expected) in found.into_iter().zip([3.434, 3.0, 2.0, 3.15]) {
        assert!((found - expected).abs() < 5e-4, "{found} {expected}");
    }
}

#[test]
fn the_teapot_faces_outwards_and_its_poles_have_normals() {
    let pot = teapot::teapot(DVec3::ZERO, 1.0);
    let nets = nets(&pot);
    let steps = || (0..=16).map(|k| f64::from(k) / 16.0);
    for (k, net) in nets.iter().enumerate() {
        for (s, t) in steps().flat_map(|s| steps().map(move |t| (s, t))) {
            let (p, n) = (jet(net, s, t).point, normal(net, s, t));
            assert!((n.length() - 1.0).abs() < 1e-15, "{k} {s} {t}");
            // Away from the middle line: of handle and spout that of their rings, of the rim its ring, of the body the axis.
            let out = match k {
                0..4 => p - 1.45 * v(p.x, 0.0, p.z).normalize() - v(0.0, 2.4, 0.0),
                4..12 => v(p.x, 0.0, p.z),
                12..20 => {
                    let other = &nets[((k - 12) ^ 1) + 12];
                    let ring = [
                        jet(net, 0.0, t),
                        jet(net, 0.5, t),
                        jet(net, 1.0, t),
                        jet(other, 0.5, t),
                    ];
                    p - ring.iter().map(|j| j.point).sum::<DVec3>() / 4.0
                }
                20..24 => p - v(0.0, 2.9, 0.0),
                24..28 => DVec3::Y,
                _ => DVec3::NEG_Y,
            };
            // Around the knob and the spout's lip the side follows from the rays below. Lid and bottom end upright.
            let turns = matches!(k, 18..24);
            assert!(turns || n.dot(out) > -1e-15, "{k} {s} {t}: {n} {out}");
        }
    }
    // Poles: straight up on the knob, straight down below.
    for k in 20..24 {
        for s in steps() {
            assert!((normal(&nets[k], s, 0.0) - DVec3::Y).length() < 1e-15);
            let below = normal(&nets[k + 8], s, 0.0);
            assert!((below - DVec3::NEG_Y).length() < 1e-15, "{below}");
        }
    }
    // Seen from far away, only the inside of the spout, and what shows through the gap of the lid, is a back.
    let mut random = Random(11);
    let (mut fronts, mut backs) = (0, 0);
    exact(&pot, |plan, walker| {
        for _ in 0..20000 {
            let o = v(0.0, 1.5, 0.0) + 40.0 * random.direction();
            let target = v(0.2, 1.4, 0.0) + v(3.2, 1.6, 2.0) * random.vector();
            let ray = Ray::new(o, target - o);
            let Some(hit) = surfaces::<f64>(plan).closest_hit(&ray, walker) else {
                continue;
            };
            if hit.back {
                backs += 1;
                let through = |height: f64| o + ray.direction * ((height - o.y) / ray.direction.y);
                let gap = through(2.4);
                let spout = (through(2.45) - v(3.0, 2.45, 0.0)).abs();
                let ring = v(gap.x, 0.0, gap.z).length();
                let lid = (1.28..1.43).contains(&ring);
                assert!(lid || spout.x < 0.5 && spout.z < 0.3, "{o} {target}");
            } else {
                fronts += 1;
            }
        }
    });
    println!("fronts {fronts}, backs {backs}");
    assert!(fronts > 5000 && backs * 50 < fronts, "{fronts} {backs}");
}
