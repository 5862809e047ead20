//! Forms of the power (n.h)^s: how far each is off on the exponents of a scene.
//!
//! The equation has one form, exp(s ln cos) with the logarithm taken from the sine near the peak; it stays the only one that
//! lights anything. What it saves or costs against the usual stand-ins is measured where they would stand: the equation is
//! asked for the highlight at 20,001 angles, and so is each stand-in, given the cosine in f32 as a renderer would have it. The
//! error is the largest over all angles, against f64 with the exact cosine; times the light's specular product it is the
//! error of a pixel in the highlight.

use serde::Serialize;

use crate::gl::{LightModel, LightSource, Material, SpecularModel};
use crate::lanes::Isa;
use crate::lighting::{Points, Rig, Sink, shade};
use crate::scene::Scene;

/// Angles from the peak to the horizon.
const ANGLES: u32 = 20_000;

/// A form of the power.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// The equation's.
    Equation,
    /// `powf` of the cosine.
    Direct,
    /// Repeated squaring; whole exponents only.
    Squaring,
    /// A table of this many entries over the cosine, with linear interpolation.
    Table(usize),
    /// c / (n - n c + c) (Schlick, "A Fast Alternative to Phong's Specular Model", Graphics Gems IV, 1994).
    Schlick,
}

impl Form {
    /// Those that are compared.
    pub const ALL: [Self; 6] = [
        Self::Equation,
        Self::Direct,
        Self::Squaring,
        Self::Table(4096),
        Self::Table(256),
        Self::Schlick,
    ];

    /// What to call it.
    pub fn name(self) -> String {
        match self {
            Self::Equation => {
                "the equation's: exp(n ln cos), ln from the sine near the peak".to_owned()
            }
            Self::Direct => "powf of the cosine".to_owned(),
            Self::Squaring => "repeated squaring".to_owned(),
            Self::Table(n) => format!("table of {n}, interpolated"),
            Self::Schlick => "Schlick's fraction".to_owned(),
        }
    }

    /// The form on f32 cosines; `None` where it has no value for this exponent, and for the equation, which is asked itself.
    fn of_cosines(self, cosines: &[f64], exponent: f64) -> Option<Vec<f64>> {
        let n = exponent as f32;
        let single = cosines.iter().map(|c| *c as f32);
        let values: Vec<f32> = match self {
            Self::Equation => return None,
            Self::Direct => single.map(|c| libm::powf(c, n)).collect(),
            Self::Squaring => {
                let whole = (exponent.fract() == 0.0 && (1.0..=1e6).contains(&exponent))
                    .then_some(exponent as u32)?;
                single.map(|c| squared(c, whole)).collect()
            }
            Self::Table(entries) => {
                let table = table(entries, exponent);
                single.map(|c| look_up(&table, c)).collect()
            }
            Self::Schlick => single.map(|c| c / (n - n * c + c)).collect(),
        };
        Some(values.into_iter().map(f64::from).collect())
    }
}

/// x^n by squaring.
fn squared(mut x: f32, mut n: u32) -> f32 {
    let mut product = 1.0;
    while n > 0 {
        if n & 1 == 1 {
            product *= x;
        }
        x *= x;
        n >>= 1;
    }
    product
}

/// Powers of 0 to 1 in equal steps.
fn table(entries: usize, exponent: f64) -> Vec<f32> {
    let step = 1.0 / (entries - 1) as f64;
    (0..entries)
        .map(|i| libm::pow(i as f64 * step, exponent) as f32)
        .collect()
}

fn look_up(table: &[f32], c: f32) -> f32 {
    let place = c * (table.len() - 1) as f32;
    let i = (place as usize).min(table.len() - 2);
    let part = place - i as f32;
    table[i] + part * (table[i + 1] - table[i])
}

/// How far a form is off.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PowerError {
    /// [`Form::name`].
    pub form: String,
    /// For each exponent the largest error; `None` where the form has no value.
    pub errors: Vec<Option<f64>>,
}

