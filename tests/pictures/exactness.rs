//! What an exact renderer promises of whole pictures: size means nothing, precision means little, a camera may stand inside
//! a medium, and mirrors may face each other for ten thousand bounces.
//!
//! Scale (NUMERICS section 5, T1): every length of a shipped scene times 2^k, attenuation accordingly, leaves every bit of
//! both renderers' pictures as it was. Precision: f32 against f64, values before clamping relative to max(1, magnitude),
//! and decisions. The long forms:
//!
//! ```text
//! cargo test --test pictures -- --ignored --nocapture exactness::every_power     every k in -20..=26, all shipped scenes
//! cargo test --test pictures -- --ignored --nocapture exactness::table           f32 against f64 as a Markdown table
//! ```

use std::collections::HashMap;
use std::sync::Arc;
use std::time::Instant;

use rastray::frame::{Frame, LayerIndex, NONE};
use rastray::gl;
use rastray::import::{LoadOptions, Shipped, load, shipped};
use rastray::lanes::{Isa, Real};
use rastray::math::{DAffine3, DMat4, DVec3};
use rastray::render::{Assembled, Tracer};
use rastray::scene::profile::{Curve, Profile};
use rastray::scene::{
    Camera, Geometry as Form, Light, LightSpace, Material, Mesh, Object, Optics, Projection, Scene,
    Shape, Tir,
};
use rastray::{raster, trace};

use crate::common::precise::{Precise, assembled, follow, rasterize, rasterizer, tracer};

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

// ---- Drawing ---------------------------------------------------------------------------------------------------------

fn rasterized<R: Precise>(scene: &Scene, assembly: &Assembled) -> Frame<R> {
    let options = raster::Options {
        shading: scene.raster.shading,
        clamp: false,
        layers: false,
        isa: Isa::detect(),
    };
    let plan = rasterizer(scene, assembly);
    rasterize(&plan, &options).expect("drawn").0
}

fn plan<'a>(scene: &'a Scene, assembly: &'a Assembled) -> Tracer<'a> {
    tracer(scene, assembly, trace::Geometry::Exact).expect("a plan")
}

fn traced<R: Precise>(scene: &Scene, assembly: &Assembled) -> Frame<R> {
    let options = trace::Options::of(scene, Isa::detect());
    follow(&plan(scene, assembly), &options).expect("drawn").0
}

/// A shipped scene at a size of its own.
fn loaded(shipped: &Shipped, [width, height]: [u32; 2]) -> Scene {
    let mut imported = load(shipped.name, &LoadOptions::default()).expect("a shipped scene loads");
    imported.resize(width, height);
    imported.scene
}

// ---- Scale -----------------------------------------------------------------------------------------------------------

/// Curve and points of each profile of a scene file, by the object's name: the scene itself holds their pieces alone.
fn profiles(shipped: &Shipped) -> HashMap<String, (Curve, Vec<[f64; 2]>)> {
    let file: toml::Table = shipped.text.parse().expect("a scene file");
    let objects = file.get("object").and_then(toml::Value::as_table);
    let number = |x: &toml::Value| x.as_float().or(x.as_integer().map(|i| i as f64));
    let profile = |(name, object): (&String, &toml::Value)| {
        let points = object.get("profile")?.as_array()?.iter();
        let point = |p: &toml::Value| Some([number(p.get(0)?)?, number(p.get(1)?)?]);
        let curve = object.get("curve").and_then(toml::Value::as_str);
        let named = |(name, _): &&(&str, Curve)| Some(*name) == curve;
        let curve = Curve::NAMES.iter().find(named).map(|(_, c)| *c);
        let points = points.map(point).collect::<Option<Vec<_>>>()?;
        Some((name.clone(), (curve.unwrap_or_default(), points)))
    };
    objects.into_iter().flatten().filter_map(profile).collect()
}

