//! The top of the page: title, result, the equation, and what each of its symbols means.

use maud::{Markup, html};

use super::Report;
use super::parts::piece;
use super::sections;
use crate::gl::SpecularModel;
use crate::report::equation::{Factor, Form, Piece, Term, pieces, plain, runs};
use crate::report::prose;

/// Title, and the result in a sentence or two.
pub(super) fn title(report: &Report) -> Markup {
    let [w, h] = report.summary.size;
    html! {
        p.kicker { "rastray compare · " (w) " × " (h) " pixels" }
        h1 { (report.title) }
        p.lead { (sections::verdict(report)) }
    }
}

/// The equation; its parts carry the letter by which the script lights them.
pub(super) fn equation(form: Form) -> Markup {
    let whole = pieces(form, Term::Refraction);
    html! {
        section.equation #equation aria-label="The equation" {
            p.formula role="math" aria-label=(plain(&whole)) {
                @for (key, run) in runs(&whole, false, key) {
                    @match key {
                        Some((letter, global)) => {
                            span.term.global[global].local[!global] data-term=(letter) { @for p in run { (piece(p)) } }
                        },
                        None => @for p in run { (piece(p)) },
                    }
                }
            }
            p.key {
                span.local { "local" } " a surface and its lights: the rasterizer, exactly · "
                span.global { "global" } " other surfaces too: only the tracer"
                span.lit #lit {}
            }
        }
    }
}

/// Which switch lights a piece: E, A, D, S, s (shadows), R, T; L: light at all, diffuse or specular.
fn key(p: &Piece) -> Option<(char, bool)> {
    let term = p.term?;
    let letter = match (term, p.factor) {
        (_, Some(Factor::Sum | Factor::Light)) => 'L',
        (Term::Emission, _) => 'E',
        (Term::Ambient, _) => 'A',
        (Term::Diffuse, _) => 'D',
        (Term::Specular, _) => 'S',
        (Term::Shadow, _) => 's',
        (Term::Reflection, _) => 'R',
        (Term::Refraction, _) => 'T',
    };
    Some((letter, term.is_global()))
}

/// Every symbol once, for somebody who sees the equation for the first time.
pub(super) fn symbols(form: Form) -> Markup {
    let entries = entries(form);
    html! {
        details.symbols open[true] {
            summary { "What the symbols mean" }
            dl {
                @for (symbol, meaning) in entries {
                    div { dt { (prose::html(symbol)) } dd { (prose::html(meaning)) } }
                }
            }
        }
    }
}

/// Symbols and their meanings, in the order of the equation.
fn entries(form: Form) -> Vec<(&'static str, &'static str)> {
    let specular: [(&str, &str); 2] = match form.specular {
        SpecularModel::HalfVector => [
            (
                "N.H",
                "cosine of the angle between the normal and H, halfway from the light to the viewer",
            ),
            ("n", "shininess: the larger, the smaller the highlight"),
        ],
        SpecularModel::Reflection => [
            (
                "V.R",
                "cosine of the angle between the viewer's direction V and R, the light's mirror direction",
            ),
            ("n", "shininess: the larger, the smaller the highlight"),
        ],
    };
    let mut list = vec![
        (
            "I",
            "the colour that the pixel gets: red, green, blue; 1 is full intensity",
        ),
        (
            "I_E",
            "emission: light that the surface gives off by itself",
        ),
        ("K_A", "how much ambient light the surface returns"),
        (
            "I_AL",
            "ambient light: a constant stand-in for light from everywhere",
        ),
        ("Σ", "sum over all lights, each called L"),
        ("K_D", "diffuse colour of the surface"),
        (
            "N.L",
            "cosine of the angle between the surface's normal N and the direction to the light; 0 where it faces away",
        ),
        ("K_S", "specular colour of the surface: its highlight"),
    ];
    list.extend(specular);
    list.extend([
        (
            "S_L",
            "shadow: 1 where the light arrives, 0 where something stands between",
        ),
        (
            "I_L",
            "the light's colour, after distance and spotlight cone have weakened it",
        ),
    ]);
    if !form.mirror_is_specular {
        list.push(("K_R", "how strongly the surface mirrors"));
    }
    list.extend([
        (
            "I_R",
            "what arrives from the mirror direction: this equation again, where that ray ends",
        ),
        ("K_T", "how much light the surface lets through"),
        (
            "I_T",
            "what arrives through the surface along the bent ray: this equation once more",
        ),
    ]);
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_symbol_of_the_equation_is_defined_once() {
        for (specular, mirror_is_specular) in [
            (SpecularModel::HalfVector, false),
            (SpecularModel::Reflection, true),
        ] {
            let form = Form {
                specular,
                mirror_is_specular,
            };
            let entries = entries(form);
            let written = plain(&pieces(form, Term::Refraction));
            for symbol in [
                "I_E", "K_A", "I_AL", "Σ", "K_D", "K_S", "n", "S_L", "I_L", "I_R", "K_T", "I_T",
            ] {
                let times = entries.iter().filter(|(s, _)| *s == symbol).count();
                assert_eq!(times, 1, "{symbol}");
                assert!(written.contains(symbol));
            }
            let mirror = entries.iter().any(|(s, _)| *s == "K_R");
            assert_eq!(mirror, written.contains("K_R"));
        }
    }

    #[test]
    fn every_term_can_be_lit() {
        let form = Form {
            specular: SpecularModel::HalfVector,
            mirror_is_specular: false,
        };
        let html = equation(form).into_string();
        for letter in ["E", "A", "D", "S", "L", "s", "R", "T"] {
            assert!(
                html.contains(&format!("data-term=\"{letter}\"")),
                "{letter}: {html}"
            );
        }
    }
}
