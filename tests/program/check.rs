//! `check`: planted mistakes are named, right pictures are right, unrelated ones are unexplained.
//!
//! How pictures are planted: *plain* = by the tracer and the rasterizer of `common/plain.rs`, which share no code with the
//! crate; *text* = by another scene file, drawn rightly; *pixels* = from the right picture's own values; *layers* = by summing
//! the right picture's layers wrongly. None goes through the switches that `check` makes its mistakes with.
//!
//! `cargo test --test program check::` takes ten planted mistakes over five scenes, at 64x48. All of them:
//! `cargo test --test program check:: -- --ignored --nocapture`.

use crate::common::plain::{Lamp, Matter, Mesh, World, Wrong, gouraud};
use crate::common::program::rastray;
use crate::common::scenes::scene;
use rastray::check::{Finding, Given, Mode, Options, Report, Verdict, check};
use rastray::frame::{self, Plane};
use rastray::gl::ShadeModel;
use rastray::import;
use rastray::math::DVec3;
use rastray::math::color::{quantize8, srgb_from_linear};
use rastray::render::{self, Assembled, Job, Rasterizer};
use rastray::scene::Scene;
use rastray::{raster, trace};

type Values = Plane<[f32; 3]>;

const WIDTH: usize = 64;
const HEIGHT: usize = 48;

/// A scene by its name, or one of the tests' own by its text.
#[derive(Clone, Copy)]
enum Source {
    Shipped(&'static str),
    Own(fn() -> String),
}

fn load(source: Source, sets: &[&str], size: [usize; 2]) -> Scene {
    let size = size.map(|n| n as u32);
    match source {
        Source::Shipped(name) => scene(name, size, sets),
        Source::Own(text) => {
            let folder = tempfile::tempdir().expect("a temporary folder");
            let path = folder.path().join("scene.toml");
            std::fs::write(&path, text()).expect("writable");
            scene(path.to_str().expect("UTF-8"), size, sets)
        }
    }
}

/// How everything here is rendered: most of the time goes into pictures of meshes, which need not be fine.
fn rendered() -> render::Options {
    render::Options {
        level: Some(24),
        ..render::Options::default()
    }
}

/// A right picture, clamped where GL clamps.
fn draw(scene: &Scene, mode: Mode, layers: bool) -> (Values, Option<frame::Layers<f32>>) {
    let mut job = Job::with(scene, mode.renderer(), &rendered());
    job.shading = mode.shading().unwrap_or(job.shading);
    job.clamp = !layers;
    job.layers = layers;
    let picture = job.draw().expect("drawn").picture;
    (picture.color_f32(), picture.layers_f32())
}

fn eight_bits(linear: &Values) -> Values {
    linear.map(|c| c.map(|x| f32::from(quantize8(x)) / 255.0))
}

fn given(color: Values) -> Given {
    Given {
        color,
        eight_bits: true,
        lossy: false,
    }
}

fn options(modes: &[Mode]) -> Options {
    Options {
        modes: modes.to_vec(),
        render: rendered(),
        srgb: false,
    }
}

fn judge(scene: &Scene, picture: &Given, modes: &[Mode]) -> Report {
    check(scene, picture, &options(modes), &|_, _, _| {}).expect("checked")
}

fn rmse(a: &Values, b: &Values) -> f64 {
    let pairs = a.data.iter().flatten().zip(b.data.iter().flatten());
    let sum: f64 = pairs.map(|(a, b)| f64::from(a - b).powi(2)).sum();
    (sum / (3 * a.data.len()) as f64).sqrt()
}

/// The pixels of a layer or picture.
type Colors = Vec<[f32; 3]>;

/// How a mistake is planted.
#[derive(Clone, Copy)]
enum Plant {
    /// The scene with these overrides, drawn rightly.
    Text(&'static [&'static str]),
    /// Another text of the same scene.
    Edited(fn() -> String),
    /// Changed pixels of the right picture: stored values in, stored values out.
    Pixels(fn(&Values) -> Values),
    /// The right picture's layers, summed wrongly.
    Layers(fn(&[Colors]) -> Colors),
    /// The small tracer, in a world.
    Tracer(fn() -> World, fn(&mut World, &mut Wrong)),
    /// The small rasterizer.
    Gouraud(fn(&mut Wrong)),
}

struct Planted {
    name: &'static str,
    scene: Source,
    mode: Mode,
    plant: Plant,
}

const fn planted(name: &'static str, scene: Source, mode: Mode, plant: Plant) -> Planted {
    Planted {
        name,
        scene,
        mode,
        plant,
    }
}

