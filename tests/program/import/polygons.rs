//! Faces that touch or cross themselves cover what their outline goes round; groups whose normals cancel.

use rastray::import::Imported;
use rastray::math::DVec3;
use rastray::scene::Mesh;

use super::{load_files, load_text, mesh_of, notes};

/// An OBJ face through these points, from each corner in turn.
fn face(points: &[(f64, f64)], start: usize) -> Imported {
    let n = points.len();
    let mut text = String::new();
    for k in 0..n {
        let (x, y) = points[(start + k) % n];
        text.push_str(&format!("v {x} {y} 0\n"));
    }
    let corners: Vec<String> = (1..=n).map(|i| i.to_string()).collect();
    text.push_str(&format!("f {}\n", corners.join(" ")));
    load_text("a.obj", text, &[]).unwrap()
}

fn cross(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    (b - a).cross(c - a).z
}

/// How many triangles have a place.
fn cover(mesh: &Mesh, place: DVec3) -> usize {
    let has = |t: &&[u32; 3]| {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
        let sides = [cross(a, b, place), cross(b, c, place), cross(c, a, place)];
        sides.iter().all(|s| *s > 0.0) || sides.iter().all(|s| *s < 0.0)
    };
    mesh.triangles.iter().filter(has).count()
}

/// How often an outline goes round a place.
fn winding(points: &[(f64, f64)], place: DVec3) -> i32 {
    let n = points.len();
    let at = |i: usize| DVec3::new(points[i % n].0, points[i % n].1, 0.0);
    let step = |i: usize| {
        let (a, b) = (at(i), at(i + 1));
        let side = cross(a, b, place);
        match (a.y <= place.y, b.y <= place.y) {
            (true, false) if side > 0.0 => 1,
            (false, true) if side < 0.0 => -1,
            _ => 0,
        }
    };
    (0..n).map(step).sum()
}

