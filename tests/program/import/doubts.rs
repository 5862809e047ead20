//! Notes that only the whole scene can tell, the key `priority`, and the two ways to write a matrix.

use super::*;

fn notes(text: &str) -> Vec<String> {
    let imported = load_text("scene.toml", text, &[]).unwrap_or_else(|e| panic!("{e}\n{text}"));
    imported.notes.iter().map(ToString::to_string).collect()
}

fn noted(text: &str, words: &[&str]) -> bool {
    let holds = |note: &String| words.iter().all(|word| note.contains(word));
    notes(text).iter().any(holds)
}

const LIGHT: &str = "[light.key]\nposition = [3, 4, 5]\n";

/// Opaque things in one plane that could be seen to fight are named, in whatever way both are turned; what only stands on
/// something, lies beside it, or is clear, is not.
#[test]
fn planes_with_two_owners_are_named() {
    let turn = "transform = [{ rotate = { axis = [0.3, 1, 0.2], degrees = 33 } }, { translate = [1, 2, 3] }]\n";
    let floor = "[object.floor]\nshape = \"plane\"\nsize = 10\n";
    let rug = "[object.rug]\nshape = \"plane\"\nsize = 3\n";
    let flush = "[object.rug]\nshape = \"box\"\nmin = [-1, -1, -1]\nmax = [1, 0, 1]\n";
    let standing = "[object.rug]\nshape = \"box\"\nmin = [-1, 0, -1]\nmax = [1, 1, 1]\n";
    let beside = "[object.rug]\nshape = \"plane\"\nsize = 3\ncenter = [6.5, 0, 0]\n";
    let round = "[object.rug]\nshape = \"disk\"\nradius = 2\n";
    for (thing, is_named) in [
        (rug, true),
        (flush, true),
        (round, true),
        (standing, false),
        (beside, false),
    ] {
        for turn in ["", turn] {
            for rug_first in [true, false] {
                let (a, b) = (format!("{thing}{turn}"), format!("{floor}{turn}"));
                let text = if rug_first {
                    format!("{LIGHT}{a}{b}")
                } else {
                    format!("{LIGHT}{b}{a}")
                };
                let owner = if rug_first {
                    "rug, the first"
                } else {
                    "floor, the first"
                };
                let found = noted(&text, &["floor", "rug", "in one plane", owner]);
                assert_eq!(found, is_named, "{text}\n{:?}", notes(&text));
            }
        }
    }
    let clear = "[material.clear]\ntransmission = 0.9\n";
    let text = format!("{LIGHT}{clear}{floor}{rug}material = \"clear\"\n");
    assert!(!noted(&text, &["in one plane"]), "{:?}", notes(&text));
}

#[test]
fn lights_that_light_nothing_or_without_end_are_noted() {
    let ball = "[object.ball]\nshape = \"sphere\"\n";
    let inside = "[light.key]\nposition = [0.2, 0.1, 0.3]\n";
    let tube =
        "[object.ball]\nshape = \"cylinder\"\nbase = [0, -1, 0]\ntop = [0, 1, 0]\nradius = 1\n";
    let turned =
        "[object.ball]\nshape = \"revolution\"\nprofile = [[0, -1], [1, -1], [1, 1], [0, 1]]\n";
    let mesh = "[object.ball]\npositions = [[-4, -4, -4], [9, -4, -4], [-4, 9, -4], [-4, -4, 9]]\n\
                indices = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]\n";
    for solid in [ball, tube, turned, mesh] {
        let words = ["light key", "inside object ball"];
        assert!(noted(&format!("{inside}{solid}"), &words), "{solid}");
        let outside = "[light.key]\nposition = [20, 0.1, 0.3]\n";
        assert!(!noted(&format!("{outside}{solid}"), &words), "{solid}");
    }
    // Open, or clear and filtered: it lights what is outside.
    let open = format!("{inside}{tube}caps = false\n");
    let clear = format!(
        "[trace]\nshadow = \"filtered\"\n[material.clear]\ntransmission = 0.9\n{inside}{ball}material = \"clear\"\n"
    );
    for text in [open, clear] {
        assert!(!noted(&text, &["inside object"]), "{text}");
    }
    for (attenuation, is_noted) in [("0, 0, 0", true), ("1, 0, 0", false), ("0, 0, 1", false)] {
        let text = format!("{LIGHT}attenuation = [{attenuation}]\n{ball}");
        assert_eq!(
            noted(&text, &["light key", "attenuation 0, 0, 0"]),
            is_noted
        );
    }
}

#[test]
fn a_camera_too_far_away_for_f32_is_noted() {
    let text = |distance: f64| {
        format!(
            "{LIGHT}[camera]\neye = [0, 0, {distance:?}]\ntarget = [0, 0, 0]\n[object.ball]\nshape = \"sphere\"\n"
        )
    };
    for (distance, is_noted) in [(1e3, false), (1e5, true), (1e6, true), (1e7, true)] {
        let found = noted(&text(distance), &["camera", "--precision f64"]);
        assert_eq!(found, is_noted, "{distance}");
    }
}

/// Sixteen numbers, or four rows of four: the same place. What is neither is an error with its place.
#[test]
fn a_matrix_is_sixteen_numbers_or_four_rows() {
    let place = |matrix: &str| {
        let text = format!(
            "{LIGHT}[object.ball]\nshape = \"sphere\"\ntransform = [{{ matrix = {matrix} }}]\n"
        );
        load_text("scene.toml", text, &[]).map(|found| found.scene.objects[0].world_from_object)
    };
    let flat = place("[1, 2, 3, 4, 0, 1, 5, 6, 0, 0, 2, 7, 0, 0, 0, 1]").unwrap();
    let rows = place("[[1, 2, 3, 4], [0, 1, 5, 6], [0, 0, 2, 7], [0, 0, 0, 1]]").unwrap();
    assert_eq!(flat, rows);
    assert_eq!(rows.translation.to_array(), [4.0, 6.0, 7.0]);
    for wrong in [
        "[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]",
        "[[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0]]",
        "[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], 1]",
        "[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]",
        "[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 1, 1]]",
    ] {
        let error = place(wrong).unwrap_err().to_string();
        assert!(error.contains("matrix"), "{wrong}: {error}");
    }
}

/// `priority` is a whole number of either sign; an instance has its original's unless it states one.
#[test]
fn priorities_are_whole_numbers() {
    let with = |line: &str| {
        let text = format!("{LIGHT}[object.ball]\nshape = \"sphere\"\n{line}\n");
        load_text("scene.toml", text, &[])
    };
    assert_eq!(with("").unwrap().scene.objects[0].priority, 0);
    assert_eq!(with("priority = -3").unwrap().scene.objects[0].priority, -3);
    for wrong in [
        "priority = 0.5",
        "priority = \"high\"",
        "priority = 99999999999",
    ] {
        let error = with(wrong).unwrap_err().to_string();
        assert!(error.contains("priority"), "{wrong}: {error}");
    }
    let twice = "priority = 2\n[object.again]\ninstance = \"ball\"\n[object.third]\ninstance = \"ball\"\npriority = 1";
    let objects = with(twice).unwrap().scene.objects;
    let found: Vec<i32> = objects.iter().map(|o| o.priority).collect();
    assert_eq!(found, [2, 2, 1]);
    let set = load_text(
        "scene.toml",
        format!("{LIGHT}[object.ball]\nshape = \"sphere\"\n"),
        &["object.ball.priority=-7"],
    );
    assert_eq!(set.unwrap().scene.objects[0].priority, -7);
}
