//! `trade --verify`: each answer against the truth at places that had no part in it.

use rastray::error::Error;
use rastray::scene::Scene;
use rastray::trade::finding::Trade;
use rastray::trade::run::{Options, Outcome};
use rastray::trade::setting::Setting;
use rastray::trade::verify::{edges, elsewhere};

use super::commands;

/// Seeds of the two pictures of one jittered sample a pixel: twice the samples of the promise.
const SEEDS: [u32; 2] = [1, 2];

/// Prints a table: what was promised, and what is found at other places.
pub(super) fn print(
    scene: &Scene,
    trade: &Trade,
    outcome: &Outcome,
    options: &Options,
) -> Result<(), Error> {
    let mut text = format!(
        "{:34} {:>9} {:>12} {:>12}\n",
        "verified", "target", "promised", "elsewhere"
    );
    let named = |name: &str| -> Option<Setting> {
        let task = outcome
            .tasks
            .iter()
            .find(|t| t.setting.name(scene) == name)?;
        Some(task.setting)
    };
    let answers = trade
        .answers
        .iter()
        .filter_map(|a| Some((a.target, &trade.rows[a.row?])));
    for (target, row) in answers {
        let (Some(setting), Some(accuracy)) = (named(&row.setting), row.full) else {
            continue;
        };
        let mut squares = 0.0;
        for seed in SEEDS {
            let rmse = elsewhere(scene, &setting, seed, options.isa)?.all.rmse;
            squares += rmse * rmse / SEEDS.len() as f64;
        }
        text += &line(
            &row.setting,
            &format!("{target:.1e}"),
            accuracy.all.rmse,
            squares.sqrt(),
        );
    }
    for row in trade.rows.iter().filter(|r| r.ideal.is_some()) {
        let (Some(setting), Some(ideal)) = (named(&row.setting), row.ideal) else {
            continue;
        };
        if setting.samples >= 16 {
            let samples = 2 * options.ideal_samples;
            let found = edges(scene, &setting, samples, SEEDS[0], options.isa)?;
            text += &line(&row.setting, "edges", ideal.silhouette.rmse, found);
        }
    }
    commands::print(&text)
}

fn line(setting: &str, target: &str, promised: f64, found: f64) -> String {
    format!("{setting:34} {target:>9} {promised:>12.3e} {found:>12.3e}\n")
}
