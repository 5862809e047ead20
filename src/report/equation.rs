//! The lighting equation as pieces of text, for the figures and the page alike.
//!
//! `I = I_E + K_A I_AL + SUM_L (K_D (N.L) + K_S (V.R)^n) S_L I_L + K_S I_R + K_T I_T`, whole or as far as a term.
//! The rasterizer computes the terms up to specular; S_L, I_R and I_T exist only in the tracer.

use crate::gl::SpecularModel;
use crate::scene::Scene;

/// The terms in the order in which the picture grows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Term {
    /// What the surface emits.
    Emission,
    /// Scene ambient, and the ambient of each light.
    Ambient,
    /// Diffuse of each light.
    Diffuse,
    /// Specular of each light.
    Specular,
    /// S_L: whether the light reaches the point.
    Shadow,
    /// What arrives from the mirror direction.
    Reflection,
    /// What arrives through the surface.
    Refraction,
}

impl Term {
    /// All, in order.
    pub const ALL: [Self; 7] = [
        Self::Emission,
        Self::Ambient,
        Self::Diffuse,
        Self::Specular,
        Self::Shadow,
        Self::Reflection,
        Self::Refraction,
    ];

    /// The house's word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Emission => "emission",
            Self::Ambient => "ambient",
            Self::Diffuse => "diffuse",
            Self::Specular => "specular",
            Self::Shadow => "shadow",
            Self::Reflection => "reflection",
            Self::Refraction => "refraction",
        }
    }

    /// How the term joins what stands before it, as plain text: "E", "+ A", ..., "× S_L".
    pub fn label(self) -> &'static str {
        match self {
            Self::Emission => "E",
            Self::Ambient => "+ A",
            Self::Diffuse => "+ D",
            Self::Specular => "+ S",
            Self::Shadow => "× S_L",
            Self::Reflection => "+ I_R",
            Self::Refraction => "+ I_T",
        }
    }

    /// The term of a name, which is also the name of its cause.
    pub fn of_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|t| t.name() == name)
    }

    /// Only a renderer that knows the whole scene can compute it.
    pub fn is_global(self) -> bool {
        self >= Self::Shadow
    }
}

/// How the scene's model writes the equation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Form {
    /// Half-vector (N.H) or reflection (V.R).
    pub specular: SpecularModel,
    /// The mirror weight is K_S, as in the lecture; otherwise the material's own weight, written K_R.
    pub mirror_is_specular: bool,
}

impl Form {
    /// How a scene writes the equation: its specular form, and whether every mirror weight is K_S.
    pub fn of(scene: &Scene) -> Self {
        let mut mirrors = scene.materials.iter().filter(|m| m.optics.is_mirror());
        Self {
            specular: scene.light_model.specular_model,
            mirror_is_specular: mirrors.all(|m| m.optics.reflection == m.front.specular),
        }
    }
}

/// A part of the sum over the lights, or of what a light is, that can be spoken of by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Factor {
    /// Σ_L, its brackets and the plus between them.
    Sum,
    /// L of N·L.
    ToLight,
    /// The exponent n.
    Exponent,
    /// I_L.
    Light,
    /// L of a light source with a position.
    Position,
    /// L of a light source with a direction only.
    Direction,
    /// 1 / (c + l d + q d^2).
    Attenuation,
    /// Where a spot light shines at all.
    SpotCutoff,
    /// The power of the cosine to the spot's axis.
    SpotExponent,
}

/// Where a piece stands relative to the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Script {
    /// On the line.
    Base,
    /// Lowered, small.
    Sub,
    /// Raised, small.
    Sup,
}

/// A piece of the equation in one style.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Piece {
    /// The characters.
    pub text: &'static str,
    /// On the line, lowered or raised.
    pub script: Script,
    /// A variable, set in italics.
    pub variable: bool,
    /// The term that it came with; none for `I =`.
    pub term: Option<Term>,
    /// The part that it belongs to, where that can be spoken of by itself.
    pub factor: Option<Factor>,
    /// A line may break before it.
    pub breaks: bool,
}

/// The equation as it stands once `last` has been added.
pub fn pieces(form: Form, last: Term) -> Vec<Piece> {
    let mut list = List::new(last);
    list.variable(None, "I");
    list.plain(None, " = ");
    let e = Term::Emission;
    list.symbol(e, "I", "E");
    let a = Term::Ambient;
    list.join(a);
    list.symbol(a, "K", "A");
    list.plain(Some(a), " ");
    list.symbol(a, "I", "AL");
    direct(&mut list, form.specular);
    for (term, weight, arrives) in [
        (
            Term::Reflection,
            if form.mirror_is_specular { "S" } else { "R" },
            "R",
        ),
        (Term::Refraction, "T", "T"),
    ] {
        list.join(term);
        list.symbol(term, "K", weight);
        list.plain(Some(term), " ");
        list.symbol(term, "I", arrives);
    }
    list.pieces
}

