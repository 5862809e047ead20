//! The rasterizer against answers derived by hand, by brute force, or by a property that must hold.

use std::sync::Arc;

use proptest::prelude::*;
use rastray::frame::{Frame, LayerIndex, NONE, Plane};
use rastray::gl::{self, ColorControl, LightSource, ShadeModel};
use rastray::lanes::Isa;
use rastray::math::{DAffine3, DVec2, DVec3};
use rastray::raster::{Counters, Options, coverage};
use rastray::sampling::{self, Pattern};
use rastray::scene::{
    Camera, Cull, FrontFace, Geometry, Light, LightSpace, Material, Mesh, Object, Optics,
    Projection, Scene, Shape, Snap,
};

use crate::common::precise::{Precise, assembled, rasterize, rasterizer};

// ---- building scenes ----------------------------------------------------------------------------------------------

/// A picture of `width` x `height` pixels in which one scene unit is one pixel; world (0, 0) is its centre.
fn pixel_scene(width: u32, height: u32) -> Scene {
    let mut scene = Scene::default();
    scene.image.width = width;
    scene.image.height = height;
    scene.camera = Camera {
        projection: Projection::Orthographic {
            height: f64::from(height),
        },
        near: 1.0,
        ..Camera::default()
    };
    scene.light_model.ambient = [0.0; 3];
    scene
}

/// A material that only shines by itself.
fn glow(color: [f64; 3]) -> Material {
    let front = gl::Material {
        emission: color,
        ambient: [0.0; 3],
        diffuse: [0.0; 3],
        ..gl::Material::default()
    };
    material(front)
}

/// A white diffuse material.
fn white() -> Material {
    material(gl::Material {
        ambient: [0.0; 3],
        diffuse: [1.0; 3],
        ..gl::Material::default()
    })
}

fn material(front: gl::Material) -> Material {
    Material {
        name: String::new(),
        front,
        back: None,
        optics: Optics::default(),
    }
}

/// A white light from +z, eye space.
fn headlight() -> Light {
    light(LightSource::default())
}

fn light(source: LightSource) -> Light {
    Light {
        name: "key".into(),
        source,
        space: LightSpace::Eye,
        enabled: true,
    }
}

