//! Sentences with symbols in them, as the comments of scenes write them: `K_T`, `cos^n`, `N.L`.
//!
//! In: plain text. Out: the same with its symbols told apart ([`Bit`]), and as HTML, Markdown, LaTeX and spans, each
//! escaped as its format needs. Only what cannot be meant otherwise is a symbol: one capital or n with a subscript of one
//! or two letters, a power of letters and digits, a dot between the letters of two of the equation's vectors.

use std::fmt::Write;

use maud::{Markup, html};

use super::equation::Script;
use super::text::{Face, Span};

/// A part of a sentence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bit<'a> {
    /// Words.
    Text(&'a str),
    /// A letter with a subscript: `K_T`.
    Symbol(&'a str, &'a str),
    /// What stands behind `^`.
    Power(&'a str),
    /// Two vectors with a dot between them.
    Product(&'a str, &'a str),
}

/// The parts of a text, in order.
///
/// ```
/// use rastray::report::prose::{Bit, bits};
/// assert_eq!(
///     bits("K_T is cos^2, N.L is"),
///     [
///         Bit::Symbol("K", "T"),
///         Bit::Text(" is cos"),
///         Bit::Power("2"),
///         Bit::Text(", "),
///         Bit::Product("N", "L"),
///         Bit::Text(" is"),
///     ]
/// );
/// assert_eq!(bits("trace.weight_cutoff, U.S.A"), [Bit::Text("trace.weight_cutoff, U.S.A")]);
/// ```
pub fn bits(text: &str) -> Vec<Bit<'_>> {
    let mut found = Vec::new();
    let (mut start, mut at) = (0, 0);
    while at < text.len() {
        let rest = &text[at..];
        let boundary = !text[..at].ends_with(|c: char| c.is_alphanumeric() || "_.^".contains(c));
        let bit = power(rest).or_else(|| boundary.then(|| symbol(rest)).flatten());
        if let Some((bit, length)) = bit {
            if start < at {
                found.push(Bit::Text(&text[start..at]));
            }
            found.push(bit);
            at += length;
            start = at;
        } else {
            at += rest.chars().next().map_or(1, char::len_utf8);
        }
    }
    if start < text.len() {
        found.push(Bit::Text(&text[start..]));
    }
    found
}

/// A power at the start, and its length.
fn power(rest: &str) -> Option<(Bit<'_>, usize)> {
    let digits = rest.strip_prefix('^')?;
    let end = digits
        .find(|c: char| !c.is_ascii_alphanumeric())
        .unwrap_or(digits.len());
    (end > 0).then(|| (Bit::Power(&digits[..end]), end + 1))
}

/// `K_T` or `N.L` at the start, and its length; what follows must be no part of a longer name.
fn symbol(rest: &str) -> Option<(Bit<'_>, usize)> {
    let letter = rest
        .get(..1)
        .filter(|l| l.as_bytes()[0].is_ascii_alphabetic())?;
    let sign = rest.get(1..2)?;
    let tail = rest.get(2..)?;
    let end = tail
        .find(|c: char| !c.is_ascii_alphabetic())
        .unwrap_or(tail.len());
    let (second, after) = tail.split_at(end);
    let more = after.starts_with(|c: char| c.is_alphanumeric() || c == '_')
        || after.starts_with('.') && after[1..].starts_with(|c: char| c.is_alphanumeric());
    let quantity = letter == "n" || letter.as_bytes()[0].is_ascii_uppercase();
    let vector = |s: &str| ["N", "L", "V", "R", "H", "S", "D"].contains(&s);
    match sign {
        _ if more => None,
        "_" if quantity && (1..=2).contains(&second.len()) => {
            Some((Bit::Symbol(letter, second), 2 + second.len()))
        }
        "." if vector(letter) && vector(second) => Some((Bit::Product(letter, second), 3)),
        _ => None,
    }
}