fn scaled_shape(shape: &Shape, profile: Option<&(Curve, Vec<[f64; 2]>)>, k: f64) -> Shape {
    let mut shape = shape.clone();
    match &mut shape {
        Shape::Sphere { center, radius } | Shape::Disk { center, radius, .. } => {
            *center *= k;
            *radius *= k;
        }
        Shape::Box { min, max } => {
            *min *= k;
            *max *= k;
        }
        Shape::Patch {
            corner,
            edge_u,
            edge_v,
            ..
        } => [corner, edge_u, edge_v].into_iter().for_each(|x| *x *= k),
        Shape::Cylinder {
            base,
            top: end,
            radius,
            ..
        }
        | Shape::Cone {
            base,
            apex: end,
            radius,
            ..
        } => {
            *base *= k;
            *end *= k;
            *radius *= k;
        }
        Shape::Torus {
            center,
            major,
            minor,
            ..
        } => {
            *center *= k;
            *major *= k;
            *minor *= k;
        }
        Shape::Revolution {
            base, profile: p, ..
        } => {
            let (curve, points) = profile.expect("the points of a profile");
            let points: Vec<_> = points.iter().map(|p| p.map(|x| x * k)).collect();
            *base *= k;
            *p = Arc::new(Profile::new(*curve, &points).expect("a profile"));
        }
        Shape::Bezier { points, .. } => *points = points.iter().map(|p| *p * k).collect(),
    }
    shape
}

/// Every length of a scene times `k`, attenuation by distance accordingly.
fn scaled(scene: &Scene, profiles: &HashMap<String, (Curve, Vec<[f64; 2]>)>, k: f64) -> Scene {
    let mut scene = scene.clone();
    let camera = &mut scene.camera;
    camera.eye *= k;
    camera.target *= k;
    camera.near *= k;
    camera.far = camera.far.map(|far| far * k);
    match &mut camera.projection {
        Projection::Perspective { .. } => {}
        Projection::Orthographic { height } => *height *= k,
        Projection::Matrix { clip_from_eye } => {
            *clip_from_eye *= DMat4::from_scale(DVec3::splat(1.0 / k));
        }
    }
    for light in &mut scene.lights {
        let source = &mut light.source;
        if source.position[3] != 0.0 {
            source.position[..3].iter_mut().for_each(|x| *x *= k);
        }
        source.attenuation[1] /= k;
        source.attenuation[2] /= k * k;
    }
    // Meshes that objects share stay shared.
    let mut meshes: HashMap<*const Mesh, Arc<Mesh>> = HashMap::new();
    for object in &mut scene.objects {
        object.world_from_object.translation *= k;
        object.geometry = match &object.geometry {
            Form::Shape(shape) => Form::Shape(scaled_shape(shape, profiles.get(&object.name), k)),
            Form::Mesh(mesh) => {
                let larger = meshes.entry(Arc::as_ptr(mesh)).or_insert_with(|| {
                    let mut mesh = (**mesh).clone();
                    mesh.positions.iter_mut().for_each(|p| *p *= k);
                    Arc::new(mesh)
                });
                Form::Mesh(Arc::clone(larger))
            }
        };
    }
    scene
}

/// What must not change: colours, who is seen, and depth in units of the scene.
fn bits<R: Real>(frame: &Frame<R>, k: f64) -> (Vec<[u64; 3]>, Vec<u64>, Vec<u32>, Vec<u32>) {
    let bits = |x: f64| x.to_bits();
    let color = frame.color.data.iter();
    let depth = frame.depth.data.iter();
    (
        color.map(|c| c.map(|x| bits(x.to_f64()))).collect(),
        depth.map(|x| bits(x.to_f64() / k)).collect(),
        frame.primitive.data.clone(),
        frame.object.data.clone(),
    )
}

/// How many pictures of a scene change with its size, of how many.
fn changed_by_scale<R: Precise>(shipped: &Shipped, size: [u32; 2], powers: &[i32]) -> [usize; 2] {
    let (scene, profiles) = (loaded(shipped, size), profiles(shipped));
    assert_eq!(scaled(&scene, &profiles, 1.0), scene, "{}", shipped.name);
    let level = Some(16);
    let pictures = |scene: &Scene, k: f64| {
        let assembly = assembled::<R>(scene, level).expect("a small scene");
        [
            bits(&rasterized::<R>(scene, &assembly), k),
            bits(&traced::<R>(scene, &assembly), k),
        ]
    };
    let expected = pictures(&scene, 1.0);
    let (mut changed, mut drawn) = (0, 0);
    for power in powers {
        let k = libm::exp2(f64::from(*power));
        let found = pictures(&scaled(&scene, &profiles, k), k);
        for (renderer, (a, b)) in ["raster", "trace"].iter().zip(expected.iter().zip(&found)) {
            drawn += 1;
            if a != b {
                changed += 1;
                let pixels = a.0.iter().zip(&b.0).filter(|(a, b)| a != b).count();
                let (name, bits) = (shipped.name, 8 * std::mem::size_of::<R>());
                println!("{name} 2^{power} {renderer} f{bits}: {pixels} colours differ");
            }
        }
    }
    [changed, drawn]
}

