//! Contacts: surfaces that a ray meets at one place, decided from the shapes (DESIGN section 1, "Contact" and "Coplanar opaque
//! surfaces"). Every picture here is known by construction: walls and clear things emit full steps of 1/8 and let all light
//! through, so a pixel is a sum of what the rule says it shows, and nothing else.
//!
//! Scenes are random: which shapes, in which order, turned about a random axis, moved and scaled, drawn in both precisions.
//! `RASTRAY_CONTACT_SCENES=N` draws N of each kind instead of [`FEW`].

use super::*;
use crate::common::random::Random;
use rastray::gl::ShadeModel;
use rastray::lanes::Real;
use rastray::math::{DAffine3, DMat3};
use rastray::render::{Job, Precision, Renderer};

/// Scenes of each kind that a plain run draws.
const FEW: u64 = 40;

/// Nothing is there: no test expects this.
const GREEN: &str = "[material.green]\ncolor = 0\nemission = [0, 1, 0]\n";
const RED: &str = "[material.red]\ncolor = 0\nemission = [0.5, 0, 0]\n";
const BLUE: &str = "[material.blue]\ncolor = 0\nemission = [0, 0, 0.25]\n";

fn count() -> u64 {
    let asked = std::env::var("RASTRAY_CONTACT_SCENES").ok();
    asked.and_then(|n| n.parse().ok()).unwrap_or(FEW)
}

/// A random number between two.
fn between(random: &mut Random, low: f64, high: f64) -> f64 {
    low + (0.5 + 0.5 * random.next()) * (high - low)
}

fn choose<T: Copy>(random: &mut Random, items: &[T]) -> T {
    let i = (random.next().abs() * items.len() as f64) as usize;
    items[i.min(items.len() - 1)]
}

/// A transform in the words of a scene file, and as a matrix.
struct Place {
    steps: String,
    matrix: DAffine3,
}

/// Turned, scaled and moved at random; every fourth one is left as it is.
fn place(random: &mut Random) -> Place {
    if random.next() < -0.5 {
        return Place {
            steps: String::new(),
            matrix: DAffine3::IDENTITY,
        };
    }
    let (axis, degrees) = (random.direction(), 180.0 * random.next());
    let size = 2f64.powf(4.0 * random.next());
    let offset = size * 3.0 * random.vector();
    let turn = DMat3::from_axis_angle(axis, degrees.to_radians());
    let steps = format!(
        "transform = [{{ rotate = {{ axis = {}, degrees = {degrees:?} }} }}, {{ scale = {size:?} }}, {{ translate = {} }}]\n",
        list(axis),
        list(offset)
    );
    Place {
        steps,
        matrix: DAffine3::from_translation(offset) * DAffine3::from_mat3(turn * size),
    }
}

/// A camera placed with the scene.
fn camera(place: &Place, eye: DVec3, target: DVec3, fovy: f64) -> String {
    let at = |p: DVec3| list(place.matrix.transform_point3(p));
    let up = place.matrix.transform_vector3(v(0.1, 1.0, 0.05));
    format!(
        "[image]\nwidth = 24\nheight = 18\nbackground = [0, 1, 0]\n[light_model]\nambient = 0\n\
         [camera]\neye = {}\ntarget = {}\nup = {}\nfovy = {fovy:?}\n",
        at(eye),
        at(target),
        list(up)
    )
}

/// An object: its own lines, and where it stands.
fn object(name: &str, form: &str, material: &str, place: &Place) -> String {
    format!(
        "[object.{name}]\n{form}\nmaterial = \"{material}\"\n{}",
        place.steps
    )
}

/// One picture of a text.
struct Picture {
    which: &'static str,
    colors: Vec<[f64; 3]>,
    objects: Vec<u32>,
    depths: Vec<f64>,
}

fn picture<R: Real>(which: &'static str, frame: &Frame<R>) -> Picture {
    Picture {
        which,
        colors: frame
            .color
            .data
            .iter()
            .map(|c| c.map(Real::to_f64))
            .collect(),
        objects: frame.object.data.clone(),
        depths: frame.depth.data.iter().map(|z| z.to_f64()).collect(),
    }
}