impl Planted {
    /// The scene, the picture with the mistake, and the right one.
    fn pictures(&self) -> (Scene, Values, Values) {
        let size = [WIDTH, HEIGHT];
        let scene = load(self.scene, &[], size);
        let right = eight_bits(&draw(&scene, self.mode, false).0);
        let plane = |data| Plane {
            width: WIDTH,
            height: HEIGHT,
            data,
        };
        let picture = match self.plant {
            Plant::Text(sets) => draw(&load(self.scene, sets, size), self.mode, false).0,
            Plant::Edited(text) => draw(&load(Source::Own(text), &[], size), self.mode, false).0,
            Plant::Pixels(change) => change(&right),
            Plant::Layers(sum) => {
                let layers = draw(&scene, self.mode, true).1.expect("layers");
                let planes: Vec<_> = layers.planes.into_iter().map(|p| p.data).collect();
                plane(sum(&planes))
            }
            Plant::Tracer(world, put) => {
                let (mut world, mut wrong) = (world(), Wrong::default());
                put(&mut world, &mut wrong);
                plane(world.picture(WIDTH, HEIGHT, wrong))
            }
            Plant::Gouraud(put) => {
                let mut wrong = Wrong::default();
                put(&mut wrong);
                plane(gouraud(&stage(), &sheet(), WIDTH, HEIGHT, wrong))
            }
        };
        (scene, eight_bits(&picture), right)
    }

    /// Whether it is named first, or in a tie with the first; says how it went.
    fn is_named(&self) -> (bool, String) {
        let (scene, picture, right) = self.pictures();
        let change = rmse(&picture, &right);
        assert!(
            change > 1e-3,
            "{}: changes the picture by {change} only",
            self.name
        );
        let report = judge(&scene, &given(picture), &Mode::ALL);
        let hit = |f: &Finding| f.mistake.name == self.name;
        let named = report.verdict == Verdict::Mistake
            && (report.findings.first().is_some_and(hit)
                || report.findings.iter().any(|f| hit(f) && f.tied));
        let tell = |f: &Finding| {
            let tie = if f.tied { " (tie)" } else { "" };
            format!("{} {:.3}{tie}", f.mistake.name, f.removed)
        };
        let told: Vec<String> = report.findings.iter().map(tell).collect();
        let line = format!(
            "{} {:26} rmse {change:.4}  {:?} {}: {}",
            if named { "ok    " } else { "MISSED" },
            self.name,
            report.verdict,
            report.mode.name(),
            told.join(", ")
        );
        (named, line)
    }
}

// The scenes of the tests.

const WHITTED: Source = Source::Shipped("whitted");
const LIGHTS: Source = Source::Shipped("lights");
const TWO_SIDED: Source = Source::Shipped("two-sided");
const BALLS: Source = Source::Own(|| world_text(&balls()));
const BRIGHT: Source = Source::Own(|| world_text(&bright_balls()));
const STAGE: Source = Source::Own(stage_text);

const PLAIN: Matter = Matter {
    color: [0.6, 0.6, 0.55],
    specular: 0.0,
    shininess: 0.0,
    reflection: 0.0,
    transmission: 0.0,
    ior: 1.0,
};

/// Three balls on a floor, a fourth one above the lamp, outside of the picture.
fn balls() -> World {
    let red = Matter {
        color: [0.7, 0.15, 0.1],
        specular: 0.6,
        shininess: 20.0,
        ..PLAIN
    };
    let mirror = Matter {
        color: [0.05; 3],
        specular: 0.6,
        shininess: 60.0,
        reflection: 0.7,
        ..PLAIN
    };
    let glass = Matter {
        color: [0.03; 3],
        specular: 0.4,
        shininess: 80.0,
        reflection: 0.1,
        transmission: 0.8,
        ior: 1.5,
    };
    let lamp = |place: [f64; 3], directional, color| Lamp {
        place: DVec3::from_array(place),
        directional,
        color,
    };
    World {
        eye: DVec3::new(0.0, 1.7, 6.0),
        target: DVec3::new(0.0, 0.8, 0.0),
        fovy_deg: 42.0,
        ambient: 0.15,
        background: [0.3, 0.4, 0.6],
        depth: 4,
        lamps: vec![
            lamp([-1.5, 3.2, 2.5], false, [1.4, 1.2, 1.0]),
            lamp([0.6, 1.0, 0.5], true, [0.4, 0.4, 0.5]),
        ],
        balls: vec![
            (DVec3::new(-1.3, 0.7, 0.3), 0.7, red),
            (DVec3::new(1.4, 0.9, -0.6), 0.9, mirror),
            (DVec3::new(0.2, 0.6, 1.4), 0.6, glass),
            (DVec3::new(-1.7, 4.9, 2.9), 1.0, red),
        ],
        floor: (5.0, PLAIN),
    }
}

/// The same under a lamp that is too bright: a clamped sum hides what is clamped earlier but in mirrors.
fn bright_balls() -> World {
    let mut world = balls();
    world.lamps[0].color = [2.4, 2.0, 1.8];
    world
}