/// The sum over the lights.
fn direct(list: &mut List, specular: SpecularModel) {
    let (d, s, shadow) = (Term::Diffuse, Term::Specular, Term::Shadow);
    list.join(d);
    list.factor = Some(Factor::Sum);
    list.push(Some(d), "Σ", Script::Base, false);
    list.push(Some(d), "L", Script::Sub, true);
    list.plain(Some(d), " ");
    list.plain(Some(s), "(");
    list.factor = None;
    list.symbol(d, "K", "D");
    list.plain(Some(d), " (");
    list.variable(Some(d), "N");
    list.plain(Some(d), "·");
    list.factor = Some(Factor::ToLight);
    list.variable(Some(d), "L");
    list.factor = None;
    list.plain(Some(d), ")");
    list.factor = Some(Factor::Sum);
    list.plain(Some(s), " ");
    list.plain(Some(s), "+ ");
    list.factor = None;
    list.symbol(s, "K", "S");
    list.plain(Some(s), " (");
    let (left, right) = match specular {
        SpecularModel::HalfVector => ("N", "H"),
        SpecularModel::Reflection => ("V", "R"),
    };
    list.variable(Some(s), left);
    list.plain(Some(s), "·");
    list.variable(Some(s), right);
    list.plain(Some(s), ")");
    list.factor = Some(Factor::Exponent);
    list.push(Some(s), "n", Script::Sup, true);
    list.factor = Some(Factor::Sum);
    list.plain(Some(s), ")");
    list.factor = None;
    list.plain(Some(shadow), " ");
    list.symbol(shadow, "S", "L");
    list.plain(Some(d), " ");
    list.factor = Some(Factor::Light);
    list.symbol(d, "I", "L");
    list.factor = None;
}

/// What L and I_L are, in two lines: what the light sources of OpenGL and of the lecture have in common.
///
/// P is the point, P_L the light's place, d their distance, D the direction in which a directional light travels, S a
/// spot's axis, e its exponent and γ its cutoff.
pub fn light_lines() -> [Vec<Piece>; 2] {
    let mut to_light = List::new(Term::Refraction);
    let list = &mut to_light;
    list.variable(None, "L");
    list.plain(None, " = ");
    list.factor = Some(Factor::Position);
    list.plain(None, "(");
    list.variable(None, "P");
    list.push(None, "L", Script::Sub, true);
    list.plain(None, " − ");
    list.variable(None, "P");
    list.plain(None, ") / ");
    list.variable(None, "d");
    list.factor = None;
    list.plain(None, "  or  ");
    list.factor = Some(Factor::Direction);
    list.plain(None, "−");
    list.variable(None, "D");
    let mut light = List::new(Term::Refraction);
    let list = &mut light;
    list.variable(None, "I");
    list.push(None, "L", Script::Sub, true);
    list.plain(None, " = ");
    list.variable(None, "I");
    list.push(None, "0", Script::Sub, false);
    list.plain(None, " ");
    list.factor = Some(Factor::SpotExponent);
    list.plain(None, "(−");
    list.variable(None, "S");
    list.plain(None, "·");
    list.variable(None, "L");
    list.plain(None, ")");
    list.push(None, "e", Script::Sup, true);
    list.factor = None;
    list.plain(None, " ");
    attenuation(list);
    list.plain(None, "  ");
    list.factor = Some(Factor::SpotCutoff);
    list.plain(None, "where ");
    list.plain(None, "−");
    list.variable(None, "S");
    list.plain(None, "·");
    list.variable(None, "L");
    list.plain(None, " ≥ cos ");
    list.variable(None, "γ");
    list.plain(None, ", else 0");
    [to_light.pieces, light.pieces]
}

/// / (c + l d + q d^2).
fn attenuation(list: &mut List) {
    list.factor = Some(Factor::Attenuation);
    list.plain(None, "/ (");
    list.variable(None, "c");
    list.plain(None, " + ");
    list.variable(None, "l d");
    list.plain(None, " + ");
    list.variable(None, "q d");
    list.push(None, "2", Script::Sup, false);
    list.plain(None, ")");
    list.factor = None;
}

/// The pieces so far; pieces of later terms are dropped.
struct List {
    pieces: Vec<Piece>,
    last: Term,
    /// What the next pieces belong to.
    factor: Option<Factor>,
}

impl List {
    fn new(last: Term) -> Self {
        Self {
            pieces: Vec::new(),
            last,
            factor: None,
        }
    }

    fn push(&mut self, term: Option<Term>, text: &'static str, script: Script, variable: bool) {
        if term.is_none_or(|t| t <= self.last) {
            self.pieces.push(Piece {
                text,
                script,
                variable,
                term,
                factor: self.factor,
                breaks: false,
            });
        }
    }

    fn plain(&mut self, term: Option<Term>, text: &'static str) {
        self.push(term, text, Script::Base, false);
    }