/// The pictures of a text, traced: on the true shapes first, in both precisions.
fn pictures(text: &str) -> Vec<Picture> {
    let scene = stage(text, 1.0);
    vec![
        picture("exact f64", &draw::<f64>(&scene, Geometry::Exact, false)),
        picture("exact f32", &draw::<f32>(&scene, Geometry::Exact, false)),
        picture("mesh f64", &draw::<f64>(&scene, Geometry::Mesh, false)),
        picture("mesh f32", &draw::<f32>(&scene, Geometry::Mesh, false)),
    ]
}

/// The rasterizer's, in both precisions.
fn rasterized(text: &str) -> Vec<Picture> {
    let scene = stage(text, 1.0);
    let one = |which: &'static str, precision| {
        let job = Job::new(&scene, Renderer::Raster).precision(precision);
        let drawn = job.shading(ShadeModel::Flat).draw().expect("a picture");
        picture(which, &drawn.picture.to_f64())
    };
    vec![
        one("raster f64", Precision::F64),
        one("raster f32", Precision::F32),
    ]
}

/// A surface in the plane z = 0 that reaches at least `half` about the middle; its front towards +z where it is a solid.
fn flat_face(random: &mut Random, half: f64) -> String {
    let reach = half * between(random, 1.5, 3.0);
    let depth = half * between(random, 0.2, 1.0);
    match choose(random, &[0, 1, 2, 3, 4, 5]) {
        0 => format!(
            "shape = \"quad\"\ncorner = [{0:?}, {0:?}, 0]\nedge_u = [{1:?}, 0, 0]\nedge_v = [0, {1:?}, 0]",
            -reach,
            2.0 * reach
        ),
        1 => format!(
            "shape = \"disk\"\nnormal = [0, 0, 1]\nradius = {:?}",
            1.5 * reach
        ),
        2 => format!(
            "shape = \"box\"\nmin = [{0:?}, {0:?}, {1:?}]\nmax = [{2:?}, {2:?}, 0]",
            -reach, -depth, reach
        ),
        3 => format!(
            "shape = \"cylinder\"\nbase = [0, 0, {:?}]\ntop = [0, 0, 0]\nradius = {:?}",
            -depth,
            1.5 * reach
        ),
        4 => format!(
            "positions = [[{0:?}, {0:?}, 0], [{1:?}, {0:?}, 0], [{1:?}, {1:?}, 0], [{0:?}, {1:?}, 0]]\nindices = [[0, 1, 2, 3]]",
            -reach, reach
        ),
        _ => format!(
            "shape = \"revolution\"\naxis = [0, 0, 1]\nprofile = [[0, {0:?}], [{1:?}, {0:?}], [{1:?}, 0], [0, 0]]",
            -depth,
            1.5 * reach
        ),
    }
}

/// A clear thing whose face lies in the plane z = 0, before it (or behind it, or a sheet in it).
fn clear_thing(random: &mut Random) -> String {
    let (half, depth) = (between(random, 0.3, 0.9), between(random, 0.1, 0.8));
    let (near, far) = if random.next() < 0.4 {
        (0.0, depth)
    } else {
        (-depth, 0.0)
    };
    let end = if near == 0.0 { far } else { near };
    match choose(random, &[0, 1, 2, 3, 4, 5, 6]) {
        0 | 1 => format!(
            "shape = \"quad\"\ncorner = [{0:?}, {0:?}, 0]\nedge_u = [{1:?}, 0, 0]\nedge_v = [0, {1:?}, 0]",
            -half,
            2.0 * half
        ),
        2 => format!("shape = \"disk\"\nnormal = [0, 0, 1]\nradius = {half:?}"),
        3 => format!(
            "shape = \"box\"\nmin = [{0:?}, {0:?}, {near:?}]\nmax = [{half:?}, {half:?}, {far:?}]",
            -half
        ),
        4 => {
            format!("shape = \"cone\"\nbase = [0, 0, 0]\napex = [0, 0, {end:?}]\nradius = {half:?}")
        }
        5 => format!(
            "shape = \"cylinder\"\nbase = [0, 0, 0]\ntop = [0, 0, {end:?}]\nradius = {half:?}"
        ),
        _ => format!("shape = \"sphere\"\ncenter = [0, 0, {half:?}]\nradius = {half:?}"),
    }
}

