//! `figures.tex`: every slide as a figure, and the equation as math with the scene's terms lit.
//!
//! Out: a document that plain LaTeX compiles with graphicx and xcolor, which every distribution has; its figures are to be
//! copied into one's own. Text is escaped by [`super::super::prose::latex`].

use std::fmt::Write;

use super::super::equation::{Form, Piece, Script, runs};
use super::super::folder::{RASTER_NOTE, TRACE_NOTE};
use super::super::prose;
use super::super::topic::Topics;
use super::{Deck, Entry};

/// What the figures need.
const PREAMBLE: &str = r"\documentclass[a4paper]{article}
\usepackage[T1]{fontenc}
% Needed where figures of this file are copied to: from here ...
\usepackage{graphicx}
\usepackage{xcolor}
\definecolor{rastraylit}{HTML}{FFE0BD}
\definecolor{rastrayink}{HTML}{1B1F24}
\definecolor{rastraydim}{HTML}{5A636E}
\newcommand{\rastraylit}[1]{{\setlength{\fboxsep}{1.5pt}\colorbox{rastraylit}{\color{rastrayink}$\displaystyle #1$}}}
\newcommand{\rastraydim}[1]{{\color{rastraydim}#1}}
% ... to here.
\usepackage[margin=25mm]{geometry}
\begin{document}
";

impl Deck {
    /// The document.
    pub(super) fn to_latex(&self) -> String {
        let mut out = String::from("% Made by rastray: ");
        // The command is one line, and a comment ends with its line.
        out += &self.command.replace(['\n', '\r'], " ");
        out += "\n% pdflatex figures.tex, in this folder; or copy a figure, with the lines marked below.\n";
        out += PREAMBLE;
        for entry in &self.entries {
            out += &figure(entry);
        }
        out += "\\end{document}\n";
        out
    }
}

/// A figure: the pictures side by side, the equation, the caption.
fn figure(entry: &Entry) -> String {
    let mut out = String::from("\n\\begin{figure}[htbp]\n  \\centering\n");
    let include = |kind: &str| {
        let file = entry.file(kind);
        format!("  \\includegraphics[width=0.325\\linewidth]{{{file}}}")
    };
    out += &super::KINDS.map(include).join("\\hfill\n");
    out += "\n  \\par\\medskip\n";
    for line in math(&entry.topics, entry.form) {
        // Writing to a String cannot fail.
        let _ = writeln!(
            out,
            "  \\rastraydim{{$\\displaystyle {line}$}}\\par\\smallskip"
        );
    }
    let what = [RASTER_NOTE, TRACE_NOTE].map(prose::latex);
    let _ = writeln!(
        out,
        "  \\caption{{{} Left: {}. Middle: {}. Right: trace $-$ raster. {}.{}}}",
        prose::latex(&entry.caption()),
        what[0],
        what[1],
        prose::latex(&entry.numbers),
        match entry.topics.names().as_str() {
            "" => String::new(),
            names => format!(" Lit: {names}."),
        },
    );
    let _ = writeln!(out, "  \\label{{fig:{}}}", entry.stem);
    let equation = entry.file("equation");
    let _ = writeln!(
        out,
        "  % The slide with the equation: \\includegraphics{{{equation}}}"
    );
    out + "\\end{figure}\n\\clearpage\n"
}

/// The lines of the equation in math, lit by `\rastraylit`.
fn math(topics: &Topics, form: Form) -> Vec<String> {
    lines(topics, form, "\\rastraylit")
}

/// The lines of the equation in math; `lit` is the command around what is lit.
pub(super) fn lines(topics: &Topics, form: Form, lit: &str) -> Vec<String> {
    let line = |pieces: &Vec<Piece>| {
        let mut out = String::new();
        for (new, run) in runs(pieces, false, |p| topics.lit(p).then_some(())) {
            match (new, run) {
                (None, run) => out += &run.iter().map(piece).collect::<String>(),
                // A script alone keeps its place and size.
                (Some(()), [only]) if only.script == Script::Sup => {
                    out += &format!("{{}}^{{{lit}{{\\scriptstyle {}}}}}", only.text);
                }
                (Some(()), run) => {
                    let inner: String = run.iter().map(piece).collect();
                    out += &format!("{lit}{{{}}}", inner.trim());
                }
            }
        }
        out
    };
    topics.lines(form).iter().map(line).collect()
}

/// A piece in math.
fn piece(p: &Piece) -> String {
    match p.script {
        Script::Base => base(p.text, p.variable),
        Script::Sub => format!("_{{{}}}", p.text),
        Script::Sup => format!("^{{{}}}", p.text),
    }
}

/// Characters on the line: words upright, signs as commands.
fn base(text: &str, variable: bool) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let word = rest
            .find(|c: char| !c.is_ascii_alphabetic())
            .unwrap_or(rest.len());
        if word > 1 && !variable {
            match &rest[..word] {
                "cos" => out += "\\cos ",
                other => out += &format!("\\mbox{{ {other} }}"),
            }
            rest = &rest[word..];
            continue;
        }
        if rest.starts_with("  ") {
            out += "\\quad ";
        } else {
            match c {
                'Σ' => out += "\\sum ",
                '·' => out += " \\cdot ",
                '−' => out.push('-'),
                '≥' => out += "\\ge ",
                'γ' => out += "\\gamma ",
                c => out.push(c),
            }
        }
        rest = &rest[c.len_utf8()..];
    }
    out
}
