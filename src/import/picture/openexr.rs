//! OpenEXR through the `exr` package: the channels R, G, B (or those of them that there are), Y, or Y, RY and BY of the
//! picture or of one of its layers. Parts and views are layers, too, by their names; a layer with one channel is grey.
//!
//! The pixels of the file's data window are placed in its display window, which is the picture; the rest of it is 0. Colours are
//! premultiplied by alpha, so they are those of the picture over black.

mod luminance;
mod subsampled;

use std::io::Cursor;

use exr::meta::header::Header;
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
    let data = match MetaData::read_from_buffered(Cursor::new(bytes), true) {
        Err(exr::error::Error::NotSupported(what)) if what.contains("subsampling") => {
            return subsampled_picture(bytes, layer);
        }
        data => data.map_err(refused)?,
    };
    let halved = |part: &Header| part.channels.list.iter().any(|c| c.sampling != Vec2(1, 1));
    if data.headers.iter().any(halved) {
        return subsampled_picture(bytes, layer);
    }
    check(&data)?;
    let Some(choice) = choose(&data, layer) else {
        return Err(missing(&data, layer));
    };
    let mut notes = Vec::new();
    if layer.is_none() {
        notes.extend(choice.others(&data));
    }
    notes.extend(choice.absent(&data));
    let part = &data.headers[choice.part];
    let display = part.shared_attributes.display_window;
    let primaries = part
        .shared_attributes
        .chromaticities
        .map(|c| [c.red, c.green, c.blue, c.white].map(|v| [f64::from(v.x()), f64::from(v.y())]));
    let yw = primaries.and_then(luminance::weights);
    let yw = yw.unwrap_or_else(luminance::default_weights);
    let (filled, attributes) = fill(bytes, &choice, yw)?;
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
        orientation: 1,
        assumed: encoding(&attributes),
        notes,
    })
}

/// A picture with subsampled chroma.
fn subsampled_picture(bytes: &[u8], layer: Option<&str>) -> Result<Decoded, Trouble> {
    if let Some(layer) = layer {
        let message = format!("this EXR holds luminance and chroma only, no layer {layer}");
        return Err(Trouble::Unsupported(
            message,
            "compare it without --layer".into(),
        ));
    }
    let found = subsampled::read(bytes)?;
    let filled = Filled {
        size: Vec2(found.pixels.width, found.pixels.height),
        kind: Kind::Chroma(luminance::default_weights()),
        data: found.pixels.data,
        clear: 0,
    };
    let position = |(left, top, ..): subsampled::Window| Vec2(left as i32, top as i32);
    let display = IntegerBounds {
        position: position(found.display),
        size: Vec2(found.display.2, found.display.3),
    };
    let half = "its chroma of every other pixel is filled in with OpenEXR's filter";
    let mut notes = vec![half.to_owned()];
    let pixels = placed(filled, position(found.data), display, &mut notes)?;
    Ok(Decoded {
        bits: None,
        pixels,
        orientation: 1,
        assumed: Assumed::new(Encoding::Linear, "EXR files hold light"),
        notes,
    })
}

/// Why the package refused a file: its kind, or what is in it.
fn refused(error: exr::error::Error) -> Trouble {
    match error {
        exr::error::Error::NotSupported(what) => {
            let message = format!("this EXR is of a kind that is not read: {what}");
            let help = "write it with ZIP compression and the channels R, G and B";
            Trouble::Unsupported(message, help.into())
        }
        error => Trouble::broken(error),
    }
}

/// Which part of a file is read, and what its channels begin with.
struct Choice {
    part: usize,
    prefix: String,
    /// The only channel of the layer, where it is no known one.
    single: Option<String>,
}

/// The names that a part goes by: its own and that of its view.
fn part_names(part: &Header) -> impl Iterator<Item = String> {
    let own = &part.own_attributes;
    let names = [&own.layer_name, &own.view_name];
    names.into_iter().flatten().map(ToString::to_string)
}

fn channel_names(part: &Header) -> impl Iterator<Item = String> {
    part.channels.list.iter().map(|c| c.name.to_string())
}

