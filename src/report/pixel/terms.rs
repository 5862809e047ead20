//! The terms of one point as rows: emission, ambient, then each light with what makes its terms.

use super::sheet::{FAINT, MARK, NAME, STRONG, Sheet, styled};
use super::{short, triple, vector};
use crate::explain::{Coefficients, Explanation, Factors, Light, LightTerms, Terms};
use crate::math::color::Rgb;

/// Columns of a label.
pub(super) const LABEL: usize = 16;

/// Writes the terms of a point.
pub(super) fn rows(sheet: &mut Sheet, all: &Explanation, terms: &Terms, background: bool) {
    let emission = if background { "the background" } else { "I_E" };
    sheet.row((LABEL, &term("emission", 2)), terms.emission, emission);
    if background {
        return;
    }
    let ambient = terms.material.map_or(String::new(), |m| {
        let (k, i) = (triple(m.ambient), triple(all.scene_ambient));
        format!("K_A {k} × I_AL {i}")
    });
    sheet.row((LABEL, &term("ambient", 2)), terms.ambient, &ambient);
    for (light, source) in terms.lights.iter().zip(&all.lights) {
        one_light(sheet, light, source, terms.material.as_ref());
    }
    // Rounding that these numbers do not show stays unsaid.
    let visible = |rest: &Rgb| rest.iter().any(|x| x.abs() >= 5e-5);
    if let Some(rest) = terms.remainder.filter(visible) {
        sheet.row((LABEL, &term("remainder", 2)), rest, "what rounding leaves");
    }
}

fn term(name: &str, indent: usize) -> String {
    format!("{:indent$}{name}", "")
}

/// A light's line and its terms.
fn one_light(sheet: &mut Sheet, light: &LightTerms, source: &Light, k: Option<&Coefficients>) {
    let name = styled(NAME, &light.name);
    let (Some(factors), Some(k)) = (&light.factors, k) else {
        sheet.sentence(2, 2, &format!("light {name}"));
        plain_rows(sheet, light);
        return;
    };
    let arrives = if factors.distance.is_finite() {
        format!("{} away", short(factors.distance))
    } else {
        "a directional light".to_owned()
    };
    let line = format!(
        "light {name}: L {}, {arrives}; {}",
        vector(factors.to_light),
        facing(factors)
    );
    sheet.sentence(2, 2, &line);
    let scale = scale(factors);
    if light.ambient != [0.0; 3] {
        let working = format!(
            "K_A {} × I_L {}{scale}",
            triple(k.ambient),
            triple(source.ambient)
        );
        sheet.row((LABEL, &term("ambient", 4)), light.ambient, &working);
    }
    sheet.row(
        (LABEL, &term("diffuse", 4)),
        light.diffuse,
        &diffuse(factors, source, k, &scale),
    );
    let working = specular(factors, source, k, &scale);
    sheet.row((LABEL, &term("specular", 4)), light.specular, &working);
}

/// Terms that are interpolated: the vertices say how they came about.
fn plain_rows(sheet: &mut Sheet, light: &LightTerms) {
    if light.ambient != [0.0; 3] {
        sheet.row((LABEL, &term("ambient", 4)), light.ambient, "");
    }
    sheet.row((LABEL, &term("diffuse", 4)), light.diffuse, "");
    sheet.row((LABEL, &term("specular", 4)), light.specular, "");
}

/// Does the light face the point, and does it get there?
fn facing(factors: &Factors) -> String {
    if factors.n_dot_l <= 0.0 {
        return format!(
            "N·L {} ≤ 0, it shines on the other side",
            short(factors.n_dot_l)
        );
    }
    if factors.spot == 0.0 {
        return styled(MARK, "outside its cone");
    }
    match (factors.shadow, &factors.blocker) {
        (_, Some(blocker)) => {
            format!(
                "{} {}",
                styled(MARK, "S_L 0, blocked by"),
                styled(NAME, blocker)
            )
        }
        (Some(s), None) if !factors.filters.is_empty() => {
            let names = factors.filters.join(", ");
            format!("S_L {}, filtered by {}", triple(s), styled(NAME, names))
        }
        (Some(s), None) => format!("S_L {}", triple(s)),
        (None, None) => "nothing here answers it, so no shadow ray is cast".to_owned(),
    }
}

/// What scales I_L, where it is not 1.
fn scale(factors: &Factors) -> String {
    let mut text = String::new();
    if factors.attenuation != 1.0 {
        text += &format!(" × attenuation {}", short(factors.attenuation));
    }
    if factors.spot != 1.0 {
        text += &format!(" × spot {}", short(factors.spot));
    }
    text
}

/// S_L, where it has a say.
fn shadow(factors: &Factors) -> String {
    factors
        .shadow
        .map_or(String::new(), |s| format!(" × S_L {}", triple(s)))
}

fn diffuse(factors: &Factors, source: &Light, k: &Coefficients, scale: &str) -> String {
    if factors.n_dot_l <= 0.0 {
        return String::new();
    }
    format!(
        "K_D {} × N·L {}{} × I_L {}{scale}",
        triple(k.diffuse),
        short(factors.n_dot_l),
        shadow(factors),
        triple(source.diffuse)
    )
}

fn specular(factors: &Factors, source: &Light, k: &Coefficients, scale: &str) -> String {
    if k.specular == [0.0; 3] {
        return "K_S 0".to_owned();
    }
    if factors.n_dot_l <= 0.0 {
        return "no highlight on an unlit side".to_owned();
    }
    let (name, cosine) = match (factors.n_dot_h, factors.v_dot_r) {
        (Some(h), _) => ("N·H", h),
        (None, r) => ("V·R", r.unwrap_or(0.0)),
    };
    let power = cosine.max(0.0).powf(k.shininess);
    format!(
        "K_S {} × ({name})^n {}^{} = {}{} × I_L {}{scale}",
        triple(k.specular),
        short(cosine.max(0.0)),
        short(k.shininess),
        short(power),
        shadow(factors),
        triple(source.specular)
    )
}

/// A sum, set apart.
pub(super) fn total(sheet: &mut Sheet, name: &str, color: Rgb, working: &str) {
    let rule = "─".repeat(LABEL + 25);
    sheet.line(&format!("  {}", styled(FAINT, rule)));
    let label = format!("  {}", styled(STRONG, name));
    sheet.row((LABEL, &label), color, working);
}