/// Something clear touches an opaque wall that fills the picture: what lies behind the wall is never seen, and what does
/// not bend shows the wall everywhere.
#[test]
fn nothing_shines_through_a_wall_that_something_clear_touches() {
    let mut random = Random(13);
    for number in 0..count() {
        let place = place(&mut random);
        let thin = random.next() < 0.3;
        let ior = choose(&mut random, &[1.0, 1.0, 1.5]);
        let clear = format!(
            "[material.clear]\ncolor = 0\ntransmission = 1\nior = {ior:?}\nthin = {thin}\n"
        );
        let wall = object("wall", &flat_face(&mut random, 9.0), "red", &place);
        let thing = object("thing", &clear_thing(&mut random), "clear", &place);
        let behind = object(
            "behind",
            "shape = \"box\"\nmin = [-90, -90, -99]\nmax = [90, 90, -98]",
            "green",
            &place,
        );
        let mut objects = [wall, thing, behind];
        for i in (1..3).rev() {
            let j = (random.next().abs() * (i + 1) as f64) as usize;
            objects.swap(i, j.min(i));
        }
        let eye = v(random.next(), random.next(), between(&mut random, 2.5, 5.0));
        let text = format!(
            "{}[trace]\ndepth = 12\ntir = \"reflect\"\n{GREEN}{RED}{clear}{}",
            // What bends may leave the stage; only what lies behind the wall is green.
            camera(&place, eye, v(0.05, 0.02, 0.0), 40.0)
                .replace("background = [0, 1, 0]", "background = 0"),
            objects.concat()
        );
        for Picture { which, colors, .. } in pictures(&text) {
            for (pixel, color) in colors.iter().enumerate() {
                let is_right = color[1] == 0.0 && (ior != 1.0 || *color == [0.5, 0.0, 0.0]);
                assert!(
                    is_right,
                    "scene {number}, {which}, pixel {} {}: {color:?}\n{text}",
                    pixel % 24,
                    pixel / 24
                );
            }
        }
    }
}

/// Two opaque things with faces in one plane: where both are seen alone, the first in the file is, in both renderers.
#[test]
fn the_lowest_number_owns_a_plane() {
    let mut random = Random(31);
    for number in 0..count() {
        let place = place(&mut random);
        // Each is first moved in the plane, then turned and placed with the other.
        let shift = |random: &mut Random, form: String| {
            let by = list(v(random.next(), random.next(), 0.0) * 0.5);
            let steps = match place.steps.strip_prefix("transform = [") {
                Some(rest) => format!("transform = [{{ translate = {by} }}, {rest}"),
                None => format!("transform = [{{ translate = {by} }}]\n"),
            };
            (form, steps)
        };
        let a = flat_face(&mut random, 0.4);
        let (a, a_steps) = shift(&mut random, a);
        let b = flat_face(&mut random, 0.7);
        let (b, b_steps) = shift(&mut random, b);
        let one = |name: &str, form: &str, material: &str, steps: &str| {
            format!("[object.{name}]\n{form}\nmaterial = \"{material}\"\n{steps}")
        };
        let eye = v(
            2.0 * random.next(),
            2.0 * random.next(),
            between(&mut random, 2.5, 6.0),
        );
        let head = format!("{}{RED}{BLUE}", camera(&place, eye, DVec3::ZERO, 40.0));
        let (a, b) = (
            one("a", &a, "red", &a_steps),
            one("b", &b, "blue", &b_steps),
        );
        let both = format!("{head}{a}{b}");
        let (only_a, only_b) = (format!("{head}{a}"), format!("{head}{b}"));
        let all = |text: &str| {
            let mut all = pictures(text);
            all.extend(rasterized(text));
            all
        };
        let (found, alone_a, alone_b) = (all(&both), all(&only_a), all(&only_b));
        for ((found, a), b) in found.iter().zip(&alone_a).zip(&alone_b) {
            for i in 0..found.objects.len() {
                // Sides of a solid lie behind the plane: of two places the nearer one is seen.
                let nearest = a.depths[i].min(b.depths[i]);
                let seen = |alone: &Picture| {
                    let depth = alone.depths[i];
                    depth < f64::INFINITY && depth - nearest <= 1e-6 * nearest
                };
                let expected = match (seen(a), seen(b)) {
                    (true, _) => 0,
                    (false, true) => 1,
                    (false, false) => rastray::frame::NONE,
                };
                assert_eq!(
                    found.objects[i],
                    expected,
                    "scene {number}, {}, pixel {} {}\n{both}",
                    found.which,
                    i % 24,
                    i / 24
                );
            }
        }
    }
}

