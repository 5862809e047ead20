//! `figures.md`: every slide with its pictures, its texts, and the equation in LaTeX.

use super::super::folder::{DIFFERENCE_NOTE, RASTER_NOTE, TRACE_NOTE};
use super::super::prose::markdown;
use super::{Deck, Entry, KINDS, latex};

impl Deck {
    /// The text.
    pub(super) fn to_markdown(&self) -> String {
        let mut out = String::from("# Figures\n\n");
        out += &format!(
            "Made by `{}`.\n\n",
            self.command.replace(['`', '\n', '\r'], " ")
        );
        out += &format!("- raster: {}\n", markdown(RASTER_NOTE));
        out += &format!("- trace: {}\n", markdown(TRACE_NOTE));
        out += &format!("- difference: {}\n", markdown(DIFFERENCE_NOTE));
        for entry in &self.entries {
            out += &section(entry);
        }
        out
    }
}

/// A slide.
fn section(entry: &Entry) -> String {
    let title = markdown(entry.title());
    let mut out = format!("\n## {}: {title}\n\n", markdown(&entry.stem));
    let answer = markdown(&entry.head.answer);
    if !answer.is_empty() {
        out += &format!("{answer}\n\n");
    }
    let picture = |kind: &str| format!("![{title} ({kind})]({})", entry.file(kind));
    out += "| raster | trace | difference |\n| - | - | - |\n";
    out += &format!("| {} |\n\n", KINDS.map(picture).join(" | "));
    out += &format!("{}.\n\n", markdown(&entry.numbers));
    let names = entry.topics.names();
    if !names.is_empty() {
        out += &format!("Lit: {names}.\n\n");
    }
    for line in latex::lines(&entry.topics, entry.form, "\\boxed") {
        out += &format!("```math\n{line}\n```\n\n");
    }
    let alt = if names.is_empty() {
        "the equation"
    } else {
        &names
    };
    out += &format!(
        "![The equation with its new part lit: {alt}]({})\n",
        entry.file("equation")
    );
    for paragraph in &entry.head.paragraphs {
        out += &format!("\n{}\n", markdown(paragraph));
    }
    out
}
