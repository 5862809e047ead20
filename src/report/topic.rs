//! What a scene of a lecture is about: terms of the equation, or parts of them, and how they are lit in it.
//!
//! In: the words behind `term:` in the comment at the head of a scene ([`crate::import::Head`]). Out: [`Topics`], which
//! knows the lines to show and which of their pieces are lit. One table names the words.

use crate::error::Error;
use crate::import::Word;

use super::equation::{Factor, Form, Piece, Term, light_lines, pieces};

/// One thing that a scene is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Topic {
    /// A term of the equation.
    Term(Term),
    /// The exponent n of the specular term.
    Shininess,
    /// The sum over the light sources.
    Sum,
    /// L and I_L of a light source with a position.
    PointLight,
    /// L and I_L of a light source with a direction.
    DirectionalLight,
    /// How I_L fades with distance.
    Attenuation,
    /// Where a spot light shines.
    SpotCutoff,
    /// How a spot light fades towards its rim.
    SpotExponent,
}

/// The words, those of the terms first.
pub const WORDS: [(&str, Topic); 14] = [
    ("emission", Topic::Term(Term::Emission)),
    ("ambient", Topic::Term(Term::Ambient)),
    ("diffuse", Topic::Term(Term::Diffuse)),
    ("specular", Topic::Term(Term::Specular)),
    ("shadow", Topic::Term(Term::Shadow)),
    ("reflection", Topic::Term(Term::Reflection)),
    ("refraction", Topic::Term(Term::Refraction)),
    ("shininess", Topic::Shininess),
    ("sum", Topic::Sum),
    ("point light", Topic::PointLight),
    ("directional light", Topic::DirectionalLight),
    ("attenuation", Topic::Attenuation),
    ("spot cutoff", Topic::SpotCutoff),
    ("spot exponent", Topic::SpotExponent),
];

impl Topic {
    /// The word.
    pub fn name(self) -> &'static str {
        let found = WORDS.iter().find(|(_, topic)| *topic == self);
        found.map_or("", |(word, _)| word)
    }

    /// What stands before the word in headings: how a term joins the equation, or the symbol; a part after an
    /// underscore is lowered.
    pub fn label(self) -> &'static str {
        match self {
            Self::Term(term) => term.label(),
            Self::Shininess => "n",
            Self::Sum => "Σ_L",
            Self::PointLight | Self::DirectionalLight => "L, I_L",
            Self::Attenuation | Self::SpotCutoff | Self::SpotExponent => "I_L",
        }
    }

    /// Whether a piece belongs to it, were it alone.
    fn has(self, piece: &Piece) -> bool {
        use Factor as F;
        match (self, piece.factor) {
            (Self::Term(term), None | Some(F::ToLight | F::Exponent)) => piece.term == Some(term),
            (Self::Shininess, Some(F::Exponent)) => true,
            // The sum's own sign, not its brackets.
            (Self::Sum, Some(F::Sum)) => piece.term == Some(Term::Diffuse),
            (Self::PointLight | Self::DirectionalLight, Some(F::ToLight | F::Light)) => true,
            (Self::PointLight, Some(F::Position)) => true,
            (Self::DirectionalLight, Some(F::Direction)) => true,
            (Self::Attenuation | Self::SpotCutoff | Self::SpotExponent, Some(F::Light)) => true,
            (Self::Attenuation, Some(F::Attenuation)) => true,
            (Self::SpotCutoff, Some(F::SpotCutoff)) => true,
            (Self::SpotExponent, Some(F::SpotExponent)) => true,
            _ => false,
        }
    }
}

/// All that a scene is about; empty where it does not say.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Topics(pub Vec<Topic>);

impl Topics {
    /// The topics of the words.
    ///
    /// # Errors
    /// A word that is none of [`WORDS`], or stands twice, with its place.
    pub fn of(words: &[Word]) -> Result<Self, Error> {
        let mut topics = Vec::new();
        for word in words {
            let found = WORDS.iter().find(|(name, _)| *name == word.text);
            let Some((_, topic)) = found else {
                let names: Vec<&str> = WORDS.iter().map(|(name, _)| *name).collect();
                let message = format!("`{}` is no term of the equation", word.text);
                return Err(Error::input(word.place.clone(), message)
                    .with_help(format!("the terms are {}", names.join(", "))));
            };
            if topics.contains(topic) {
                let message = format!("`{}` is named twice", word.text);
                return Err(Error::input(word.place.clone(), message));
            }
            topics.push(*topic);
        }
        Ok(Self(topics))
    }

