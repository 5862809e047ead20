//! Reading files and embedded texts, and telling early what is no scene at all.

use std::cell::RefCell;
use std::path::{Path, PathBuf};

use super::shipped;
use crate::error::{Error, Place};

/// Largest scene file (TOML): a list of numbers takes some 75 bytes of memory for each of its characters.
pub const MAX_TEXT: u64 = 8 << 20;
/// Largest material library.
pub const MAX_LIBRARY: u64 = 4 << 20;
/// Largest mesh file.
pub const MAX_MESH: u64 = 1 << 30;

/// Where the files of a scene come from.
#[derive(Debug)]
pub(crate) enum Home {
    /// A folder, that of the scene file, and the files read from it so far.
    Folder(PathBuf, RefCell<Vec<PathBuf>>),
    /// The scenes inside the program.
    Embedded,
}

impl Home {
    /// A folder that nothing was read from.
    pub(crate) fn folder(folder: PathBuf) -> Self {
        Self::Folder(folder, RefCell::default())
    }

    /// The files that were read.
    pub(crate) fn files(self) -> Vec<PathBuf> {
        match self {
            Self::Folder(_, files) => files.into_inner(),
            Self::Embedded => Vec::new(),
        }
    }

    /// How messages call a file of this home.
    pub(crate) fn name(&self, file: &str) -> String {
        match self {
            Self::Folder(folder, _) => folder.join(file).display().to_string(),
            Self::Embedded => file.to_owned(),
        }
    }

    /// Whether a file is there.
    pub(crate) fn has(&self, file: &str) -> bool {
        match self {
            Self::Folder(folder, _) => folder.join(file).is_file(),
            Self::Embedded => shipped::file(file).is_some(),
        }
    }

    /// Whether there is anything of that name, be it a folder.
    pub(crate) fn exists(&self, file: &str) -> bool {
        match self {
            Self::Folder(folder, _) => folder.join(file).exists(),
            Self::Embedded => self.has(file),
        }
    }

    /// The bytes of a file.
    pub(crate) fn read(&self, file: &str, limit: u64) -> Result<Vec<u8>, Error> {
        match self {
            Self::Folder(folder, files) => {
                let path = folder.join(file);
                let bytes = read_file(&path, limit)?;
                files.borrow_mut().push(path);
                Ok(bytes)
            }
            Self::Embedded => match shipped::file(file) {
                Some(text) => Ok(text.as_bytes().to_vec()),
                None => Err(Error::io(
                    file,
                    "read",
                    std::io::Error::from(std::io::ErrorKind::NotFound),
                )),
            },
        }
    }
}

/// The bytes of a file of a scene, of at most `limit` bytes.
fn read_file(path: &Path, limit: u64) -> Result<Vec<u8>, Error> {
    let advice = match limit {
        MAX_TEXT => "keep large meshes in OBJ files",
        _ => "cut it into several files",
    };
    if path.is_dir() {
        return Err(folder(&path.display().to_string()));
    }
    read_limited(path, limit, advice)
}

/// The bytes of a file of at most `limit` bytes; `advice` says what to do about a longer one.
pub(super) fn read_limited(path: &Path, limit: u64, advice: &str) -> Result<Vec<u8>, Error> {
    use std::io::Read;
    let name = path.display().to_string();
    let failed = |e| Error::io(&name, "read", e);
    let metadata = std::fs::metadata(path).map_err(failed)?;
    let too_long = || {
        let message = format!("{name} is longer than {} MiB", limit >> 20);
        Error::limit(message).with_help(advice)
    };
    if metadata.len() > limit {
        return Err(too_long());
    }
    // The length may lie (pipes, devices): read no more than the limit.
    let mut bytes = Vec::with_capacity(metadata.len() as usize + 1);
    let file = std::fs::File::open(path).map_err(failed)?;
    let read = file.take(limit + 1).read_to_end(&mut bytes);
    let length = read.map_err(failed)? as u64;
    if length > limit {
        return Err(too_long());
    }
    Ok(bytes)
}

/// The error for a folder.
pub(crate) fn folder(name: &str) -> Error {
    Error::input(Place::file(name), "is a folder, not a scene")
        .with_help("name a .toml, .scn or .obj file in it")
}

/// Refuses what cannot be a text: nothing at all, pictures, other binary files, UTF-16.
pub(crate) fn check_text(name: &str, bytes: &[u8]) -> Result<(), Error> {
    let refuse = |what: &str| Err(Error::input(Place::file(name), what));
    if bytes.iter().all(u8::is_ascii_whitespace) {
        return refuse("is empty");
    }
    const PICTURES: [(&[u8], &str); 5] = [
        (b"\x89PNG", "is a PNG picture, not a scene"),
        (b"\xff\xd8\xff", "is a JPEG picture, not a scene"),
        (b"GIF8", "is a GIF picture, not a scene"),
        (b"\x76\x2f\x31\x01", "is an OpenEXR picture, not a scene"),
        (b"glTF", "is a binary glTF file, which is not imported"),
    ];
    if let Some((_, what)) = PICTURES.iter().find(|(magic, _)| bytes.starts_with(magic)) {
        return refuse(what);
    }
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        return refuse("is UTF-16 text; save it as UTF-8");
    }
    if bytes.contains(&0) {
        return refuse("is a binary file, not a scene");
    }
    Ok(())
}

/// The text of a UTF-8 file, without its byte order mark.
pub(crate) fn utf8(name: &str, bytes: Vec<u8>) -> Result<String, Error> {
    check_text(name, &bytes)?;
    let mut text = String::from_utf8(bytes).map_err(|error| {
        let good = error.utf8_error().valid_up_to();
        let bytes = error.into_bytes();
        let text = String::from_utf8_lossy(&bytes);
        let message = format!("byte {:#04x} is not UTF-8", bytes[good]);
        Error::input(Place::span(name, &text, good..good + 1), message)
            .with_help("save the file as UTF-8")
    })?;
    if text.starts_with('\u{feff}') {
        text.drain(..'\u{feff}'.len_utf8());
    }
    Ok(text)
}

/// The text of a file of plain words, without its byte order mark. What is not UTF-8, in old comments mostly, becomes
/// replacement characters.
pub(crate) fn lossy(name: &str, bytes: Vec<u8>) -> Result<String, Error> {
    check_text(name, &bytes)?;
    let mut text = String::from_utf8(bytes)
        .unwrap_or_else(|error| String::from_utf8_lossy(error.as_bytes()).into_owned());
    if text.starts_with('\u{feff}') {
        text.drain(..'\u{feff}'.len_utf8());
    }
    Ok(text)
}