/// A solid in the hollow of another, wall on wall: the shapes of the hollow, of the solid, and of the space left above it.
fn vessel(random: &mut Random) -> [String; 4] {
    let (r, low, high, top) = (
        between(random, 0.3, 0.5),
        -0.5,
        between(random, 0.1, 0.6),
        0.8,
    );
    let cylinder = |from: f64, to: f64| {
        format!(
            "shape = \"cylinder\"\nbase = [0, {from:?}, 0]\ntop = [0, {to:?}, 0]\nradius = {r:?}"
        )
    };
    let turned = |from: f64, to: f64| {
        format!(
            "shape = \"revolution\"\nprofile = [[0, {from:?}], [{r:?}, {from:?}], [{r:?}, {to:?}], [0, {to:?}]]"
        )
    };
    let cuboid = |from: f64, to: f64| {
        format!(
            "shape = \"box\"\nmin = [{0:?}, {from:?}, {0:?}]\nmax = [{r:?}, {to:?}, {r:?}]",
            -r
        )
    };
    type Form<'f> = &'f dyn Fn(f64, f64) -> String;
    let (round, also_round): (Form<'_>, Form<'_>) = if random.next() < 0.0 {
        (&cylinder, &turned)
    } else {
        (&turned, &cylinder)
    };
    let outer = "shape = \"box\"\nmin = [-0.7, -0.8, -0.7]\nmax = [0.7, 1, 0.7]".to_owned();
    let square = random.next() < 0.3;
    let (a, b): (Form<'_>, Form<'_>) = if square {
        (&cuboid, &cuboid)
    } else {
        (round, also_round)
    };
    [outer, a(low, top), b(low, high), a(high, top)]
}

/// Water in an air cavity with the same walls, whatever the file's order and however all is turned, is the same picture
/// as water and air side by side.
#[test]
fn what_lies_in_a_cavity_is_inside_it() {
    let mut random = Random(55);
    for number in 0..count() {
        let place = place(&mut random);
        let upright = Place {
            steps: String::new(),
            matrix: DAffine3::IDENTITY,
        };
        let [outer, cavity, water, air] = vessel(&mut random);
        let media = format!(
            "{}{}{}",
            glass("glass", 1.5),
            glass("air", 1.0),
            "[material.water]\ncolor = 0\ntransmission = [0.5, 0.75, 1]\nior = 1.33\n"
        );
        let eye = v(2.5 * random.next(), between(&mut random, -0.4, 1.5), 4.0);
        let text = |place: &Place, order: &[usize], parts: bool| {
            let inner = if parts { &air } else { &cavity };
            let objects = [
                object("outer", &outer, "glass", place),
                object("cavity", inner, "air", place),
                object("water", &water, "water", place),
            ];
            let listed: String = order.iter().map(|i| objects[*i].as_str()).collect();
            format!(
                "{}[trace]\ndepth = 20\ntir = \"reflect\"\n{media}{listed}\
                 [material.back]\ncolor = 0\nemission = [0.5, 0.25, 1]\n\
                 [material.side]\ncolor = 0\nemission = [0.25, 1, 0.125]\n{}",
                camera(place, eye, v(0.0, 0.1, 0.0), 32.0),
                object(
                    "back",
                    "shape = \"checkered floor\"\nsize = [40, 40]\ntiles = [29, 31]\nmaterials = [\"back\", \"side\"]\ncenter = [0.01, -1.5, 0.02]",
                    "",
                    place
                )
                .replace("material = \"\"\n", "")
            )
        };
        let exact = |text: &str| {
            draw::<f64>(&stage(text, 1.0), Geometry::Exact, false)
                .color
                .data
                .clone()
        };
        let truth = exact(&text(&upright, &[0, 1, 2], true));
        for (turned, order) in [
            (&upright, [0, 1, 2]),
            (&upright, [2, 1, 0]),
            (&place, [1, 0, 2]),
            (&place, [2, 0, 1]),
        ] {
            let own = text(turned, &order, false);
            let wrong = exact(&own)
                .iter()
                .zip(&truth)
                .filter(|(a, b)| (0..3).any(|c| (a[c] - b[c]).abs() > 1e-6))
                .count();
            assert_eq!(wrong, 0, "scene {number}, order {order:?}\n{own}");
        }
    }
}