/// A world for the crate.
fn world_text(world: &World) -> String {
    let mut text = format!(
        "[image]\nbackground = {:?}\n[camera]\neye = {:?}\ntarget = {:?}\nfovy = {:?}\nnear = 0.1\n\
         [light_model]\nambient = {:?}\n[trace]\ndepth = {}\n",
        world.background,
        world.eye.to_array(),
        world.target.to_array(),
        world.fovy_deg,
        world.ambient,
        world.depth
    );
    for (i, lamp) in world.lamps.iter().enumerate() {
        let [x, y, z] = lamp.place.to_array();
        let w = if lamp.directional { 0.0 } else { 1.0 };
        text += &format!(
            "[light.l{i}]\nposition = [{x:?}, {y:?}, {z:?}, {w:?}]\ndiffuse = {:?}\n",
            lamp.color
        );
    }
    let matter = |name: &str, m: &Matter| {
        format!(
            "[material.{name}]\ncolor = {:?}\nspecular = {:?}\nshininess = {:?}\nreflection = {:?}\ntransmission = {:?}\n\
             ior = {:?}\n",
            m.color, m.specular, m.shininess, m.reflection, m.transmission, m.ior
        )
    };
    text += &matter("floor", &world.floor.1);
    text += &format!(
        "[object.floor]\nshape = \"plane\"\nsize = {:?}\nmaterial = \"floor\"\n",
        2.0 * world.floor.0
    );
    for (i, (center, radius, m)) in world.balls.iter().enumerate() {
        text += &matter(&format!("m{i}"), m);
        text += &format!(
            "[object.ball{i}]\nshape = \"sphere\"\ncenter = {:?}\nradius = {radius:?}\nmaterial = \"m{i}\"\n",
            center.to_array()
        );
    }
    text
}

/// Light and camera of the rasterized scene: a lamp close above a large floor, a low one below it, a sun that would fade.
fn stage() -> World {
    let lamp = |place: [f64; 3], directional, color| Lamp {
        place: DVec3::from_array(place),
        directional,
        color,
    };
    World {
        eye: DVec3::new(0.5, 1.6, 5.0),
        target: DVec3::new(0.0, 0.3, 0.0),
        fovy_deg: 40.0,
        ambient: 0.2,
        background: [0.1, 0.12, 0.15],
        depth: 0,
        lamps: vec![
            lamp([1.2, 1.0, 1.5], false, [1.5, 1.3, 1.1]),
            lamp([0.3, -0.4, -6.0], false, [0.8, 0.9, 1.0]),
            lamp([1.0, 2.0, 2.0], true, [0.3, 0.3, 0.3]),
        ],
        balls: Vec::new(),
        floor: (1.0, PLAIN),
    }
}

/// A sheet of 2 x 3 large quads, bent a little: its normals differ from corner to corner.
fn sheet() -> Mesh {
    let mut mesh = Mesh {
        positions: Vec::new(),
        normals: Vec::new(),
        triangles: Vec::new(),
        matter: Matter {
            color: [0.7, 0.5, 0.4],
            specular: 0.5,
            shininess: 12.0,
            ..PLAIN
        },
    };
    for j in 0..4 {
        for i in 0..3 {
            let (u, v) = (f64::from(i) - 1.0, f64::from(j) - 1.5);
            mesh.positions
                .push(DVec3::new(1.8 * u, 0.15 * u * u, 2.0 * v));
            mesh.normals
                .push(DVec3::new(-0.3 * u, 1.0, 0.2 * v).normalize());
        }
    }
    for j in 0..3 {
        for i in 0..2 {
            let a = 3 * j + i;
            mesh.triangles.push([a, a + 3, a + 4]);
            mesh.triangles.push([a, a + 4, a + 1]);
        }
    }
    mesh
}

/// The scale that the sheet is written with: the crate's model matrix.
const SCALE: [f64; 3] = [3.0, 1.0, 0.5];

fn stage_text() -> String {
    stage_with(|n| n, |t| t)
}

/// Normals M n instead of M^-T n: written as M^T M n, which the right transform takes to M n.
fn stage_with_bent_normals() -> String {
    stage_with(
        |n| n * DVec3::from_array(SCALE) * DVec3::from_array(SCALE),
        |t| t,
    )
}

/// Triangles begin one corner later, so that their first corner comes last.
fn stage_with_turned_triangles() -> String {
    stage_with(|n| n, |[a, b, c]| [b, c, a])
}

fn stage_with(bend: fn(DVec3) -> DVec3, turn: fn([usize; 3]) -> [usize; 3]) -> String {
    let (world, mesh) = (stage(), sheet());
    let scale = DVec3::from_array(SCALE);
    let mut text = format!(
        "[image]\nbackground = {:?}\n[camera]\neye = {:?}\ntarget = {:?}\nfovy = {:?}\nnear = 0.1\n\
         [light_model]\nambient = {:?}\n",
        world.background,
        world.eye.to_array(),
        world.target.to_array(),
        world.fovy_deg,
        world.ambient
    );
    for (i, lamp) in world.lamps.iter().enumerate() {
        let [x, y, z] = lamp.place.to_array();
        let w = if lamp.directional { 0.0 } else { 1.0 };
        text += &format!(
            "[light.l{i}]\nposition = [{x:?}, {y:?}, {z:?}, {w:?}]\ndiffuse = {:?}\n",
            lamp.color
        );
        if lamp.directional {
            text += "attenuation = [1, 0.2, 0.1]\n";
        }
    }
    // M^-T takes these to the mesh's own normals, up to their length, which `normalize` mends.
    let normals: Vec<_> = mesh
        .normals
        .iter()
        .map(|n| bend(*n * scale).normalize().to_array())
        .collect();
    let positions: Vec<_> = mesh
        .positions
        .iter()
        .map(|p| (*p / scale).to_array())
        .collect();
    let triangles: Vec<_> = mesh.triangles.iter().map(|t| turn(*t)).collect();
    text += &format!(
        "[material.sheet]\ncolor = {:?}\nspecular = {:?}\nshininess = {:?}\n[object.sheet]\nmaterial = \"sheet\"\n\
         transform = [{{ scale = {SCALE:?} }}]\npositions = {positions:?}\nnormals = {normals:?}\nindices = {triangles:?}\n",
        mesh.matter.color, mesh.matter.specular, mesh.matter.shininess
    );
    text
}

