//! What pages are made of: pieces of the equation, pictures, legends.

use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use maud::{Markup, html};
use rastray_compare::{Map, Scale, ScaleKind};

use crate::error::Error;
use crate::frame::Plane;
use crate::report::equation::{Piece, Script, Term, runs};
use crate::report::files::View;
use crate::report::formats::{png, png_of_picture, png_small};
use crate::report::numbers::tick;
use crate::report::picture::Picture;

/// One piece as HTML. A line may break before a sign, not behind it.
pub(in crate::report) fn piece(p: &Piece) -> Markup {
    let inner = html! {
        @if p.variable { var { (p.text) } } @else if p.text == "+ " { "+\u{a0}" } @else { (p.text) }
    };
    match p.script {
        Script::Base => inner,
        Script::Sub => html! { sub { (inner) } },
        Script::Sup => html! { sup { (inner) } },
    }
}

/// The equation with local and global parts underlined; the signs between the summands stay plain.
pub(in crate::report) fn grouped(equation: &[Piece]) -> Markup {
    let class = |p: &Piece| {
        let global = p.term.map(Term::is_global);
        global.map(|global| if global { "global" } else { "local" })
    };
    html! {
        @for (class, run) in runs(equation, false, class) {
            @match class {
                Some(class) => span class={ "term " (class) } title=(names_of(run)) { @for p in run { (piece(p)) } },
                None => @for p in run { (piece(p)) },
            }
        }
    }
}

/// The names of the terms of a run, each once.
fn names_of(run: &[Piece]) -> String {
    let mut names: Vec<&str> = Vec::new();
    for term in run.iter().filter_map(|p| p.term) {
        if !names.contains(&term.name()) {
            names.push(term.name());
        }
    }
    names.join(", ")
}

/// "+ I_R" with its subscript lowered.
pub(super) fn label(term: Term) -> Markup {
    let (base, sub) = term.label().split_once('_').unwrap_or((term.label(), ""));
    html! { (base) @if !sub.is_empty() { sub { (sub) } } }
}

/// A PNG inside the page.
pub(in crate::report) fn image(bytes: &[u8], width: usize, height: usize, alt: &str) -> Markup {
    let source = format!("data:image/png;base64,{}", BASE64.encode(bytes));
    let class = if width < 320 { "small" } else { "" };
    html! { img src=(source) width=(width) height=(height) alt=(alt) class=[(!class.is_empty()).then_some(class)]; }
}

/// A linear picture, all its pixels.
pub(in crate::report) fn linear_image(
    plane: &Plane<[f32; 3]>,
    view: View,
    alt: &str,
) -> Result<Markup, Error> {
    Ok(image(&png(plane, view)?, plane.width, plane.height, alt))
}

/// A map without its legend, all its pixels.
pub(in crate::report) fn map_picture(map: &Map, alt: &str) -> Result<Markup, Error> {
    let bytes = png_of_picture(&Picture::from_map(map))?;
    Ok(image(&bytes, map.width, map.height, alt))
}

/// A linear picture, reduced until it is about `width` wide.
pub(super) fn overview(
    plane: &Plane<[f32; 3]>,
    view: View,
    width: usize,
    alt: &str,
) -> Result<Markup, Error> {
    reduced(&Picture::from_linear(plane, view)?, width, alt)
}

/// A map, reduced until it is about `width` wide.
pub(super) fn map_overview(map: &Map, width: usize, alt: &str) -> Result<Markup, Error> {
    reduced(&Picture::from_map(map), width, alt)
}

fn reduced(picture: &Picture, width: usize, alt: &str) -> Result<Markup, Error> {
    let small = picture.reduced(picture.width.div_ceil(width));
    Ok(image(&png_small(&small)?, small.width, small.height, alt))
}

/// A scale as a bar with numbers.
pub(in crate::report) fn legend(scale: &Scale) -> Markup {
    let range = scale.max - scale.min();
    let colors: Vec<String> = (0..=24)
        .map(|i| scale.color(scale.min() + range * f64::from(i) / 24.0))
        .map(hex)
        .collect();
    let signed = scale.kind == ScaleKind::Signed;
    let ends = if signed {
        "blue darker, white equal, orange brighter"
    } else {
        "black equal, light different"
    };
    html! {
        div.legend role="img" aria-label={ "Scale from " (tick(scale.min())) " to " (tick(scale.max)) ": " (ends) } {
            i style={ "background:linear-gradient(90deg," (colors.join(",")) ")" } {}
            div aria-hidden="true" {
                @for t in scale.ticks() {
                    span { @if signed && t > 0.0 { "+" } (tick(t)) }
                }
            }
        }
    }
}

/// A colour as style sheets write it.
pub(super) fn hex([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}