/// Adds a mesh object of one material; empty normals = flat.
fn add_mesh(scene: &mut Scene, points: &[[f64; 3]], normals: &[[f64; 3]], m: Material) {
    scene.materials.push(m);
    let triangles = (0..points.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
    let mesh = Mesh {
        positions: points.iter().map(|p| DVec3::from_array(*p)).collect(),
        normals: normals.iter().map(|n| DVec3::from_array(*n)).collect(),
        triangles: triangles.collect(),
        ..Mesh::default()
    };
    add(scene, Geometry::Mesh(Arc::new(mesh)));
}

fn add_shape(scene: &mut Scene, shape: Shape, m: Material) {
    scene.materials.push(m);
    add(scene, Geometry::Shape(shape));
}

fn add(scene: &mut Scene, geometry: Geometry) {
    scene.objects.push(Object {
        name: format!("object {}", scene.objects.len()),
        geometry,
        materials: vec![scene.materials.len() - 1],
        world_from_object: DAffine3::IDENTITY,
        tessellation: None,
        priority: 0,
    });
}

fn options(shading: ShadeModel) -> Options {
    Options {
        shading,
        clamp: false,
        layers: false,
        isa: Isa::detect(),
    }
}

fn draw_with<R: Precise>(scene: &Scene, options: &Options) -> (Frame<R>, Counters) {
    let assembly = assembled::<R>(scene, None).expect("a small scene");
    let plan = rasterizer(scene, &assembly);
    rasterize(&plan, options).expect("a legal picture")
}

fn draw(scene: &Scene, shading: ShadeModel) -> Frame<f64> {
    draw_with(scene, &options(shading)).0
}

/// One character a pixel: the primitive's number, or a dot.
fn text(frame: &Frame<f64>) -> String {
    let plane = &frame.primitive;
    let rows = plane.data.chunks(plane.width).map(|row| {
        let digit = |p: &u32| char::from_digit(*p, 36).unwrap_or('?');
        let pixel = |p: &u32| if *p == NONE { '.' } else { digit(p) };
        row.iter().map(pixel).collect::<String>()
    });
    rows.collect::<Vec<_>>().join("\n")
}

/// How many of some triangles (pixel coordinates, y down) own each pixel centre, as text.
fn owners(triangles: &[[[f64; 2]; 3]], size: [u32; 2], snap: Snap) -> String {
    let mut count = Plane::filled(size[0] as usize, size[1] as usize, 0u32);
    for t in triangles {
        for run in coverage(*t, [0, 0], size, snap) {
            for x in run.x0..=run.x1 {
                count.data[run.y as usize * count.width + x as usize] += 1;
            }
        }
    }
    let digit = |n: &u32| char::from_digit(*n, 36).unwrap_or('?');
    let rows = count.data.chunks(count.width);
    let rows = rows.map(|row| row.iter().map(digit).collect::<String>());
    rows.collect::<Vec<_>>().join("\n")
}

fn close(a: [f64; 3], b: [f64; 3], tolerance: f64) -> bool {
    (0..3).all(|k| (a[k] - b[k]).abs() <= tolerance)
}

// ---- coverage -----------------------------------------------------------------------------------------------------

#[test]
fn a_quad_of_two_triangles_owns_each_pixel_once() {
    let (a, b, c, d) = ([1.5, 1.5], [6.5, 1.5], [6.5, 5.5], [1.5, 5.5]);
    // Centres on the left and top sides are in, those on the right and bottom sides are out.
    let expected = "00000000\n01111100\n01111100\n01111100\n01111100\n00000000\n00000000";
    for quad in [
        [[a, b, c], [a, c, d]],
        [[b, a, c], [d, c, a]],
        [[a, b, d], [b, c, d]],
    ] {
        assert_eq!(owners(&quad, [8, 7], Snap::Bits8), expected);
        assert_eq!(owners(&quad, [8, 7], Snap::Bits12), expected);
    }
}

#[test]
fn a_fan_around_a_pixel_centre_owns_each_pixel_once() {
    let hub = [5.5, 5.5];
    let rim = [
        [9.5, 5.5],
        [9.0, 8.0],
        [5.5, 9.5],
        [2.0, 9.0],
        [1.5, 5.5],
        [2.0, 2.0],
        [5.5, 1.5],
        [8.0, 3.0],
    ];
    let fan: Vec<_> = (0..8).map(|i| [hub, rim[i], rim[(i + 1) % 8]]).collect();
    let got = owners(&fan, [11, 11], Snap::Bits8);
    assert!(!got.contains('2'), "{got}");
    // Every centre strictly inside the rim is owned: compare with the polygon's own even-odd test.
    for y in 0..11 {
        for x in 0..11 {
            let (px, py) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
            let side = |i: usize| {
                let (a, b): ([f64; 2], [f64; 2]) = (rim[i], rim[(i + 1) % 8]);
                (b[0] - a[0]) * (py - a[1]) - (b[1] - a[1]) * (px - a[0])
            };
            let inside = (0..8).all(|i| side(i) > 0.0);
            let outside = (0..8).any(|i| side(i) < 0.0);
            let owned = got
                .lines()
                .nth(y as usize)
                .map(|l| &l[x as usize..=x as usize]);
            if inside {
                assert_eq!(owned, Some("1"), "{x} {y}\n{got}");
            } else if outside {
                assert_eq!(owned, Some("0"), "{x} {y}\n{got}");
            }
        }
    }
}

#[test]
fn without_a_grid_nothing_is_lost() {
    // Two triangles far smaller than the snap around two pixel centres, and one between them.
    let around = |x: f64, y: f64| [[x - 1e-4, y - 1e-4], [x + 1e-4, y - 1e-4], [x, y + 1e-4]];
    let tiny = [around(1.5, 0.5), around(3.5, 1.5), around(2.0, 1.0)];
    assert_eq!(owners(&tiny, [5, 2], Snap::Bits8), "00000\n00000");
    assert_eq!(owners(&tiny, [5, 2], Snap::Exact), "01000\n00010");
    // A fan whose middle the grid would move: each centre still has one owner, its hub's among them.
    let hub = [3.5, 3.5];
    let ring = [[0.3, 0.4], [6.7, 0.2], [7.1, 6.9], [0.1, 7.2]];
    let fan = [0, 1, 2, 3].map(|i| [hub, ring[i], ring[(i + 1) % 4]]);
    let square = "1111111\n".repeat(6) + "1111111";
    assert_eq!(owners(&fan, [7, 7], Snap::Exact), square);
    assert_eq!(owners(&fan, [7, 7], Snap::Bits8), square);
}

#[test]
fn triangles_beyond_the_integers_share_their_edges() {
    // A fan from one hub to corners so far away that they do not snap.
    for (size, hub) in [(1e12, [7.3, 6.1]), (1e30, [7.5, 6.5]), (1e300, [2.0, 9.9])] {
        let ring = [
            [-size, -0.7 * size],
            [size, -size],
            [0.3 * size, size],
            [-size, size],
        ];
        let fan = [0, 1, 2, 3].map(|i| [hub, ring[i], ring[(i + 1) % 4]]);
        for snap in [Snap::Bits8, Snap::Bits12, Snap::Exact] {
            let all = "111111111111\n".repeat(11) + "111111111111";
            assert_eq!(owners(&fan, [12, 12], snap), all, "{size:e} {snap:?}");
        }
    }
}

#[test]
fn degenerate_triangles_own_nothing() {
    let p = [3.5, 3.5];
    for t in [
        [p, p, p],
        [p, p, [7.5, 7.5]],
        [[0.5, 0.5], [3.5, 3.5], [7.5, 7.5]],
        [[f64::NAN, 0.0], p, [0.0, 5.0]],
        [[f64::INFINITY, 0.0], p, [0.0, 5.0]],
    ] {
        assert!(coverage(t, [0, 0], [8, 8], Snap::Bits8).is_empty(), "{t:?}");
    }
}

proptest! {
    #[test]
    fn any_triangulated_quad_owns_no_pixel_twice(
        points in prop::array::uniform4(prop::array::uniform2(-200i32..1800)),
        fine in any::<bool>(),
    ) {
        // Four points on a grid of 1/64 px; the two triangles on either side of the diagonal a-c.
        let [a, b, c, d] = points.map(|p| p.map(|x| f64::from(x) / 64.0));
        let side = |p: [f64; 2]| (c[0] - a[0]) * (p[1] - a[1]) - (c[1] - a[1]) * (p[0] - a[0]);
        prop_assume!(side(b) * side(d) < 0.0);
        let snap = if fine { Snap::Bits12 } else { Snap::Bits8 };
        let text = owners(&[[a, b, c], [a, c, d]], [26, 26], snap);
        prop_assert!(!text.contains('2'), "{}", text);
        // And each centre strictly inside one of them is owned.
        let strictly = |t: [[f64; 2]; 3], p: [f64; 2]| {
            let s = |i: usize| {
                let (u, v): ([f64; 2], [f64; 2]) = (t[i], t[(i + 1) % 3]);
                (v[0] - u[0]) * (p[1] - u[1]) - (v[1] - u[1]) * (p[0] - u[0])
            };
            (0..3).all(|i| s(i) > 0.0) || (0..3).all(|i| s(i) < 0.0)
        };
        for (y, row) in text.lines().enumerate() {
            for (x, owners) in row.chars().enumerate() {
                let p = [x as f64 + 0.5, y as f64 + 0.5];
                if strictly([a, b, c], p) || strictly([a, c, d], p) {
                    prop_assert_eq!(owners, '1', "{} {}\n{}", x, y, text);
                }
            }
        }
    }

    #[test]
    fn turning_the_vertices_round_changes_no_pixel(
        points in prop::array::uniform3(prop::array::uniform2(-20.0f64..60.0)),
    ) {
        let [a, b, c] = points;
        let reference = owners(&[[a, b, c]], [40, 40], Snap::Bits8);
        for t in [[b, c, a], [c, a, b], [b, a, c], [a, c, b]] {
            prop_assert_eq!(&owners(&[t], [40, 40], Snap::Bits8), &reference);
        }
    }
}

#[test]
fn the_picture_is_y_down_from_the_top_left() {
    let mut scene = pixel_scene(6, 4);
    // Pixel corner (0, 0) is world (-3, 2). A triangle in the top-left corner, counter-clockwise for a y-up viewer.
    add_mesh(
        &mut scene,
        &[[-3.0, 2.0, 0.0], [-3.0, -1.0, 0.0], [0.0, 2.0, 0.0]],
        &[],
        glow([1.0; 3]),
    );
    assert_eq!(
        text(&draw(&scene, ShadeModel::Flat)),
        "00....\n0.....\n......\n......"
    );
}

#[test]
fn huge_triangles_cover_the_picture() {
    let mut scene = pixel_scene(70, 66);
    let far = 1e9;
    add_mesh(
        &mut scene,
        &[[-far, -far, 0.0], [far, -far, 0.0], [0.0, far, 0.0]],
        &[],
        glow([0.25, 0.5, 1.0]),
    );
    // And one beyond the range of the integers, farther away: it fills nothing that the first has not.
    let farther = 1e14;
    add_mesh(
        &mut scene,
        &[
            [-farther, -farther, -1.0],
            [farther, -farther, -1.0],
            [0.0, farther, -1.0],
        ],
        &[],
        glow([1.0; 3]),
    );
    let frame = draw(&scene, ShadeModel::Gouraud);
    assert!(frame.primitive.data.iter().all(|p| *p == 0));
    assert!(frame.color.data.iter().all(|c| *c == [0.25, 0.5, 1.0]));
    scene.objects.remove(0);
    let (frame, counters) = draw_with::<f64>(&scene, &options(ShadeModel::Gouraud));
    assert!(frame.primitive.data.iter().all(|p| *p == 0));
    assert_eq!(
        (counters.triangles_drawn, counters.triangles_clipped),
        (1, 0)
    );
}

// ---- perspective, near plane, depth -------------------------------------------------------------------------------

/// Where a pixel's ray meets the plane of three points, by the textbook: barycentric weights and distance along -z.
fn meet(points: [DVec3; 3], origin: DVec3, direction: DVec3) -> ([f64; 3], f64) {
    let [a, b, c] = points;
    let n = (b - a).cross(c - a);
    let t = n.dot(a - origin) / n.dot(direction);
    let p = origin + direction * t;
    let area = |u: DVec3, v: DVec3| (u - p).cross(v - p).dot(n) / n.length_squared();
    ([area(b, c), area(c, a), area(a, b)], t)
}

#[test]
fn interpolation_is_perspective_correct() {
    let mut scene = Scene::default();
    (scene.image.width, scene.image.height) = (96, 64);
    scene.camera.eye = DVec3::ZERO;
    scene.camera.target = DVec3::NEG_Z;
    scene.light_model.ambient = [0.0; 3];
    scene.lights.push(headlight());
    let points = [[-3.0, -1.0, -3.0], [2.0, -0.5, -2.5], [1.0, 4.0, -14.0]];
    // n.l = n_z: 1, 0.6, 0.28
    let normals = [[0.0, 0.0, 1.0], [0.8, 0.0, 0.6], [0.0, 0.96, 0.28]];
    add_mesh(&mut scene, &points, &normals, white());
    let frame = draw(&scene, ShadeModel::Gouraud);
    let mut seen = 0;
    for y in 0..64 {
        for x in 0..96 {
            if *frame.primitive.at(x, y) == NONE {
                continue;
            }
            seen += 1;
            let place = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
            let (o, d) = scene.camera.primary_ray(place, 96, 64);
            let (b, t) = meet(points.map(DVec3::from_array), o, d);
            if b.iter().any(|b| *b < 0.0) {
                continue; // owned through snapping
            }
            let expected = b[0] + 0.6 * b[1] + 0.28 * b[2];
            let got = *frame.color.at(x, y);
            assert!(
                close(got, [expected; 3], 1e-12),
                "{x} {y}: {got:?} {expected}"
            );
            assert!((frame.depth.at(x, y) - t).abs() < 1e-12 * t);
        }
    }
    assert!(seen > 500, "{seen}");
}

#[test]
fn a_floor_through_the_eye_plane_is_drawn_from_near_on() {
    let mut scene = Scene::default();
    (scene.image.width, scene.image.height) = (40, 40);
    scene.camera.eye = DVec3::ZERO;
    scene.camera.target = DVec3::NEG_Z;
    scene.camera.projection = Projection::Perspective { fovy_deg: 90.0 };
    scene.camera.near = 1.5;
    // The plane y = -1, from behind the eye to far ahead; the view is 45 degrees down at the bottom edge.
    let points = [[-1e6, -1.0, 1e6], [1e6, -1.0, 1e6], [0.0, -1.0, -1e9]];
    add_mesh(&mut scene, &points, &[], glow([1.0, 0.5, 0.25]));
    let frame = draw(&scene, ShadeModel::Flat);
    for y in 0..40 {
        for x in 0..40 {
            // Row y looks along slope s = (y + 0.5 - 20) / 20; the floor lies at distance 1 / s.
            let slope = (y as f64 + 0.5 - 20.0) / 20.0;
            let distance = 1.0 / slope;
            let visible = slope > 0.0 && distance >= 1.5;
            assert_eq!(*frame.primitive.at(x, y) == 0, visible, "{x} {y}");
            if visible {
                assert!((frame.depth.at(x, y) - distance).abs() < 1e-9 * distance);
                assert_eq!(*frame.color.at(x, y), [1.0, 0.5, 0.25]);
            } else {
                assert_eq!(*frame.depth.at(x, y), f64::INFINITY);
            }
        }
    }
}

#[test]
fn far_cuts_where_the_camera_has_one() {
    let mut scene = Scene::default();
    (scene.image.width, scene.image.height) = (40, 40);
    scene.camera.eye = DVec3::ZERO;
    scene.camera.target = DVec3::NEG_Z;
    scene.camera.projection = Projection::Perspective { fovy_deg: 90.0 };
    scene.camera.near = 0.5;
    scene.camera.far = Some(3.0);
    let points = [[-1e3, -1.0, 1e3], [1e3, -1.0, 1e3], [0.0, -1.0, -1e6]];
    add_mesh(&mut scene, &points, &[], glow([1.0; 3]));
    let frame = draw(&scene, ShadeModel::Flat);
    for y in 0..40 {
        let slope = (y as f64 + 0.5 - 20.0) / 20.0;
        let visible = slope > 0.0 && 1.0 / slope <= 3.0;
        assert_eq!(*frame.primitive.at(20, y) == 0, visible, "{y}");
    }
}

#[test]
fn the_nearer_wins_and_ties_go_to_the_lower_number() {
    for projection in [
        Projection::Perspective { fovy_deg: 60.0 },
        Projection::Orthographic { height: 8.0 },
    ] {
        let square = |z: f64| {
            let (a, b, c, d) = (
                [-3.0, -3.0, z],
                [3.0, -3.0, z],
                [3.0, 3.0, z],
                [-3.0, 3.0, z],
            );
            [a, b, c, a, c, d]
        };
        let mut scene = pixel_scene(8, 8);
        scene.camera.projection = projection;
        for (i, z) in [0.0, 1.0, 1.0, -1.0, 0.5].into_iter().enumerate() {
            add_mesh(&mut scene, &square(z), &[], glow([i as f64, 0.0, 0.0]));
        }
        let frame = draw(&scene, ShadeModel::Flat);
        assert_eq!(*frame.object.at(4, 4), 1);
        assert_eq!(frame.color.at(4, 4)[0], 1.0);
        assert_eq!(*frame.depth.at(4, 4), 4.0);
        for object in &frame.object.data {
            assert!(*object == 1 || *object == NONE || *object == 0, "{object}");
        }
    }
}

/// GL_LESS on the window depth that the depth range makes: GL 2.1 sections 2.11.1 and 4.1.6.
#[test]
fn the_depth_range_decides_what_less_means() {
    let mut scene = pixel_scene(2, 2);
    scene.image.background = [0.125; 3];
    // Drawn in the order middle, far, near; each covers the picture.
    for (z, e) in [(1.0, 0.5), (-1.0, 0.25), (2.0, 0.75)] {
        let corners = [[-9.0, -9.0, z], [9.0, -9.0, z], [0.0, 9.0, z]];
        add_mesh(&mut scene, &corners, &[], glow([e; 3]));
    }
    for (range, depth_test, expected) in [
        ([0.0, 1.0], true, 0.75),
        ([0.25, 0.5], true, 0.75),
        ([1.0, 0.0], true, 0.25),
        ([0.5, 0.5], true, 0.5),
        ([1.0, 1.0], true, 0.125),
        ([1.0, 7.0], true, 0.125),
        ([-1.0, 0.0], true, 0.5),
        ([0.0, 1.0], false, 0.75),
        ([1.0, 0.0], false, 0.75),
    ] {
        (scene.raster.depth_range, scene.raster.depth_test) = (range, depth_test);
        for snap in [Snap::Bits8, Snap::Exact] {
            scene.raster.snap = snap;
            let frame = draw(&scene, ShadeModel::Flat);
            let found = frame.color.data.iter().all(|c| *c == [expected; 3]);
            assert!(
                found,
                "{range:?} {depth_test} {snap:?}: {:?}",
                frame.color.data
            );
        }
    }
}

#[test]
fn near_and_distant_surfaces_keep_their_order() {
    // Relative distances of 2^-22 at 5 million times near, as the depth cases ask; drawn far to near and near to far.
    for near_first in [false, true] {
        let mut scene = Scene::default();
        (scene.image.width, scene.image.height) = (16, 16);
        scene.camera.eye = DVec3::ZERO;
        scene.camera.target = DVec3::NEG_Z;
        scene.camera.near = 1e-3;
        let z = 5000.0;
        let mut distances = [z * (1.0 + 2f64.powi(-22)), z];
        if near_first {
            distances.reverse();
        }
        for d in distances {
            let points = [[-9e3, -9e3, -d], [9e3, -9e3, -d], [0.0, 9e3, -d]];
            add_mesh(&mut scene, &points, &[], glow([d, 0.0, 0.0]));
        }
        let frame = draw_with::<f32>(&scene, &options(ShadeModel::Flat)).0;
        assert_eq!(frame.color.at(8, 8)[0], 5000.0);
    }
}

// ---- shading ------------------------------------------------------------------------------------------------------

/// Right triangle with legs of 8 px along the left and the bottom side of an 8 x 8 picture, n.l = 1, 0.5, 0 at the corners.
fn ramp() -> Scene {
    let mut scene = pixel_scene(8, 8);
    scene.lights.push(headlight());
    let points = [[-4.0, 4.0, 0.0], [-4.0, -4.0, 0.0], [4.0, -4.0, 0.0]];
    let s = 0.75f64.sqrt();
    let normals = [[0.0, 0.0, 1.0], [s, 0.0, 0.5], [1.0, 0.0, 0.0]];
    add_mesh(&mut scene, &points, &normals, white());
    scene
}

#[test]
fn gouraud_is_affine_between_the_corners_of_a_flat_view() {
    let frame = draw(&ramp(), ShadeModel::Gouraud);
    for y in 0..8 {
        for x in 0..y {
            // Weights at (x + 1/2, y + 1/2): the far right corner X = (x + 1/2) / 8, the top one 1 - (y + 1/2) / 8.
            let right = (x as f64 + 0.5) / 8.0;
            let top = 1.0 - (y as f64 + 0.5) / 8.0;
            let expected = top + 0.5 * (1.0 - top - right);
            assert!(
                close(*frame.color.at(x, y), [expected; 3], 1e-14),
                "{x} {y}"
            );
        }
    }
}

#[test]
fn flat_takes_the_last_vertex_even_when_it_is_clipped_away() {
    let frame = draw(&ramp(), ShadeModel::Flat);
    assert_eq!(*frame.color.at(0, 7), [0.0; 3]);
    // The provoking vertex lies before near: GL 2.1 section 2.14.7 decides before clipping.
    let mut scene = ramp();
    scene.objects.clear();
    let points = [[-4.0, 4.0, 0.0], [4.0, -4.0, 0.0], [-4.0, -4.0, 4.9]];
    let normals = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.6, 0.0, 0.8]];
    add_mesh(&mut scene, &points, &normals, white());
    let (frame, counters) = draw_with::<f64>(&scene, &options(ShadeModel::Flat));
    assert_eq!(counters.triangles_clipped, 1);
    assert_eq!(*frame.primitive.at(0, 7), NONE);
    assert!(close(*frame.color.at(3, 4), [0.8; 3], 1e-15));
}