// The planted mistakes.

fn flipped(p: &Values) -> Values {
    let rows = p.data.chunks(p.width).rev();
    Plane {
        data: rows.flatten().copied().collect(),
        ..p.clone()
    }
}

fn mirrored(p: &Values) -> Values {
    let rows = p.data.chunks(p.width);
    Plane {
        data: rows.flat_map(|row| row.iter().rev()).copied().collect(),
        ..p.clone()
    }
}

fn brightened(p: &Values) -> Values {
    p.map(|c| c.map(|x| srgb_from_linear(f64::from(x)) as f32))
}

/// Every layer in 8 bits, then the sum.
fn summed_in_bytes(layers: &[Colors]) -> Colors {
    summed(layers, |x| f32::from(quantize8(x)) / 255.0)
}

fn summed(layers: &[Colors], change: fn(f32) -> f32) -> Colors {
    let sum = |i: usize| {
        let terms = layers.iter().map(|layer| layer[i].map(change));
        terms.fold([0.0; 3], |s, t| [0, 1, 2].map(|c| s[c] + t[c]))
    };
    (0..layers[0].len()).map(sum).collect()
}

use Mode::{Flat, Gouraud as Gour, Phong, Trace};
use Plant::{Edited, Gouraud, Layers, Pixels, Text, Tracer};

/// One or two of each scene and each way of planting.
const FEW: &[Planted] = &[
    planted(
        "no-ray-offset",
        BALLS,
        Trace,
        Tracer(balls, |_, w| w.no_offset = true),
    ),
    planted(
        "shadow-ray-endless",
        BALLS,
        Trace,
        Tracer(balls, |_, w| w.endless = true),
    ),
    planted(
        "ratio-kept-inside",
        BALLS,
        Trace,
        Tracer(balls, |_, w| w.ratio_kept = true),
    ),
    planted(
        "reflection-for-half-vector",
        WHITTED,
        Trace,
        Text(&["light_model.specular_model=\"reflection\""]),
    ),
    planted("rows-flipped", WHITTED, Gour, Pixels(flipped)),
    planted(
        "spot-angle-halved",
        LIGHTS,
        Trace,
        Text(&["light.stage.spot_cutoff=12"]),
    ),
    planted("eight-bits-early", LIGHTS, Trace, Layers(summed_in_bytes)),
    planted(
        "two-sided-missing",
        TWO_SIDED,
        Gour,
        Text(&["light_model.two_sided=false"]),
    ),
    planted(
        "affine-interpolation",
        STAGE,
        Gour,
        Gouraud(|w| w.affine = true),
    ),
    planted(
        "normals-by-model-matrix",
        STAGE,
        Phong,
        Edited(stage_with_bent_normals),
    ),
];