    /// Whether a piece of the equation is lit. The sum's brackets and I_L are, where all between them is.
    pub fn lit(&self, piece: &Piece) -> bool {
        let has = |term| self.0.contains(&Topic::Term(term));
        let whole = matches!(piece.factor, Some(Factor::Sum | Factor::Light))
            && has(Term::Diffuse)
            && has(Term::Specular);
        whole || self.0.iter().any(|topic| topic.has(piece))
    }

    /// The equation, and below it the lines about light sources in which something is lit.
    pub fn lines(&self, form: Form) -> Vec<Vec<Piece>> {
        let more = light_lines().into_iter();
        let more = more.filter(|line| line.iter().any(|piece| self.lit(piece)));
        std::iter::once(pieces(form, Term::Refraction))
            .chain(more)
            .collect()
    }

    /// The words in one line.
    pub fn names(&self) -> String {
        let names: Vec<&str> = self.0.iter().map(|topic| topic.name()).collect();
        names.join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Place;
    use crate::gl::SpecularModel;
    use crate::import::{Head, shipped};
    use crate::report::equation::runs;

    const FORM: Form = Form {
        specular: SpecularModel::Reflection,
        mirror_is_specular: true,
    };

    /// The lit runs of all lines.
    fn lit(topics: &Topics) -> Vec<String> {
        let lines = topics.lines(FORM);
        let mut found = Vec::new();
        for line in &lines {
            for (key, run) in runs(line, false, |p| topics.lit(p).then_some(())) {
                if key.is_some() {
                    found.push(run.iter().map(|p| p.text).collect());
                }
            }
        }
        found
    }

    #[test]
    fn each_topic_lights_its_part() {
        let expected: [&[&str]; 14] = [
            &["IE"],
            &["KA IAL"],
            &["KD (N·L)"],
            &["KS (V·R)n"],
            &["SL"],
            &["KS IR"],
            &["KT IT"],
            &["n"],
            &["ΣL"],
            &["L", "IL", "(PL − P) / d"],
            &["L", "IL", "−D"],
            &["IL", "/ (c + l d + q d2)"],
            &["IL", "where −S·L ≥ cos γ, else 0"],
            &["IL", "(−S·L)e"],
        ];
        for ((word, topic), parts) in WORDS.into_iter().zip(expected) {
            assert_eq!(lit(&Topics(vec![topic])), parts, "{word}");
            assert_eq!(topic.name(), word);
        }
    }

    #[test]
    fn diffuse_and_specular_together_light_the_sum() {
        let local = Term::ALL[..4].iter().map(|t| Topic::Term(*t)).collect();
        assert_eq!(
            lit(&Topics(local)),
            ["IE", "KA IAL", "ΣL (KD (N·L) + KS (V·R)n)", "IL"]
        );
        let casting = Term::ALL[..5].iter().map(|t| Topic::Term(*t)).collect();
        assert_eq!(lit(&Topics(casting))[2], "ΣL (KD (N·L) + KS (V·R)n) SL IL");
        assert!(lit(&Topics::default()).is_empty());
    }

    #[test]
    fn every_lecture_scene_has_terms_that_light_something() {
        for scene in shipped() {
            let head = Head::of(scene.name, scene.text);
            let topics = Topics::of(&head.terms).expect("known words");
            let lecture = scene.folder == "lecture";
            assert!(!lecture || !lit(&topics).is_empty(), "{}", scene.name);
        }
    }

    #[test]
    fn wrong_words_have_their_place() {
        let word = |text: &str| Word {
            text: text.into(),
            place: Place::file("mine.toml"),
        };
        for (words, wanted) in [
            (vec![word("glow")], "`glow` is no term"),
            (vec![word("")], "`` is no term"),
            (vec![word("sum"), word("sum")], "named twice"),
        ] {
            let error = Topics::of(&words).expect_err("wrong").to_string();
            assert!(
                error.contains("mine.toml") && error.contains(wanted),
                "{error}"
            );
        }
    }
}