fn no_picture_changes_with_its_size(size: [u32; 2], powers: &[i32]) {
    let (mut changed, mut drawn) = (0, 0);
    for scene in shipped() {
        for [c, d] in [
            changed_by_scale::<f32>(scene, size, powers),
            changed_by_scale::<f64>(scene, size, powers),
        ] {
            changed += c;
            drawn += d;
        }
    }
    println!(
        "{drawn} pictures of {} scenes, {changed} changed",
        shipped().len()
    );
    assert!(drawn >= 4 * powers.len() * shipped().len());
    assert_eq!(changed, 0, "of {drawn} pictures");
}

#[test]
fn powers_of_two_leave_the_shipped_scenes_bit_identical() {
    no_picture_changes_with_its_size([24, 18], &[-20, -1, 13, 26]);
}

#[test]
#[ignore = "every power of two on every shipped scene: a few minutes"]
fn every_power_of_two_leaves_the_shipped_scenes_bit_identical() {
    let powers: Vec<i32> = (-20..=26).collect();
    no_picture_changes_with_its_size([40, 30], &powers);
}

// ---- f32 against f64 -------------------------------------------------------------------------------------------------

/// A picture as numbers that both precisions have.
struct Seen {
    color: Vec<[f64; 3]>,
    primitive: Vec<u32>,
    object: Vec<u32>,
    /// Per light and pixel whether its diffuse and specular light is blocked, where there would be any; empty for the
    /// rasterizer.
    shadowed: Vec<Option<bool>>,
}

impl Seen {
    fn new<R: Real>(frame: &Frame<R>, shadowed: Vec<Option<bool>>) -> Self {
        let color = frame.color.data.iter();
        Self {
            color: color.map(|c| c.map(Real::to_f64)).collect(),
            primitive: frame.primitive.data.clone(),
            object: frame.object.data.clone(),
            shadowed,
        }
    }
}

/// The rasterizer's picture and the tracer's.
fn both<R: Precise>(scene: &Scene) -> [Seen; 2] {
    let assembly = assembled::<R>(scene, None).expect("a small scene");
    let plan = plan(scene, &assembly);
    let draw = |options: trace::Options| {
        let options = trace::Options {
            layers: true,
            ..options
        };
        follow::<R>(&plan, &options).expect("drawn").0
    };
    let isa = Isa::detect();
    let (full, cast) = (
        draw(trace::Options::of(scene, isa)),
        draw(trace::Options::cast(isa)),
    );
    let lights = scene.enabled_lights().count();
    let lit = |frame: &Frame<R>, light: usize, pixel: usize| {
        let first = LayerIndex { lights }.light(light) + 1;
        let planes = &frame.layers.as_ref().expect("layers").planes[first..first + 2];
        let values = planes.iter().flat_map(|p| p.data[pixel]);
        values.into_iter().any(|x| x.to_f64() != 0.0)
    };
    let pixels = full.color.data.len();
    let places = (0..lights * pixels).map(|i| (i / pixels, i % pixels));
    let shadowed = places
        .map(|(light, pixel)| lit(&cast, light, pixel).then(|| !lit(&full, light, pixel)))
        .collect();
    [
        Seen::new(&rasterized::<R>(scene, &assembly), Vec::new()),
        Seen::new(&full, shadowed),
    ]
}

/// How two precisions differ.
#[derive(Clone, Copy, Debug, Default)]
struct Apart {
    /// Largest difference and 99th percentile over pixels, relative to max(1, magnitude).
    max: f64,
    p99: f64,
    /// The largest where all decisions are equal.
    agreed_max: f64,
    /// Pixels where one precision hits something and the other nothing, where the objects, and the primitives differ.
    hit: usize,
    object: usize,
    primitive: usize,
    /// Lights and pixels where one precision has shadow and the other light.
    shadow: usize,
}