/// The others.
const MORE: &[Planted] = &[
    planted(
        "offset-too-large",
        BALLS,
        Trace,
        Tracer(balls, |_, w| w.offset = Some(0.12)),
    ),
    planted(
        "directional-unblocked",
        BALLS,
        Trace,
        Tracer(balls, |_, w| w.sun_unblocked = true),
    ),
    planted(
        "shadows-missing",
        BALLS,
        Trace,
        Tracer(balls, |_, w| w.no_shadows = true),
    ),
    planted(
        "eta-inverted",
        BALLS,
        Trace,
        Tracer(balls, |_, w| w.eta_inverted = true),
    ),
    planted(
        "normal-kept-inside",
        BALLS,
        Trace,
        Tracer(balls, |_, w| w.normal_kept = true),
    ),
    planted(
        "farther-root",
        BALLS,
        Trace,
        Tracer(balls, |_, w| w.far_root = true),
    ),
    planted(
        "first-hit",
        BALLS,
        Trace,
        Tracer(balls, |_, w| w.first_hit = true),
    ),
    planted(
        "reflection-not-recursive",
        BALLS,
        Trace,
        Tracer(balls, |world, _| world.depth = 1),
    ),
    planted(
        "normals-not-normalised",
        BALLS,
        Trace,
        Tracer(balls, |_, w| w.normal_length = true),
    ),
    planted(
        "clamp-per-light",
        BRIGHT,
        Trace,
        Tracer(bright_balls, |_, w| w.clamp_light = true),
    ),
    planted(
        "transmission-once-a-body",
        BALLS,
        Trace,
        Tracer(balls, |_, w| w.once_a_body = true),
    ),
    planted(
        "half-pixel-up-left",
        BALLS,
        Trace,
        Tracer(balls, |_, w| w.corner = true),
    ),
    planted(
        "aspect-missing",
        BALLS,
        Trace,
        Tracer(balls, |_, w| w.no_aspect = true),
    ),
    planted(
        "field-of-view-horizontal",
        BALLS,
        Trace,
        Tracer(balls, |_, w| w.fov_across = true),
    ),
    planted(
        "ambient-missing",
        WHITTED,
        Trace,
        Text(&["light_model.ambient=0"]),
    ),
    planted(
        "ambient-doubled",
        WHITTED,
        Gour,
        Text(&["light_model.ambient=0.5"]),
    ),
    planted(
        "exponent-four-times",
        WHITTED,
        Phong,
        Text(&[
            "material.glass.shininess=480",
            "material.mirror.shininess=400",
        ]),
    ),
    planted(
        "light-follows-camera",
        WHITTED,
        Trace,
        Text(&["light.sun.space=\"eye\"", "light.lamp.space=\"eye\""]),
    ),
    planted(
        "field-of-view-doubled",
        WHITTED,
        Trace,
        Text(&["camera.fovy=76"]),
    ),
    planted(
        "field-of-view-halved",
        WHITTED,
        Gour,
        Text(&["camera.fovy=19"]),
    ),
    planted("srgb-applied", WHITTED, Trace, Pixels(brightened)),
    planted(
        "attenuation-missing",
        LIGHTS,
        Trace,
        Text(&["light.candle.attenuation=[1,0,0]"]),
    ),
    planted(
        "spot-angle-doubled",
        LIGHTS,
        Gour,
        Text(&["light.stage.spot_cutoff=48"]),
    ),
    planted(
        "spot-exponent-missing",
        LIGHTS,
        Trace,
        Text(&["light.stage.spot_exponent=0"]),
    ),
    planted(
        "light-stays-in-world",
        LIGHTS,
        Gour,
        Text(&["light.headlight.space=\"world\""]),
    ),
    planted(
        "infinite-viewer",
        LIGHTS,
        Phong,
        Text(&["light_model.local_viewer=false"]),
    ),
    planted(
        "clamp-per-term",
        BRIGHT,
        Trace,
        Tracer(bright_balls, |_, w| w.clamp_term = true),
    ),
    planted("columns-mirrored", TWO_SIDED, Trace, Pixels(mirrored)),
    planted(
        "exponent-a-quarter",
        TWO_SIDED,
        Trace,
        Text(&[
            "material.sheet.shininess=10",
            "material.sheet.back.shininess=2.5",
        ]),
    ),
    planted(
        "no-depth-test",
        TWO_SIDED,
        Gour,
        Text(&["raster.depth_test=false"]),
    ),
    planted(
        "vertex-colours-not-clamped",
        STAGE,
        Gour,
        Gouraud(|w| w.clamp_late = true),
    ),
    planted(
        "specular-on-unlit-side",
        STAGE,
        Gour,
        Gouraud(|w| w.unlit_specular = true),
    ),
    planted(
        "first-vertex-provokes",
        STAGE,
        Flat,
        Edited(stage_with_turned_triangles),
    ),
    // 1 / (1 + 0.2 d + 0.1 d^2) with d = |(1, 2, 2)| = 3 is 0.4.
    planted(
        "directional-attenuated",
        STAGE,
        Gour,
        Text(&["light.l2.diffuse=0.12"]),
    ),
    planted(
        "direction-reversed",
        STAGE,
        Phong,
        Text(&["light.l2.position=[-1,-2,-2,0]"]),
    ),
];

#[test]
fn planted_mistakes_are_named() {
    let results: Vec<(bool, String)> = FEW.iter().map(Planted::is_named).collect();
    let missed: Vec<&String> = results.iter().filter(|r| !r.0).map(|r| &r.1).collect();
    assert!(missed.is_empty(), "{missed:#?}");
}

#[test]
#[ignore = "minutes: all planted mistakes"]
fn nearly_all_planted_mistakes_are_named() {
    let all = || FEW.iter().chain(MORE);
    let results: Vec<(bool, String)> = all().map(Planted::is_named).collect();
    for (_, line) in &results {
        println!("{line}");
    }
    let (named, planted) = (results.iter().filter(|r| r.0).count(), results.len());
    println!("{named} of {planted} are named");
    // 38 of 40.
    assert!(
        planted >= 40 && 20 * named >= 19 * planted,
        "{named} of {planted}"
    );
}

/// A right picture of the two small renderers is right: they and the crate agree where nothing is wrong.
#[test]
fn right_pictures_of_others_are_right() {
    let plane = |data| Plane {
        width: WIDTH,
        height: HEIGHT,
        data,
    };
    let traced = plane(balls().picture(WIDTH, HEIGHT, Wrong::default()));
    let drawn = plane(gouraud(&stage(), &sheet(), WIDTH, HEIGHT, Wrong::default()));
    for (source, picture, mode) in [(BALLS, traced, Trace), (STAGE, drawn, Gour)] {
        let scene = load(source, &[], [WIDTH, HEIGHT]);
        let report = judge(&scene, &given(eight_bits(&picture)), &Mode::ALL);
        assert_eq!(
            (report.verdict, report.mode),
            (Verdict::Right, mode),
            "{report:?}"
        );
        assert!(report.error < 2e-3, "rmse {}", report.error);
    }
}