    fn variable(&mut self, term: Option<Term>, text: &'static str) {
        self.push(term, text, Script::Base, true);
    }

    /// A variable with its subscript.
    fn symbol(&mut self, term: Term, letter: &'static str, subscript: &'static str) {
        self.variable(Some(term), letter);
        self.push(Some(term), subscript, Script::Sub, true);
    }

    /// A plus on the outermost level; a line may break at the space before it.
    fn join(&mut self, term: Term) {
        let before = self.pieces.len();
        self.plain(Some(term), " ");
        if let Some(piece) = self.pieces.get_mut(before) {
            piece.breaks = true;
        }
        self.plain(Some(term), "+ ");
    }
}

/// The pieces in runs of one key. A space takes the key of its neighbours where they agree, and none otherwise, so that
/// runs begin and end at ink; the signs between the summands have none unless `signs` are asked for.
pub fn runs<K: PartialEq + Copy>(
    pieces: &[Piece],
    signs: bool,
    key: impl Fn(&Piece) -> Option<K>,
) -> Vec<(Option<K>, &[Piece])> {
    let own = |i: usize| -> Option<K> {
        let sign = i > 0 && pieces[i - 1].breaks;
        key(&pieces[i]).filter(|_| signs || !sign)
    };
    let blank = |i: usize| pieces.get(i).is_none_or(|p| p.text.trim().is_empty());
    let of = |i: usize| match blank(i) {
        false => own(i),
        true if i == 0 || i + 1 >= pieces.len() || blank(i - 1) || blank(i + 1) => None,
        true => own(i - 1).filter(|k| own(i + 1) == Some(*k)),
    };
    let keys: Vec<Option<K>> = (0..pieces.len()).map(of).collect();
    let mut start = 0;
    let run = |same: &[Option<K>]| {
        let range = start..start + same.len();
        start = range.end;
        (same[0], &pieces[range])
    };
    keys.chunk_by(|a, b| a == b).map(run).collect()
}

/// The equation in plain characters, subscripts after an underscore: for alternative texts.
pub fn plain(pieces: &[Piece]) -> String {
    let write = |p: &Piece| match p.script {
        Script::Base => p.text.to_owned(),
        Script::Sub => format!("_{}", p.text),
        Script::Sup => format!("^{}", p.text),
    };
    pieces.iter().map(write).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const LECTURE: Form = Form {
        specular: SpecularModel::Reflection,
        mirror_is_specular: true,
    };

    #[test]
    fn the_whole_equation_is_the_lectures() {
        assert_eq!(
            plain(&pieces(LECTURE, Term::Refraction)),
            "I = I_E + K_A I_AL + Σ_L (K_D (N·L) + K_S (V·R)^n) S_L I_L + K_S I_R + K_T I_T"
        );
        let gl = Form {
            specular: SpecularModel::HalfVector,
            mirror_is_specular: false,
        };
        assert!(plain(&pieces(gl, Term::Refraction)).contains("K_S (N·H)^n) S_L I_L + K_R I_R"));
    }

    #[test]
    fn runs_begin_and_end_at_ink() {
        let whole = pieces(LECTURE, Term::Refraction);
        let text = |run: &[Piece]| run.iter().map(|p| p.text).collect::<String>();
        let global: Vec<String> = runs(&whole, false, |p| p.term.map(Term::is_global))
            .iter()
            .map(|(key, run)| {
                format!(
                    "{}{}",
                    key.map_or(' ', |g| if g { 'g' } else { 'l' }),
                    text(run)
                )
            })
            .collect();
        assert_eq!(
            global,
            [
                " I = ",
                "lIE",
                "  + ",
                "lKA IAL",
                "  + ",
                "lΣL (KD (N·L) + KS (V·R)n)",
                "  ",
                "gSL",
                "  ",
                "lIL",
                "  + ",
                "gKS IR",
                "  + ",
                "gKT IT"
            ]
        );
        let last = runs(&whole, true, |p| {
            (p.term == Some(Term::Refraction)).then_some(())
        });
        assert_eq!(
            last.last().map(|(_, run)| text(run)).as_deref(),
            Some("+ KT IT")
        );
    }

    #[test]
    fn it_grows_term_by_term() {
        let steps: Vec<String> = Term::ALL.map(|t| plain(&pieces(LECTURE, t))).into();
        assert_eq!(steps[0], "I = I_E");
        assert_eq!(steps[1], "I = I_E + K_A I_AL");
        assert_eq!(steps[2], "I = I_E + K_A I_AL + Σ_L K_D (N·L) I_L");
        assert_eq!(
            steps[3],
            "I = I_E + K_A I_AL + Σ_L (K_D (N·L) + K_S (V·R)^n) I_L"
        );
        assert!(steps.windows(2).all(|w| w[0].len() < w[1].len()));
    }
}