fn apart(single: &Seen, double: &Seen) -> Apart {
    let pixels = double.color.len();
    let mut errors = Vec::with_capacity(pixels);
    let mut found = Apart::default();
    for pixel in 0..pixels {
        let difference = |c: usize| {
            let (a, b) = (single.color[pixel][c], double.color[pixel][c]);
            let plain = (a - b).abs() / b.abs().max(1.0);
            if a == b { 0.0 } else { plain }
        };
        let error = difference(0).max(difference(1)).max(difference(2));
        let changes = |list: fn(&Seen) -> &Vec<u32>| list(single)[pixel] != list(double)[pixel];
        let (object, primitive) = (changes(|s| &s.object), changes(|s| &s.primitive));
        let nothing = [single, double].map(|s| s.object[pixel] == NONE);
        let lights = single.shadowed.len() / pixels;
        let shadows = (0..lights).map(|light| light * pixels + pixel);
        // Light that is 0 in one precision for other reasons (a power below the smallest number) decides nothing.
        let shadows = shadows
            .filter(|i| match (single.shadowed[*i], double.shadowed[*i]) {
                (Some(a), Some(b)) => !object && a != b,
                _ => false,
            })
            .count();
        found.hit += usize::from(nothing[0] != nothing[1]);
        found.object += usize::from(object);
        found.primitive += usize::from(primitive);
        found.shadow += shadows;
        if !primitive && shadows == 0 {
            found.agreed_max = found.agreed_max.max(error);
        }
        errors.push(error);
    }
    errors.sort_by(f64::total_cmp);
    found.max = errors[pixels - 1];
    found.p99 = errors[pixels * 99 / 100];
    found
}

fn precisions_apart(scene: &Scene) -> [Apart; 2] {
    let (single, double) = (both::<f32>(scene), both::<f64>(scene));
    [0, 1].map(|k| apart(&single[k], &double[k]))
}

#[test]
#[ignore = "a measurement: f32 against f64 of every shipped scene as a Markdown table"]
fn table_of_precisions() {
    println!(
        "| scene | raster max | p99 | agreed | hit | object | prim. | trace max | p99 | agreed | hit | object | prim. | shadow |"
    );
    println!("| - | - | - | - | - | - | - | - | - | - | - | - | - | - |");
    for shipped in shipped() {
        let scene = loaded(shipped, [160, 120]);
        let [r, t] = precisions_apart(&scene);
        let one = |a: &Apart| {
            let Apart {
                max,
                p99,
                agreed_max,
                hit,
                object,
                primitive,
                ..
            } = a;
            format!("{max:.1e} | {p99:.1e} | {agreed_max:.1e} | {hit} | {object} | {primitive}")
        };
        println!(
            "| {} | {} | {} | {} |",
            shipped.name,
            one(&r),
            one(&t),
            t.shadow
        );
    }
}

/// Few decisions differ, and values only where they do, or by roundings of f32.
#[test]
fn f32_pictures_are_f64_pictures_within_rounding() {
    for name in ["whitted", "14-shadow", "17-refraction", "vase"] {
        let found = shipped().iter().find(|s| s.name == name);
        let scene = loaded(found.expect("a shipped scene"), [64, 48]);
        let pixels = 64 * 48;
        for (renderer, a) in ["raster", "trace"].iter().zip(precisions_apart(&scene)) {
            println!("{name} {renderer}: {a:?}");
            assert!(a.p99 <= 1e-5, "{name} {renderer}: {a:?}");
            let decisions = a.primitive + a.shadow;
            assert!(decisions * 1000 <= pixels, "{name} {renderer}: {a:?}");
        }
    }
}

// ---- A camera inside a medium ------------------------------------------------------------------------------------------

const HAIR: f64 = 1e-9;

/// How a picture of one pixel looks along the view direction.
#[derive(Clone, Copy, Debug)]
enum View {
    Perspective,
    Orthographic,
    Matrix,
}

const VIEWS: [View; 3] = [View::Perspective, View::Orthographic, View::Matrix];

/// A scene of one pixel whose ray starts at `eye` and goes along `direction`. No lights, no ambient.
fn one_ray(view: View, eye: DVec3, direction: DVec3) -> Scene {
    let mut scene = Scene::default();
    (scene.image.width, scene.image.height) = (1, 1);
    scene.light_model.ambient = [0.0; 3];
    scene.camera = Camera {
        eye,
        target: eye + direction,
        up: direction.any_orthonormal_vector(),
        projection: match view {
            View::Orthographic => Projection::Orthographic { height: 1e-3 },
            View::Perspective | View::Matrix => Projection::Perspective { fovy_deg: 40.0 },
        },
        near: 1e-6,
        far: None,
    };
    if let View::Matrix = view {
        let clip_from_eye = scene.camera.clip_from_eye(1.0);
        scene.camera.projection = Projection::Matrix { clip_from_eye };
    }
    scene
}