/// 8 x 8 blocks through the cosine transform, coefficients rounded to steps: what JPEG does to each channel.
fn compressed(picture: &Values, quality: f32) -> Values {
    // Steps of JPEG's luminance table grow from 16 to about 100 with the frequency; quality 50 is that table.
    let scale = (200.0 - 2.0 * quality) / 100.0;
    let step = |u: usize, v: usize| ((10.0 + 6.0 * (u + v) as f32) * scale).max(1.0);
    let wave = |x: usize, u: usize| {
        let norm = if u == 0 { 0.125f32.sqrt() } else { 0.5 };
        norm * ((2 * x + 1) as f32 * u as f32 * std::f32::consts::PI / 16.0).cos()
    };
    let mut out = picture.clone();
    for channel in 0..3 {
        for top in (0..picture.height).step_by(8) {
            for left in (0..picture.width).step_by(8) {
                let value = |x: usize, y: usize| 255.0 * picture.at(left + x, top + y)[channel];
                let mut kept = [[0.0f32; 8]; 8];
                for (v, row) in kept.iter_mut().enumerate() {
                    for (u, k) in row.iter_mut().enumerate() {
                        let cells = (0..64).map(|i| (i % 8, i / 8));
                        let sum: f32 = cells
                            .map(|(x, y)| value(x, y) * wave(x, u) * wave(y, v))
                            .sum();
                        *k = (sum / step(u, v)).round() * step(u, v);
                    }
                }
                for i in 0..64 {
                    let (x, y) = (i % 8, i / 8);
                    let cells = (0..64).map(|j| (j % 8, j / 8));
                    let sum: f32 = cells
                        .map(|(u, v)| kept[v][u] * wave(x, u) * wave(y, v))
                        .sum();
                    out.data[(top + y) * picture.width + left + x][channel] =
                        f32::from(quantize8(sum / 255.0)) / 255.0;
                }
            }
        }
    }
    out
}

#[test]
fn compression_is_no_mistake_and_hides_none() {
    for (name, mode, sets, planted) in [
        (
            "two-sided",
            Trace,
            "light_model.two_sided=false",
            "two-sided-missing",
        ),
        (
            "lights",
            Gour,
            "light.stage.spot_cutoff=48",
            "spot-angle-doubled",
        ),
    ] {
        let scene = load(Source::Shipped(name), &[], [WIDTH, HEIGHT]);
        let right = eight_bits(&draw(&scene, mode, false).0);
        let noisy = compressed(&right, 80.0);
        assert!(rmse(&noisy, &right) > 5e-3, "{name}: no noise");
        let report = judge(&scene, &given(noisy), &Mode::ALL);
        assert_eq!(
            (report.verdict, report.mode),
            (Verdict::Right, mode),
            "{name}"
        );
        let wrong = load(Source::Shipped(name), &[sets], [WIDTH, HEIGHT]);
        let noisy = compressed(&eight_bits(&draw(&wrong, mode, false).0), 80.0);
        let report = judge(&scene, &given(noisy), &Mode::ALL);
        assert_eq!(report.findings[0].mistake.name, planted, "{name}");
    }
}

/// Colours of 2 x 2 pixels averaged, brightness kept: what JPEG does before anything else, unless told not to.
fn with_chroma_halved(picture: &Values) -> Values {
    let bright = |c: &[f32; 3]| 0.299 * c[0] + 0.587 * c[1] + 0.114 * c[2];
    let pixel = |i: usize| {
        let (x, y) = (i % picture.width / 2 * 2, i / picture.width / 2 * 2);
        let cells = [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)];
        let own = bright(&picture.data[i]);
        [0, 1, 2].map(|k| {
            let off = cells.iter().map(|(x, y)| {
                let c = picture.at(*x, *y);
                c[k] - bright(c)
            });
            (own + off.sum::<f32>() / 4.0).clamp(0.0, 1.0)
        })
    };
    Plane {
        width: picture.width,
        height: picture.height,
        data: (0..picture.data.len()).map(pixel).collect(),
    }
}

/// The bytes of a JPEG file of the ordinary kind: halved chroma, blocks of 8 x 8. Sides must be even.
fn jpeg(picture: &Values, quality: u8) -> Vec<u8> {
    let halved = with_chroma_halved(picture);
    let bytes: Vec<u8> = halved
        .data
        .iter()
        .flatten()
        .map(|x| quantize8(*x))
        .collect();
    let (width, height) = (picture.width as u32, picture.height as u32);
    let mut file = Vec::new();
    image::codecs::jpeg::JpegEncoder::new_with_quality(&mut file, quality)
        .encode(&bytes, width, height, image::ExtendedColorType::Rgb8)
        .expect("encoded");
    file
}

/// A picture through such a file.
fn through_jpeg(picture: &Values, quality: u8) -> Given {
    let file = import::picture::decode("picture.jpg", &jpeg(picture, quality), None);
    Given::from(file.expect("a JPEG"))
}

/// Above the first pass's size.
const JPEG_SIZE: [usize; 2] = [192, 144];

