//! Pictures and layers in few bytes, for a script to unpack.
//!
//! In: planes of linear f32. Out: [`Blob`]s, each a name, a small description (JSON) and deflated bytes. `codec.js` undoes it.
//!
//! **Values** are half floats of x / 2^11: beyond 1/8 they keep 11 significant bits, as half floats do; below, steps of 2^-13,
//! which is 1/32 of a step of an 8-bit picture. Largest magnitude 1.3e8. A *code* is the half float's bits as an integer that
//! grows with the value, two's complement.
//!
//! **Pictures** ([`rgb`]) and other colours: each code is predicted from its neighbours left, above and above left (the
//! median edge detector of LOCO-I: Weinberger, Seroussi, Sapiro 2000), or is the difference to another picture's
//! code, or to the code of the channel before; what remains is zigzagged, split into low and high bytes, and deflated. Of the
//! modes the one with the smallest remainders is taken. **Layers** that are one number times one of a few colours ([`tone`])
//! keep that number, a palette and an index. **8-bit pictures** ([`bytes`]) keep their distance to their rounded float twin.
//!
//! How small that is: [`super::live`].

use std::collections::HashMap;
use std::io::Write;

use flate2::Compression;
use flate2::write::DeflateEncoder;
// Conversions of half floats, rounded to nearest even; EXR files already need the crate.
use half::f16;
use serde_json::{Value, json};

use crate::error::Error;
use crate::frame::Plane;

/// Values are divided by this before they become half floats.
const SCALE: f32 = 2048.0;
/// Index of a pixel outside the palette.
const ESCAPE: u8 = 255;

/// A packed plane.
#[derive(Clone, Debug)]
pub(super) struct Blob {
    /// What the page's index calls it.
    pub(super) name: String,
    /// How to unpack it.
    pub(super) how: Value,
    /// Deflated, without a header.
    pub(super) bytes: Vec<u8>,
}

/// The code of a value: grows with it.
pub(super) fn code(x: f32) -> u16 {
    let largest = f16::MAX.to_f32();
    let bits = f16::from_f32((x / SCALE).clamp(-largest, largest)).to_bits();
    let magnitude = bits & 0x7fff;
    if bits == magnitude {
        magnitude
    } else {
        magnitude.wrapping_neg()
    }
}

/// The value of a code.
pub(super) fn value(code: u16) -> f32 {
    let magnitude = (code as i16).unsigned_abs();
    let x = f16::from_bits(magnitude).to_f32() * SCALE;
    if (code as i16) < 0 { -x } else { x }
}

/// The codes of a picture, channel by channel.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Codes {
    /// Pixels in a row.
    pub(super) width: usize,
    /// Red, green, blue.
    pub(super) channels: [Vec<u16>; 3],
}

impl Codes {
    /// Each value rounded.
    pub(super) fn of(plane: &Plane<[f32; 3]>) -> Self {
        let channel = |c: usize| plane.data.iter().map(|p| code(p[c])).collect();
        Self {
            width: plane.width,
            channels: [0, 1, 2].map(channel),
        }
    }

    /// Each value rounded, but a code of `before` kept where it is less than a step off: differences of less than the
    /// stored precision show as none, not as noise.
    pub(super) fn near(plane: &Plane<[f32; 3]>, before: &Self) -> Self {
        let mut codes = Self::of(plane);
        for (c, channel) in codes.channels.iter_mut().enumerate() {
            let old = before.channels[c].iter();
            for ((new, &old), pixel) in channel.iter_mut().zip(old).zip(&plane.data) {
                let close = (*new as i16).abs_diff(old as i16) == 1;
                let step = (value(*new) - value(old)).abs();
                if close && (pixel[c] - value(old)).abs() < 0.75 * step {
                    *new = old;
                }
            }
        }
        codes
    }
}

/// Small for small remainders of either sign.
fn zigzag(x: u16) -> u16 {
    let x = x as i16;
    ((x << 1) ^ (x >> 15)) as u16
}

