//! The extremes atlas as a page, a table and JSON: small pictures, each with what f32 is off by, and why where it is much.
//!
//! In: an [`Atlas`]. Out: `index.html`, which needs no other file, `extremes.csv` and `extremes.json`. The page says nothing that
//! the numbers do not: what holds, what is ill-conditioned and what is a fault follows from each figure.

use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use maud::{Markup, html};

use super::document::{ARTICLE, Document};
use super::files::View;
use super::folder::File;
use super::formats::png;
use super::numbers::{count, value};
use crate::error::Error;
use crate::frame::Plane;
use crate::trade::extremes::{Atlas, BAR, BAR_HIGH_EXPONENT, Cell, Condition, Figure, Sheet};

/// The files of the atlas.
///
/// # Errors
/// [`Error::Limit`] where JSON cannot hold it; what encoding a picture refuses.
pub fn files(atlas: &Atlas, command: &str) -> Result<Vec<File>, Error> {
    let file = |name: &str, bytes: Vec<u8>| File {
        name: name.into(),
        bytes,
    };
    Ok(vec![
        file("extremes.json", json(atlas)?.into_bytes()),
        file("extremes.csv", csv(atlas).into_bytes()),
        file("index.html", page(atlas, command)?.into_bytes()),
    ])
}

/// Every number, indented.
///
/// # Errors
/// [`Error::Limit`] where JSON cannot hold it.
pub fn json(atlas: &Atlas) -> Result<String, Error> {
    let json = serde_json::to_string_pretty(atlas)
        .map_err(|e| Error::limit(format!("cannot write extremes.json: {e}")))?;
    Ok(json + "\n")
}

/// One line a figure.
pub fn csv(atlas: &Atlas) -> String {
    let mut text = String::from(
        "sheet,scene,setting,renderer,bar,error,arithmetic,not_numbers,objects,wrong,over,input,change,condition,mesh_rmse\n",
    );
    for (sheet, cell) in atlas.cells() {
        for (renderer, f) in cell.figures() {
            let condition = f.condition.as_ref();
            let cause = condition.map_or(",,".into(), |c| {
                format!("{},{:e},{:e}", c.input, c.change, c.number)
            });
            text += &format!(
                "{},{},{},{renderer},{:e},{:e},{:e},{},{},{},{},{cause},{:e}\n",
                sheet.name,
                cell.scene,
                cell.setting,
                cell.bar,
                f.error,
                f.arithmetic,
                f.not_numbers,
                f.objects,
                f.wrong,
                f.over,
                cell.mesh_rmse,
            );
        }
    }
    text
}

/// How many figures hold, are ill-conditioned, or are at fault.
#[derive(Clone, Copy, Default)]
struct Tally {
    cells: usize,
    hold: usize,
    ill: usize,
    fault: usize,
    /// Largest error of the arithmetic.
    arithmetic: f64,
    /// Largest condition number.
    condition: f64,
}

impl Tally {
    fn of<'a>(cells: impl Iterator<Item = &'a Cell>) -> Self {
        let mut tally = Self::default();
        for cell in cells {
            tally.cells += 1;
            for (_, figure) in cell.figures() {
                let (holds, fault) = (figure.holds(cell.bar), figure.fault(cell.bar));
                tally.fault += usize::from(fault);
                tally.hold += usize::from(holds && !fault);
                tally.ill += usize::from(!holds && !fault);
                tally.arithmetic = tally.arithmetic.max(figure.arithmetic);
                let number = figure.condition.as_ref().map_or(0.0, |c| c.number);
                tally.condition = tally.condition.max(number);
            }
        }
        tally
    }
}

/// The page.
///
/// # Errors
/// What encoding a picture refuses.
pub fn page(atlas: &Atlas, command: &str) -> Result<String, Error> {
    let [width, height] = atlas.size;
    let body = html! {
        body {
            header {
                p.kicker { "rastray trade --extremes · pictures of " (width) " × " (height) " pixels" }
                h1 { "What holds at the ends of the numbers" }
                p.lead { (verdict(atlas)) }
                (how_to_read(atlas))
                (overview(atlas))
            }
            main {
                @for sheet in &atlas.sheets { (section(sheet)?) }
            }
            footer {
                p { "Made by rastray " (env!("CARGO_PKG_VERSION")) " with " code { (command) } ". Every number is in "
                    a href="extremes.csv" { "extremes.csv" } " and " a href="extremes.json" { "extremes.json" }
                    ". Type: Inter, SIL Open Font License 1.1." }
            }
        }
    };
    let document = Document {
        title: "Extremes · rastray trade".to_owned(),
        policy: None,
        sheets: &[ARTICLE, include_str!("atlas.css")],
        body,
    };
    Ok(document.into_html())
}

