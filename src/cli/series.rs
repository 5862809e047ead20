//! `--turntable N` and `--vary KEY=A..B:N`: several pictures of one scene, as numbered files or one GIF.
//!
//! Every frame is loaded as `--set` would have it: a turntable overrides the camera's eye and target, a varied key its
//! value, so that whatever follows from them (a fitted near distance, a range) is what a file saying so would have.

use std::path::{Path, PathBuf};

use rastray::error::Error;
use rastray::import::keys::wants_whole;
use rastray::math::DVec3;
use rastray::report::animation;
use rastray::scene::{Camera, ImageSettings};

use super::args::RenderArgs;

/// Most frames of a series.
const MOST: u32 = 10_000;

/// What changes from frame to frame.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Series {
    /// The camera goes around its target in this many frames.
    Turntable(u32),
    /// A key goes from one value to another.
    Vary(Vary),
}

/// A key and its values.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Vary {
    key: String,
    from: Vec<f64>,
    to: Vec<f64>,
    /// The values were written as lists.
    list: bool,
    /// The key holds whole numbers.
    whole: bool,
    frames: u32,
}

impl Series {
    /// What the flags ask for.
    pub(super) fn new(args: &RenderArgs) -> Result<Option<Self>, Error> {
        if !animation::RATES.contains(&args.fps) {
            let (low, high) = (animation::RATES.start(), animation::RATES.end());
            let message = format!("{}: expected {low} to {high} frames a second", args.fps);
            return Err(Error::parameter("--fps", message));
        }
        match (args.turntable, &args.vary) {
            (Some(frames), _) => {
                let frames = count("--turntable", frames.into())?;
                Ok(Some(Self::Turntable(frames)))
            }
            (None, Some(text)) => Vary::parse(text).map(|vary| Some(Self::Vary(vary))),
            (None, None) => Ok(None),
        }
    }

    /// Their number.
    pub(super) fn frames(&self) -> u32 {
        match self {
            Self::Turntable(frames) => *frames,
            Self::Vary(vary) => vary.frames,
        }
    }

    /// The overrides of a frame; `camera` is that of the scene without them.
    pub(super) fn sets(&self, frame: u32, camera: &Camera) -> Vec<String> {
        match self {
            Self::Turntable(frames) => {
                let eye = turned(camera, frame, *frames).to_array();
                let target = camera.target.to_array();
                vec![
                    format!("camera.eye={eye:?}"),
                    format!("camera.target={target:?}"),
                ]
            }
            Self::Vary(vary) => vec![vary.set(frame)],
        }
    }

    /// What a frame is called while it is drawn.
    pub(super) fn title(&self, frame: u32) -> String {
        match self {
            Self::Turntable(frames) => {
                let degrees = 360.0 * f64::from(frame) / f64::from(*frames);
                format!("{degrees:.0} degrees")
            }
            Self::Vary(vary) => vary.set(frame),
        }
    }

    /// An error about an override in the words of the flag that made it.
    pub(super) fn own_words(&self, error: Error) -> Error {
        let Self::Vary(vary) = self else {
            return error;
        };
        let mine = |file: &str| {
            file.strip_prefix("--set ")
                .is_some_and(|set| set.starts_with(&vary.key))
        };
        match error {
            Error::Input {
                mut place,
                message,
                help,
            } if mine(&place.file) => {
                place.file = place.file.replacen("--set", "--vary", 1);
                Error::Input {
                    place,
                    message,
                    help,
                }
            }
            other => other,
        }
    }
}

/// A number of frames.
fn count(flag: &str, frames: u64) -> Result<u32, Error> {
    match u32::try_from(frames) {
        Ok(frames @ 1..=MOST) => Ok(frames),
        _ => {
            let message = format!("{frames} frames: expected 1 to {MOST}");
            Err(Error::parameter(flag, message))
        }
    }
}

/// The eye after a part of a full turn, counter-clockwise seen from above: against `up`.
fn turned(camera: &Camera, frame: u32, frames: u32) -> DVec3 {
    if frame == 0 {
        return camera.eye;
    }
    let angle = std::f64::consts::TAU * f64::from(frame) / f64::from(frames);
    let (sin, cos) = (libm::sin(angle), libm::cos(angle));
    let axis = camera.up.normalize();
    let offset = camera.eye - camera.target;
    let along = axis * axis.dot(offset);
    let around = offset - along;
    camera.target + along + around * cos + axis.cross(around) * sin
}

impl Vary {
    /// Reads KEY=A..B:N.
    fn parse(text: &str) -> Result<Self, Error> {
        let wrong = |what: String| {
            Error::parameter("--vary", format!("{what}; expected KEY=A..B:N"))
                .with_help("for example --vary material.red.shininess=1..128:24")
        };
        let (key, rest) = text
            .split_once('=')
            .ok_or_else(|| wrong(format!("there is no `=` in `{text}`")))?;
        let (range, frames) = rest
            .rsplit_once(':')
            .ok_or_else(|| wrong(format!("there is no `:N` in `{rest}`")))?;
        let (from, to) = range
            .split_once("..")
            .ok_or_else(|| wrong(format!("there is no `..` in `{range}`")))?;
        let key = key.trim().to_owned();
        if key.is_empty() {
            return Err(wrong(format!("there is no key before `=` in `{text}`")));
        }
        let frames: u64 = frames
            .trim()
            .parse()
            .map_err(|_| wrong(format!("`{}` is no number of frames", frames.trim())))?;
        let (from, list) = values(from).map_err(wrong)?;
        let (to, list_too) = values(to).map_err(wrong)?;
        if list != list_too || from.len() != to.len() {
            return Err(wrong(format!("`{range}` has ends of different kinds")));
        }
        Ok(Self {
            whole: wants_whole(&key),
            frames: count("--vary", frames)?,
            key,
            from,
            to,
            list,
        })
    }