/// What the median edge detector leaves, in wrapping arithmetic on codes taken as signed numbers.
fn spatial(plane: &[u16], width: usize) -> Vec<u16> {
    let at = |i: usize| i32::from(plane[i] as i16);
    let rest = |i: usize| {
        let guess = match (i % width, i / width) {
            (0, 0) => 0,
            (_, 0) => at(i - 1),
            (0, _) => at(i - width),
            _ => {
                let (a, b, c) = (at(i - 1), at(i - width), at(i - width - 1));
                match c {
                    c if c >= a.max(b) => a.min(b),
                    c if c <= a.min(b) => a.max(b),
                    c => a + b - c,
                }
            }
        };
        zigzag(plane[i].wrapping_sub(guess as u16))
    };
    (0..plane.len()).map(rest).collect()
}

fn minus(a: &[u16], b: &[u16]) -> Vec<u16> {
    a.iter().zip(b).map(|(a, b)| a.wrapping_sub(*b)).collect()
}

/// About how many bits remainders take when deflated.
fn cost(rests: &[Vec<u16>; 3]) -> f64 {
    let bits = |r: &u16| match r {
        0 => 0.2,
        r => 1.5 + f64::from(16 - r.leading_zeros()),
    };
    rests.iter().flatten().map(bits).sum()
}

/// What is done to the codes: `base`: minus the other picture's; `previous`: green minus red, blue minus green;
/// `spatial`: minus what the neighbours say.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Mode {
    base: bool,
    previous: bool,
    spatial: bool,
}

impl Mode {
    /// All that make sense, with and without another picture.
    fn all(base: bool) -> Vec<Self> {
        let free = [false, true].map(|previous| Self {
            base: false,
            previous,
            spatial: true,
        });
        let based = [(false, false), (false, true), (true, true)].map(|(previous, spatial)| Self {
            base: true,
            previous,
            spatial,
        });
        free.into_iter()
            .chain(based.into_iter().filter(|_| base))
            .collect()
    }

    fn rests(self, codes: &Codes, base: Option<&Codes>) -> [Vec<u16>; 3] {
        let plain = [0, 1, 2].map(|c| match base.filter(|_| self.base) {
            Some(base) => minus(&codes.channels[c], &base.channels[c]),
            None => codes.channels[c].clone(),
        });
        let [r, g, b] = &plain;
        let split = match self.previous {
            true => [r.clone(), minus(g, r), minus(b, g)],
            false => plain,
        };
        split.map(|plane| match self.spatial {
            true => spatial(&plane, codes.width),
            false => plane.into_iter().map(zigzag).collect(),
        })
    }
}

/// Low bytes, then high bytes.
fn halves(rests: &[u16]) -> impl Iterator<Item = u8> {
    let low = rests.iter().map(|r| *r as u8);
    low.chain(rests.iter().map(|r| (r >> 8) as u8))
}

fn deflate(bytes: &[u8]) -> Result<Vec<u8>, Error> {
    let mut encoder = DeflateEncoder::new(Vec::new(), Compression::best());
    encoder
        .write_all(bytes)
        .and_then(|()| encoder.finish())
        .map_err(|e| Error::limit(format!("cannot pack the page's pictures: {e}")))
}

/// A picture of any colours; `base`: a picture that it may be close to, and its name.
pub(super) fn rgb(name: &str, codes: &Codes, base: Option<(&str, &Codes)>) -> Result<Blob, Error> {
    let tried = Mode::all(base.is_some()).into_iter().map(|mode| {
        let rests = mode.rests(codes, base.map(|(_, codes)| codes));
        (cost(&rests), mode, rests)
    });
    let best = tried.min_by(|a, b| a.0.total_cmp(&b.0));
    let Some((_, mode, rests)) = best else {
        return Err(Error::limit("a picture without a way to pack it"));
    };
    let bytes: Vec<u8> = rests.iter().flat_map(|r| halves(r)).collect();
    let base = base.filter(|_| mode.base).map(|(name, _)| name);
    Ok(Blob {
        name: name.to_owned(),
        how: json!({"kind": "rgb", "base": base, "previous": mode.previous, "spatial": mode.spatial}),
        bytes: deflate(&bytes)?,
    })
}