/// The result in a sentence: "221 of 232 figures agree within the bar; 11 are of ill-conditioned scenes; none at fault."
pub fn summary(atlas: &Atlas) -> String {
    let all = Tally::of(atlas.cells().map(|(_, cell)| cell));
    let faults = match all.fault {
        0 => "none at fault".to_owned(),
        n => format!("{} at fault", count(n)),
    };
    format!(
        "{} of {} figures agree within the bar; {} are of ill-conditioned scenes; {faults}.",
        count(all.hold),
        count(all.hold + all.ill + all.fault),
        count(all.ill),
    )
}

fn verdict(atlas: &Atlas) -> String {
    let all = Tally::of(atlas.cells().map(|(_, cell)| cell));
    let figures = all.hold + all.ill + all.fault;
    let faults = match all.fault {
        0 => "No picture holds a NaN or a wrong decision.".to_owned(),
        n => format!("{} are at fault, and marked.", count(n)),
    };
    format!(
        "{} scenes at an extreme, each drawn by both renderers. Of {} figures {} agree between f32 and f64 within the bar; {} \
         are of scenes so ill-conditioned that half an ulp of an input is worth more than the bar, as measured. {faults}",
        count(all.cells),
        count(figures),
        count(all.hold),
        count(all.ill),
    )
}

fn how_to_read(atlas: &Atlas) -> Markup {
    html! {
        div.read {
            p {
                "Each cell shows the rasterizer's picture at the left (" (atlas.level) " slices a turn, lit per fragment) and the \
                 tracer's at the right (true shapes, shadows, all rays), both in f32. The number under each is the largest \
                 difference of a value from the same picture in f64, relative to max(1, magnitude). The bar is "
                (value(BAR)) ", and " (value(BAR_HIGH_EXPONENT)) " for exponents above 1000. \u{201c}Triangles\u{201d} is the \
                 RMSE of the rasterizer's shapes against the true ones, in f64: what precision does not buy."
            }
            p {
                "Where a figure is over the bar, a third picture is drawn in f64 from the inputs that f32 has: each rounded, so moved \
                 by half an ulp at most. What it differs by from f64 is the scene's condition, and the caption gives the input that \
                 does most of it when rounded alone: the largest change of a value, and that change over 2⁻²⁴, the condition number. \
                 What it differs by from f32 is the program's arithmetic, and has to stay under the bar everywhere."
            }
        }
    }
}

fn overview(atlas: &Atlas) -> Markup {
    html! {
        div.scroll { table {
            caption { "Two figures a cell: rasterizer and tracer" }
            thead { tr {
                th scope="col" { "Input" }
                th.number scope="col" { "Cells" }
                th.number scope="col" { "Within the bar" }
                th.number scope="col" { "Ill-conditioned" }
                th.number scope="col" { "At fault" }
                th.number scope="col" { "Largest error of the arithmetic" }
                th.number scope="col" { "Largest condition number" }
            } }
            tbody { @for sheet in &atlas.sheets {
                @let tally = Tally::of(sheet.cells.iter());
                tr {
                    th scope="row" { a href={ "#" (sheet.name) } { (sheet.title) } }
                    td.number { (count(tally.cells)) }
                    td.number { (count(tally.hold)) }
                    td.number { (count(tally.ill)) }
                    td.number { (count(tally.fault)) }
                    td.number { (value(tally.arithmetic)) }
                    td.number { @if tally.condition > 0.0 { (rounded(tally.condition)) } @else { "–" } }
                }
            } }
        } }
    }
}

fn section(sheet: &Sheet) -> Result<Markup, Error> {
    let mut scenes: Vec<&str> = sheet.cells.iter().map(|cell| cell.scene).collect();
    scenes.dedup();
    Ok(html! {
        section id=(sheet.name) {
            h2 { (sheet.title) }
            p { (sheet.text) }
            @for scene in scenes {
                h3 { (scene) }
                div.cells {
                    @for cell in sheet.cells.iter().filter(|cell| cell.scene == scene) { (figure(cell)?) }
                }
            }
        }
    })
}

fn figure(cell: &Cell) -> Result<Markup, Error> {
    Ok(html! {
        figure {
            div.pair {
                (image(&cell.raster_picture, &alt(cell, "rasterized"))?)
                (image(&cell.trace_picture, &alt(cell, "traced"))?)
            }
            figcaption {
                strong { (cell.setting) }
                div.errors {
                    @for (_, f) in cell.figures() {
                        span { span.over[f.error > cell.bar] { (value(f.error)) } }
                    }
                }
                "Triangles " (value(cell.mesh_rmse))
                @for (renderer, f) in cell.figures() {
                    @if f.fault(cell.bar) { p.fault { (fault(renderer, f)) } }
                    @else if let Some(condition) = &f.condition { p.why { (why(renderer, f, condition)) } }
                }
            }
        }
    })
}