    /// The override of a frame.
    fn set(&self, frame: u32) -> String {
        let last = f64::from(self.frames.max(2) - 1);
        let t = f64::from(frame) / last;
        // Whole values are written as such: a key that wants them refuses 3.0.
        let written = |x: f64| {
            if self.whole {
                format!("{:.0}", x.round())
            } else {
                format!("{x:?}")
            }
        };
        let ends = self.from.iter().zip(&self.to);
        let values: Vec<String> = ends
            .map(|(a, b)| written(if t == 1.0 { *b } else { a + (b - a) * t }))
            .collect();
        let values = values.join(", ");
        if self.list {
            format!("{}=[{values}]", self.key)
        } else {
            format!("{}={values}", self.key)
        }
    }
}

/// A number, or a list of numbers in brackets; whether it was a list.
fn values(text: &str) -> Result<(Vec<f64>, bool), String> {
    let text = text.trim();
    let inner = text
        .strip_prefix('[')
        .and_then(|rest| rest.strip_suffix(']'));
    let number = |word: &str| {
        let found = word.trim().parse::<f64>().ok().filter(|x| x.is_finite());
        found.ok_or_else(|| format!("`{}` is no number", word.trim()))
    };
    let found: Result<Vec<f64>, String> = inner.unwrap_or(text).split(',').map(number).collect();
    match (found?, inner.is_some()) {
        (numbers, true) => Ok((numbers, true)),
        (numbers, false) if numbers.len() == 1 => Ok((numbers, false)),
        _ => Err(format!("`{text}` is no number (lists stand in brackets)")),
    }
}

/// Whether a path asks for a GIF.
pub(super) fn is_gif(path: &Path) -> bool {
    path.extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("gif"))
}

/// `name.png` to `name-0001.png`.
pub(super) fn numbered(path: &Path, frame: u32) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!("{stem}-{:04}.{extension}", frame + 1))
}

/// Refuses a GIF whose frames would not fit into memory.
pub(super) fn fits_memory(image: &ImageSettings, frames: u32) -> Result<(), Error> {
    let pixels = u64::from(image.width) * u64::from(image.height) * u64::from(frames);
    let most = animation::MAX_PIXELS;
    if pixels <= most {
        return Ok(());
    }
    let message = format!("{frames} frames have {pixels} pixels, expected at most {most} in a GIF");
    Err(Error::limit(message).with_help("take a smaller --size, or numbered .png files"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_go_from_one_end_to_the_other() {
        let sets = |text: &str| -> Vec<String> {
            let vary = Vary::parse(text).expect("well formed");
            (0..vary.frames).map(|i| vary.set(i)).collect()
        };
        assert_eq!(
            sets("material.red.shininess=1..128:3"),
            ["1.0", "64.5", "128.0"].map(|v| format!("material.red.shininess={v}"))
        );
        assert_eq!(
            sets("trace.depth=0..3:3"),
            ["0", "2", "3"].map(|v| format!("trace.depth={v}"))
        );
        assert_eq!(
            sets("light.key.position=[-1,2,0]..[1,2,1]:2"),
            ["[-1.0, 2.0, 0.0]", "[1.0, 2.0, 1.0]"].map(|v| format!("light.key.position={v}"))
        );
        // Downwards, with exponents and signs; and a single frame has the first value.
        assert_eq!(sets("a.b=1e-3..-2:2"), ["a.b=0.001", "a.b=-2.0"]);
        assert_eq!(sets("a.b=5..7:1"), ["a.b=5.0"]);
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (text, wanted) in [
            ("shininess", "no `=`"),
            ("a=1..2", "no `:N`"),
            ("a=1-2:3", "no `..`"),
            ("a=1..b:3", "`b` is no number"),
            ("a=..2:3", "`` is no number"),
            ("a=1..nan:3", "`nan` is no number"),
            ("a=1..2:x", "`x` is no number of frames"),
            ("a=1..2:0", "0 frames: expected 1 to 10000"),
            ("a=1..2:10001", "10001 frames: expected 1 to 10000"),
            ("=1..2:3", "no key"),
            ("a=[1,2]..3:3", "different kinds"),
            ("a=[1,2]..[1]:3", "different kinds"),
            ("a=1,2..3,4:3", "in brackets"),
        ] {
            let error = Vary::parse(text).expect_err(text).to_string();
            assert!(error.contains(wanted), "{text}: {error}");
        }
    }

    #[test]
    fn a_turn_keeps_height_and_distance_and_closes() {
        let camera = Camera {
            eye: DVec3::new(3.0, 4.0, 0.0),
            target: DVec3::new(0.0, 1.0, 0.0),
            ..Camera::default()
        };
        assert_eq!(turned(&camera, 0, 4), camera.eye);
        // A quarter, counter-clockwise from above: +x goes to -z.
        let quarter = turned(&camera, 1, 4);
        assert!((quarter - DVec3::new(0.0, 4.0, -3.0)).length() < 1e-14);
        for frame in 0..7 {
            let eye = turned(&camera, frame, 7);
            assert!((eye.y - 4.0).abs() < 1e-14);
            assert!(((eye - camera.target).length() - 18f64.sqrt()).abs() < 1e-14);
        }
    }

    #[test]
    fn frames_count_from_one() {
        assert_eq!(
            numbered(Path::new("out/turn.exr"), 0),
            Path::new("out/turn-0001.exr")
        );
        assert_eq!(
            numbered(Path::new("a.b.png"), 9999),
            Path::new("a.b-10000.png")
        );
    }
}