#[test]
fn per_fragment_shading_renormalises() {
    let frame = draw(&ramp(), ShadeModel::Phong);
    // On the left side between the first two corners, at weight q of the second:
    // n = (1 - q)(0, 0, 1) + q (sqrt(3)/2, 0, 1/2), colour = n_z / |n|. Row y, column x as in the affine test.
    let s = 0.75f64.sqrt();
    for (x, y) in [(0, 3), (1, 4), (2, 6)] {
        let right = (f64::from(x) + 0.5) / 8.0;
        let top = 1.0 - (f64::from(y) + 0.5) / 8.0;
        let middle = 1.0 - top - right;
        let (nx, nz) = (middle * s + right, top + 0.5 * middle);
        let expected = nz / (nx * nx + nz * nz).sqrt();
        let got = *frame.color.at(x as usize, y as usize);
        assert!(close(got, [expected; 3], 1e-14), "{got:?} {expected}");
    }
}

#[test]
fn clamping_happens_at_vertices_before_interpolation() {
    let mut scene = ramp();
    scene.lights[0].source.diffuse = [4.0; 3]; // vertex colours 4, 2, 0: clamped 1, 1, 0
    let clamped = Options {
        clamp: true,
        ..options(ShadeModel::Gouraud)
    };
    let frame = draw_with::<f64>(&scene, &clamped).0;
    let expected = 1.0 - 2.5 / 8.0; // only the right corner is dark
    assert!(close(*frame.color.at(2, 5), [expected; 3], 1e-14));
    let unclamped = draw(&scene, ShadeModel::Gouraud);
    assert!(unclamped.color.at(0, 2)[0] > 2.0);
    // Per fragment: clamped there.
    let phong = Options {
        clamp: true,
        ..options(ShadeModel::Phong)
    };
    let frame = draw_with::<f64>(&scene, &phong).0;
    assert!(
        frame
            .color
            .data
            .iter()
            .flatten()
            .all(|x| (0.0..=1.0).contains(x))
    );
}