/// As HTML.
pub fn html(text: &str) -> Markup {
    html! {
        @for bit in bits(text) {
            @match bit {
                Bit::Text(text) => (text),
                Bit::Symbol(letter, sub) => { var { (letter) } sub { var { (sub) } } },
                Bit::Power(exponent) => sup { (exponent) },
                Bit::Product(a, b) => { var { (a) } "·" var { (b) } },
            }
        }
    }
}

/// As Markdown; symbols as the HTML that Markdown allows.
pub fn markdown(text: &str) -> String {
    let mut out = String::new();
    for bit in bits(text) {
        match bit {
            Bit::Text(text) => out += &markdown_text(text),
            Bit::Symbol(letter, sub) => out += &format!("*{letter}*<sub>{sub}</sub>"),
            Bit::Power(exponent) => out += &format!("<sup>{exponent}</sup>"),
            Bit::Product(a, b) => out += &format!("*{a}*·*{b}*"),
        }
    }
    out
}

/// Words in Markdown: every character that could mean something there is escaped.
fn markdown_text(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '&' => out += "&amp;",
            '\\' | '`' | '*' | '_' | '{' | '}' | '[' | ']' | '#' | '|' | '~' | '$' | '!' => {
                out.push('\\');
                out.push(c);
            }
            c => out.push(c),
        }
    }
    out
}

/// As LaTeX; symbols in math.
pub fn latex(text: &str) -> String {
    let mut out = String::new();
    for bit in bits(text) {
        // Writing to a String cannot fail.
        let _ = match bit {
            Bit::Text(text) => write!(out, "{}", latex_text(text)),
            Bit::Symbol(letter, sub) => write!(out, "${letter}_{{{sub}}}$"),
            Bit::Power(exponent) => write!(out, "$^{{{exponent}}}$"),
            Bit::Product(a, b) => write!(out, "${a} \\cdot {b}$"),
        };
    }
    out
}