fn material(scene: &mut Scene, emission: f64, optics: Optics) -> usize {
    let front = gl::Material {
        emission: [emission; 3],
        ambient: [0.0; 3],
        diffuse: [0.0; 3],
        ..gl::Material::default()
    };
    scene.materials.push(Material {
        name: format!("m{}", scene.materials.len()),
        front,
        back: None,
        optics,
    });
    scene.materials.len() - 1
}

fn glass(scene: &mut Scene, ior: f64) -> usize {
    let optics = Optics {
        transmission: [1.0; 3],
        ior,
        ..Optics::default()
    };
    material(scene, 0.0, optics)
}

fn add(scene: &mut Scene, geometry: Form, materials: &[usize]) {
    scene.objects.push(Object {
        name: format!("o{}", scene.objects.len()),
        geometry,
        materials: materials.to_vec(),
        world_from_object: DAffine3::IDENTITY,
        tessellation: None,
        priority: 0,
    });
}

fn ball(scene: &mut Scene, radius: f64, material: usize) {
    let center = DVec3::ZERO;
    add(
        scene,
        Form::Shape(Shape::Sphere { center, radius }),
        &[material],
    );
}

/// A wall at z, dark where x < border and bright beyond.
fn wall(scene: &mut Scene, z: f64, border: f64) {
    let dark = material(scene, 0.25, Optics::default());
    let bright = material(scene, 0.75, Optics::default());
    let shape = Shape::Patch {
        corner: v(border - 1e3, -1e3, z),
        edge_u: v(2e3, 0.0, 0.0),
        edge_v: v(0.0, 2e3, 0.0),
        tiles: [2, 1],
    };
    add(scene, Form::Shape(shape), &[dark, bright]);
}

/// Green of the first pixel, f64.
fn seen(scene: &Scene) -> f64 {
    let assembly = assembled::<f64>(scene, Some(16)).expect("a small scene");
    traced::<f64>(scene, &assembly).color.data[0][1]
}

/// Asserts that `scene(border)` sees its wall exactly at x = `expected`.
fn assert_border(expected: f64, scene: impl Fn(f64) -> Scene) {
    assert_eq!(seen(&scene(expected + HAIR)), 0.25, "left of {expected}");
    assert_eq!(seen(&scene(expected - HAIR)), 0.75, "right of {expected}");
}

/// From (a, 0, 0) along +z: the sphere of radius r is met at height sqrt(r^2 - a^2), at the angle i with sin i = a / r to
/// its normal; outside, the ray leans towards the axis by the angle of refraction less i.
#[test]
fn from_inside_a_ball_rays_leave_by_snells_law() {
    for view in VIEWS {
        for (n, a, r) in [
            (1.5, 0.5, 1.0),
            (1.33, 1.2, 2.0),
            (0.8, 0.9, 1.0),
            (1.5, 0.0, 1.0),
        ] {
            let scene = |border: f64| {
                let mut scene = one_ray(view, v(a, 0.0, 0.0), DVec3::Z);
                let m = glass(&mut scene, n);
                ball(&mut scene, r, m);
                wall(&mut scene, 4.0, border);
                scene
            };
            let turn = libm::asin(n * a / r) - libm::asin(a / r);
            let height = (r * r - a * a).sqrt();
            assert_border(a - (4.0 - height) * libm::tan(turn), scene);
        }
    }
}

/// Total from the distance r / n of the middle on.
#[test]
fn from_inside_a_ball_total_reflection_starts_at_the_critical_angle() {
    let (n, r) = (1.5, 1.0);
    for view in VIEWS {
        for (step, total) in [(-HAIR, false), (HAIR, true)] {
            for tir in [Tir::None, Tir::Reflect] {
                let mut scene = one_ray(view, v(r / n + step, 0.0, 0.0), DVec3::Z);
                scene.image.background = [0.5; 3];
                scene.trace.tir = tir;
                let m = glass(&mut scene, n);
                ball(&mut scene, r, m);
                // Within a ball the angle stays: what is reflected once is reflected for ever.
                assert_eq!(
                    seen(&scene),
                    if total { 0.0 } else { 0.5 },
                    "{view:?} {tir:?}"
                );
            }
        }
    }
}

fn block(min: DVec3, max: DVec3) -> Shape {
    Shape::Box { min, max }
}

/// The closed mesh of a shape.
fn meshed(shape: &Shape) -> Form {
    let mesh = rastray::scene::tessellate::tessellate(shape, 64, 1);
    assert!(mesh.is_closed());
    Form::Mesh(Arc::new(mesh))
}