#[test]
fn separate_specular_clamps_apart() {
    // Diffuse -0.5, specular 0.8 at n = l = h: together 0.3; apart clamp(-0.5) + clamp(0.8) = 0.8.
    let mut scene = pixel_scene(4, 4);
    scene.lights.push(light(LightSource {
        specular: [0.8; 3],
        ..LightSource::default()
    }));
    scene.light_model.local_viewer = false;
    let front = gl::Material {
        ambient: [0.0; 3],
        diffuse: [-0.5; 3],
        specular: [1.0; 3],
        shininess: 10.0,
        ..gl::Material::default()
    };
    let points = [[-9.0, -9.0, 0.0], [9.0, -9.0, 0.0], [0.0, 9.0, 0.0]];
    add_mesh(&mut scene, &points, &[], material(front));
    for shading in [ShadeModel::Flat, ShadeModel::Gouraud, ShadeModel::Phong] {
        for (control, expected) in [
            (ColorControl::Single, 0.3),
            (ColorControl::SeparateSpecular, 0.8),
        ] {
            scene.light_model.color_control = control;
            let clamp = Options {
                clamp: true,
                ..options(shading)
            };
            let frame = draw_with::<f64>(&scene, &clamp).0;
            assert!(close(*frame.color.at(2, 2), [expected; 3], 1e-12));
            let plain = draw(&scene, shading);
            assert!(close(*plain.color.at(2, 2), [0.3; 3], 1e-12));
        }
    }
}