impl Choice {
    /// A part's channels with a prefix, where they are a picture.
    fn of(data: &MetaData, part: usize, prefix: &str) -> Option<Self> {
        let own = channel_names(&data.headers[part]);
        let own = own.filter_map(|name| Some(name.strip_prefix(prefix)?.to_owned()));
        let own: Vec<String> = own.filter(|name| !name.contains('.')).collect();
        let known = own
            .iter()
            .any(|name| ["R", "G", "B", "Y"].contains(&name.as_str()));
        let single = match &own[..] {
            [only] if !known && !prefix.is_empty() => Some(format!("{prefix}{only}")),
            _ => None,
        };
        (known || single.is_some()).then(|| Self {
            part,
            prefix: prefix.to_owned(),
            single,
        })
    }

    /// The full name of a channel.
    fn channel(&self, name: &str) -> String {
        format!("{}{name}", self.prefix)
    }

    /// A note about the other parts.
    fn others(&self, data: &MetaData) -> Option<String> {
        let names = |part: &Header| part_names(part).next();
        let others = data
            .headers
            .iter()
            .enumerate()
            .filter(|(i, _)| *i != self.part);
        let others: Vec<String> = others.filter_map(|(_, part)| names(part)).collect();
        let taken = names(&data.headers[self.part]).unwrap_or_else(|| "the first".into());
        (!others.is_empty()).then(|| {
            format!(
                "of its {} parts, {taken} is taken; --layer chooses: {}",
                data.headers.len(),
                others.join(", ")
            )
        })
    }

    /// A note about colours that are not there.
    fn absent(&self, data: &MetaData) -> Option<String> {
        let has = |name: &&str| {
            channel_names(&data.headers[self.part]).any(|own| own == self.channel(name))
        };
        let absent: Vec<&str> = ["R", "G", "B"]
            .into_iter()
            .filter(|name| !has(name))
            .collect();
        let some = (1..3).contains(&absent.len());
        some.then(|| format!("it has no channel {}: taken as 0", absent.join(" and no ")))
    }
}

/// The picture of the file, or the layer of that name: of channels that begin with it, a part or view of that name, or
/// such channels of such a part.
fn choose(data: &MetaData, layer: Option<&str>) -> Option<Choice> {
    let parts = || 0..data.headers.len();
    let Some(layer) = layer else {
        return parts().find_map(|part| Choice::of(data, part, ""));
    };
    let by_channels = parts().find_map(|part| Choice::of(data, part, &format!("{layer}.")));
    let by_part = || {
        parts().find_map(|part| {
            let mut names = part_names(&data.headers[part]);
            let rest = names.find_map(|name| {
                let rest = layer.strip_prefix(&name)?;
                (rest.is_empty() || rest.starts_with('.')).then(|| rest.to_owned())
            })?;
            let prefix = rest
                .strip_prefix('.')
                .map_or(String::new(), |rest| format!("{rest}."));
            Choice::of(data, part, &prefix).or_else(|| single(data, part, &prefix))
        })
    };
    // The first view of a file of one part has no prefix.
    let by_view = || {
        let first = |part: &usize| {
            let views = data.headers[*part].own_attributes.multi_view_names.as_ref();
            let view = views.and_then(|views| views.first());
            view.is_some_and(|view| view == layer)
        };
        parts()
            .find(first)
            .and_then(|part| Choice::of(data, part, ""))
    };
    by_channels.or_else(by_part).or_else(by_view)
}

/// The one channel of a part that has only one.
fn single(data: &MetaData, part: usize, prefix: &str) -> Option<Choice> {
    let own: Vec<String> = channel_names(&data.headers[part]).collect();
    let [only] = &own[..] else {
        return None;
    };
    let single = only.starts_with(prefix).then(|| only.clone())?;
    Some(Choice {
        part,
        prefix: prefix.to_owned(),
        single: Some(single),
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
            let message =
                "this is a deep EXR, which holds many values a pixel: not read".to_owned();
            return Err(Trouble::Unsupported(message, "flatten it first".to_owned()));
        }
    }
    Ok(())
}

