//! Material libraries (MTL) to materials and optics.
//!
//! `tobj` reads the statements; a thin scan before it checks numbers (with their places, which `tobj` does not give),
//! completes `Kd 0.5` to three components (`tobj` panics on fewer) and keeps from it what is dropped. Names run to the
//! end of the line; `tobj` gets numbers for them, since they are bytes. A material that cannot be read is an error only
//! where a face needs it. Which terms a material has follows `illum` (Ramey, Rose, Tyerman 1995; default 2 where K_s > 0, else 1):
//!
//! | illum | taken as |
//! | - | - |
//! | 0 | the constant colour K_d: emission, nothing lit |
//! | 1, 2 | ambient and diffuse; 2 adds specular |
//! | 3, 5 | 2 and a mirror of weight K_s (the Fresnel factor of 5 is dropped) |
//! | 4 | 3 and straight-through transmission of weight (1 - d) Tf |
//! | 6 | 3 and refraction of weight (1 - K_s) Tf with index Ni |
//! | 7 | refraction of weight (1 - K_s) Tf with index Ni, shared with the mirror by Fresnel's equations |
//! | 8, 9, 10 | 2: maps, blending and shadow catchers are dropped |
//!
//! Values that the library leaves out are OpenGL's defaults. Textures (`map_*`, `bump`, `refl`, ...) are dropped.

use std::ops::Range;

use super::names::shown;
use super::words::{Words, line_at, place};
use crate::error::{Error, Note};
use crate::import::text::decode;
use crate::math::color::Rgb;
use crate::scene::{Fresnel, Material, Optics};

/// A material of a library.
#[derive(Debug)]
pub(super) struct Entry {
    /// As the bytes it is.
    pub(super) name: Vec<u8>,
    /// Or why it cannot be read.
    pub(super) material: Result<Material, Error>,
}

/// Reads a library; the notes say what was dropped or doubted.
pub(super) fn read(file: &str, bytes: &[u8], notes: &mut Vec<Note>) -> Result<Vec<Entry>, Error> {
    let mut cleaner = Cleaner {
        file,
        bytes,
        clean: String::new(),
        named: Vec::new(),
        dropped: Vec::new(),
    };
    let mut start = if bytes.starts_with(b"\xef\xbb\xbf") {
        3
    } else {
        0
    };
    while start < bytes.len() {
        let line = line_at(bytes, start, is_keyword);
        cleaner.line(start..line.end, line.stray)?;
        start = line.next.max(line.end + 1);
    }
    let (parsed, _) = tobj::load_mtl_buf(&mut cleaner.clean.as_bytes())
        .map_err(|e| cleaner.error(0..0, format!("the material library cannot be read: {e}")))?;
    notes.append(&mut cleaner.dropped);
    let mut entries = Vec::with_capacity(parsed.len());
    for (material, named) in parsed.iter().zip(cleaner.named) {
        let name = Words::joined(bytes, named.line.clone());
        if let Some(error) = named.error {
            let material = Err(error);
            entries.push(Entry { name, material });
            continue;
        }
        let mut doubts = Vec::new();
        let mut material = convert(material, &mut doubts);
        material.name = shown(&name);
        let place = place(file, bytes, named.line);
        notes.extend(doubts.into_iter().map(|message| Note {
            place: Some(place.clone()),
            message: format!("material {}: {message}", material.name),
        }));
        let material = Ok(material);
        entries.push(Entry { name, material });
    }
    Ok(entries)
}

/// Whether a word is one of MTL's statements.
fn is_keyword(word: &[u8]) -> bool {
    #[rustfmt::skip] // a table
    const KNOWN: [&[u8]; 26] = [
        b"newmtl", b"Ka", b"Kd", b"Ks", b"Ke", b"Tf", b"Ns", b"Ni", b"d", b"Tr", b"illum", b"sharpness", b"bump", b"disp",
        b"decal", b"refl", b"norm", b"Pr", b"Pm", b"Ps", b"Pc", b"Pcr", b"aniso", b"anisor", b"Km", b"Kt",
    ];
    KNOWN.contains(&word) || word.starts_with(b"map_")
}

/// Where a material is named, and the first thing that is wrong with it.
struct Named {
    line: Range<usize>,
    error: Option<Error>,
}

/// Checks the statements and writes those that `tobj` is to read.
struct Cleaner<'a> {
    file: &'a str,
    bytes: &'a [u8],
    clean: String,
    named: Vec<Named>,
    dropped: Vec<Note>,
}