#[test]
fn two_sided_lighting_flips_normal_and_material() {
    let mut scene = pixel_scene(4, 4);
    scene.lights.push(headlight());
    let mut m = white();
    m.back = Some(gl::Material {
        ambient: [0.0; 3],
        diffuse: [0.25, 0.5, 0.75],
        ..gl::Material::default()
    });
    // Clockwise from the eye, so a back face; its normal points away from the eye and the light.
    let points = [[-9.0, -9.0, 0.0], [0.0, 9.0, 0.0], [9.0, -9.0, 0.0]];
    add_mesh(&mut scene, &points, &[], m);
    for shading in [ShadeModel::Flat, ShadeModel::Gouraud, ShadeModel::Phong] {
        scene.light_model.two_sided = true;
        assert_eq!(*draw(&scene, shading).color.at(2, 2), [0.25, 0.5, 0.75]);
        scene.light_model.two_sided = false;
        assert_eq!(*draw(&scene, shading).color.at(2, 2), [0.0; 3]);
        // With the other winding as front, the same triangle is a front face: front material, normal as given.
        scene.light_model.two_sided = true;
        scene.raster.front_face = FrontFace::Cw;
        assert_eq!(*draw(&scene, shading).color.at(2, 2), [0.0; 3]);
        scene.raster.front_face = FrontFace::Ccw;
    }
}

