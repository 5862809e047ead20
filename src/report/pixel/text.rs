//! The explanation of a pixel as text: for a reader who sees the equation for the first time.

use super::sheet::{FAINT, HEADING, NAME, STRONG, Sheet, cells, styled, swatch};
use super::terms::{self, LABEL};
use super::{branches, degrees, short, triple, vector};
use crate::explain::{Blended, Explanation, Hit, Raster, Ray, Vertex};
use crate::gl::SpecularModel;
use crate::math::color::Rgb;
use crate::report::causes::CAUSES;
use crate::report::equation::{Form, Term, pieces, plain};
use crate::scene::Scene;

/// Rays that have lines of their own, unless all are asked for.
const RAYS: usize = 40;
/// What they add at least.
const LEAST: f64 = 1e-4;

/// How to lay the text out.
#[derive(Clone, Copy, Debug, Default)]
pub struct Layout {
    /// Columns of the terminal; `None` for a file.
    pub width: Option<usize>,
    /// Every ray has a line, however small its part.
    pub all_rays: bool,
}

/// The text, with escape codes for colours and bold type.
pub fn text(scene: &Scene, explanation: &Explanation, layout: Layout) -> String {
    let mut sheet = Sheet::new(layout.width);
    let form = Form::of(scene);
    head(&mut sheet, explanation);
    equation(&mut sheet, form);
    raster(&mut sheet, explanation);
    trace(&mut sheet, explanation, form);
    let rays = &explanation.trace.rays;
    if rays.len() > 1 {
        sheet.heading("The ray tree");
        sheet.sentence(0, 0, &tree_intro(form));
        let (most, least) = if layout.all_rays {
            (usize::MAX, 0.0)
        } else {
            (RAYS, LEAST)
        };
        branches::rows(&mut sheet, rays, most, least);
    }
    causes(&mut sheet, explanation);
    sheet.blank();
    let end = "Numbers are rounded for reading; --json has them exact, and they add up to the pixels bit for bit.";
    sheet.sentence(0, 0, &styled(FAINT, end));
    sheet.finish()
}

fn tree_intro(form: Form) -> String {
    let mirror = if form.mirror_is_specular {
        "K_S"
    } else {
        "K_R"
    };
    format!(
        "A ray adds its weight times the light at its own hit. The weight is the product of {mirror} (R) and K_T (T) on the \
         way: one factor for every interface, so two for a solid that is passed. Angles are to the normal N."
    )
}

/// Both colours and their difference.
fn head(sheet: &mut Sheet, e: &Explanation) {
    let [x, y] = e.pixel;
    let [width, height] = e.size;
    let title = format!("{}, pixel {x} {y}", e.scene);
    sheet.line(&format!(
        "{} {}",
        styled(HEADING, title),
        styled(
            FAINT,
            format!("of {width}x{height}, counted from the top left")
        )
    ));
    sheet.columns(LABEL, "PNG");
    for (name, color, stored) in [
        ("rasterizer", e.raster.color, e.raster.stored),
        ("ray tracer", e.trace.color, e.trace.stored),
    ] {
        let [r, g, b] = stored;
        let shown = stored.map(|x| f64::from(x) / 255.0);
        let pad = LABEL - name.len();
        sheet.line(&format!(
            "{}{:pad$}{}   {r:>3} {g:>3} {b:>3}  {}",
            styled(STRONG, name),
            "",
            cells(color),
            swatch(shown)
        ));
    }
    if let Some(samples) = &e.samples {
        let [x, y] = samples.places[samples.shown];
        let text = format!(
            "The pixel is the mean of {} samples. Explained is sample {}, the nearest to the centre, at {} {} of the pixel.",
            samples.places.len(),
            samples.shown + 1,
            short(x),
            short(y)
        );
        sheet.sentence(0, 0, &text);
    }
}