impl Cleaner<'_> {
    fn text(&self, span: Range<usize>) -> String {
        decode(&self.bytes[span]).into_owned()
    }

    fn error(&self, span: Range<usize>, message: impl Into<String>) -> Error {
        Error::input(place(self.file, self.bytes, span), message)
    }

    fn note(&mut self, span: Range<usize>, message: String) {
        // A library of nothing but strange lines must not make a long list.
        if self.dropped.len() < 256 {
            self.dropped.push(Note {
                place: Some(place(self.file, self.bytes, span)),
                message,
            });
        }
    }

    fn write(&mut self, keyword: &str, values: &[String]) {
        self.clean.push_str(keyword);
        for value in values {
            self.clean.push(' ');
            self.clean.push_str(value);
        }
        self.clean.push('\n');
    }

    fn line(&mut self, line: Range<usize>, stray: bool) -> Result<(), Error> {
        if stray {
            let end = line.start + self.bytes[line.clone()].trim_ascii_end().len();
            let message = "the `\\` at the end of this line does not join the next one to it, which is a statement";
            self.note(end - 1..end, message.into());
        }
        let mut words = Words::new(self.bytes, line);
        let Some(keyword) = words.next() else {
            return Ok(());
        };
        let name = self.text(keyword.clone());
        if name == "newmtl" {
            let rest = words.rest();
            if rest.is_empty() {
                return Err(self.error(keyword, "`newmtl` needs a name"));
            }
            self.write("newmtl", &[self.named.len().to_string()]);
            self.named.push(Named {
                line: rest,
                error: None,
            });
            return Ok(());
        }
        if self.named.is_empty() {
            self.note(
                keyword,
                format!("`{name}` before the first newmtl: dropped"),
            );
            return Ok(());
        }
        if let Err(error) = self.statement(&name, keyword, words)
            && let Some(named) = self.named.last_mut()
        {
            named.error.get_or_insert(error);
        }
        Ok(())
    }

    /// A statement about a material.
    fn statement(
        &mut self,
        name: &str,
        keyword: Range<usize>,
        words: Words<'_>,
    ) -> Result<(), Error> {
        match name {
            "Ka" | "Kd" | "Ks" | "Ke" | "Tf" => self.color(name, keyword, words),
            "Ns" | "Ni" | "d" | "Tr" => self.scalar(name, keyword, words),
            "illum" => self.illum(keyword, words),
            _ => {
                self.note(keyword, format!("`{name}` is dropped"));
                Ok(())
            }
        }
    }

    /// A finite number, in tobj's spelling.
    fn number(&self, word: Range<usize>) -> Result<(f64, String), Error> {
        let text = self.text(word.clone());
        match text.parse::<f64>() {
            Ok(x) if x.is_finite() && x.abs() <= f64::from(f32::MAX) => Ok((x, text)),
            Ok(_) => Err(self.error(word, format!("expected a finite number, found `{text}`"))),
            Err(_) => Err(self.error(word, format!("expected a number, found `{text}`"))),
        }
    }

    fn color(&mut self, name: &str, keyword: Range<usize>, words: Words<'_>) -> Result<(), Error> {
        let words: Vec<Range<usize>> = words.take(3).collect();
        let first = words
            .first()
            .map(|w| self.text(w.clone()))
            .unwrap_or_default();
        if first == "spectral" || first == "xyz" {
            return Err(Error::Unsupported {
                place: Some(Box::new(place(self.file, self.bytes, keyword))),
                message: format!("`{name} {first}` is not supported: write red, green and blue"),
                help: None,
            });
        }
        let mut values = Vec::new();
        for word in &words {
            values.push(self.number(word.clone())?.1);
        }
        match values.len() {
            1 => values = vec![values[0].clone(), values[0].clone(), values[0].clone()],
            3 => {}
            found => {
                let message = format!("`{name}` needs 1 or 3 numbers, found {found}");
                return Err(self.error(keyword, message));
            }
        }
        self.write(name, &values);
        Ok(())
    }

    fn scalar(&mut self, name: &str, keyword: Range<usize>, words: Words<'_>) -> Result<(), Error> {
        let mut words = words.peekable();
        if words
            .peek()
            .is_some_and(|w| &self.bytes[w.clone()] == b"-halo")
        {
            let span = words.next().unwrap_or_else(|| keyword.clone());
            self.note(span, "`-halo` is dropped".into());
        }
        let Some(word) = words.next() else {
            return Err(self.error(keyword, format!("`{name}` needs a number")));
        };
        let (x, text) = self.number(word.clone())?;
        if name == "Ns" && x < 0.0 {
            return Err(self.error(word, format!("expected Ns 0 or more, found {x}")));
        }
        self.write(name, &[text]);
        Ok(())
    }

    fn illum(&mut self, keyword: Range<usize>, mut words: Words<'_>) -> Result<(), Error> {
        let Some(word) = words.next() else {
            return Err(self.error(keyword, "`illum` needs a number"));
        };
        let (x, text) = self.number(word.clone())?;
        if x.fract() == 0.0 && (0.0..=10.0).contains(&x) {
            self.write("illum", &[format!("{x}")]);
        } else {
            self.note(
                word,
                format!("there is no illumination model {text}: dropped"),
            );
        }
        Ok(())
    }
}

