//! What a run says beside its numbers: what it found in its folder, what its truth leaves out, and what was run how.

use std::path::Path;

use crate::error::Note;
use crate::scene::Scene;
use crate::trade::journal::Found;
use crate::trade::run::{Options, Outcome};
use crate::trade::timing::ROUNDS;
use crate::trade::truth::End;

/// What the state of the journal means for the reader.
pub fn found_note(found: Found, folder: &Path) -> Option<Note> {
    let message = match found {
        Found::Nothing | Found::Same(0) => return None,
        Found::Same(n) => format!(
            "{n} settings were measured by earlier runs, kept in {}",
            folder.display()
        ),
        Found::Other => format!(
            "{} held measurements of another scene, size, version or instruction set: they are gone, and this run starts again",
            folder.display()
        ),
    };
    Some(Note {
        place: None,
        message,
    })
}

/// What the truth itself leaves out.
pub fn left_note(end: &End) -> Option<Note> {
    let left = end.weight_left?;
    let weight = if left < 1.0 {
        format!("the next would weigh up to {left:.1e}")
    } else {
        "surfaces pass on all light, so what is left then has no bound".to_owned()
    };
    Some(Note {
        place: None,
        message: format!(
            "the truth follows {} generations of rays; {weight}, and smaller errors than that say little",
            end.depth
        ),
    })
}

/// What was run how, name and value; `depth` is the generations of rays that the truth follows.
pub fn settings(
    scene: &Scene,
    options: &Options,
    outcome: &Outcome,
    depth: u32,
) -> Vec<(String, String)> {
    let image = &scene.image;
    let [asked, complete] = outcome.timed;
    let times = if options.times {
        format!(
            "{} s; times of {asked} settings; {complete} of them have all {ROUNDS} rounds yet",
            options.budget.as_secs_f64()
        )
    } else {
        format!("{} s; no times", options.budget.as_secs_f64())
    };
    let pairs = [
        ("size", format!("{} × {}", image.width, image.height)),
        ("budget", times),
        (
            "truth",
            format!(
                "exact shapes, f64, rays of weight 10⁻⁷ and more, at most {depth} generations of them"
            ),
        ),
        ("instruction set", options.isa.name().to_owned()),
    ];
    pairs.map(|(name, value)| (name.to_owned(), value)).to_vec()
}