/// The equation and each of its symbols, once.
fn equation(sheet: &mut Sheet, form: Form) {
    sheet.heading("The equation");
    let whole = plain(&pieces(form, Term::Refraction));
    sheet.line(&format!("  {}", styled(STRONG, &whole)));
    // The bracket below what the rasterizer has; S_L, I_R and I_T are the tracer's.
    let sum_end = whole
        .find(" S_L")
        .map_or(0, |at| whole[..at].chars().count());
    let local = whole
        .find(" I_L")
        .map_or(sum_end, |at| whole[..at].chars().count() + 4);
    let words = " the rasterizer, with S_L = 1 ";
    let fill = |n: usize| "─".repeat(n);
    let inside = local.saturating_sub(4 + 2 + words.chars().count());
    let left = format!("└{}{words}{}┘", fill(inside / 2), fill(inside - inside / 2));
    let rest = whole.chars().count().saturating_sub(local + 3 + 2 + 13);
    let right = format!("└{} tracer only {}┘", fill(rest / 2), fill(rest - rest / 2));
    sheet.line(&styled(FAINT, format!("      {left}   {right}")));
    symbols(sheet, form);
}

/// What each symbol stands for.
fn symbols(sheet: &mut Sheet, form: Form) {
    let half = form.specular == SpecularModel::HalfVector;
    let mirror = if form.mirror_is_specular {
        ("I_R", "light from the mirror direction; K_S weighs it, too")
    } else {
        (
            "K_R, I_R",
            "the mirror's weight; light from the mirror direction",
        )
    };
    let vectors = if half {
        (
            "N, L, H",
            "unit vectors: the normal, to the light, halfway between L and the viewer",
        )
    } else {
        (
            "N, L, V, R",
            "unit vectors: the normal, to the light, to the viewer, L mirrored about N",
        )
    };
    let symbols = [
        (
            "I",
            "the colour of the pixel: red, green, blue, linear, before it is limited to 0..1",
        ),
        ("I_E", "light that the surface emits"),
        (
            "K_A, K_D, K_S",
            "what its material makes of ambient, diffuse and specular light",
        ),
        (
            "I_AL",
            "ambient light of the scene; a light may bring some of its own",
        ),
        ("Σ_L", "the sum over the lights"),
        vectors,
        ("n", "the shininess: the larger, the smaller the highlight"),
        (
            "S_L",
            "1 where light L is seen, 0 where something blocks it; the rasterizer cannot know and takes 1",
        ),
        (
            "I_L",
            "the light's colour, times attenuation 1 / (c + l d + q d²) and spot factor, where it has them",
        ),
        mirror,
        (
            "K_T, I_T",
            "transmission, a factor an interface; light from the refracted direction",
        ),
    ];
    for (symbol, meaning) in symbols {
        let pad = 15 - symbol.chars().count();
        sheet.sentence(
            2,
            15,
            &format!("{}{:pad$}{meaning}", styled(NAME, symbol), ""),
        );
    }
}

/// The rasterizer's side.
fn raster(sheet: &mut Sheet, e: &Explanation) {
    let side = &e.raster;
    sheet.heading("The rasterizer");
    let Some(hit) = &side.hit else {
        sheet.sentence(0, 0, "No triangle covers the pixel.");
        sheet.columns(LABEL, "");
        terms::rows(sheet, e, &side.terms, true);
        blended(sheet, e, side);
        return;
    };
    let how = match side.shading {
        "flat" => "flat shading: the equation at its last vertex colours the whole triangle",
        "gouraud" => {
            "Gouraud shading: the equation at its three vertices, interpolated between them"
        }
        _ => "the equation at the pixel itself, with the interpolated normal",
    };
    sheet.sentence(
        0,
        0,
        &format!(
            "Seen is triangle {} of {}; {how}.",
            hit.triangle.unwrap_or(0),
            place(hit)
        ),
    );
    for (i, vertex) in side.vertices.iter().enumerate() {
        one_vertex(sheet, e, (i + 1, side.vertices.len()), vertex);
    }
    if side.shading == "gouraud" {
        sheet.blank();
        sheet.sentence(0, 0, "Interpolated:");
    }
    if side.shading != "flat" {
        sheet.columns(LABEL, "");
        terms::rows(sheet, e, &side.terms, false);
    }
    let shown = e.samples.as_ref().map_or(side.color, |s| s.raster[s.shown]);
    if side.blended.is_empty() {
        terms::total(sheet, "I", shown, "");
    } else {
        blended(sheet, e, side);
    }
}

/// Transmissive surfaces over what is seen.
fn blended(sheet: &mut Sheet, e: &Explanation, side: &Raster) {
    for Blended {
        alpha, color, hit, ..
    } in &side.blended
    {
        let text = format!(
            "{} is blended over it: {} times its colour, {} times what was there.",
            styled(NAME, &hit.object),
            short(*alpha),
            short(1.0 - alpha)
        );
        sheet.sentence(2, 2, &text);
        sheet.row((LABEL, "    its colour"), *color, "");
    }
    let shown = e.samples.as_ref().map_or(side.color, |s| s.raster[s.shown]);
    terms::total(sheet, "I", shown, "");
}