/// Exponents of a scene: shininess of used materials with a specular colour, rising, without 0 and 1, which need no power.
pub fn exponents(scene: &Scene) -> Vec<f64> {
    let used = scene.objects.iter().flat_map(|o| &o.materials);
    let materials = used.map(|m| &scene.materials[*m].front);
    let shiny = materials.filter(|m| m.specular.iter().any(|x| *x != 0.0));
    let mut all: Vec<f64> = shiny
        .map(|m| m.shininess)
        .filter(|n| *n != 0.0 && *n != 1.0)
        .collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

/// The largest error of each form at each exponent.
pub fn errors(exponents: &[f64], model: SpecularModel, isa: Isa) -> Vec<PowerError> {
    let angles: Vec<f64> = (0..=ANGLES)
        .map(|i| std::f64::consts::FRAC_PI_2 * f64::from(i) / f64::from(ANGLES))
        .collect();
    let cosines: Vec<f64> = angles.iter().map(|a| libm::cos(*a)).collect();
    let worst = |form: Form, exponent: f64| {
        let values = match form {
            Form::Equation => highlight(&angles, exponent, model, isa),
            form => form.of_cosines(&cosines, exponent)?,
        };
        let exact = cosines.iter().map(|c| libm::pow(*c, exponent));
        Some(
            values
                .iter()
                .zip(exact)
                .map(|(v, e)| (v - e).abs())
                .fold(0.0, f64::max),
        )
    };
    Form::ALL
        .into_iter()
        .map(|form| PowerError {
            form: form.name(),
            errors: exponents.iter().map(|n| worst(form, *n)).collect(),
        })
        .collect()
}

/// The equation's highlight in f32 where n.h (or V.R) is the cosine of each angle: viewer and light together along z, the
/// normal turned away from them by the angle (by half of it for V.R).
fn highlight(angles: &[f64], exponent: f64, model: SpecularModel, isa: Isa) -> Vec<f64> {
    let light = LightSource {
        position: [0.0, 0.0, 1.0, 0.0],
        specular: [1.0; 3],
        ..LightSource::default()
    };
    let model_of_light = LightModel {
        ambient: [0.0; 3],
        specular_model: model,
        ..LightModel::default()
    };
    let material = Material {
        ambient: [0.0; 3],
        diffuse: [0.0; 3],
        specular: [1.0; 3],
        shininess: exponent,
        ..Material::default()
    };
    let share = if model == SpecularModel::HalfVector {
        1.0
    } else {
        0.5
    };
    let mut points = Points::<f32>::default();
    for angle in angles {
        // At the horizon itself the gate n.l > 0 would close.
        let turn = (share * angle).min(std::f64::consts::FRAC_PI_2 - 1e-6);
        let normal = [libm::sin(turn) as f32, 0.0, libm::cos(turn) as f32];
        points.push([0.0; 3], normal, [0.0, 0.0, 1.0]);
    }
    let rig = Rig::new(&[light], &model_of_light);
    let mut sum: [Vec<f32>; 3] = Default::default();
    let sink = Sink::Sum(&mut sum);
    shade(isa, &rig, &material, &points, None, false, sink);
    sum[0].iter().map(|x| f64::from(*x)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the numerics guide's own measurement (`trade.json`, pow_n8, pow_n128, pow_n1000).
    #[test]
    fn forms_are_off_by_what_the_guide_measured() {
        let found = errors(
            &[8.0, 128.0, 1000.0],
            SpecularModel::HalfVector,
            Isa::detect(),
        );
        let of = |form: Form| {
            let name = form.name();
            let row = found.iter().find(|e| e.form == name).expect("compared");
            [0, 1, 2].map(|i| row.errors[i].expect("whole exponents"))
        };
        let near = |form, expected: [f64; 3], within: f64| {
            for (f, e) in of(form).into_iter().zip(expected) {
                assert!((f / e).ln().abs() < within, "{form:?}: {f}, not {e}");
            }
        };
        near(Form::Direct, [2.67e-7, 3.68e-6, 2.69e-5], 0.35);
        near(Form::Squaring, [3.96e-7, 5.72e-6, 3.54e-5], 0.35);
        near(Form::Table(256), [1.06e-4, 0.0246, 0.404], 0.15);
        near(Form::Schlick, [0.173, 0.202, 0.203], 0.02);
        let [_, fine, finest] = of(Form::Table(4096));
        assert!((fine / 1.19e-4 - 1.0).abs() < 0.15 && (finest / 6.6e-3 - 1.0).abs() < 0.15);
        // The equation's own form beats powf of the cosine from 128 on, by more the sharper the highlight.
        let (own, direct) = (of(Form::Equation), of(Form::Direct));
        assert!(own[1] < direct[1] && own[2] < direct[2] / 4.0, "{own:?}");
        let reflection = errors(&[128.0], SpecularModel::Reflection, Isa::detect());
        assert!(reflection[0].errors[0].expect("a value") < 4.0 * own[1]);
    }

    #[test]
    fn squaring_needs_whole_exponents() {
        let rows = errors(&[2.5], SpecularModel::HalfVector, Isa::Scalar);
        assert_eq!(rows[2].errors, [None]);
        assert!(rows[1].errors[0].is_some());
    }
}