/// The sky is seen through a round window of radius depth tan(asin(1 / n)); around it is total reflection.
#[test]
fn snells_window() {
    let n = 1.33;
    let water = block(v(-1e4, -1e4, -50.0), v(1e4, 1e4, 0.0));
    for geometry in [Form::Shape(water.clone()), meshed(&water)] {
        for depth in [0.01, 3.0, 40.0] {
            let radius = depth * libm::tan(libm::asin(1.0 / n));
            for (step, sky) in [(-HAIR, 0.5), (HAIR, 0.0)] {
                let on_surface = v(0.6, 0.8, 0.0) * (radius * (1.0 + step));
                let eye = v(0.0, 0.0, -depth);
                let mut scene = one_ray(View::Perspective, eye, on_surface - eye);
                scene.image.background = [0.5; 3];
                let m = glass(&mut scene, n);
                add(&mut scene, geometry.clone(), &[m]);
                assert_eq!(seen(&scene), sky, "depth {depth}");
            }
        }
        // A whole picture, looking up: a disc of tan(asin(1 / n)) about the middle.
        let mut scene = one_ray(View::Perspective, v(0.3, 0.2, -3.0), DVec3::Z);
        (scene.image.width, scene.image.height) = (64, 64);
        scene.camera.projection = Projection::Perspective { fovy_deg: 120.0 };
        scene.image.background = [0.5; 3];
        let m = glass(&mut scene, n);
        add(&mut scene, geometry.clone(), &[m]);
        let assembly = assembled::<f32>(&scene, None).expect("a small scene");
        let frame = traced::<f32>(&scene, &assembly);
        let (window, half) = (
            libm::tan(libm::asin(1.0 / n)),
            libm::tan(60f64.to_radians()),
        );
        let mut bright = 0;
        for (i, color) in frame.color.data.iter().enumerate() {
            let at = |x: usize| (2.0 * (x as f64 + 0.5) / 64.0 - 1.0) * half;
            let distance = at(i % 64).hypot(at(i / 64));
            let expected = if distance < window { 0.5 } else { 0.0 };
            assert_eq!(color[1], expected, "pixel {i}: {distance} of {window}");
            bright += usize::from(distance < window);
        }
        assert!(bright > 500, "{bright}");
    }
}

/// The innermost solid decides: from an air bubble in glass, straight through both surfaces of a concentric ball.
#[test]
fn nested_media_are_listed_innermost_last() {
    let (n, inner, outer, a) = (1.5, 0.6, 1.0, 0.3);
    for (first, second) in [(true, false), (false, true)] {
        let scene = |border: f64| {
            let mut scene = one_ray(View::Perspective, v(a, 0.0, 0.0), DVec3::Z);
            let (m, air) = (glass(&mut scene, n), glass(&mut scene, 1.0));
            // File order does not matter.
            for bubble in [first, second] {
                let (radius, m) = if bubble { (inner, air) } else { (outer, m) };
                ball(&mut scene, radius, m);
            }
            wall(&mut scene, 4.0, border);
            scene
        };
        // Air to glass at the bubble: away from the axis; glass to air at the ball: back towards it. In the glass the ray's
        // line passes the middle at a / n.
        let angle = libm::asin;
        let lean = angle(a / inner) - angle(a / inner / n);
        let turn = lean - (angle(a / outer) - angle(a / n / outer));
        // The last stretch starts on the outer sphere where the ray in the glass meets it.
        let in_glass = v(libm::sin(lean), 0.0, libm::cos(lean));
        let start = v(a, 0.0, (inner * inner - a * a).sqrt());
        let b = start.dot(in_glass);
        let exit = start + in_glass * (-b + (b * b + outer * outer - inner * inner).sqrt());
        let direction = v(libm::sin(turn), 0.0, libm::cos(turn));
        let expected = exit.x + (4.0 - exit.z) * direction.x / direction.z;
        assert_border(expected, scene);
    }
}