#[test]
fn culling_drops_the_side_that_it_names() {
    let mut scene = pixel_scene(8, 4);
    let left = [[-4.0, -2.0, 0.0], [0.0, -2.0, 0.0], [-4.0, 2.0, 0.0]]; // counter-clockwise
    let right = [[0.0, -2.0, 0.0], [0.0, 2.0, 0.0], [4.0, -2.0, 0.0]]; // clockwise
    add_mesh(&mut scene, &left, &[], glow([1.0; 3]));
    add_mesh(&mut scene, &right, &[], glow([1.0; 3]));
    let (front, back) = ((true, false), (false, true));
    for (cull, face, expected) in [
        (Cull::None, FrontFace::Ccw, (true, true)),
        (Cull::Back, FrontFace::Ccw, front),
        (Cull::Front, FrontFace::Ccw, back),
        (Cull::Back, FrontFace::Cw, back),
        (Cull::Front, FrontFace::Cw, front),
    ] {
        scene.raster.cull = cull;
        scene.raster.front_face = face;
        let (frame, counters) = draw_with::<f64>(&scene, &options(ShadeModel::Flat));
        let seen = |p: u32| frame.primitive.data.contains(&p);
        assert_eq!((seen(0), seen(1)), expected, "{cull:?} {face:?}");
        let kept = u64::from(expected.0) + u64::from(expected.1);
        assert_eq!(counters.triangles_drawn, kept);
        assert_eq!(counters.triangles_culled, 2 - kept);
    }
}

#[test]
fn unnormalised_normals_enter_per_vertex_lighting_with_their_length() {
    let mut scene = ramp();
    scene.light_model.normalize = false;
    scene.objects[0].world_from_object = DAffine3::from_scale(DVec3::splat(1.0));
    let Geometry::Mesh(mesh) = &scene.objects[0].geometry else {
        panic!("a mesh")
    };
    let mut mesh = Mesh::clone(mesh);
    mesh.normals = vec![DVec3::new(0.0, 0.0, 0.5); 3];
    scene.objects[0].geometry = Geometry::Mesh(Arc::new(mesh));
    let assembly = assembled::<f64>(&scene, None).expect("a small scene");
    assert_eq!([0, 1, 2].map(|v| assembly.normal_length(v)), [0.5; 3]);
    // Per-fragment shading renormalises whatever the light model says.
    assert!(close(
        *draw(&scene, ShadeModel::Phong).color.at(1, 5),
        [1.0; 3],
        1e-15
    ));
}

// ---- samples ------------------------------------------------------------------------------------------------------

#[test]
fn samples_count_as_their_pattern_says() {
    for (pattern, samples) in [
        (Pattern::Grid, 4),
        (Pattern::Grid, 6),
        (Pattern::Jitter, 1),
        (Pattern::Jitter, 16),
    ] {
        let mut scene = pixel_scene(70, 9);
        scene.image.samples = samples;
        scene.image.pattern = pattern;
        scene.image.background = [0.0, 1.0, 0.0];
        // Pixel coordinates (-3, -2), (66, 4), (5, 11).
        let px = [[-3.0, -2.0], [66.0, 4.0], [5.0, 11.0]];
        let points = px.map(|[x, y]| [x - 35.0, 4.5 - y, 0.0]);
        add_mesh(&mut scene, &points, &[], glow([1.0, 0.0, 0.0]));
        let frame = draw(&scene, ShadeModel::Flat);
        for y in 0..9u32 {
            for x in 0..70u32 {
                let inside = |sample: u32| {
                    let (sx, sy) = sampling::position(pattern, samples, x, y, sample);
                    let p = [
                        f64::from(x) + f64::from(sx) / 256.0,
                        f64::from(y) + f64::from(sy) / 256.0,
                    ];
                    // No sample lies on an edge of this triangle... where one does, top-left decides.
                    (0..3).all(|i| {
                        let (a, b) = (px[i], px[(i + 1) % 3]);
                        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
                        let e = dx * (p[1] - a[1]) - dy * (p[0] - a[0]);
                        e > 0.0 || (e == 0.0 && (dy < 0.0 || (dy == 0.0 && dx > 0.0)))
                    })
                };
                let hits = (0..samples).filter(|s| inside(*s)).count() as u32;
                let share = |n: u32| f64::from(n) / f64::from(samples);
                let got = *frame.color.at(x as usize, y as usize);
                assert_eq!(
                    got,
                    [share(hits), share(samples - hits), 0.0],
                    "{pattern:?} {samples} {x} {y}"
                );
                let first = if inside(0) { 0 } else { NONE };
                assert_eq!(*frame.primitive.at(x as usize, y as usize), first);
            }
        }
    }
}

// ---- whole scenes -------------------------------------------------------------------------------------------------

/// Two spheres and a floor under three kinds of light, across several tiles.
fn spheres() -> Scene {
    let mut scene = Scene::default();
    (scene.image.width, scene.image.height) = (150, 130);
    scene.image.background = [0.1, 0.2, 0.3];
    scene.camera.eye = DVec3::new(0.5, 2.0, 7.0);
    let mut shiny = white();
    shiny.front.ambient = [0.3, 0.2, 0.1];
    shiny.front.specular = [0.9; 3];
    shiny.front.shininess = 20.0;
    shiny.front.emission = [0.01, 0.02, 0.03];
    let sphere = |x: f64, radius: f64| Shape::Sphere {
        center: DVec3::new(x, 0.2, x),
        radius,
    };
    add_shape(&mut scene, sphere(-1.0, 1.0), shiny.clone());
    shiny.front.diffuse = [0.2, 0.7, 0.4];
    add_shape(&mut scene, sphere(1.3, 0.8), shiny.clone());
    shiny.front.diffuse = [0.9, 0.9, 0.1];
    let floor = Shape::Patch {
        corner: DVec3::new(-5.0, -1.0, 5.0),
        edge_u: DVec3::X * 10.0,
        edge_v: DVec3::NEG_Z * 10.0,
        tiles: [3, 3],
    };
    add_shape(&mut scene, floor, shiny);
    let world = |name: &str, source: LightSource| Light {
        name: name.into(),
        source,
        space: LightSpace::World,
        enabled: true,
    };
    scene.lights.push(world(
        "sun",
        LightSource {
            position: [1.0, 2.0, 1.0, 0.0],
            ambient: [0.05; 3],
            diffuse: [0.6; 3],
            ..LightSource::default()
        },
    ));
    scene.lights.push(world(
        "bulb",
        LightSource {
            position: [-3.0, 4.0, 3.0, 1.0],
            diffuse: [0.9, 0.7, 0.5],
            attenuation: [0.5, 0.1, 0.02],
            ..LightSource::default()
        },
    ));
    scene.lights.push(world(
        "spot",
        LightSource {
            position: [0.0, 5.0, 0.0, 1.0],
            spot_direction: [0.0, -1.0, 0.0],
            spot_cutoff_deg: 35.0,
            spot_exponent: 3.0,
            ..LightSource::default()
        },
    ));
    scene
}