/// Words in LaTeX with T1 fonts: nothing in them is a command, a comment or a ligature of hyphens.
///
/// Signs that plain LaTeX lacks are given in math; letters stay as they are, and those beyond Latin need LuaLaTeX or
/// XeLaTeX.
fn latex_text(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '\\' => out += "\\textbackslash{}",
            '{' | '}' | '$' | '&' | '#' | '_' | '%' => {
                out.push('\\');
                out.push(c);
            }
            '^' => out += "\\textasciicircum{}",
            '~' => out += "\\textasciitilde{}",
            '<' => out += "\\textless{}",
            '>' => out += "\\textgreater{}",
            '|' => out += "\\textbar{}",
            '"' => out += "\\textquotedbl{}",
            '`' => out += "\\textasciigrave{}",
            '-' => out += "-{}",
            '−' => out += "$-$",
            '×' => out += "$\\times$",
            '·' => out += "$\\cdot$",
            '≤' => out += "$\\le$",
            '≥' => out += "$\\ge$",
            '≈' => out += "$\\approx$",
            '≠' => out += "$\\ne$",
            '→' => out += "$\\to$",
            '∞' => out += "$\\infty$",
            'Σ' | '∑' => out += "$\\Sigma$",
            '⁻' => out += "$^{-}$",
            '⁰' => out += "$^{0}$",
            '¹' => out += "$^{1}$",
            '²' => out += "$^{2}$",
            '³' => out += "$^{3}$",
            '⁴'..='⁹' => {
                let digit = u32::from(c) - u32::from('⁰');
                out += &format!("$^{{{digit}}}$");
            }
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// As words of spans: those of one word stay together, a space begins each word but the first.
pub(super) fn chunks(text: &str, face: Face, size: f32, color: [u8; 3]) -> Vec<Vec<Span>> {
    let mut words: Vec<Vec<Span>> = vec![Vec::new()];
    let span = |text: &str, face, script| Span {
        script,
        ..Span::new(text, face, size, color)
    };
    let mut push = |part: Span, new: bool| match words.last_mut() {
        Some(word) if !new => word.push(part),
        _ => words.push(vec![part]),
    };
    for bit in bits(text) {
        match bit {
            Bit::Text(text) => {
                for (i, part) in text.split(' ').enumerate() {
                    let spaced = if i == 0 {
                        part.to_owned()
                    } else {
                        format!(" {part}")
                    };
                    push(span(&spaced, face, Script::Base), i > 0);
                }
            }
            Bit::Symbol(letter, sub) => {
                push(span(letter, Face::Italic, Script::Base), false);
                push(span(sub, Face::Italic, Script::Sub), false);
            }
            Bit::Power(exponent) => push(span(exponent, face, Script::Sup), false),
            Bit::Product(a, b) => {
                push(span(a, Face::Italic, Script::Base), false);
                push(span("·", face, Script::Base), false);
                push(span(b, Face::Italic, Script::Base), false);
            }
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::{Head, shipped};

    #[test]
    fn symbols_are_found_only_where_they_are() {
        for (text, symbols) in [
            ("I = I_E + K_A I_AL", 3),
            ("1 / (c + l d + q d^2)", 1),
            ("(V.R)^n alone, N.L.", 3),
            ("n_i sin(i) = n_r sin(r)", 2),
            ("--set camera.eye=[3,7,5] trace.weight_cutoff", 0),
            ("A_B_C a.b U.S. x^ é_T ^^", 0),
        ] {
            let found = bits(text);
            let count = found.iter().filter(|b| !matches!(b, Bit::Text(_))).count();
            assert_eq!(count, symbols, "{text}: {found:?}");
        }
    }

    #[test]
    fn nothing_of_a_text_is_lost() {
        for scene in shipped() {
            let head = Head::of(scene.name, scene.text);
            for text in head.paragraphs.iter().chain([&head.question, &head.answer]) {
                let written: String = bits(text)
                    .into_iter()
                    .map(|bit| match bit {
                        Bit::Text(text) => text.to_owned(),
                        Bit::Symbol(a, b) => format!("{a}_{b}"),
                        Bit::Power(a) => format!("^{a}"),
                        Bit::Product(a, b) => format!("{a}.{b}"),
                    })
                    .collect();
                assert_eq!(&written, text);
                let plain = latex(text)
                    .chars()
                    .all(|c| c.is_ascii() || ('¡'..='ÿ').contains(&c));
                assert!(plain, "{}: {}", scene.name, latex(text));
            }
        }
    }

    #[test]
    fn each_format_escapes_what_it_must() {
        let text = r#"5% of {a_b} & $1 #2 \x <b> ~ "q" --set K_T^2 * `c` [x](y) | é −2"#;
        assert_eq!(
            latex(text),
            "5\\% of \\{a\\_b\\} \\& \\$1 \\#2 \\textbackslash{}x \\textless{}b\\textgreater{} \
             \\textasciitilde{} \\textquotedbl{}q\\textquotedbl{} -{}-{}set $K_{T}$$^{2}$ * \
             \\textasciigrave{}c\\textasciigrave{} [x](y) \\textbar{} é $-$2"
        );
        assert_eq!(
            markdown(text),
            "5% of \\{a\\_b\\} &amp; \\$1 \\#2 \\\\x &lt;b&gt; \\~ \"q\" --set *K*<sub>T</sub>\
             <sup>2</sup> \\* \\`c\\` \\[x\\](y) \\| é −2"
        );
        assert_eq!(
            html("a < b & K_T").into_string(),
            "a &lt; b &amp; <var>K</var><sub><var>T</var></sub>"
        );
    }

    #[test]
    fn words_keep_their_symbols() {
        let words = chunks("the K_T, N.L of x^2", Face::Regular, 10.0, [0; 3]);
        let text: Vec<String> = words
            .iter()
            .map(|word| word.iter().map(|s| s.text.as_str()).collect())
            .collect();
        assert_eq!(text, ["the", " KT,", " N·L", " of", " x2"]);
    }
}