/// What lies before the near plane is cut away: the ray starts inside the ball although the eye stands outside.
#[test]
fn the_near_plane_cuts_a_solid_open() {
    let (n, a, r) = (1.5, 0.5, 1.0);
    for view in VIEWS {
        for (near, inside) in [(3.0, true), (1.0, false), (6.0, false)] {
            let scene = |border: f64| {
                let mut scene = one_ray(view, v(a, 0.0, -3.0), DVec3::Z);
                scene.camera.near = near;
                if let View::Matrix = view {
                    scene.camera.projection = Projection::Perspective { fovy_deg: 40.0 };
                    let clip_from_eye = scene.camera.clip_from_eye(1.0);
                    scene.camera.projection = Projection::Matrix { clip_from_eye };
                }
                let m = glass(&mut scene, n);
                ball(&mut scene, r, m);
                wall(&mut scene, 4.0, border);
                scene
            };
            // Cut open, the front bends nothing; whole, a ray at distance a keeps it; behind the ball nothing is bent.
            let (i, t) = (libm::asin(a / r), libm::asin(a / r / n));
            let expected = match (near, inside) {
                (_, true) => {
                    let turn = libm::asin(n * a / r) - i;
                    a - (4.0 - (r * r - a * a).sqrt()) * libm::tan(turn)
                }
                (6.0, _) => a,
                _ => {
                    let (sin, cos) = libm::sincos(2.0 * (i - t));
                    let foot = (a * cos, a * sin);
                    foot.0 - (4.0 - foot.1) * sin / cos
                }
            };
            assert_border(expected, scene);
        }
    }
}

/// Open surfaces have no inside, thin and opaque ones no index, and a mesh with a hole is open.
#[test]
fn only_closed_transmissive_solids_hold_the_camera() {
    let straight = |change: &dyn Fn(&mut Scene, usize)| {
        let scene = |border: f64| {
            let mut scene = one_ray(View::Perspective, DVec3::ZERO, v(0.6, 0.0, 0.8));
            let m = glass(&mut scene, 1.5);
            change(&mut scene, m);
            wall(&mut scene, 4.0, border);
            scene
        };
        assert_border(3.0, scene);
    };
    let sides = |caps: bool| Shape::Cylinder {
        base: v(0.0, 0.0, -9.0),
        top: v(0.0, 0.0, 9.0),
        radius: 0.5,
        caps,
    };
    straight(&|scene, _| {
        let thin = Optics {
            transmission: [1.0; 3],
            ior: 1.5,
            thin: true,
            ..Optics::default()
        };
        let m = material(scene, 0.0, thin);
        ball(scene, 1.0, m);
    });
    // A point between two surfaces of a shell that the camera is not in.
    straight(&|scene, m| {
        let shape = block(v(-9.0, -9.0, -3.0), v(9.0, 9.0, -1.0));
        add(scene, Form::Shape(shape), &[m]);
    });
    // From air into an open tube's "glass", as before; closed, from glass into air, which is total reflection here.
    let from_tube = |geometry: Form| {
        let mut scene = one_ray(View::Perspective, DVec3::ZERO, v(0.6, 0.0, 0.8));
        scene.image.background = [0.5; 3];
        let m = glass(&mut scene, 1.5);
        add(&mut scene, geometry, &[m]);
        seen(&scene)
    };
    assert_eq!(from_tube(Form::Shape(sides(false))), 0.5);
    assert_eq!(from_tube(Form::Shape(sides(true))), 0.0);
    let mesh = rastray::scene::tessellate::tessellate(&sides(true), 64, 1);
    let mut holed = mesh.clone();
    holed.triangles.pop();
    assert!(mesh.is_closed() && !holed.is_closed());
    assert_eq!(from_tube(Form::Mesh(Arc::new(holed))), 0.5);
    assert_eq!(from_tube(Form::Mesh(Arc::new(mesh))), 0.0);
}

/// Inside a transmissive solid the normal faces the ray, so a light in there lights its wall; `cast` stays the rasterizer's.
#[test]
fn inside_a_medium_the_normal_faces_the_camera() {
    let mut scene = one_ray(View::Perspective, DVec3::ZERO, DVec3::Z);
    let m = glass(&mut scene, 1.5);
    scene.materials[m].front.diffuse = [0.5; 3];
    ball(&mut scene, 1.0, m);
    scene.lights.push(Light {
        name: "l".into(),
        source: gl::LightSource {
            position: [0.0, 0.0, 0.0, 1.0],
            diffuse: [1.0; 3],
            ..gl::LightSource::default()
        },
        space: LightSpace::World,
        enabled: true,
    });
    assert_eq!(seen(&scene), 0.5);
    scene.trace.depth = 0;
    assert_eq!(seen(&scene), 0.5);
    let assembly = assembled::<f64>(&scene, Some(16)).expect("a small scene");
    let cast = trace::Options::cast(Isa::detect());
    let (frame, _) = follow::<f64>(&plan(&scene, &assembly), &cast).expect("drawn");
    assert_eq!(frame.color.data[0][1], 0.0);
}

