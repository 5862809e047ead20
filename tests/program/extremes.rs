//! The extremes atlas: at the ends of every input, f32 is f64 within the bar, or the scene is ill-conditioned there and by
//! how much is measured; no NaN, no wrong decision.
//!
//! By default a few cells, small. The whole atlas, as `rastray trade --extremes` draws it (a minute or two):
//! `cargo test --release --test program extremes:: -- --ignored --nocapture`

use rastray::trade::extremes::{Atlas, BAR, Options, atlas, cell_count};

/// What every cell must say, and a line for each figure over the bar.
fn judge(atlas: &Atlas) {
    let (mut held, mut faults) = (0, Vec::new());
    for (sheet, cell) in atlas.cells() {
        for (renderer, figure) in cell.figures() {
            let place = format!(
                "{}: {}, {}, {renderer}",
                sheet.name, cell.scene, cell.setting
            );
            if figure.fault(cell.bar) {
                faults.push(format!("{place}: {figure:?}"));
            }
            let holds = figure.holds(cell.bar);
            held += usize::from(holds);
            // Over the bar, the caption names the input and how badly conditioned the scene is in it.
            assert_eq!(holds, figure.condition.is_none(), "{place}");
            if let Some(condition) = &figure.condition {
                println!(
                    "{place}: {:.1e}, {} objects; {condition:?}",
                    figure.error, figure.objects
                );
                let moved = condition.change > 0.1 * cell.bar || condition.objects > 0;
                assert!(moved, "{place}: {condition:?} is no reason");
            }
        }
    }
    println!("{held} of {} figures hold", 2 * atlas.cells().count());
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(held > 0);
}

#[test]
fn a_small_atlas_holds_the_bar() {
    let options = Options {
        width: 32,
        height: 24,
        level: 16,
        quick: true,
        ..Options::default()
    };
    let atlas = atlas(&options, &|_| {}).expect("shipped scenes render");
    assert_eq!(atlas.cells().count(), cell_count(&options));
    assert_eq!(atlas.sheets.len(), 8);
    judge(&atlas);
    // What no extreme can spoil: a scene is the same scene at any scale.
    let scale = atlas
        .sheets
        .iter()
        .find(|s| s.name == "scale")
        .expect("a sheet");
    assert!(
        scale
            .cells
            .iter()
            .all(|c| c.raster.error <= BAR && c.trace.error <= BAR)
    );
}

#[test]
#[ignore = "a minute or two: the whole atlas"]
fn the_atlas_holds_the_bar() {
    judge(&atlas(&Options::default(), &|_| {}).expect("shipped scenes render"));
}
