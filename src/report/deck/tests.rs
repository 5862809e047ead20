//! The deck's files say what its slides do, each in its own format.

use super::*;
use crate::gl::SpecularModel;
use crate::report::equation::Term;
use crate::report::topic::Topic;
use rastray_compare::{Reduction, signed_map};

/// A slide with a text that every format must escape.
fn slide(stem: &str, topic: Topic, width: usize, height: usize) -> Slide {
    let plane = |k: f32| Plane::filled(width, height, [k, 0.5 * k, 0.25]);
    let d: Vec<[f64; 3]> = (0..width * height)
        .map(|i| [(i % width) as f64 / width as f64; 3])
        .collect();
    Slide {
        stem: stem.into(),
        head: Head {
            question: "Is 5% of a_b & <c> $1?".into(),
            answer: "Yes, K_T^2 --set #1 {x} \\y ~z.".into(),
            paragraphs: vec!["A *note* with `code`.".into()],
            terms: Vec::new(),
        },
        topics: Topics(vec![topic]),
        form: Form {
            specular: SpecularModel::Reflection,
            mirror_is_specular: true,
        },
        view: View::Linear,
        raster: plane(0.5),
        trace: plane(1.0),
        difference: signed_map(width, height, &d, Reduction::Largest).unwrap(),
    }
}

fn size(png_bytes: &[u8]) -> (u32, u32) {
    let info = png::Decoder::new(std::io::Cursor::new(png_bytes))
        .read_info()
        .unwrap();
    (info.info().width, info.info().height)
}

fn deck() -> Deck {
    let topics = [Topic::Term(Term::Diffuse), Topic::Shininess];
    let slides = topics.map(|topic| slide(topic.name(), topic, 96, 54));
    Deck {
        command: "rastray lecture 'a --> b.toml'".into(),
        entries: slides.map(|s| s.finish().unwrap().1).into(),
    }
}

fn text(name: &str) -> String {
    let files = deck().files();
    let file = files.iter().find(|file| file.name == name).unwrap();
    String::from_utf8(file.bytes.clone()).unwrap()
}

#[test]
fn four_pictures_of_one_size_and_small_ones_inside() {
    for (width, height) in [(1, 1), (96, 54), (300, 900), (1920, 1080)] {
        let (files, entry) = slide("a", Topic::Sum, width, height).finish().unwrap();
        let names: Vec<&str> = files.iter().map(|f| f.name.as_str()).collect();
        assert_eq!(
            names,
            [
                "a-raster.png",
                "a-trace.png",
                "a-difference.png",
                "a-equation.png"
            ]
        );
        for file in &files {
            assert_eq!(
                size(&file.bytes),
                (width as u32, height as u32),
                "{}",
                file.name
            );
        }
        assert_eq!(entry.pictures.len(), 3);
        let (_, w, h) = entry.pictures[0];
        assert!(
            w <= 1440 && w.abs_diff(width * h / height) <= 1,
            "{w} x {h}"
        );
    }
}

#[test]
fn the_map_keeps_its_pixels_but_for_the_legend_where_least_is_hidden() {
    // The difference grows to the right, so the legend stands at the left.
    let slide = slide("a", Topic::Sum, 960, 540);
    let map = Picture::from_map(&slide.difference);
    let shown = slide::with_legend(&map).unwrap();
    let changed: Vec<usize> = (0..map.pixels.len())
        .filter(|i| shown.pixels[*i] != map.pixels[*i])
        .map(|i| i % 960)
        .collect();
    assert!(!changed.is_empty() && changed.iter().all(|x| *x < 480));
    assert!(changed.len() <= 280 * 66);
    // No room for a legend: the map as it is.
    let tiny = Picture::from_map(&signed_map(2, 2, &[[0.0; 3]; 4], Reduction::Largest).unwrap());
    assert_eq!(slide::with_legend(&tiny).unwrap(), tiny);
}

#[test]
fn the_equations_of_two_topics_differ_where_they_are_lit() {
    let lit = |topic| {
        let slide = slide("a", topic, 960, 540);
        slide::equation(&slide, 960, 540).unwrap()
    };
    let (diffuse, shadow) = (
        lit(Topic::Term(Term::Diffuse)),
        lit(Topic::Term(Term::Shadow)),
    );
    let marks = |p: &Picture| -> Vec<usize> {
        let mark = crate::report::layout::MARK;
        let at = p.pixels.iter().enumerate().filter(|(_, c)| **c == mark);
        at.map(|(i, _)| i % 960).collect()
    };
    let (a, b) = (marks(&diffuse), marks(&shadow));
    // K_D (N·L) stands left of S_L.
    assert!(!a.is_empty() && !b.is_empty());
    assert!(a.iter().max() < b.iter().min());
}

