//! The figure of a pixel: on the left its rays in a side view of the scene, on the right the ray tree, with the same numbers at
//! the same hits. One self-contained SVG, on white or, where the reader's system is dark, on black; blue and orange, as
//! everywhere, never red against green.

use super::diagram::Diagram;
use super::paths::{Line, picked};
use super::pick::pick;
use super::svg::{Drawing, escape};
use super::triple;
use super::view::View;
use crate::explain::Explanation;
use crate::scene::Scene;

/// Cards that the tree has at most.
const CARDS: usize = 12;
/// What a ray with a card adds at least: half a step of 8 bits.
const LEAST: f64 = 1.0 / 510.0;
/// Around and between the two parts.
const MARGIN: f64 = 28.0;
/// Height of the head line.
const HEAD: f64 = 84.0;
/// Height of the legend.
const LEGEND: f64 = 44.0;

/// Light, and dark where the system is. Programs that know no media queries show it light.
const STYLE: &str = "
text { font-family: system-ui, -apple-system, 'Segoe UI', 'DejaVu Sans', sans-serif; font-size: 12px; fill: #1d2430 }
.page { fill: #ffffff } .frame { fill: #f6f7f9; stroke: #c9ced8 }
.heading { font-size: 19px; font-weight: 600 } .title { font-size: 13px; font-weight: 600 }
.small { font-size: 11px; fill: #4a5568 } .faint { fill: #4a5568 }
.label { text-anchor: middle; font-weight: 600; stroke: #f6f7f9; stroke-width: 3px; paint-order: stroke }
.object { fill: #8fa0b8; fill-opacity: .16; stroke: #5b6b82; stroke-width: 1.3 }
.other { stroke-opacity: .4; fill-opacity: .05 } .open { fill: none }
.card { fill: #ffffff; stroke: #aab3c2; stroke-width: 1 }
.ray { fill: none; stroke-width: 2; stroke-linecap: round }
.ray.primary { stroke: #1d2430 } .ray.reflection { stroke: #c2570c } .ray.refraction { stroke: #1d63c4 }
.ray.shadow, .ray.blocked { stroke: #8a6d00; stroke-width: 1.3; stroke-dasharray: 1.5 4 }
.arrow { stroke: none } .arrow.primary { fill: #1d2430 } .arrow.reflection { fill: #c2570c } .arrow.refraction { fill: #1d63c4 }
.cross { stroke: #1d2430; stroke-width: 1.8; stroke-linecap: round }
.lamp { fill: #ffd54a; stroke: #8a6d00 } .eye { fill: #ffffff; stroke: #1d2430; stroke-width: 1.6 } .pupil, .dot { fill: #1d2430 }
.badge { fill: #1d2430; stroke: #ffffff; stroke-width: 1.2 } .badge-text { fill: #ffffff; font-size: 10px; font-weight: 700; text-anchor: middle }
.edge-label { text-anchor: middle; font-size: 12px; font-weight: 600 }
.edge-label.reflection { fill: #a84908 } .edge-label.refraction { fill: #1a57ad }
.edge-back { fill: #ffffff } .swatch { stroke: #aab3c2; stroke-width: .8 }
@media (prefers-color-scheme: dark) {
text { fill: #e6e9ef } .page { fill: #12151b } .frame { fill: #1a1f28; stroke: #3b4453 }
.small, .faint { fill: #aab4c3 } .label { stroke: #1a1f28 }
.object { fill: #93a5bf; stroke: #8fa0b8 } .card { fill: #1a1f28; stroke: #4c576a }
.ray.primary { stroke: #e6e9ef } .ray.reflection { stroke: #ff9a4d } .ray.refraction { stroke: #6aa9ff } .ray.shadow, .ray.blocked { stroke: #e0bc3d }
.arrow.primary { fill: #e6e9ef } .arrow.reflection { fill: #ff9a4d } .arrow.refraction { fill: #6aa9ff }
.cross { stroke: #e6e9ef } .eye { fill: #12151b; stroke: #e6e9ef } .pupil, .dot { fill: #e6e9ef }
.badge { fill: #e6e9ef; stroke: #12151b } .badge-text { fill: #12151b }
.edge-back { fill: #12151b } .edge-label.reflection { fill: #ff9a4d } .edge-label.refraction { fill: #6aa9ff } .swatch { stroke: #4c576a }
}
";

/// The figure as SVG.
pub fn figure(scene: &Scene, e: &Explanation) -> String {
    let shown = pick(&e.trace.rays, CARDS, LEAST);
    let segments = picked(e, &shown);
    let diagram = Diagram::new(e, &shown);
    let view = View::new(scene, e, &segments);
    let [view_width, view_height] = view.size;
    let [tree_width, tree_height] = diagram.size;
    let tree_left = 2.0 * MARGIN + view_width;
    let width = (tree_left + tree_width + MARGIN).max(900.0);
    let height = HEAD + LEGEND + view_height.max(tree_height - LEGEND) + MARGIN;
    let mut drawing = Drawing::default();
    let [x, y] = e.pixel;
    let name = format!("Rays of pixel {x} {y} of {}", e.scene);
    drawing.push(&format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
         viewBox=\"0 0 {width:.0} {height:.0}\" role=\"img\" aria-labelledby=\"name story\">"
    ));
    drawing.push(&format!("<title id=\"name\">{}</title>", escape(&name)));
    drawing.push(&format!("<desc id=\"story\">{}</desc>", escape(&story(e))));
    drawing.push(&format!("<style>{STYLE}</style>"));
    drawing.push("<rect class=\"page\" width=\"100%\" height=\"100%\"/>");
    head(&mut drawing, e);
    drawing.push(&format!(
        "<clipPath id=\"frame\"><rect width=\"{view_width:.1}\" height=\"{view_height:.1}\" rx=\"6\"/></clipPath>"
    ));
    drawing.push(&format!("<g transform=\"translate({MARGIN} {HEAD})\">"));
    drawing.push(&format!(
        "<rect class=\"frame\" width=\"{view_width:.1}\" height=\"{view_height:.1}\" rx=\"6\"/>"
    ));
    drawing.push("<g clip-path=\"url(#frame)\">");
    drawing.push(&view.draw(scene, e, &segments, &diagram.numbers()).0);
    drawing.push("</g>");
    legend(
        &mut drawing,
        view_height + 26.0,
        &segments.iter().map(|s| s.line).collect::<Vec<_>>(),
    );
    drawing.push("</g>");
    drawing.push(&format!("<g transform=\"translate({tree_left} {HEAD})\">"));
    drawing.push(&diagram.draw().0);
    drawing.push("</g>\n</svg>");
    drawing.0
}

/// Scene, pixel and both colours.
fn head(drawing: &mut Drawing, e: &Explanation) {
    let [x, y] = e.pixel;
    let title = format!("{}, pixel {x} {y}: where its light comes from", e.scene);
    drawing.text("heading", [MARGIN, 36.0], &title);
    let mut left = MARGIN;
    for (name, stored, color) in [
        ("ray tracer", e.trace.stored, e.trace.color),
        ("rasterizer", e.raster.stored, e.raster.color),
    ] {
        drawing.swatch([left, 50.0], [26.0, 16.0], stored);
        let text = format!("{name} {}", triple(color));
        drawing.text("faint", [left + 34.0, 62.5], &text);
        left += 330.0;
    }
}

/// What the lines stand for.
fn legend(drawing: &mut Drawing, y: f64, drawn: &[Line]) {
    let words = [
        (Line::Primary, "from the eye"),
        (Line::Reflection, "R reflected"),
        (Line::Refraction, "T transmitted"),
        (Line::Shadow, "light seen"),
        (Line::Blocked, "light blocked ×"),
    ];
    let mut x = 0.0;
    for (line, text) in words.into_iter().filter(|(line, _)| drawn.contains(line)) {
        drawing.line(&format!("ray {}", line.name()), [x, y], [x + 24.0, y]);
        drawing.text("small", [x + 31.0, y + 4.0], text);
        x += 50.0 + 6.4 * text.chars().count() as f64;
    }
}

/// The figure in a sentence, for who cannot see it.
fn story(e: &Explanation) -> String {
    let rays = &e.trace.rays;
    let meets = match rays.first().and_then(|ray| ray.hit.as_ref()) {
        Some(hit) => format!("meets {}", hit.object),
        None => "meets nothing".to_owned(),
    };
    format!(
        "A side view of the scene and the tree of {} rays. The ray from the eye {meets}. The tracer's colour is {}, the \
         rasterizer's {}.",
        rays.len(),
        triple(e.trace.color),
        triple(e.raster.color)
    )
}