/// With red and yellow tiles halved chroma leaves much, which follows the picture: no mistake may feed on it.
#[test]
fn what_jpeg_leaves_is_no_mistake() {
    let scene = load(WHITTED, &[], JPEG_SIZE);
    let right = eight_bits(&draw(&scene, Trace, false).0);
    for quality in [75, 90, 95] {
        let picture = through_jpeg(&right, quality);
        let noise = rmse(&picture.color, &right);
        assert!(picture.lossy && noise > 0.02, "quality {quality}: {noise}");
        let report = judge(&scene, &picture, &[Trace]);
        assert_eq!(
            report.verdict,
            Verdict::Right,
            "quality {quality}: {:?}",
            report.findings
        );
    }
}

#[test]
fn jpeg_hides_no_mistake_that_is_larger_than_what_it_leaves() {
    let ior = "material.glass.ior=0.6666666666666666";
    for (name, mode, set, planted) in [
        ("whitted", Trace, ior, "eta-inverted"),
        (
            "lights",
            Gour,
            "light.stage.spot_cutoff=48",
            "spot-angle-doubled",
        ),
    ] {
        let scene = load(Source::Shipped(name), &[], JPEG_SIZE);
        let wrong = load(Source::Shipped(name), &[set], JPEG_SIZE);
        let picture = through_jpeg(&eight_bits(&draw(&wrong, mode, false).0), 75);
        let report = judge(&scene, &picture, &[mode]);
        assert_eq!(report.verdict, Verdict::Mistake, "{name}");
        assert_eq!(report.findings[0].mistake.name, planted, "{name}");
    }
}

/// What is right as something else is said to be, and only that.
#[test]
fn a_right_picture_of_another_kind_is_told() {
    let scene = load(WHITTED, &[], [WIDTH, HEIGHT]);
    let traced = eight_bits(&draw(&scene, Trace, false).0);
    let report = judge(&scene, &given(traced.clone()), &[Gour, Flat, Phong]);
    assert_ne!(report.verdict, Verdict::Right);
    assert_eq!(report.right_as, Some(Trace));
    let negative = traced.map(|c| c.map(|x| 1.0 - x));
    let report = judge(&scene, &given(negative), &[Gour]);
    assert_eq!(
        (report.verdict, report.right_as),
        (Verdict::Unexplained, None)
    );
    let report = judge(&scene, &given(traced), &Mode::ALL);
    assert_eq!((report.verdict, report.right_as), (Verdict::Right, None));
}

/// `rastray check` in a folder: its exit code, and all that it says, in one line.
fn run_check(folder: &std::path::Path, args: &[&str]) -> (Option<i32>, String) {
    let run = rastray(folder, &[&["check"], args].concat());
    let said = [run.stdout, run.stderr].concat();
    let said = String::from_utf8(said).expect("UTF-8");
    let words: Vec<&str> = said.split_whitespace().collect();
    (run.status.code(), words.join(" "))
}

#[test]
fn words_say_what_to_do() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let scene = load(WHITTED, &[], [WIDTH, HEIGHT]);
    let traced = eight_bits(&draw(&scene, Trace, false).0);
    let file = folder.path().join("a.jpg");
    std::fs::write(&file, jpeg(&traced, 90)).expect("writable");
    let (code, said) = run_check(folder.path(), &["whitted", "a.jpg", "--mode", "trace"]);
    assert_eq!(code, Some(1), "{said}");
    assert!(said.contains("a PNG would say more."), "{said}");
    assert!(
        said.contains("nearest is a traced picture (trace), with"),
        "{said}"
    );

    let bytes = traced
        .data
        .iter()
        .flatten()
        .map(|x| quantize8(*x))
        .collect();
    let picture = image::RgbImage::from_raw(WIDTH as u32, HEIGHT as u32, bytes);
    let file = folder.path().join("a.png");
    picture.expect("its size").save(file).expect("writable");
    let (code, said) = run_check(folder.path(), &["whitted", "a.png", "--mode", "raster"]);
    assert_eq!(code, Some(1), "{said}");
    let advice = "As a traced picture (trace) it is right: leave --mode out, or say --mode trace.";
    assert!(said.contains(advice), "{said}");
    let (code, said) = run_check(folder.path(), &["whitted", "a.png", "--mode", "trace"]);
    assert_eq!(code, Some(0), "{said}");
    assert!(
        said.contains("would not show on this scene, so they are not ruled out:"),
        "{said}"
    );
}

#[test]
fn arguments_that_cannot_be_meant_are_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let refused = |args: &[&str], words: &str| {
        let (code, said) = run_check(folder.path(), args);
        assert_eq!(code, Some(2), "{said}");
        assert!(said.contains(words), "{args:?}: {said}");
    };
    refused(
        &["a.png", "whitted"],
        "the scene comes first: rastray check whitted a.png",
    );
    refused(
        &["whitted", "a.png", "--size", "8x8"],
        "the size of the picture",
    );
    refused(
        &["whitted", "a.png", "--mode", "trace", "--shading", "flat"],
        "--mode trace asks for rays",
    );
    for output in ["out.jpg", "o.SVG", "-"] {
        let words = format!("{output}: expected a .png file or the name of a folder");
        refused(&["whitted", "a.png", "-o", output], &words);
    }
    let left = std::fs::read_dir(folder.path()).expect("readable").count();
    assert_eq!(left, 0);
    let (code, help) = run_check(folder.path(), &["--help"]);
    assert_eq!(code, Some(0));
    assert!(
        help.contains("PNG, JPEG, BMP") && !help.contains("--size <"),
        "{help}"
    );
}