/// The material that a library's entry describes.
fn convert(parsed: &tobj::Material, doubts: &mut Vec<String>) -> Material {
    let mut material = super::default_material();
    let front = &mut material.front;
    front.ambient = parsed.ambient.unwrap_or(front.ambient);
    front.diffuse = parsed.diffuse.unwrap_or(front.diffuse);
    front.specular = parsed.specular.unwrap_or(front.specular);
    front.emission = parsed.emissive.unwrap_or(front.emission);
    front.shininess = parsed.shininess.unwrap_or(front.shininess);
    let shiny = front.specular.iter().any(|x| *x > 0.0);
    let illum = parsed
        .illumination_model
        .unwrap_or(if shiny { 2 } else { 1 });
    let (ks, kd) = (front.specular, front.diffuse);
    if illum == 0 {
        front.emission = std::array::from_fn(|c| front.emission[c] + kd[c]);
        (front.ambient, front.diffuse) = ([0.0; 3], [0.0; 3]);
    }
    if illum < 2 {
        front.specular = [0.0; 3];
    }
    for violation in front.range_violations() {
        doubts.push(crate::import::strict::refusal(&violation));
    }
    material.optics = optics(parsed, illum, ks, doubts);
    material
}

fn optics(parsed: &tobj::Material, illum: u8, ks: Rgb, doubts: &mut Vec<String>) -> Optics {
    let filter = color_of(parsed, "Tf").unwrap_or([1.0; 3]);
    let opacity = opacity(parsed, doubts);
    let index = parsed.optical_density.unwrap_or(1.0);
    let index = if index > 0.0 {
        index
    } else {
        doubts.push(format!("Ni {index} is taken as 1"));
        1.0
    };
    let through: Rgb = std::array::from_fn(|c| (1.0 - ks[c]) * filter[c]);
    let mut optics = Optics::default();
    match illum {
        3 => optics.reflection = ks,
        4 => {
            optics.reflection = ks;
            optics.transmission = filter.map(|f| (1.0 - opacity) * f);
            optics.thin = true;
        }
        5 => {
            optics.reflection = ks;
            doubts.push("illum 5: the Fresnel factor of its mirror is dropped".into());
        }
        6 => {
            (optics.reflection, optics.transmission, optics.ior) = (ks, through, index);
        }
        7 => {
            (optics.transmission, optics.ior) = (through, index);
            optics.fresnel = Fresnel::Dielectric;
        }
        8 => doubts.push("illum 8: the reflection map is dropped".into()),
        9 => doubts.push("illum 9: blending is dropped, the surface is opaque".into()),
        10 => doubts.push("illum 10: shadow catchers are not supported; drawn as illum 2".into()),
        _ => {}
    }
    if opacity != 1.0 && illum != 4 {
        doubts.push(format!("d = {opacity} has no effect under illum {illum}"));
    }
    optics
}

/// `d`, or 1 - `Tr`; where both are given and disagree, `d`.
fn opacity(parsed: &tobj::Material, doubts: &mut Vec<String>) -> f64 {
    let transparency = parsed
        .unknown_param
        .get("Tr")
        .and_then(|text| text.parse::<f64>().ok());
    match (parsed.dissolve, transparency) {
        // Both are decimals, mostly of 32-bit numbers.
        (Some(d), Some(tr)) if (d + tr - 1.0).abs() > f64::from(f32::EPSILON) => {
            doubts.push(format!("d {d} and Tr {tr} disagree: d is used"));
            d
        }
        (Some(d), _) => d,
        (None, Some(tr)) => 1.0 - tr,
        (None, None) => 1.0,
    }
}

fn color_of(parsed: &tobj::Material, name: &str) -> Option<Rgb> {
    let text = parsed.unknown_param.get(name)?;
    let mut numbers = text.split_whitespace().map(|word| word.parse::<f64>().ok());
    Some([numbers.next()??, numbers.next()??, numbers.next()??])
}
