//! The moving part's frame: the stage with its controls, the mixer, the place for a pixel's numbers.
//!
//! Everything here is hidden until the script has unpacked what it needs; it fills lists, and it takes over by `id`.

use maud::{Markup, html};

use super::Report;

/// Stage and mixer.
pub(super) fn viewer(report: &Report) -> Markup {
    html! {
        section.live.viewer #viewer aria-label="Compare two pictures" hidden {
            h2 { "Compare any two" }
            (choice())
            div.work {
                div.showing {
                    (stage())
                    (readout())
                }
                (mixer(report))
            }
            @if !report.live.left_out.is_empty() {
                ul.notice { @for sentence in &report.live.left_out { li { (sentence) } } }
            }
        }
        p.notice #fallback role="status" hidden {}
    }
}

/// Which pictures, and how.
fn choice() -> Markup {
    html! {
        div.choice {
            label { span { "left" } select #left {} }
            button.quiet #swap type="button" title="Swap left and right (key X)" aria-label="Swap left and right" { "⇄" }
            label { span { "right" } select #right {} }
            fieldset.tabs aria-label="How to compare" {
                @for (value, says, key) in [("swipe", "swipe", "1"), ("signed", "difference", "2"), ("error", "error", "3")] {
                    label title={ "Key " (key) } { input type="radio" name="look" value=(value); span { (says) } }
                }
            }
            label.check title="Key H" { input #hatch type="checkbox"; span { "hatch clamped" } }
            label.exposure #exposing hidden { span { "exposure" }
                input #exposure type="range" min="-3" max="6" step="0.5" value="0" aria-describedby="exposure-says";
                output #exposure-says for="exposure" {} }
        }
    }
}

/// The pictures over each other, the handle between them, the legend below.
fn stage() -> Markup {
    html! {
        div.stage #stage tabindex="0" role="group" aria-roledescription="pixel picker" aria-label="Picture. Arrow keys move a pixel cursor, Enter explains the pixel."
            aria-describedby="alt" {
            canvas #canvas-left role="img" {}
            canvas #canvas-right role="img" {}
            canvas #canvas-difference role="img" hidden {}
            span.tag.left #tag-left aria-hidden="true" {}
            span.tag.right #tag-right aria-hidden="true" {}
            div.handle #handle role="slider" tabindex="0" aria-label="Boundary between the two pictures" aria-orientation="horizontal"
                aria-valuemin="0" aria-valuemax="100" aria-valuenow="50" {}
            span.cross #cross aria-hidden="true" hidden {}
        }
        div.legend #legend role="img" hidden { i {} div aria-hidden="true" {} }
        p.alt #alt aria-live="polite" {}
    }
}

/// The numbers under the cursor.
fn readout() -> Markup {
    html! {
        dl.readout #readout aria-label="Values under the cursor" {
            @for (id, name) in [("at", "pixel"), ("value-left", "left"), ("value-right", "right"), ("value-difference", "right − left")] {
                div { dt { (name) } dd id=(id) { "–" } }
            }
            div.more #more hidden { dt.spoken { "more" } dd { button.quiet #tell type="button" { "all numbers of this pixel ↓" } } }
        }
    }
}

/// The switches and sliders of the sum.
fn mixer(report: &Report) -> Markup {
    html! {
        section.mixer #mixer aria-labelledby="mixer-title" hidden[report.live.mix_error.is_none()] {
            h3 #mixer-title { "Term mixer" }
            p.hint { "Summed linearly, then clamped as OpenGL does." }
            div.terms role="group" aria-label="Terms" {
                @for (letter, symbol, name) in [
                    ("E", html! { "I" sub { "E" } }, "emission"), ("A", html! { "K" sub { "A" } }, "ambient"),
                    ("D", html! { "K" sub { "D" } }, "diffuse"), ("S", html! { "K" sub { "S" } }, "specular"),
                    ("s", html! { "S" sub { "L" } }, "shadows"), ("R", html! { "I" sub { "R" } }, "reflection"),
                    ("T", html! { "I" sub { "T" } }, "refraction"),
                ] {
                    label.switch { input type="checkbox" data-switch=(letter) checked; span { var { (symbol) } " " (name) } }
                }
            }
            div.lights #lights {}
            p.presets role="group" aria-label="Presets" {
                button type="button" data-preset="all" { "all" }
                button type="button" data-preset="local" { "local only" }
                button type="button" data-preset="shadow" { "+ shadows" }
                button type="button" data-preset="none" { "none" }
            }
            details {
                summary { "What the switches do" }
                p { "Strength and colour multiply a light, before anything is clamped; a colour works as a filter in front of it. "
                    "Inside mirrors and glass they act on all of a light; single terms can be taken out only where you look at a surface directly. "
                    "Without S" sub { "L" } " no light is blocked, in mirrors and glass as well. I" sub { "R" } " and I" sub { "T" }
                    " are what arrives by the first bounce, with everything that follows." }
            }
        }
    }
}

/// The place for a pixel's numbers.
pub(super) fn pixel() -> Markup {
    html! {
        section.live.pixel #pixel aria-labelledby="pixel-title" hidden {
            h2 #pixel-title { "One pixel" }
            div.choice {
                label { span { "x" } input #x type="number" min="0" step="1" inputmode="numeric"; }
                label { span { "y" } input #y type="number" min="0" step="1" inputmode="numeric"; }
                label { span { "telling pixels" } select #telling {} }
                span.command { code #command {} button.quiet #copy type="button" title="Copy the command" { "copy" } }
                span.spoken #copied role="status" {}
            }
            p.hint { "Click the picture, or use arrow keys and Enter on it." }
            div.story #story {}
        }
    }
}
