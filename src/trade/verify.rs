//! Whether what a trade promised holds at other places: the same setting against the truth at samples that had no part in
//! the choice.
//!
//! A promise was made at pixel centres. It is checked at two jittered places a pixel, of two seeds: twice the samples, none of
//! them at a centre. For samples, the ideal picture is drawn again with another seed and twice as many.

use super::accuracy::Accuracy;
use super::draw::Ready;
use super::measure::judge;
use super::setting::Setting;
use super::truth::Truth;
use crate::error::Error;
use crate::lanes::Isa;
use crate::sampling::Pattern;
use crate::scene::Scene;

/// The error of a setting at jittered places of a seed, as many a pixel as it has samples, against the truth there.
///
/// # Errors
/// What the renderers refuse.
pub fn elsewhere(scene: &Scene, setting: &Setting, seed: u32, isa: Isa) -> Result<Accuracy, Error> {
    let mut scene = scene.clone();
    (scene.image.samples, scene.image.pattern) = (setting.samples, Pattern::Jitter);
    scene.image.seed = seed;
    let truth = Truth::Own.draw(&scene, isa)?;
    let moved = Setting {
        pattern: Pattern::Jitter,
        ..*setting
    };
    judge(&Ready::new(&scene, &moved, isa).draw()?, &truth)
}

/// Rmse at silhouettes of a setting of several samples against an ideal picture of another seed and `samples` samples.
///
/// # Errors
/// What the renderers refuse.
pub fn edges(
    scene: &Scene,
    setting: &Setting,
    samples: u32,
    seed: u32,
    isa: Isa,
) -> Result<f64, Error> {
    let drawn = Ready::new(scene, setting, isa).draw()?;
    let mut other = scene.clone();
    other.image.seed = seed;
    let truth = Truth::Ideal(samples).draw(&other, isa)?;
    Ok(judge(&drawn, &truth)?.silhouette.rmse)
}
