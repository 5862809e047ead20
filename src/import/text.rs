//! Reading files and embedded texts, and telling early what is no scene at all.

use std::borrow::Cow;
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
    pub(crate) fn name(&self, file: impl AsRef<Path>) -> String {
        match self {
            Self::Folder(folder, _) => folder.join(file).display().to_string(),
            Self::Embedded => file.as_ref().display().to_string(),
        }
    }

    /// Whether a file is there.
    pub(crate) fn has(&self, file: impl AsRef<Path>) -> bool {
        match self {
            Self::Folder(folder, _) => folder.join(file).is_file(),
            Self::Embedded => embedded(file.as_ref()).is_some(),
        }
    }

    /// Whether there is anything of that name, be it a folder.
    pub(crate) fn exists(&self, file: impl AsRef<Path>) -> bool {
        match self {
            Self::Folder(folder, _) => folder.join(file).exists(),
            Self::Embedded => self.has(file),
        }
    }

    /// The file that a text in another file means, which lies in `folder`: as its bytes say, or as its characters do, with
    /// slashes for backslashes, beside the file where its folders are not here, in capitals or not. With it, whether the
    /// spelling is another than the text's.
    pub(crate) fn find(&self, folder: &str, name: &[u8]) -> Option<(PathBuf, bool)> {
        let name = unquoted(name);
        let slashes: Vec<u8> = name
            .iter()
            .map(|b| if *b == b'\\' { b'/' } else { *b })
            .collect();
        let last = slashes.rsplit(|b| *b == b'/').next().unwrap_or(&slashes);
        let spellings = [(name, false), (&slashes[..], true), (last, true)];
        let paths = spellings.iter().flat_map(|(spelling, other)| {
            let known = [
                path_of_bytes(spelling),
                decode(spelling).into_owned().into(),
            ];
            known.map(|path| (Path::new(folder).join(path), *other && spelling != &name))
        });
        let empty = |path: &Path| path.file_name().is_none();
        let found = paths
            .clone()
            .find(|(path, _)| !empty(path) && self.has(path));
        found.or_else(|| {
            let mut paths = paths.filter(|(path, _)| !empty(path));
            paths.find_map(|(path, _)| Some((self.ignoring_case(&path)?, true)))
        })
    }

    /// The file of a folder whose name differs in capitals only; the first of several in order.
    fn ignoring_case(&self, file: &Path) -> Option<PathBuf> {
        const MOST: usize = 4096;
        let Self::Folder(home, _) = self else {
            return None;
        };
        let wanted = file.file_name()?.to_str()?.to_lowercase();
        let parent = file.parent()?;
        let entries = std::fs::read_dir(home.join(parent)).ok()?.take(MOST);
        let names = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
        let name = names.filter(|name| name.to_lowercase() == wanted).min()?;
        Some(parent.join(name)).filter(|path| self.has(path))
    }

    /// The bytes of a file.
    pub(crate) fn read(&self, file: impl AsRef<Path>, limit: u64) -> Result<Vec<u8>, Error> {
        let file = file.as_ref();
        match self {
            Self::Folder(folder, files) => {
                let path = folder.join(file);
                let bytes = read_file(&path, limit)?;
                files.borrow_mut().push(path);
                Ok(bytes)
            }
            Self::Embedded => match embedded(file) {
                Some(text) => Ok(text.as_bytes().to_vec()),
                None => Err(Error::io(
                    file.display().to_string(),
                    "read",
                    std::io::Error::from(std::io::ErrorKind::NotFound),
                )),
            },
        }
    }
}

/// The text of a shipped file.
fn embedded(file: &Path) -> Option<&'static str> {
    shipped::file(file.to_str()?)
}

/// A path as the system stores it: bytes where it does.
fn path_of_bytes(name: &[u8]) -> PathBuf {
    #[cfg(unix)]
    {
        use std::os::unix::ffi::OsStrExt;
        std::ffi::OsStr::from_bytes(name).into()
    }
    #[cfg(not(unix))]
    {
        decode(name).into_owned().into()
    }
}

/// A name without blanks and quotes around it.
pub(crate) fn unquoted(name: &[u8]) -> &[u8] {
    let name = name.trim_ascii();
    let inner = |quote: &[u8]| name.strip_prefix(quote)?.strip_suffix(quote);
    let inner = inner(b"\"").or_else(|| inner(b"'"));
    inner.map_or(name, <[u8]>::trim_ascii)
}

/// Bytes as characters: UTF-8 where they are, else each byte as Latin-1 has it, so that different bytes stay different.
/// Bytes that Latin-1 has no character for become private ones, which no terminal obeys.
pub(crate) fn decode(bytes: &[u8]) -> Cow<'_, str> {
    const PRIVATE: u32 = 0xf700;
    if let Ok(text) = std::str::from_utf8(bytes) {
        return Cow::Borrowed(text);
    }
    let mut text = String::with_capacity(bytes.len());
    for chunk in bytes.utf8_chunks() {
        text.push_str(chunk.valid());
        let latin = chunk.invalid().iter().map(|byte| match byte {
            0x80..=0x9f => char::from_u32(PRIVATE + u32::from(*byte)).unwrap_or('\u{fffd}'),
            byte => char::from(*byte),
        });
        text.extend(latin);
    }
    Cow::Owned(text)
}

/// Ends every line with a line feed: a carriage return without one, as old Macintoshes wrote it, becomes one.
pub(crate) fn end_lines(bytes: &mut [u8]) {
    for at in 0..bytes.len() {
        if bytes[at] == b'\r' && bytes.get(at + 1) != Some(&b'\n') {
            bytes[at] = b'\n';
        }
    }
}

/// The UTF-8 of a text in UTF-16, which its mark or the zeros of its first letters show; none where it is none.
pub(crate) fn from_utf16(bytes: &[u8]) -> Option<String> {
    let (little, start) = match bytes {
        [0xff, 0xfe, ..] => (true, 2),
        [0xfe, 0xff, ..] => (false, 2),
        [1..=127, 0, 1..=127, 0, ..] => (true, 0),
        [0, 1..=127, 0, 1..=127, ..] => (false, 0),
        _ => return None,
    };
    let unit = |b: &[u8]| match little {
        true => u16::from_le_bytes([b[0], b[1]]),
        false => u16::from_be_bytes([b[0], b[1]]),
    };
    let units = bytes[start..].chunks_exact(2).map(unit);
    Some(
        char::decode_utf16(units)
            .map(|c| c.unwrap_or('\u{fffd}'))
            .collect(),
    )
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

/// The text of a file of plain words, without its byte order mark, every line ended by a line feed. What is not UTF-8 is
/// taken as Latin-1: see [`decode`].
pub(crate) fn plain(name: &str, mut bytes: Vec<u8>) -> Result<String, Error> {
    check_text(name, &bytes)?;
    end_lines(&mut bytes);
    let mut text =
        String::from_utf8(bytes).unwrap_or_else(|error| decode(error.as_bytes()).into_owned());
    if text.starts_with('\u{feff}') {
        text.drain(..'\u{feff}'.len_utf8());
    }
    Ok(text)
}