/// What to say of a file without the asked channels: the layers that it has.
fn missing(data: &MetaData, layer: Option<&str>) -> Trouble {
    let channels = data.headers.iter().flat_map(channel_names);
    let layer_of = |name: String| Some(name.rsplit_once('.')?.0.to_owned());
    let mut layers: Vec<String> = data.headers.iter().flat_map(part_names).collect();
    layers.extend(channels.filter_map(layer_of));
    let mut seen = std::collections::HashSet::new();
    layers.retain(|layer| seen.insert(layer.clone()));
    let help = match layers.len() {
        0 => "write the picture with the channels R, G and B".to_owned(),
        _ => format!("choose a layer with --layer: {}", layers.join(", ")),
    };
    let prefix = layer.map_or(String::new(), |layer| format!("{layer}."));
    let message = format!("holds neither {prefix}R, {prefix}G, {prefix}B nor {prefix}Y");
    Trouble::Unsupported(message, help)
}

/// The pixels of one part's data window, and what the part says of itself.
fn fill(
    bytes: &[u8],
    choice: &Choice,
    yw: luminance::Weights,
) -> Result<(Filled, LayerAttributes), Trouble> {
    let name = |name: &str| choice.channel(name);
    let grey = choice.single.clone().unwrap_or_else(|| name("Y"));
    let image = reading()
        .no_deep_data()
        .largest_resolution_level()
        .specific_channels()
        .optional(name("R").as_str(), 0.0f32)
        .optional(name("G").as_str(), 0.0f32)
        .optional(name("B").as_str(), 0.0f32)
        .optional(grey.as_str(), 0.0f32)
        .optional(name("RY").as_str(), 0.0f32)
        .optional(name("BY").as_str(), 0.0f32)
        .optional(name("A").as_str(), 1.0f32)
        .collect_pixels(
            |size, (r, g, b, y, ry, by, _)| {
                let kind = match (r.is_some() || g.is_some() || b.is_some(), y.is_some()) {
                    (true, _) => Kind::Color,
                    (false, true) if ry.is_some() && by.is_some() => Kind::Chroma(yw),
                    (false, true) => Kind::Grey,
                    (false, false) => Kind::Nothing,
                };
                Filled::new(size, kind)
            },
            |filled: &mut Filled,
             at,
             (r, g, b, y, ry, by, a): (f32, f32, f32, f32, f32, f32, f32)| {
                filled.set(at, [r, g, b], [y, ry, by], a);
            },
        )
        .all_layers()
        .all_attributes()
        .non_parallel()
        .pedantic()
        .from_buffered(Cursor::new(bytes))
        .map_err(refused)?;
    let found = image.layer_data.into_iter().nth(choice.part);
    let found = found.ok_or_else(|| Trouble::broken("a part is missing"))?;
    Ok((found.channel_data.pixels, found.attributes))
}

/// What a part's channels are.
#[derive(Clone, Copy)]
enum Kind {
    Color,
    Grey,
    /// Luminance and chroma.
    Chroma(luminance::Weights),
    /// It has none of the asked channels.
    Nothing,
}

/// A data window while it is filled.
struct Filled {
    size: Vec2<usize>,
    kind: Kind,
    /// Empty for parts without the asked channels.
    data: Vec<[f32; 3]>,
    /// Pixels that are not opaque.
    clear: usize,
}

impl Filled {
    fn new(size: Vec2<usize>, kind: Kind) -> Self {
        let wanted = !matches!(kind, Kind::Nothing);
        Self {
            size,
            kind,
            data: vec![[0.0; 3]; if wanted { size.area() } else { 0 }],
            clear: 0,
        }
    }

    fn set(&mut self, at: Vec2<usize>, rgb: [f32; 3], [y, ry, by]: [f32; 3], alpha: f32) {
        let index = at.y() * self.size.width() + at.x();
        if let Some(pixel) = self.data.get_mut(index) {
            *pixel = match self.kind {
                Kind::Color => rgb,
                Kind::Chroma(yw) => luminance::rgb(y, ry, by, yw),
                Kind::Grey | Kind::Nothing => [y; 3],
            };
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