/// An 8-bit picture (values k/255) by its distance from the rounded values of a float one.
pub(super) fn bytes(
    name: &str,
    plane: &Plane<[f32; 3]>,
    base: (&str, &Codes),
) -> Result<Blob, Error> {
    let rest = |c: usize| {
        let pairs = plane.data.iter().zip(&base.1.channels[c]);
        pairs.map(move |(pixel, &code)| byte(pixel[c]).wrapping_sub(byte(value(code))))
    };
    let rests: Vec<u8> = (0..3).flat_map(rest).collect();
    Ok(Blob {
        name: name.to_owned(),
        how: json!({"kind": "bytes", "base": base.0}),
        bytes: deflate(&rests)?,
    })
}

/// round(255 clamp(x)), as the script computes it: in doubles, halves up.
fn byte(x: f32) -> u8 {
    (f64::from(x).clamp(0.0, 1.0) * 255.0 + 0.5).floor() as u8
}

/// Yes or no for each pixel, eight to a byte, lowest bit first.
pub(super) fn mask(name: &str, pixels: &[bool]) -> Result<Blob, Error> {
    let pack = |eight: &[bool]| {
        let bits = eight.iter().enumerate();
        bits.fold(0u8, |byte, (i, &on)| byte | u8::from(on) << i)
    };
    let packed: Vec<u8> = pixels.chunks(8).map(pack).collect();
    Ok(Blob {
        name: name.to_owned(),
        how: json!({"kind": "mask"}),
        bytes: deflate(&packed)?,
    })
}

/// Any bytes.
pub(super) fn raw(name: &str, bytes: &[u8]) -> Result<Blob, Error> {
    Ok(Blob {
        name: name.to_owned(),
        how: json!({"kind": "raw"}),
        bytes: deflate(bytes)?,
    })
}

/// A layer as one number a pixel times a colour of a palette.
pub(super) struct Tone {
    width: usize,
    palette: Vec<[f32; 3]>,
    index: Vec<u8>,
    scalar: Vec<u16>,
    /// Codes of the pixels with index [`ESCAPE`], in order.
    escapes: Vec<[u16; 3]>,
}

impl Tone {
    /// None where too many colours are needed. Index 0 is black.
    pub(super) fn of(plane: &Plane<[f32; 3]>) -> Option<Self> {
        // Colours closer than this share an entry: far less than a half float's step.
        const FINE: f32 = 32768.0;
        let mut known: HashMap<[i32; 3], u8> = HashMap::new();
        let mut tone = Self {
            width: plane.width,
            palette: vec![[0.0; 3]],
            index: Vec::with_capacity(plane.data.len()),
            scalar: Vec::with_capacity(plane.data.len()),
            escapes: Vec::new(),
        };
        for pixel in &plane.data {
            let largest = pixel
                .iter()
                .fold(0.0f32, |m, x| if x.abs() > m.abs() { *x } else { m });
            let number = code(largest);
            if number == 0 {
                tone.push(0, 0);
                continue;
            }
            let color = pixel.map(|x| x / largest);
            let full = tone.palette.len() >= usize::from(ESCAPE);
            let key = color.map(|x| (x * FINE).round() as i32);
            let index = match known.get(&key) {
                Some(index) => *index,
                None if full || !largest.is_finite() => ESCAPE,
                None => {
                    let index = tone.palette.len() as u8;
                    known.insert(key, index);
                    tone.palette.push(color);
                    index
                }
            };
            if index == ESCAPE {
                tone.escapes.push(pixel.map(code));
                if tone.escapes.len() > plane.data.len() / 16 {
                    return None;
                }
            }
            tone.push(index, number);
        }
        Some(tone)
    }

    fn push(&mut self, index: u8, scalar: u16) {
        self.index.push(index);
        self.scalar.push(scalar);
    }