#[test]
fn long_texts_shrink_and_are_cut_but_never_leave_the_slide() {
    let mut long = slide("a", Topic::Sum, 480, 270);
    long.head.question = "Why? ".repeat(3000);
    long.head.answer = "W".repeat(3000);
    assert!(slide::equation(&long, 480, 270).is_ok());
}

#[test]
fn every_text_names_every_picture() {
    for name in ["figures.md", "figures.tex"] {
        let text = text(name);
        for stem in ["diffuse", "shininess"] {
            for kind in ["raster", "trace", "difference", "equation"] {
                assert!(
                    text.contains(&format!("{{{stem}-{kind}.png}}"))
                        || text.contains(&format!("({stem}-{kind}.png)")),
                    "{name}: {stem}-{kind}"
                );
            }
        }
    }
}

#[test]
fn latex_is_escaped_and_lights_the_terms() {
    let tex = text("figures.tex");
    assert!(tex.contains("Is 5\\% of a\\_b \\& \\textless{}c\\textgreater{} \\$1?"));
    assert!(
        tex.contains(
            "$K_{T}$$^{2}$ -{}-{}set \\#1 \\{x\\} \\textbackslash{}y \\textasciitilde{}z."
        )
    );
    assert!(tex.contains(
        "I = I_{E} + K_{A} I_{AL} + \\sum _{L} (\\rastraylit{K_{D} (N \\cdot L)} + K_{S} (V \\cdot R)^{n}) S_{L} I_{L}"
    ), "{tex}");
    assert!(tex.contains("(V \\cdot R){}^{\\rastraylit{\\scriptstyle n}}) S_{L}"));
    let balance = |open: char, close: char| {
        let escaped = tex.replace("\\{", "").replace("\\}", "");
        escaped.matches(open).count() as i64 - escaped.matches(close).count() as i64
    };
    assert_eq!(balance('{', '}'), 0);
    assert_eq!(tex.matches("\\begin{figure}[htbp]").count(), 2);
    assert!(
        tex.lines()
            .next()
            .unwrap()
            .starts_with("% Made by rastray: rastray lecture")
    );
}

#[test]
fn markdown_shows_the_equation_with_its_terms_in_a_box() {
    let md = text("figures.md");
    assert!(
        md.contains("\\boxed{K_{D} (N \\cdot L)}") && md.contains("{}^{\\boxed{\\scriptstyle n}}")
    );
    assert!(md.contains("Is 5% of a\\_b &amp; &lt;c&gt; \\$1?"));
    assert!(md.contains("A \\*note\\* with \\`code\\`."));
}

#[test]
fn the_page_needs_nothing_else_and_can_be_heard() {
    let page = text("index.html");
    assert!(page.starts_with("<!DOCTYPE html><html lang=\"en\">"));
    assert!(!page.contains("http") && !page.contains("<link") && !page.contains("@LIGHT@"));
    assert!(!page.contains("base64,@"));
    for (at, _) in page.match_indices(" src=\"") {
        assert!(page[at..].starts_with(" src=\"data:image/png;base64,iVB"));
    }
    let count = |what: &str| page.matches(what).count();
    assert_eq!(count("<img "), 6);
    assert_eq!(count(" alt=\""), 6);
    assert_eq!(count("aria-roledescription=\"slide\""), 2);
    assert_eq!(count("<h1"), 1);
    assert_eq!(count("<h2"), 2);
    // The whole equation, and one for each slide.
    assert_eq!(count("role=\"math\""), 3);
    assert!(page.contains("<mark class=\"new\"><var>K</var><sub><var>D</var></sub> ("));
    assert!(page.contains("<mark class=\"new\"><sup><var>n</var></sup></mark>"));
    assert!(page.contains("Is 5% of a_b &amp; &lt;c&gt; $1?"));
    assert!(page.contains("href=\"#shininess\"") && page.contains("id=\"shininess\""));
    assert!(page.contains("a --&gt; b.toml"));
}

#[test]
fn a_scene_that_says_nothing_has_its_name_and_the_whole_equation() {
    let mut bare = slide("bare", Topic::Sum, 96, 54);
    (bare.head, bare.topics) = (Head::default(), Topics::default());
    let deck = Deck {
        command: String::new(),
        entries: vec![bare.finish().unwrap().1],
    };
    let page = deck.to_html();
    assert!(
        page.contains("One equation, one question")
            && page.contains("<h2 tabindex=\"-1\">bare</h2>")
    );
    assert!(!page.contains("<mark") && !page.contains("class=\"dim\""));
    assert!(
        !deck.to_latex().contains("\\rastraylit{I") && deck.to_markdown().contains("## bare: bare")
    );
}

#[test]
fn an_empty_deck_is_a_deck() {
    let deck = Deck {
        command: String::new(),
        entries: Vec::new(),
    };
    assert_eq!(deck.files().len(), 3);
}