/// Curved walls that touch: of each the lowest number shows its own light, so a turned scene counts as the upright one.
#[test]
fn curved_walls_that_touch_turn_as_one() {
    let mut random = Random(4);
    for number in 0..count() {
        let place = place(&mut random);
        let upright = Place {
            steps: String::new(),
            matrix: DAffine3::IDENTITY,
        };
        let r = between(&mut random, 0.3, 0.5);
        let (tumbler, drink) = match choose(&mut random, &[0, 1, 2, 3]) {
            0 => (
                format!(
                    "shape = \"revolution\"\nprofile = [[0, -0.8], [0.6, -0.8], [0.6, 0.8], [{r:?}, 0.8], [{r:?}, -0.5], [0, -0.5]]"
                ),
                format!(
                    "shape = \"cylinder\"\nbase = [0, -0.5, 0]\ntop = [0, 0.5, 0]\nradius = {r:?}"
                ),
            ),
            1 => (
                format!(
                    "shape = \"revolution\"\nprofile = [[0, -0.8], [0.6, -0.8], [0.6, 0.8], [{r:?}, 0.8], [0, -0.5]]"
                ),
                format!(
                    "shape = \"cone\"\nbase = [0, 0.8, 0]\napex = [0, -0.5, 0]\nradius = {r:?}"
                ),
            ),
            2 => (
                format!("shape = \"sphere\"\ncenter = [0, 0.1, 0]\nradius = {r:?}"),
                format!("shape = \"sphere\"\ncenter = [0, 0.1, 0]\nradius = {r:?}"),
            ),
            _ => (
                format!("shape = \"torus\"\naxis = [0, 1, 0]\nmajor = {r:?}\nminor = 0.2"),
                format!("shape = \"torus\"\naxis = [0, 2, 0]\nmajor = {r:?}\nminor = 0.2"),
            ),
        };
        let steps = |name: &str, channel: usize| {
            let mut light = [0.0; 3];
            light[channel] = 0.25;
            format!(
                "[material.{name}]\ncolor = 0\nemission = {light:?}\ntransmission = 1\nior = 1.5\n"
            )
        };
        let eye = v(random.next(), between(&mut random, -0.4, 1.5), 4.0);
        let text = |place: &Place, swap: bool| {
            let mut objects = [
                object("a", &tumbler, "a", place),
                object("b", &drink, "b", place),
            ];
            if swap {
                objects.swap(0, 1);
            }
            format!(
                "{}[trace]\ndepth = 9\ntir = \"reflect\"\n{}{}{}",
                camera(place, eye, v(0.0, 0.1, 0.0), 24.0),
                steps("a", 0),
                steps("b", 2),
                objects.concat()
            )
        };
        for swap in [false, true] {
            let truth = pictures(&text(&upright, swap)).swap_remove(0).colors;
            let own = text(&place, swap);
            // The true shapes, in both precisions; background green counts as 1.
            for Picture { which, colors, .. } in pictures(&own).into_iter().take(2) {
                let steps = |c: &[f64; 3]| c.map(|x| (x * 4.0).round());
                let wrong = colors
                    .iter()
                    .zip(&truth)
                    .filter(|(a, b)| steps(a) != steps(b));
                assert_eq!(
                    wrong.count(),
                    0,
                    "scene {number}, {which}, swap {swap}\n{own}"
                );
            }
        }
    }
}

/// A light that lies exactly on a surface is not blocked by it: what the surface alone would take away is there.
#[test]
fn a_light_on_a_surface_is_not_blocked_by_it() {
    let mut random = Random(77);
    for number in 0..count() {
        let place = place(&mut random);
        // A white wall at z = -2 seen from the side, and a surface in the plane z = 0 (or a ball's lowest point) at the lamp.
        let lamp = v(0.2 * random.next(), 0.2 * random.next(), 0.0);
        let on = match choose(&mut random, &[0, 1, 2]) {
            0 => format!(
                "shape = \"sphere\"\ncenter = [{:?}, {:?}, 0.75]\nradius = 0.75",
                lamp.x, lamp.y
            ),
            _ => {
                // Fronts face the wall: solids lie on the far side of the plane.
                flat_face(&mut random, 0.8).replace("normal = [0, 0, 1]", "normal = [0, 0, -1]")
            }
        };
        let turned = "transform = [{ rotate = { axis = [1, 0, 0], degrees = 180 } }";
        let steps = match place.steps.strip_prefix("transform = [") {
            _ if on.contains("sphere") => place.steps.clone(),
            Some(rest) => format!("{turned}, {rest}"),
            None => format!("{turned}]\n"),
        };
        let head = format!(
            "{}[light.lamp]\nposition = {}\n[material.white]\ncolor = 0.8\n",
            camera(&place, v(6.0, 1.0, -1.0), v(0.0, 0.0, -2.0), 30.0),
            list(place.matrix.transform_point3(lamp))
        );
        let wall = object(
            "wall",
            "shape = \"box\"\nmin = [-2, -2, -2.5]\nmax = [2, 2, -2]",
            "white",
            &place,
        );
        let alone = format!("{head}{wall}");
        let both = format!("{head}{wall}[object.on]\n{on}\nmaterial = \"white\"\n{steps}");
        for (found, expected) in pictures(&both).iter().zip(pictures(&alone)) {
            // A tessellated ball does not hold the lamp: its facets lie within it.
            if on.contains("sphere") && found.which.starts_with("mesh") {
                continue;
            }
            let colors = found.colors.iter().zip(&expected.colors);
            for (i, (a, b)) in colors.enumerate() {
                let lit = (0..3).all(|c| (a[c] - b[c]).abs() <= 1e-6);
                assert!(
                    lit || found.objects[i] != 0,
                    "scene {number}, {}, pixel {} {}: {a:?}, not {b:?}\n{both}",
                    found.which,
                    i % 24,
                    i / 24
                );
            }
        }
    }
}

