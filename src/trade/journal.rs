//! What was measured so far, on disk: a run that was interrupted goes on where it ended.
//!
//! One JSON value a line, appended as soon as it is known and never changed: a header, which names the scene by a hash of
//! everything in it, then settings and times. A line that an interruption cut short is left out when the file is read. A
//! header of another scene, size, version or instruction set makes the file worthless: it is begun anew.

use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::measure::Measured;
use super::timing::Ratio;
use crate::error::Error;
use crate::lanes::Isa;
use crate::scene::Scene;

/// A line of the file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Line {
    Header(Header),
    Measured(Measured),
    Timed(Timed),
}

/// What the lines belong to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Header {
    rastray: String,
    scene: String,
    isa: String,
}

/// A time as a multiple of the base setting's.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Timed {
    /// [`super::measure::key`] of the setting.
    pub setting: String,
    /// Its time over the base's.
    pub ratio: Ratio,
}

/// How a journal was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Found {
    /// None was there.
    Nothing,
    /// Of the same scene, with this many settings.
    Same(usize),
    /// Of another scene, size, version or instruction set: begun anew.
    Other,
}

/// Everything that is known, and where it is kept.
#[derive(Debug)]
pub struct Journal {
    path: Option<PathBuf>,
    /// Settings in the order in which they were measured.
    pub measured: Vec<Measured>,
    /// Times; the last of a setting counts.
    pub timed: Vec<Timed>,
    /// How it was found.
    pub found: Found,
}

impl Journal {
    /// One that is kept nowhere.
    pub fn in_memory() -> Self {
        Self {
            path: None,
            measured: Vec::new(),
            timed: Vec::new(),
            found: Found::Nothing,
        }
    }

    /// Opens the journal of a scene, or begins it.
    ///
    /// # Errors
    /// [`Error::Io`] where the file cannot be read or written.
    pub fn open(path: &Path, scene: &Scene, isa: Isa) -> Result<Self, Error> {
        let header = Header {
            rastray: env!("CARGO_PKG_VERSION").to_owned(),
            scene: format!("{:016x}", hash(scene)),
            isa: isa.name().to_owned(),
        };
        let io = |action| move |e| Error::io(path.display().to_string(), action, e);
        let mut journal = Self {
            path: Some(path.to_owned()),
            ..Self::in_memory()
        };
        if path.exists() {
            let text = fs::read_to_string(path).map_err(io("read"))?;
            journal.found = journal.take(&text, &header);
        }
        if !matches!(journal.found, Found::Same(_)) {
            fs::write(path, "").map_err(io("write"))?;
            journal.append(&Line::Header(header))?;
        }
        Ok(journal)
    }

    /// Reads the lines of a text, if they belong to the header.
    fn take(&mut self, text: &str, header: &Header) -> Found {
        let mut lines = text.lines().map(serde_json::from_str::<Line>);
        match lines.next() {
            Some(Ok(Line::Header(found))) if found == *header => {}
            _ => return Found::Other,
        }
        for line in lines.flatten() {
            match line {
                Line::Measured(measured) => self.measured.push(measured),
                Line::Timed(timed) => self.timed.push(timed),
                Line::Header(_) => {}
            }
        }
        Found::Same(self.measured.len())
    }

    /// Keeps a measurement.
    ///
    /// # Errors
    /// [`Error::Io`] where the file cannot be written.
    pub fn keep(&mut self, measured: Measured) -> Result<(), Error> {
        self.append(&Line::Measured(measured.clone()))?;
        self.measured.push(measured);
        Ok(())
    }

    /// Keeps a time.
    ///
    /// # Errors
    /// As [`Self::keep`].
    pub fn keep_time(&mut self, timed: Timed) -> Result<(), Error> {
        self.append(&Line::Timed(timed.clone()))?;
        self.timed.push(timed);
        Ok(())
    }

    /// The latest measurement of a setting: another number of ideal samples measures it again.
    pub fn measurement(&self, key: &str) -> Option<&Measured> {
        self.measured.iter().rev().find(|m| m.setting == key)
    }

    /// The latest time of a setting.
    pub fn time(&self, key: &str) -> Option<&Ratio> {
        let found = self.timed.iter().rev().find(|t| t.setting == key);
        found.map(|timed| &timed.ratio)
    }

    /// Appends a line, on its own even where the last one was cut short.
    fn append(&self, line: &Line) -> Result<(), Error> {
        let Some(path) = &self.path else {
            return Ok(());
        };
        let fail = |e: std::io::Error| Error::io(path.display().to_string(), "write", e);
        let text = serde_json::to_string(line).map_err(|e| fail(e.into()))?;
        let cut = fs::read(path)
            .map_err(fail)?
            .last()
            .is_some_and(|b| *b != b'\n');
        let mut file = fs::File::options().append(true).open(path).map_err(fail)?;
        let start = if cut { "\n" } else { "" };
        file.write_all(format!("{start}{text}\n").as_bytes())
            .map_err(fail)
    }
}

/// A hash of everything in a scene: FNV-1a over its debug form, in which floats have their shortest exact digits.
pub fn hash(scene: &Scene) -> u64 {
    struct Fnv(u64);
    impl std::fmt::Write for Fnv {
        fn write_str(&mut self, text: &str) -> std::fmt::Result {
            for byte in text.bytes() {
                self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
            }
            Ok(())
        }
    }
    let mut fnv = Fnv(0xcbf2_9ce4_8422_2325);
    // This writer never fails.
    let _ = write!(fnv, "{scene:?}");
    fnv.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::{LoadOptions, load};
    use crate::trade::accuracy::Accuracy;
    use crate::trade::cost::Counts;

    fn scene() -> Scene {
        load("highlight", &LoadOptions::default())
            .expect("shipped")
            .scene
    }

    fn measured(name: &str) -> Measured {
        let accuracy = Accuracy {
            flip: 1.0 / 3.0,
            ..Accuracy::default()
        };
        Measured {
            setting: name.to_owned(),
            errors: vec![("full".to_owned(), accuracy)],
            counts: Counts::default(),
        }
    }

    #[test]
    fn a_journal_is_found_again_whole() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("journal.jsonl");
        let (scene, isa) = (scene(), Isa::Scalar);
        let mut first = Journal::open(&path, &scene, isa).expect("opens");
        assert_eq!(first.found, Found::Nothing);
        first.keep(measured("a")).expect("writes");
        // An interruption in the middle of a line.
        let mut text = fs::read_to_string(&path).expect("reads");
        text.push_str("{\"measured\":{\"setting\":\"b\"");
        fs::write(&path, &text).expect("writes");
        let mut second = Journal::open(&path, &scene, isa).expect("opens");
        assert_eq!(second.found, Found::Same(1));
        assert_eq!(second.measurement("a"), Some(&measured("a")));
        second.keep(measured("c")).expect("writes");
        let third = Journal::open(&path, &scene, isa).expect("opens");
        assert_eq!(third.measured, [measured("a"), measured("c")]);
    }

    #[test]
    fn another_scene_begins_anew() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("journal.jsonl");
        let mut scene = scene();
        let mut first = Journal::open(&path, &scene, Isa::Scalar).expect("opens");
        first.keep(measured("a")).expect("writes");
        scene.lights[0].source.diffuse[1] += 1e-15;
        let second = Journal::open(&path, &scene, Isa::Scalar).expect("opens");
        assert_eq!((second.found, second.measured.len()), (Found::Other, 0));
        let third = Journal::open(&path, &scene, Isa::Scalar).expect("opens");
        assert_eq!(third.found, Found::Same(0));
    }
}