// ---- Ten thousand bounces ----------------------------------------------------------------------------------------------

/// e (1 - k^(m + 1)) / (1 - k) for m bounces between two mirrors that glow with e, from a scene file.
fn between_mirrors(k: f64, depth: u32) -> Scene {
    let file = format!(
        r#"
[image]
width = 8
height = 6
[camera]
eye = [0, 0, 0]
target = [0, 0, -1]
fovy = 20
[light_model]
ambient = 0
[trace]
depth = {depth}
[material.mirror]
color = 0
emission = 0.25
reflection = {k}
[object.front]
shape = "plane"
center = [0, 0, -1]
normal = [0, 0, 1]
size = 100000
material = "mirror"
[object.back]
shape = "plane"
center = [0, 0, 1]
normal = [0, 0, -1]
size = 100000
material = "mirror"
"#
    );
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("mirrors.toml");
    std::fs::write(&path, file).expect("written");
    let name = path.to_str().expect("a name in UTF-8");
    load(name, &LoadOptions::default()).expect("a scene").scene
}

/// Largest error of a picture of the mirrors, relative to the closed form.
fn mirrors_error<R: Precise>(k: f64, depth: u32) -> f64 {
    let scene = between_mirrors(k, depth);
    let assembly = assembled::<R>(&scene, None).expect("a small scene");
    let start = Instant::now();
    let frame = traced::<R>(&scene, &assembly);
    let seconds = start.elapsed().as_secs_f64();
    // -expm1((m + 1) ln k) = 1 - k^(m + 1), without cancellation.
    let power = (f64::from(depth) + 1.0) * libm::log(k);
    let expected = 0.25 * -libm::expm1(power) / (1.0 - k);
    let values = frame.color.data.iter().flatten().map(|x| x.to_f64());
    let worst = values
        .map(|x| (x / expected - 1.0).abs())
        .fold(0.0, f64::max);
    let bits = 8 * std::mem::size_of::<R>();
    println!(
        "k {k}, depth {depth}, f{bits}: {expected} within {worst:e}, {seconds:.2} s for 48 pixels"
    );
    worst
}

#[test]
fn mirrors_facing_each_other_for_ten_thousand_bounces() {
    for k in [0.5, 0.999] {
        // The weights are products of up to m factors, in f64; the sums have up to m additions, in the precision of the render.
        let terms = f64::min(10_000.0, 40.0 / (1.0 - k));
        assert!(mirrors_error::<f64>(k, 10_000) <= terms * f64::EPSILON);
        assert!(mirrors_error::<f32>(k, 10_000) <= terms * f64::from(f32::EPSILON) / 2.0);
    }
}

/// A weight of 0.9^6723 is below the smallest normal number, and counts as 0: the path ends there, not at the depth.
#[test]
fn a_weight_that_underflows_ends_its_path() {
    let scene = between_mirrors(0.9, 1 << 20);
    let assembly = assembled::<f64>(&scene, None).expect("a small scene");
    let options = trace::Options::of(&scene, Isa::detect());
    let drawn = follow::<f64>(&plan(&scene, &assembly), &options);
    let (frame, counters) = drawn.expect("drawn");
    assert_eq!(counters.rays.reflection, 48 * 6723);
    for x in frame.color.data.iter().flatten() {
        assert!((x - 2.5).abs() <= 100.0 * f64::EPSILON, "{x}");
    }
}

/// Two branches a hit: the tree would have 2^depth rays, and ends in an error that says where and what to do.
#[test]
fn trees_that_run_away_end_in_an_error() {
    let mut scene = between_mirrors(0.9, 10_000);
    for material in &mut scene.materials {
        material.optics.transmission = [0.9; 3];
        material.optics.ior = 1.0;
    }
    // More mirrors behind the two, so that what passes them comes back.
    for z in [-1.0, 1.0] {
        let mut behind = scene.objects[0].clone();
        behind.world_from_object.translation += v(0.0, 0.0, 4.0 * z);
        scene.objects.push(behind);
    }
    let assembly = assembled::<f64>(&scene, None).expect("a small scene");
    let options = trace::Options::of(&scene, Isa::detect());
    let error = plan(&scene, &assembly)
        .draw(&options)
        .expect_err("too many rays");
    assert!(error.to_string().contains("secondary rays"), "{error}");
    assert!(
        error.help().is_some_and(|help| help.contains("depth")),
        "{error}"
    );
}
