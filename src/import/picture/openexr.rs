//! OpenEXR through the `exr` package: the channels R, G, B (or Y) of the picture or of one of its layers.
//!
//! The pixels of the file's data window are placed in its display window, which is the picture; the rest of it is 0. Colours are
//! premultiplied by alpha, so they are those of the picture over black.

use std::io::Cursor;

use exr::prelude::{
    IntegerBounds, LayerAttributes, MetaData, ReadChannels, ReadLayers, ReadSpecificChannel, Text,
    Vec2, attribute::AttributeValue, read as reading,
};
use rastray_compare::Encoding;

use super::{Assumed, Decoded, Trouble, checked_size};
use crate::frame::Plane;

/// Values of all channels that a file may hold, since whole rows of all of them are unpacked.
const MAX_VALUES: u64 = 1 << 30;

/// The picture, or the layer of that name.
pub(super) fn read(bytes: &[u8], layer: Option<&str>) -> Result<Decoded, Trouble> {
    let data = MetaData::read_from_buffered(Cursor::new(bytes), true).map_err(Trouble::broken)?;
    check(&data)?;
    let prefix = layer.map_or(String::new(), |layer| format!("{layer}."));
    let names = ["R", "G", "B", "Y", "A"].map(|c| format!("{prefix}{c}"));
    let complete = |part: &exr::meta::header::Header| {
        let has = |name: &String| {
            part.channels
                .list
                .iter()
                .any(|c| c.name.to_string() == *name)
        };
        names[..3].iter().all(has) || has(&names[3])
    };
    let Some(part) = data.headers.iter().position(complete) else {
        return Err(missing(&data, &prefix));
    };
    let display = data.headers[part].shared_attributes.display_window;
    let (filled, attributes) = fill(bytes, &names, part)?;
    let mut notes = Vec::new();
    if filled.clear > 0 {
        notes.push(format!(
            "{} pixels are not opaque; they are taken as shown over black",
            filled.clear
        ));
    }
    let pixels = placed(filled, attributes.layer_position, display, &mut notes)?;
    Ok(Decoded {
        bits: None,
        pixels,
        assumed: encoding(&attributes),
        notes,
    })
}

/// Refuses what is too large, and deep data, before anything is unpacked.
fn check(data: &MetaData) -> Result<(), Trouble> {
    let mut values = 0u64;
    for part in &data.headers {
        let (width, height) = (
            part.layer_size.width() as u64,
            part.layer_size.height() as u64,
        );
        checked_size(width, height)?;
        values = values.saturating_add(part.channels.list.len() as u64 * width * height);
        if values > MAX_VALUES {
            return Err(Trouble::TooLarge(width, height));
        }
        if part.deep {
            let message = "is a deep EXR, which holds many values a pixel".to_owned();
            return Err(Trouble::Unsupported(message, "flatten it first".to_owned()));
        }
    }
    Ok(())
}

/// What to say of a file without the asked channels: the layers that it has.
fn missing(data: &MetaData, prefix: &str) -> Trouble {
    let channels = data.headers.iter().flat_map(|part| &part.channels.list);
    let layer = |name: String| Some(name.rsplit_once('.')?.0.to_owned());
    let mut layers: Vec<String> = channels.filter_map(|c| layer(c.name.to_string())).collect();
    layers.dedup();
    let help = match layers.len() {
        0 => "write the picture with the channels R, G and B".to_owned(),
        _ => format!("choose a layer with --layer: {}", layers.join(", ")),
    };
    let message = format!("holds neither {prefix}R, {prefix}G, {prefix}B nor {prefix}Y");
    Trouble::Unsupported(message, help)
}

/// The pixels of one part's data window, and what the part says of itself.
fn fill(
    bytes: &[u8],
    names: &[String; 5],
    part: usize,
) -> Result<(Filled, LayerAttributes), Trouble> {
    let [r, g, b, y, a] = names;
    let image = reading()
        .no_deep_data()
        .largest_resolution_level()
        .specific_channels()
        .optional(r.as_str(), 0.0f32)
        .optional(g.as_str(), 0.0f32)
        .optional(b.as_str(), 0.0f32)
        .optional(y.as_str(), 0.0f32)
        .optional(a.as_str(), 1.0f32)
        .collect_pixels(
            |size, (r, g, b, y, _)| {
                let color = r.is_some() && g.is_some() && b.is_some();
                Filled::new(size, color, color || y.is_some())
            },
            |filled: &mut Filled, at, (r, g, b, y, a): (f32, f32, f32, f32, f32)| {
                filled.set(at, [r, g, b], y, a);
            },
        )
        .all_layers()
        .all_attributes()
        .non_parallel()
        .pedantic()
        .from_buffered(Cursor::new(bytes))
        .map_err(Trouble::broken)?;
    let found = image.layer_data.into_iter().nth(part);
    let found = found.ok_or_else(|| Trouble::broken("a part is missing"))?;
    Ok((found.channel_data.pixels, found.attributes))
}

/// A data window while it is filled.
struct Filled {
    size: Vec2<usize>,
    /// R, G, B count, not Y.
    color: bool,
    /// Empty for parts without the asked channels.
    data: Vec<[f32; 3]>,
    /// Pixels that are not opaque.
    clear: usize,
}

impl Filled {
    fn new(size: Vec2<usize>, color: bool, wanted: bool) -> Self {
        Self {
            size,
            color,
            data: vec![[0.0; 3]; if wanted { size.area() } else { 0 }],
            clear: 0,
        }
    }

    fn set(&mut self, at: Vec2<usize>, rgb: [f32; 3], grey: f32, alpha: f32) {
        let index = at.y() * self.size.width() + at.x();
        if let Some(pixel) = self.data.get_mut(index) {
            *pixel = if self.color { rgb } else { [grey; 3] };
            self.clear += usize::from(alpha != 1.0);
        }
    }
}

/// The data window in the display window.
fn placed(
    filled: Filled,
    position: Vec2<i32>,
    display: IntegerBounds,
    notes: &mut Vec<String>,
) -> Result<Plane<[f32; 3]>, Trouble> {
    let (width, height) = (display.size.width() as u64, display.size.height() as u64);
    let (width, height) = checked_size(width, height)?;
    if position == display.position && filled.size == display.size {
        return Ok(Plane {
            width,
            height,
            data: filled.data,
        });
    }
    notes.push(format!(
        "{} x {} pixels of data are placed in a picture of {width} x {height}, as its windows say; the rest is black",
        filled.size.width(),
        filled.size.height()
    ));
    let mut plane = Plane::filled(width, height, [0.0; 3]);
    let offset = |axis: fn(&Vec2<i32>) -> i32| {
        i64::from(axis(&position)) - i64::from(axis(&display.position))
    };
    let (left, top) = (offset(|v| v.0), offset(|v| v.1));
    for (i, pixel) in filled.data.iter().enumerate() {
        let x = left + (i % filled.size.width()) as i64;
        let y = top + (i / filled.size.width()) as i64;
        if (0..width as i64).contains(&x) && (0..height as i64).contains(&y) {
            plane.data[y as usize * width + x as usize] = *pixel;
        }
    }
    Ok(plane)
}

/// EXR holds light, unless this program wrote it through a view transform.
fn encoding(attributes: &LayerAttributes) -> Assumed {
    let key = Text::from_slice_unchecked(b"rastray:encoding");
    match attributes.other.get(&key) {
        Some(AttributeValue::Text(text)) if *text == *"srgb" => {
            Assumed::new(Encoding::Srgb, "rastray wrote it and says so")
        }
        _ => Assumed::new(Encoding::Linear, "EXR files hold light"),
    }
}