    /// The value of a pixel as the script will see it; `escape`: how many escapes came before, counted on.
    pub(super) fn value(&self, pixel: usize, escape: &mut usize) -> [f32; 3] {
        if self.index[pixel] == ESCAPE {
            *escape += 1;
            return self.escapes[*escape - 1].map(value);
        }
        let number = value(self.scalar[pixel]);
        self.palette[usize::from(self.index[pixel])].map(|c| number * c)
    }

    /// Packed.
    pub(super) fn blob(&self, name: &str) -> Result<Blob, Error> {
        let escapes: Vec<u16> = self.escapes.as_flattened().to_vec();
        let mut bytes = self.index.clone();
        bytes.extend(halves(&spatial(&self.scalar, self.width)));
        bytes.extend(halves(&escapes));
        Ok(Blob {
            name: name.to_owned(),
            how: json!({"kind": "tone", "palette": self.palette, "escapes": self.escapes.len()}),
            bytes: deflate(&bytes)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_grow_with_values_and_keep_what_they_promise() {
        let mut last = i16::MIN;
        for i in -4000..4000 {
            let x = (i as f32 / 1000.0).powi(3);
            let now = code(x) as i16;
            assert!(now >= last, "{x}");
            last = now;
            let error = (value(code(x)) - x).abs();
            assert!(
                error <= (x.abs() / 2048.0).max(1.0 / 16384.0),
                "{x}: {error}"
            );
        }
        assert_eq!(code(0.0), 0);
        assert_eq!(code(-0.0), 0);
        assert_eq!(value(code(1.0)), 1.0);
        assert_eq!(value(code(-0.25)), -0.25);
        assert!(value(code(f32::INFINITY)) > 1e8 && value(code(f32::NEG_INFINITY)) < -1e8);
    }

    #[test]
    fn near_values_keep_the_code_before() {
        let plane = |x: f32| Plane::filled(2, 1, [x; 3]);
        let before = Codes::of(&plane(0.3));
        assert_eq!(Codes::near(&plane(0.3 + 1e-5), &before), before);
        assert_ne!(Codes::near(&plane(0.301), &before), before);
    }

    #[test]
    fn a_tone_is_one_number_and_one_color() {
        let data: Vec<[f32; 3]> = (0..600)
            .map(|i| {
                let (s, k) = (i as f32 / 300.0, i % 3);
                [[0.8, 0.1, 0.4], [0.2, 0.9, 0.0], [0.0; 3]][k].map(|c: f32| c * s)
            })
            .collect();
        let plane = Plane {
            width: 30,
            height: 20,
            data,
        };
        let tone = Tone::of(&plane).unwrap();
        assert_eq!((tone.palette.len(), tone.escapes.len()), (3, 0));
        let mut escape = 0;
        for (i, pixel) in plane.data.iter().enumerate() {
            let seen = tone.value(i, &mut escape);
            for c in 0..3 {
                let bar = (pixel[c].abs() / 2048.0).max(1.0 / 8192.0);
                assert!((seen[c] - pixel[c]).abs() <= bar, "{i}: {seen:?} {pixel:?}");
            }
        }
        // As many colours as pixels.
        let many = (0..600).map(|i| [1.0, i as f32 / 600.0, 0.5]).collect();
        assert!(
            Tone::of(&Plane {
                data: many,
                ..plane
            })
            .is_none()
        );
    }

    #[test]
    fn pictures_close_to_another_take_next_to_nothing() {
        let picture = |k: f32| Plane {
            width: 64,
            height: 64,
            data: (0..4096)
                .map(|i| {
                    [
                        (i as f32 * 0.37).sin().abs(),
                        0.5,
                        k * (i % 64) as f32 / 64.0,
                    ]
                })
                .collect(),
        };
        let one = Codes::of(&picture(1.0));
        let alone = rgb("b", &one, None).unwrap();
        let beside = rgb("b", &one, Some(("a", &one))).unwrap();
        assert!(beside.bytes.len() < 100 && alone.bytes.len() > 1000);
        assert_eq!(beside.how["base"], "a");
    }
}
