//! `render --error E` and `--time MS`: the setting is picked by a quick trade of the scene.

use std::time::Duration;

use rastray::error::Error;
use rastray::lanes::Isa;
use rastray::scene::Scene;
use rastray::trade::choose::{Choice, Goal, choose};

use super::args::RenderArgs;
use super::options::Verbosity;
use super::progress::Progress;

/// The longest time that can be asked for, in milliseconds: a day.
const LONGEST_MS: f64 = 86_400_000.0;

/// Picks a setting where one is asked for, and says which and what to expect of it.
pub(super) fn pick(
    args: &RenderArgs,
    scene: &Scene,
    isa: Isa,
    verbosity: Verbosity,
) -> Result<Option<Choice>, Error> {
    let Some(goal) = goal(args)? else {
        return Ok(None);
    };
    let progress = Progress::new(verbosity, 1);
    let choice = choose(scene, goal, isa, &|name| {
        progress.step(0, &format!("trying {name}"))
    })?;
    drop(progress);
    let expected = match choice.seconds {
        Some(seconds) => format!(
            "expected to take {:.1} ms, rmse {:.1e}",
            1e3 * seconds,
            choice.error
        ),
        None => format!("expected rmse {:.1e}", choice.error),
    };
    verbosity.say(format!(
        "picked of {} settings: {}; {expected}",
        choice.tried, choice.arguments
    ));
    Ok(Some(choice))
}

/// What the flags ask for.
fn goal(args: &RenderArgs) -> Result<Option<Goal>, Error> {
    if let Some(text) = &args.error {
        return parse_error(text).map(Some);
    }
    match args.time {
        None => Ok(None),
        Some(ms) if ms > 0.0 && ms <= LONGEST_MS => {
            Ok(Some(Goal::Time(Duration::from_secs_f64(ms / 1e3))))
        }
        Some(ms) => {
            let message = format!("{ms}: expected milliseconds, more than 0, at most {LONGEST_MS}");
            Err(Error::parameter("--time", message))
        }
    }
}

/// A number, or a fraction such as 1/255.
fn parse_error(text: &str) -> Result<Goal, Error> {
    let number = |s: &str| {
        s.trim()
            .parse::<f64>()
            .ok()
            .filter(|x| *x > 0.0 && x.is_finite())
    };
    let value = match text.split_once('/') {
        None => number(text),
        Some((a, b)) => number(a).zip(number(b)).map(|(a, b)| a / b),
    };
    value.map(Goal::Error).ok_or_else(|| {
        let message = format!("{text}: expected a number above 0, or a fraction");
        Error::parameter("--error", message).with_help("1/255 is a step of an 8-bit display")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_numbers_or_fractions() {
        assert_eq!(parse_error("1e-3").ok(), Some(Goal::Error(1e-3)));
        assert_eq!(parse_error("1/255").ok(), Some(Goal::Error(1.0 / 255.0)));
        for wrong in ["0", "-1", "inf", "nan", "1/0", "a", "", "1/"] {
            assert!(parse_error(wrong).is_err(), "{wrong}");
        }
    }
}