/// Schmidt and Budge (2002): water drawn into the glass around it. The water's priority is higher, so that the glass's inner
/// wall, which lies inside the water, is not there: the same as glass that ends where the water begins.
#[test]
fn the_higher_priority_is_there_where_solids_overlap() {
    let slab = |name: &str, top: f64, bottom: f64, material: &str, more: &str| {
        cuboid(name, v(-15.0, -15.0, bottom), v(15.0, 15.0, top), material) + more
    };
    for i in [0.0, 0.4, 1.0] {
        let (sin, cos) = libm::sincos(i);
        let along = v(sin, 0.0, -cos);
        let way = |t: f64, n: f64| t * libm::tan(libm::asin(sin / n));
        // Flint from 0 to -2, water from -1.5 to -3.5: what overlaps is the higher one's.
        for (flint, water, layers) in [
            (1, 0, [(2.0, 1.7), (1.5, 1.33)]),
            (-2, 3, [(1.5, 1.7), (2.0, 1.33)]),
            (0, 1, [(1.5, 1.7), (2.0, 1.33)]),
        ] {
            let x: f64 = layers.iter().map(|(t, n)| way(*t, *n)).sum();
            let a = slab("a", 0.0, -2.0, "flint", &format!("priority = {flint}\n"));
            let b = slab("b", -1.5, -3.5, "water", &format!("priority = {water}\n"));
            for order in [[&a, &b], [&b, &a]] {
                let text = format!(
                    "{}{}{}{}{}",
                    one_ray(-3.0 * along, along),
                    glass("flint", 1.7),
                    glass("water", 1.33),
                    order[0],
                    order[1]
                );
                assert_ray_on(
                    &text,
                    &[Geometry::Exact, Geometry::Mesh],
                    v(x, 0.0, -3.5),
                    along,
                    [4.0 / (cos * cos); 2],
                );
            }
        }
    }
}

/// Surfaces that are not there take no light and are not seen: each passage through what is there weighs once.
#[test]
fn surfaces_inside_a_higher_priority_weigh_nothing() {
    let text = |priority: i32| {
        format!(
            "{}[material.half]\ncolor = 0\nemission = 0.125\ntransmission = 0.5\n\
             [material.back]\ncolor = 0\nemission = 1\n{}priority = {priority}\n{}{}",
            one_ray(v(0.1, 0.2, 5.0), v(0.0, 0.0, -1.0)),
            cuboid("around", v(-2.0, -2.0, -2.0), v(2.0, 2.0, 2.0), "half"),
            cuboid("inner", v(-1.0, -1.0, -1.0), v(1.0, 1.0, 1.0), "half"),
            quad(
                "back",
                v(-9.0, -9.0, -4.0),
                v(18.0, 0.0, 0.0),
                v(0.0, 18.0, 0.0),
                "back"
            )
        )
    };
    // e (1 + 1/2 + ...) over each surface that is there, then the wall behind.
    let sum = |n: i32| 0.125 * (2.0 - 2.0 * 0.5f64.powi(n)) + 0.5f64.powi(n);
    assert_seen(&text(0), [sum(4); 3], 0.0);
    assert_seen(&text(1), [sum(2); 3], 0.0);
    assert_seen(&text(-1), [sum(4); 3], 0.0);
}