const SHADINGS: [ShadeModel; 3] = [ShadeModel::Flat, ShadeModel::Gouraud, ShadeModel::Phong];

#[test]
fn visibility_agrees_with_brute_force_rays() {
    let scene = spheres();
    let assembly = assembled::<f64>(&scene, Some(24)).expect("a small scene");
    let plan = rasterizer(&scene, &assembly);
    let (frame, counters) = rasterize::<f64>(&plan, &options(ShadeModel::Flat)).expect("drawn");
    let all = counters.triangles_outside + counters.triangles_culled;
    let all = all + counters.triangles_degenerate + counters.triangles_drawn;
    assert_eq!(counters.triangles_in, all);
    let edges = plan.near_edge(&frame.primitive, 0.01);
    let corners = assembly.triangles().iter();
    let corners = corners.map(|t| t.map(|v| DVec3::from_array(assembly.vertex_eye(v))));
    let corners: Vec<_> = corners.collect();
    // What the ray of each pixel meets first.
    let nearest = |x: usize, y: usize| {
        let place = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
        let (o, d) = scene.camera.primary_ray(place, 150, 130);
        let mut best = (f64::INFINITY, NONE);
        for (i, points) in corners.iter().enumerate() {
            let (b, t) = meet(*points, o, d);
            if b.iter().all(|b| *b >= 0.0) && t >= scene.camera.near && t < best.0 {
                best = (t, i as u32);
            }
        }
        best
    };
    let pixels = (0..130).flat_map(|y| (0..150).map(move |x| (x, y)));
    let met = Plane {
        width: 150,
        height: 130,
        data: pixels.map(|(x, y)| nearest(x, y)).collect(),
    };
    let near_other = plan.near_edge(&met.map(|(_, i)| *i), 0.01);
    let (mut compared, mut apart) = (0, 0);
    for y in 0..130 {
        for x in 0..150 {
            let (best, got) = (*met.at(x, y), *frame.primitive.at(x, y));
            if *edges.at(x, y) || (best.1 != NONE && got != best.1 && *near_other.at(x, y)) {
                apart += 1;
                continue;
            }
            compared += 1;
            assert_eq!(got, best.1, "{x} {y}");
            if got != NONE {
                assert!((frame.depth.at(x, y) - best.0).abs() <= 1e-12 * best.0);
            }
        }
    }
    assert!(apart * 20 < compared, "{apart} apart, {compared} compared");
}

#[test]
fn layers_add_up_to_the_picture_bit_for_bit() {
    let mut signed = spheres();
    signed.lights[0].source.diffuse = [0.6, -0.4, 0.2];
    signed.materials[2].front.specular = [0.5, 0.5, -3.0];
    for (mut scene, negative) in [(spheres(), false), (signed, true)] {
        assert_eq!(scene.has_negative_colors(), negative);
        for shading in SHADINGS {
            for samples in [1, 3] {
                scene.image.samples = samples;
                layers_add_up::<f32>(&scene, shading, samples);
                layers_add_up::<f64>(&scene, shading, samples);
            }
        }
    }
}

fn layers_add_up<R: Precise>(scene: &Scene, shading: ShadeModel, samples: u32) {
    let plain = draw_with::<R>(scene, &options(shading)).0;
    for clamp in [false, true] {
        let with_layers = Options {
            clamp,
            layers: true,
            ..options(shading)
        };
        let frame = draw_with::<R>(scene, &with_layers).0;
        let layers = frame.layers.as_ref().expect("layers");
        let index = LayerIndex { lights: 3 };
        assert_eq!(layers.planes.len(), index.count());
        for (pixel, color) in plain.color.data.iter().enumerate() {
            assert_eq!(
                layers.sum(pixel),
                *color,
                "{shading:?} {samples} {clamp} {pixel}"
            );
            let rest = layers.planes[index.remainder()].data[pixel];
            if samples == 1 && shading != ShadeModel::Gouraud {
                let zero = |x: &R| x.to_f64().to_bits() == 0;
                assert!(rest.iter().all(zero), "{rest:?}");
            }
            // It is rounding, not substance.
            let bound = 64.0 * R::ROUNDOFF.to_f64();
            assert!(rest.iter().all(|x| x.to_f64().abs() <= bound), "{rest:?}");
        }
        if !clamp {
            assert_eq!(frame.color, plain.color);
        } else {
            let clamped = Options {
                layers: false,
                ..with_layers
            };
            assert_eq!(frame.color, draw_with::<R>(scene, &clamped).0.color);
        }
        assert_eq!(frame.depth, plain.depth);
    }
}

#[test]
fn threads_and_draws_give_the_same_bytes() {
    let mut scene = spheres();
    scene.image.pattern = Pattern::Jitter;
    scene.image.samples = 2;
    for shading in SHADINGS {
        let options = Options {
            layers: true,
            clamp: true,
            ..options(shading)
        };
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let pool = pool.expect("threads");
            pool.install(|| draw_with::<f32>(&scene, &options))
        };
        let (one, counters) = on(1);
        for threads in [2, 8] {
            let (many, counted) = on(threads);
            assert_eq!(counted, counters);
            assert_eq!(bytes(&one), bytes(&many));
        }
    }
}

fn bytes(frame: &Frame<f32>) -> Vec<u32> {
    let colors = frame.color.data.iter().flatten().map(|x| x.to_bits());
    let depth = frame.depth.data.iter().map(|x| x.to_bits());
    let layers = frame.layers.iter().flat_map(|l| &l.planes);
    let layers = layers.flat_map(|p| p.data.iter().flatten().map(|x| x.to_bits()));
    let ids = frame.primitive.data.iter().chain(&frame.object.data);
    colors
        .chain(depth)
        .chain(layers)
        .chain(ids.copied())
        .collect()
}