fn alt(cell: &Cell, how: &str) -> String {
    format!("{}, {}, {how}", cell.scene, cell.setting)
}

fn image(picture: &Plane<[f32; 3]>, alt: &str) -> Result<Markup, Error> {
    let source = format!(
        "data:image/png;base64,{}",
        BASE64.encode(png(picture, View::Linear)?)
    );
    Ok(html! {
        img src=(source) alt=(alt) width=(picture.width) height=(picture.height) loading="lazy";
    })
}

/// What the scene's conditioning says of a figure.
fn why(renderer: &str, figure: &Figure, condition: &Condition) -> Markup {
    let pixels = |n: usize| format!("{} pixel{}", count(n), if n == 1 { "" } else { "s" });
    html! {
        b { (sentence_name(renderer)) ", ill-conditioned in " (condition.input) "." }
        " Half an ulp moves a value by " (value(condition.change)) ": condition " (rounded(condition.number))
        @if condition.objects > 0 { ", and " (pixels(condition.objects)) " to another object" }
        ". Over the bar: " (pixels(figure.over))
        @if figure.objects > 0 { "; another object: " (pixels(figure.objects)) }
        ". Arithmetic " (value(figure.arithmetic)) "."
    }
}

fn fault(renderer: &str, figure: &Figure) -> Markup {
    html! {
        b { (sentence_name(renderer)) " at fault." }
        " Arithmetic off by " (value(figure.arithmetic)) ", " (count(figure.wrong)) " wrong decisions, "
        (count(figure.not_numbers)) " values that are no numbers."
    }
}

/// A condition number: three digits, grouped as long as that is short.
fn rounded(number: f64) -> String {
    let digits: f64 = format!("{number:.2e}").parse().unwrap_or(number);
    if (1e3..1e7).contains(&digits) {
        count(digits as usize)
    } else {
        value(digits)
    }
}

fn sentence_name(renderer: &str) -> &'static str {
    if renderer == "raster" {
        "Rasterizer"
    } else {
        "Tracer"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure(error: f64, condition: Option<Condition>) -> Figure {
        Figure {
            error,
            arithmetic: 1e-7,
            not_numbers: 0,
            objects: 0,
            wrong: 0,
            over: usize::from(error > BAR),
            condition,
        }
    }

    fn atlas(raster: Figure) -> Atlas {
        let picture = Plane::filled(4, 3, [0.5; 3]);
        let cell = Cell {
            scene: "whitted",
            setting: "x 100".into(),
            bar: BAR,
            raster,
            trace: figure(1e-7, None),
            mesh_rmse: 0.01,
            mesh_pixels: 0,
            raster_picture: picture.clone(),
            trace_picture: picture,
        };
        let (name, title, text) = ("scale", "Scale", "All of it.");
        Atlas {
            size: [4, 3],
            level: 8,
            sheets: vec![Sheet {
                name,
                title,
                text,
                cells: vec![cell],
            }],
        }
    }

    #[test]
    fn the_page_says_what_holds_and_what_is_ill_conditioned() {
        let held = page(&atlas(figure(1e-7, None)), "rastray trade --extremes").unwrap();
        assert!(held.contains("Of 2 figures 2 agree"));
        assert!(held.contains("extremes.csv") && held.contains("extremes.json"));
        assert_eq!(
            summary(&atlas(figure(1e-7, None))),
            "2 of 2 figures agree within the bar; 0 are of ill-conditioned scenes; none at fault."
        );
        assert!(!held.contains("class=\"why\"") && !held.contains("class=\"fault\""));
        let condition = Condition {
            input: "lights",
            change: 0.25,
            number: 0.25 * 16_777_216.0 - 4e3,
            objects: 0,
        };
        let ill = page(&atlas(figure(0.2, Some(condition.clone()))), "x").unwrap();
        assert!(ill.contains("ill-conditioned in lights") && ill.contains("4,190,000"));
        let mut wrong = figure(0.2, Some(condition));
        wrong.wrong = 3;
        assert!(summary(&atlas(wrong.clone())).ends_with("; 1 at fault."));
        let fault = page(&atlas(wrong), "x").unwrap();
        assert!(fault.contains("3 wrong decisions") && fault.contains("are at fault"));
        assert!(!fault.contains("src=\"http"));
    }

    #[test]
    fn the_table_has_a_line_a_figure() {
        let text = csv(&atlas(figure(1e-7, None)));
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 3);
        let columns = lines[0].split(',').count();
        assert!(
            lines.iter().all(|line| line.split(',').count() == columns),
            "{text}"
        );
    }
}