#[test]
fn right_pictures_are_right_and_unrelated_ones_unexplained() {
    let size = [WIDTH, HEIGHT];
    let picture = |name, mode| {
        let scene = load(Source::Shipped(name), &[], size);
        let picture = eight_bits(&draw(&scene, mode, false).0);
        (scene, picture)
    };
    let (whitted, traced) = picture("whitted", Trace);
    let (_, other) = picture("lights", Gour);
    let report = judge(&whitted, &given(traced.clone()), &Mode::ALL);
    assert_eq!(
        (report.verdict, report.mode, report.error),
        (Verdict::Right, Trace, 0.0)
    );
    assert!(report.findings.is_empty() && report.telling.is_empty());
    let grey = Plane::filled(WIDTH, HEIGHT, [0.4f32, 0.5, 0.6]);
    let bars = traced.map(|c| c.map(|x| 1.0 - x));
    for unrelated in [other, grey, bars, Plane::filled(WIDTH, HEIGHT, [0.0f32; 3])] {
        let report = judge(&whitted, &given(unrelated), &Mode::ALL);
        assert_eq!(
            report.verdict,
            Verdict::Unexplained,
            "{:?}",
            report.findings
        );
    }
}

/// Pictures above the first pass's size take the same answer in two steps, and the telling pixels are their own.
#[test]
fn large_pictures_are_judged_in_two_steps() {
    let size = [169, 121];
    let scene = load(WHITTED, &[], size);
    let wrong = load(WHITTED, &["material.glass.ior=0.6666666666666666"], size);
    let picture = eight_bits(&draw(&wrong, Trace, false).0);
    let report = judge(&scene, &given(picture.clone()), &[Trace]);
    let first = &report.findings[0];
    assert_eq!(
        (report.verdict, first.mistake.name),
        (Verdict::Mistake, "eta-inverted")
    );
    assert!(first.removed > 0.99 && report.size == size);
    assert_eq!(report.telling.len(), 3);
    for t in &report.telling {
        assert_eq!(t.given, *picture.at(t.x, t.y));
        let apart = (0..3)
            .map(|c| (t.right[c] - t.mistaken[c]).abs())
            .fold(0.0, f32::max);
        assert!(apart > 0.2, "{t:?}");
    }
    let turned = judge(
        &scene,
        &given(flipped(&eight_bits(&draw(&scene, Trace, false).0))),
        &[Trace],
    );
    assert_eq!(turned.findings[0].mistake.name, "rows-flipped");
    assert!(turned.findings[0].removed > 0.999);
}

/// Without a mistake the switches change nothing: a plan that is relit draws the picture of a new one.
#[test]
fn plans_that_are_relit_draw_what_new_ones_draw() {
    let size = [WIDTH, HEIGHT];
    let scene = load(WHITTED, &[], size);
    let other = load(
        WHITTED,
        &["light.sun.diffuse=0.2", "camera.fovy=50", "trace.depth=3"],
        size,
    );
    let dimmed = load(
        WHITTED,
        &["light.sun.diffuse=0.2", "material.glass.shininess=3"],
        size,
    );
    let asked = rendered();
    let assembled = Assembled::new(&scene, asked.level, asked.precision).expect("few triangles");
    let plan =
        render::Tracer::new(&scene, &assembled, asked.geometry, asked.model).expect("a plan");
    let relit = plan.relit(&other).with_faults(trace::Faults::default());
    let drawn = relit.draw(&asked.trace(&other)).expect("drawn");
    assert_eq!(drawn.picture.color_f32(), draw(&other, Trace, false).0);
    let plan = Rasterizer::new(&scene, &assembled, asked.model);
    let relit = plan
        .relit(&dimmed, &assembled)
        .with_faults(raster::Faults::default());
    let gouraud = asked.raster(ShadeModel::Gouraud, true, false);
    let drawn = relit.draw(&gouraud).expect("drawn");
    assert_eq!(drawn.picture.color_f32(), draw(&dimmed, Gour, false).0);
}

#[test]
fn wrong_input_is_refused() {
    let scene = load(WHITTED, &[], [WIDTH, HEIGHT]);
    let run = |picture: Values, modes: &[Mode]| {
        let error = check(&scene, &given(picture), &options(modes), &|_, _, _| {});
        error.expect_err("refused").to_string()
    };
    let plain = Plane::filled(WIDTH, HEIGHT, [0.5f32; 3]);
    let mut nan = plain.clone();
    nan.data[WIDTH + 3][1] = f32::NAN;
    assert!(run(nan, &Mode::ALL).contains("pixel 3 1"));
    assert!(run(Plane::filled(3, 2, [0.0; 3]), &Mode::ALL).contains("64x48"));
    assert!(run(plain, &[]).contains("at least one"));
}