/// Name, outline, and whether it crosses itself.
type Figure = (&'static str, Vec<(f64, f64)>, bool);

fn figures() -> Vec<Figure> {
    let square = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let with = |more: &[(f64, f64)]| [&square[..], more].concat();
    vec![
        (
            "a spike outwards",
            vec![
                (-1.0, -1.0),
                (1.0, -1.0),
                (1.0, 1.0),
                (1.0, 1.8),
                (1.0, 1.0),
                (-1.0, 1.0),
            ],
            false,
        ),
        (
            "a slanted spike",
            vec![
                (-1.0, -1.0),
                (1.0, -1.0),
                (1.0, 1.0),
                (1.7, 1.9),
                (1.0, 1.0),
                (-1.0, 1.0),
            ],
            false,
        ),
        ("a spike inwards", with(&[(0.0, 0.0), (-1.0, 1.0)]), false),
        (
            "two holes from one corner",
            with(&[
                (-1.0, -1.0),
                (-0.2, -0.6),
                (0.5, -0.4),
                (0.6, -0.8),
                (-0.2, -0.6),
                (-1.0, -1.0),
                (-0.8, 0.1),
                (-0.5, 0.7),
                (-0.3, 0.0),
                (-0.8, 0.1),
            ]),
            false,
        ),
        (
            "a hole on a hole",
            with(&[
                (-1.0, -1.0),
                (-0.5, -0.5),
                (-0.5, 0.0),
                (0.0, 0.0),
                (0.25, 0.5),
                (0.5, 0.25),
                (0.0, 0.0),
                (0.0, -0.5),
                (-0.5, -0.5),
            ]),
            false,
        ),
        (
            "two squares at a corner",
            vec![
                (0.0, 0.0),
                (1.0, 0.0),
                (1.0, 1.0),
                (0.0, 1.0),
                (0.0, 0.0),
                (-1.0, 0.0),
                (-1.0, -1.0),
                (0.0, -1.0),
            ],
            false,
        ),
        (
            "a hole on the edge's corner",
            vec![
                (-1.0, -1.0),
                (1.0, -1.0),
                (1.0, 1.0),
                (0.5, 0.0),
                (-0.5, 0.0),
                (0.0, 0.5),
                (1.0, 1.0),
                (-1.0, 1.0),
            ],
            false,
        ),
        (
            "an equal bow tie",
            vec![(-1.0, -1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, 1.0)],
            true,
        ),
        (
            "an unequal bow tie",
            vec![(-1.0, -1.0), (1.0, 0.5), (1.0, -1.0), (-0.5, 1.0)],
            true,
        ),
        (
            "a pentagram",
            (0..5)
                .map(|k| {
                    let a = 0.1 + f64::from(k) * 2.513_274_122_871_834_5;
                    (a.cos(), a.sin())
                })
                .collect(),
            true,
        ),
        ("twice round", [square, square].concat(), true),
    ]
}

#[test]
fn what_the_outline_goes_round_is_covered() {
    for (name, points, crosses) in figures() {
        for start in 0..points.len() {
            let found = face(&points, start);
            let mesh = mesh_of(&found.scene, 0);
            let mut wrong = 0;
            for i in 0..61 {
                for j in 0..61 {
                    // Off the edges, which have round numbers.
                    let place = DVec3::new(
                        f64::from(i) / 29.3 - 1.0417,
                        f64::from(j) / 29.7 - 1.0291,
                        0.0,
                    );
                    let expected = usize::from(winding(&points, place) != 0);
                    wrong += usize::from(cover(mesh, place) != expected);
                }
            }
            assert_eq!(wrong, 0, "{name} from {start}: {:?}", mesh.triangles);
            // All triangles face the same way.
            let sign = |t: &[u32; 3]| {
                let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
                cross(a, b, c)
            };
            // Slivers between a crossing and its own edge are thinner than the rounding of their corners: they have no side.
            let rounding = 8.0 * f64::EPSILON;
            let signs = mesh.triangles.iter().map(sign);
            let signs: Vec<f64> = signs.filter(|s| s.abs() > rounding).collect();
            assert!(
                signs.iter().all(|s| *s >= 0.0) || signs.iter().all(|s| *s <= 0.0),
                "{name}"
            );
            let noted = notes(&found).contains("crosses or covers itself");
            assert_eq!(noted, crosses, "{name} from {start}");
        }
    }
}

#[test]
fn new_corners_have_what_lies_between() {
    // The crossing is in the middle of both diagonals.
    let text = "v -1 -1 0\nv 1 1 0\nv 1 -1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 1 0 1\nvn -1 0 1\n\
                f 1/1/1 2/2/2 3/3/1 4/4/2\n";
    let found = load_text("a.obj", text, &[]).unwrap();
    let mesh = mesh_of(&found.scene, 0);
    let new = mesh
        .positions
        .iter()
        .position(|p| *p == DVec3::ZERO)
        .unwrap();
    assert_eq!(mesh.normals[new], DVec3::Z);
    assert_eq!(
        (mesh.texcoords[new].x, mesh.texcoords[new].y),
        (
            0.5,
            if mesh.texcoords[new].y == 0.0 {
                0.0
            } else {
                1.0
            }
        )
    );
    assert_eq!(mesh.triangles.len(), 2);
    // The same in OFF and in a scene file.
    let off = "OFF\n4 1 0\n-1 -1 0\n1 1 0\n1 -1 0\n-1 1 0\n4 0 1 2 3\n";
    let files = [
        ("a.scn", &b"mesh -1 m.off\n"[..]),
        ("m.off", off.as_bytes()),
    ];
    let found = load_files(&files, &[]).unwrap();
    assert_eq!(mesh_of(&found.scene, 0).positions[4], DVec3::ZERO);
    assert!(notes(&found).contains("crosses or covers itself"));
    let toml = "[object.a]\npositions = [[-1, -1, 0], [1, 1, 0], [1, -1, 0], [-1, 1, 0]]\nindices = [[0, 1, 2, 3]]\n";
    let found = load_text("a.toml", toml, &[]).unwrap();
    assert_eq!(mesh_of(&found.scene, 0).positions[4], DVec3::ZERO);
    assert!(
        notes(&found).contains("crosses or covers itself"),
        "{}",
        notes(&found)
    );
}

#[test]
fn faces_of_many_corners_end() {
    let star = |n: usize, odd: f64| -> Vec<(f64, f64)> {
        let point = |i: usize| {
            let a = i as f64 / n as f64 * std::f64::consts::TAU;
            let r = if i.is_multiple_of(2) { 1.0 } else { odd };
            (r * a.cos(), r * a.sin())
        };
        (0..n).map(point).collect()
    };
    let found = face(&star(16_384, 0.5), 0);
    assert_eq!(mesh_of(&found.scene, 0).triangles.len(), 16_382);
    assert!(!notes(&found).contains("crosses"));
    let mut crossing = star(3_000, 0.5);
    for i in (0..2_996).step_by(4) {
        crossing.swap(i, i + 2);
    }
    let found = face(&crossing, 0);
    assert!(notes(&found).contains("crosses or covers itself"));
}

#[test]
fn normals_that_cancel_are_the_faces_own() {
    let square = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nv 2 -1 0\nv 2 1 0\n";
    for faces in [
        "s 1\nf 1 2 3 4\nf 4 3 2 1\n",
        "s 1\nf 1 2 3\nf 1 3 4\nf 3 2 1\nf 4 3 1\n",
        "s 1\nf 1 2 3 4\nf 4 3 2 1\nf 2 5 6 3\n",
        "s 7\nf 1 2 3 4\nf 1 4 3 2\ns 8\nf 2 5 6 3\n",
    ] {
        let found = load_text("a.obj", format!("{square}{faces}"), &[]).unwrap();
        let mesh = mesh_of(&found.scene, 0);
        for (i, t) in mesh.triangles.iter().enumerate() {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
            let own = (b - a).cross(c - a).normalize();
            for corner in t {
                let normal = mesh.normals[*corner as usize];
                assert_eq!(normal.length(), 1.0, "{faces} {i}");
                // The front face is lit as in flat shading.
                assert!(own.z < 0.0 || normal == own, "{faces} {i}: {normal}");
            }
        }
        assert!(
            notes(&found).contains("normals of a smoothing group cancel"),
            "{}",
            notes(&found)
        );
    }
    // Turned and far away, what is left of them is rounding.
    let turned = "v 1000.1 7.3 -2.7\nv 1000.9 8.1 -2.2\nv 1000.4 8.8 -1.3\nv 999.6 8.0 -1.8\ns 1\nf 1 2 3 4\nf 3 2 1 4\n";
    let found = load_text("a.obj", turned, &[]).unwrap();
    let mesh = mesh_of(&found.scene, 0);
    let longest = mesh
        .normals
        .iter()
        .map(|n| n.length())
        .fold(f64::INFINITY, f64::min);
    assert!((longest - 1.0).abs() < 1e-12);
    assert!(notes(&found).contains("normals of a smoothing group cancel"));
}