fn one_vertex(sheet: &mut Sheet, e: &Explanation, (number, of): (usize, usize), vertex: &Vertex) {
    sheet.blank();
    let name = if of == 1 {
        "The last vertex".to_owned()
    } else {
        format!("Vertex {number} of {of}, weight {}", short(vertex.weight))
    };
    sheet.sentence(
        0,
        0,
        &format!(
            "{}, at {}, N {}",
            styled(STRONG, name),
            vector(vertex.point),
            vector(vertex.normal)
        ),
    );
    sheet.columns(LABEL, "");
    terms::rows(sheet, e, &vertex.terms, false);
    if of > 1 {
        terms::total(sheet, "its colour", vertex.color, "");
    }
}

/// The tracer's side: the primary hit.
fn trace(sheet: &mut Sheet, e: &Explanation, form: Form) {
    sheet.heading("The ray tracer");
    let Some(ray) = e.trace.rays.first() else {
        return;
    };
    match &ray.hit {
        None => sheet.sentence(0, 0, "The ray from the eye meets nothing."),
        Some(hit) => {
            let side = if hit.back { ", seen from its back" } else { "" };
            let text = format!(
                "The ray from the eye meets {}{side}, {} away, at {}; N {}, {} to the ray.",
                place(hit),
                short(hit.distance),
                vector(hit.point),
                vector(hit.normal),
                degrees(hit.incidence_deg)
            );
            sheet.sentence(0, 0, &text);
        }
    }
    sheet.columns(LABEL, "");
    terms::rows(sheet, e, &ray.terms, ray.hit.is_none());
    global(sheet, ray, form);
    terms::total(sheet, "I", ray.color, "");
}

/// What arrives by other surfaces.
fn global(sheet: &mut Sheet, ray: &Ray, form: Form) {
    let mirror = if form.mirror_is_specular {
        "K_S"
    } else {
        "K_R"
    };
    if let Some(r) = &ray.reflection {
        let working = format!("{mirror} {} × I_R {}", triple(r.weight), triple(r.color));
        sheet.row((LABEL, "  reflection"), r.contribution, &working);
    }
    if let Some(t) = &ray.refraction {
        let working = if t.tir {
            branches::total_reflection(t)
        } else {
            format!("K_T {} × I_T {}", triple(t.weight), triple(t.color))
        };
        sheet.row((LABEL, "  refraction"), t.contribution, &working);
    }
    if ray.depth_reached {
        sheet.sentence(2, 2, "Depth 0: no mirror and no transmitted ray is cast.");
    }
}

fn place(hit: &Hit) -> String {
    format!("{} (material {})", styled(NAME, &hit.object), hit.material)
}

/// The ladder at this pixel.
fn causes(sheet: &mut Sheet, e: &Explanation) {
    sheet.heading("Why the two pictures differ here");
    sheet.sentence(0, 0, "Each step changes one thing, from raster.png to trace.png; in another order the steps would have other shares.");
    sheet.columns(LABEL, "");
    let first = e.rungs.first().copied().unwrap_or_default();
    let last = e.rungs.last().copied().unwrap_or_default();
    sheet.row((LABEL, &styled(STRONG, "raster.png")), first, "");
    for cause in &e.causes {
        let words = CAUSES
            .iter()
            .find(|c| c.name == cause.name)
            .map_or("", |c| c.step);
        let nothing = cause.rgb == [0.0; 3];
        let label = format!("  {}", cause.name);
        if nothing {
            sheet.line(&styled(
                FAINT,
                format!("{label:LABEL$}{}", cells(cause.rgb)),
            ));
        } else {
            sheet.row((LABEL, &label), cause.rgb, words);
        }
    }
    sheet.row(
        (LABEL, &styled(STRONG, "trace.png")),
        last,
        &changed(e.difference),
    );
    if e.limited {
        sheet.sentence(0, 0, "Values beyond 2^20 are limited for this list.");
    }
}

fn changed(difference: Rgb) -> String {
    if difference == [0.0; 3] {
        "the same".to_owned()
    } else {
        format!("a difference of {}", triple(difference))
    }
}