#[test]
fn scaling_by_powers_of_two_changes_no_bit() {
    let reference = {
        let mut scene = spheres();
        scene.lights.remove(1); // attenuation has a length in it
        scene
    };
    for exponent in [-20, 26] {
        let k = 2f64.powi(exponent);
        let mut scene = reference.clone();
        scene.camera.eye *= k;
        scene.camera.near *= k;
        for object in &mut scene.objects {
            object.world_from_object = DAffine3::from_scale(DVec3::splat(k));
        }
        scene.lights[1].source.position[1] *= k;
        for shading in SHADINGS {
            let a = draw_with::<f32>(&reference, &options(shading)).0;
            let b = draw_with::<f32>(&scene, &options(shading)).0;
            assert_eq!(a.primitive, b.primitive);
            assert_eq!(a.color, b.color, "{shading:?} 2^{exponent}");
        }
    }
}

#[test]
fn poisoned_vertices_neither_panic_nor_leave_nan() {
    for poison in [
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        -0.0,
        f64::from(f32::MAX),
        -f64::from(f32::MAX),
        f64::MAX,
        1e-45,
        f64::MIN_POSITIVE,
    ] {
        for place in 0..9 {
            for projection in [
                Projection::Perspective { fovy_deg: 60.0 },
                Projection::Orthographic { height: 8.0 },
            ] {
                let mut scene = pixel_scene(20, 20);
                scene.camera.projection = projection;
                scene.lights.push(headlight());
                let mut points = [[-4.0, 4.0, 0.0], [-4.0, -4.0, 1.0], [4.0, -4.0, 2.0]];
                points[place / 3][place % 3] = poison;
                let normals = [[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [0.0, 0.6, 0.8]];
                add_mesh(&mut scene, &points, &normals, white());
                for shading in SHADINGS {
                    check_finite::<f32>(&scene, shading);
                    check_finite::<f64>(&scene, shading);
                }
            }
        }
    }
}

fn check_finite<R: Precise>(scene: &Scene, shading: ShadeModel) {
    let assembly = assembled::<R>(scene, None).expect("a small scene");
    let plan = rasterizer(scene, &assembly);
    let frame = rasterize::<R>(&plan, &options(shading)).expect("drawn").0;
    assert!(frame.color.data.iter().flatten().all(|x| x.is_finite()));
    assert!(frame.depth.data.iter().all(|x| x.to_f64() >= 0.0));
    let edge = plan.near_edge(&frame.primitive, 0.5);
    assert_eq!(edge.data.len(), frame.primitive.data.len());
}

#[test]
fn slivers_keep_within_the_range_of_their_corners() {
    // Triangles far thinner than the snap: a sample they win lies outside them, and extrapolation would be wild.
    let mut won = 0;
    for i in 0..2000 {
        let mut scene = pixel_scene(12, 12);
        scene.lights.push(headlight());
        let y = -5.0 + f64::from(i) * 0.004_871_3;
        let points = [
            [-6.0, y, 0.0],
            [6.0, y + 0.993, 3.0],
            [0.0, y + 0.4965 + 1e-6, -1e3],
        ];
        let normals = [[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [1.0, 0.0, 0.0]];
        add_mesh(&mut scene, &points, &normals, white());
        let frame = draw(&scene, ShadeModel::Gouraud);
        for (color, primitive) in frame.color.data.iter().zip(&frame.primitive.data) {
            if *primitive != NONE {
                won += 1;
                assert!((0.0..=1.0).contains(&color[0]), "{color:?}");
            }
        }
        let within = |d: &f64| *d == f64::INFINITY || (2.0..=1005.0).contains(d);
        assert!(frame.depth.data.iter().all(within));
    }
    assert!(won > 0, "no sliver won a sample: the test shows nothing");
}

#[test]
fn near_edge_is_the_distance_to_the_projected_outline() {
    let mut scene = pixel_scene(16, 16);
    // Right triangle with its legs on x = 2 and y = 12 (pixels), hypotenuse from (2, 2) to (12, 12).
    let px = [[2.0, 2.0], [2.0, 12.0], [12.0, 12.0]];
    let points = px.map(|[x, y]| [x - 8.0, 8.0 - y, 0.0]);
    add_mesh(&mut scene, &points, &[], glow([1.0; 3]));
    let assembly = assembled::<f64>(&scene, None).expect("a small scene");
    let plan = rasterizer(&scene, &assembly);
    let frame = rasterize::<f64>(&plan, &options(ShadeModel::Flat))
        .expect("drawn")
        .0;
    let edge = plan.near_edge(&frame.primitive, 0.75);
    for y in 0..16 {
        for x in 0..16 {
            let (cx, cy) = (x as f64 + 0.5, y as f64 + 0.5);
            let hypotenuse = (cy - cx) / 2f64.sqrt();
            let distance = (cx - 2.0).min(12.0 - cy).min(hypotenuse);
            let expected = *frame.primitive.at(x, y) != NONE && distance <= 0.75;
            assert_eq!(*edge.at(x, y), expected, "{x} {y}");
        }
    }
}

#[test]
fn impossible_pictures_are_refused() {
    let mut scene = pixel_scene(0, 8);
    let assembly = assembled::<f32>(&scene, None).expect("an empty scene");
    let refused = |scene: &Scene| {
        let plan = rasterizer(scene, &assembly);
        plan.draw(&options(ShadeModel::Flat))
            .expect_err("refused")
            .to_string()
    };
    assert!(refused(&scene).contains("0x8"));
    scene.image.width = 1 << 20;
    scene.image.height = 1 << 20;
    assert!(refused(&scene).contains("exceeds"));
    (scene.image.width, scene.image.height) = (4, 4);
    scene.image.samples = 0;
    assert!(refused(&scene).contains("samples"));
    scene.image.samples = 1;
    let plan = rasterizer(&scene, &assembly);
    let (frame, counters) = rasterize::<f32>(&plan, &options(ShadeModel::Phong)).expect("empty");
    assert_eq!(frame.primitive.data, [NONE; 16]);
    assert_eq!(counters, Counters::default());
}
