//! A setting measured: its errors against the truths that judge it, and its counts. Truths are drawn when first asked for.

use serde::{Deserialize, Serialize};

use super::accuracy::Accuracy;
use super::cost::Counts;
use super::draw::{Ready, Shot};
use super::setting::Setting;
use super::truth::{Reference, Truth};
use crate::decompose::silhouette;
use crate::error::Error;
use crate::lanes::Isa;
use crate::scene::Scene;

/// Errors and counts of a setting: exact, the same on every machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// [`key`] of the setting.
    pub setting: String,
    /// Truth ([`Truth::name`]) and error against it.
    pub errors: Vec<(String, Accuracy)>,
    /// What it took.
    pub counts: Counts,
}

impl Measured {
    /// The error against a truth, if it was measured.
    pub fn against(&self, truth: Truth) -> Option<&Accuracy> {
        let name = truth.name();
        let found = self.errors.iter().find(|(known, _)| *known == name);
        found.map(|(_, accuracy)| accuracy)
    }
}

/// What tells settings apart in a journal: every field.
pub fn key(setting: &Setting) -> String {
    format!("{setting:?}")
}

/// A scene with the truths that were drawn of it.
pub struct Judge<'a> {
    scene: &'a Scene,
    isa: Isa,
    truths: Vec<(Truth, Reference)>,
}

impl<'a> Judge<'a> {
    /// Of a scene at the size that is measured.
    pub fn new(scene: &'a Scene, isa: Isa) -> Self {
        Self {
            scene,
            isa,
            truths: Vec::new(),
        }
    }

    /// Whether a truth has been drawn.
    pub fn has(&self, truth: Truth) -> bool {
        self.truths.iter().any(|(known, _)| *known == truth)
    }

    /// A truth, drawn if it was not yet.
    ///
    /// # Errors
    /// What the renderers refuse.
    pub fn truth(&mut self, truth: Truth) -> Result<&Reference, Error> {
        let found = self.truths.iter().position(|(known, _)| *known == truth);
        let index = match found {
            Some(index) => index,
            None => {
                let reference = truth.draw(self.scene, self.isa)?;
                self.truths.push((truth, reference));
                self.truths.len() - 1
            }
        };
        Ok(&self.truths[index].1)
    }

    /// Draws a setting and judges it by some truths.
    ///
    /// # Errors
    /// What the renderers refuse.
    pub fn measure(&mut self, setting: &Setting, truths: &[Truth]) -> Result<Measured, Error> {
        let drawn = Ready::new(self.scene, setting, self.isa).draw()?;
        let mut errors = Vec::new();
        for truth in truths {
            let accuracy = judge(&drawn, self.truth(*truth)?)?;
            errors.push((truth.name(), accuracy));
        }
        Ok(Measured {
            setting: key(setting),
            errors,
            counts: drawn.counts,
        })
    }
}

/// A picture's error against a truth.
///
/// # Errors
/// [`Error::Limit`] where the pictures cannot be compared.
pub fn judge(drawn: &Shot, truth: &Reference) -> Result<Accuracy, Error> {
    let mask = silhouette(&drawn.object, &truth.object);
    Accuracy::of(&drawn.color, &truth.color, &mask, &truth.curved)
}
