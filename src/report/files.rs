//! Files: which format a path asks for, and writes that leave the old file or the new one, never half of one.
//!
//! The extension decides the format ([`Format::of_path`]). Bytes are written to a temporary name in the same folder and
//! renamed over the target; what is not a regular file (a device, a pipe) is written directly, because a rename would
//! replace it. Times, users and machine names are never written: same picture, same bytes.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::error::{Error, Note};
use crate::frame::Plane;

use super::formats;
use super::layered::{self, NamedLayer};

/// Picture formats that rastray writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// 8 bits a channel, clamped; for viewing.
    Png,
    /// OpenEXR: f32, unclamped, lossless, named layers.
    Exr,
    /// Portable float map: f32, unclamped, one picture, no compression.
    Pfm,
    /// Radiance RGBE: 8-bit mantissas with a shared exponent, no negative values.
    Hdr,
}

/// Extension of each format, as written in paths and named in messages.
const EXTENSIONS: [(&str, Format); 4] = [
    ("png", Format::Png),
    ("exr", Format::Exr),
    ("pfm", Format::Pfm),
    ("hdr", Format::Hdr),
];

impl Format {
    /// The format that a path's extension asks for; capitals count as small letters.
    ///
    /// ```
    /// use rastray::report::files::Format;
    /// assert_eq!(Format::of_path("out/ball.EXR".as_ref()).unwrap(), Format::Exr);
    /// let error = Format::of_path("ball.tiff".as_ref()).unwrap_err();
    /// assert!(error.to_string().contains(".png"));
    /// ```
    pub fn of_path(path: &Path) -> Result<Self, Error> {
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        let found = EXTENSIONS
            .iter()
            .find(|(name, _)| Some(*name) == extension.as_deref());
        found.map(|(_, format)| *format).ok_or_else(|| {
            let known = EXTENSIONS.map(|(name, _)| format!(".{name}")).join(", ");
            let got = match &extension {
                Some(extension) => format!("pictures are not written as .{extension}"),
                None => "the name has no extension, so its format is unknown".to_owned(),
            };
            let message = format!("{got}; expected one of {known}");
            Error::parameter(path.display().to_string(), message)
        })
    }

    /// Float formats hold unclamped values; PNG clamps.
    pub fn is_float(self) -> bool {
        self != Self::Png
    }
}

/// How linear colours become the values of a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum View {
    /// Stored value = linear value, as OpenGL's frame buffer holds it (no gamma).
    #[default]
    Linear,
    /// The sRGB transfer function, asked for with `--srgb`. Beyond [0, 1], in float files, the curve goes on, and
    /// negative values mirror it.
    Srgb,
}

/// The bytes of a picture in a format, and what the format loses.
#[derive(Clone, Debug)]
pub struct Encoded {
    /// The file.
    pub bytes: Vec<u8>,
    /// What the reader of the file must know; empty where nothing was lost.
    pub notes: Vec<Note>,
}

/// Encodes a picture; `layers` go into EXR and are an error elsewhere.
pub fn encode(
    format: Format,
    picture: &Plane<[f32; 3]>,
    view: View,
    layers: &[NamedLayer],
) -> Result<Encoded, Error> {
    if format != Format::Exr && !layers.is_empty() {
        return Err(
            Error::parameter("--layers", "only .exr files hold named layers")
                .with_help("write to a name that ends in .exr"),
        );
    }
    match format {
        Format::Png => Ok(Encoded {
            bytes: formats::png(picture, view)?,
            notes: Vec::new(),
        }),
        Format::Pfm => formats::pfm(picture, view),
        Format::Hdr => formats::hdr(picture, view),
        Format::Exr => Ok(Encoded {
            bytes: layered::exr(Some(picture), view, layers)?,
            notes: Vec::new(),
        }),
    }
}

/// Writes a picture to a path, in the format of its extension; `-` is PNG on stdout. Returns what the format loses.
pub fn write_picture(
    path: &Path,
    picture: &Plane<[f32; 3]>,
    view: View,
    layers: &[NamedLayer],
) -> Result<Vec<Note>, Error> {
    if path.as_os_str() == "-" {
        write_stdout(&encode(Format::Png, picture, view, layers)?.bytes)?;
        return Ok(Vec::new());
    }
    let encoded = encode(Format::of_path(path)?, picture, view, layers)?;
    write_bytes_atomic(path, &encoded.bytes)?;
    Ok(encoded.notes)
}

/// Writes bytes to stdout and flushes it.
pub fn write_stdout(bytes: &[u8]) -> Result<(), Error> {
    let mut out = std::io::stdout().lock();
    out.write_all(bytes)
        .and_then(|()| out.flush())
        .map_err(|source| Error::io("standard output", "write", source))
}

/// Says before the work what would stop a file from being written after it: a folder that is not there, or one of the
/// file's own name. `-` is stdout.
///
/// # Errors
/// [`Error::Parameter`] for `flag`, with what to do.
pub fn check_target(path: &Path, flag: &str) -> Result<(), Error> {
    let wrong = |message: String, help: String| {
        let message = format!("{}: {message}", path.display());
        Err(Error::parameter(flag, message).with_help(help))
    };
    if path.as_os_str() == "-" {
        return Ok(());
    }
    if path.is_dir() {
        return wrong(
            "is a folder, expected a file".into(),
            "add a file name".into(),
        );
    }
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    match folder {
        Some(folder) if folder.exists() && !folder.is_dir() => {
            let message = format!("{} is a file, not a folder", folder.display());
            wrong(message, "choose another folder".into())
        }
        Some(folder) if !folder.exists() => {
            let name = folder.display();
            wrong(
                format!("there is no folder {name}"),
                format!("make it first: mkdir -p {name}"),
            )
        }
        _ => Ok(()),
    }
}

/// [`check_target`] for a folder that is made where it is missing: what of its path exists must be folders.
///
/// # Errors
/// [`Error::Parameter`] for `flag`.
pub fn check_folder(path: &Path, flag: &str) -> Result<(), Error> {
    match path.ancestors().find(|part| part.exists()) {
        Some(part) if !part.is_dir() => {
            let message = format!("{}: is a file, expected a folder", part.display());
            Err(Error::parameter(flag, message).with_help("choose another folder"))
        }
        _ => Ok(()),
    }
}

/// Makes a folder and those above it, if they are missing.
pub fn create_folder(path: &Path) -> Result<(), Error> {
    fs::create_dir_all(path).map_err(|e| Error::io(path.display().to_string(), "create", e))
}

/// Writes a file so that a reader finds either what was there before or all of the new bytes.
///
/// A symbolic link keeps pointing where it does, and its target is replaced.
pub fn write_bytes_atomic(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    let result = match fs::metadata(&target) {
        Ok(found) if !found.is_file() => fs::write(&target, bytes),
        _ => write_and_rename(&target, bytes),
    };
    result.map_err(|source| Error::io(path.display().to_string(), "write", source))
}

/// Writes beside the target and renames; removes the temporary file where anything fails.
fn write_and_rename(target: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let (temporary, mut file) = create_beside(target)?;
    let written = file.write_all(bytes);
    drop(file);
    written
        .and_then(|()| fs::rename(&temporary, target))
        .inspect_err(|_| {
            // The first error is the one to tell; a temporary file that cannot be removed changes nothing about it.
            let _ = fs::remove_file(&temporary);
        })
}

/// Opens a new file with an unused name in the target's folder.
fn create_beside(target: &Path) -> std::io::Result<(PathBuf, fs::File)> {
    static COUNT: AtomicUsize = AtomicUsize::new(0);
    let folder = target.parent().unwrap_or(Path::new(""));
    loop {
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = folder.join(format!(".rastray-{}-{number}.tmp", std::process::id()));
        match fs::File::options().write(true).create_new(true).open(&name) {
            Err(e) if e.kind() == std::io::ErrorKind::AlreadyExists => {}
            opened => return opened.map(|file| (name, file)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_extensions_name_the_known_ones() {
        for path in ["a.tga", "a", "folder.png/a", ".png"] {
            let error = Format::of_path(path.as_ref()).unwrap_err();
            assert!(matches!(error, Error::Parameter { .. }), "{path}");
            let text = error.to_string();
            assert!(
                text.ends_with("expected one of .png, .exr, .pfm, .hdr"),
                "{text}"
            );
        }
    }

    #[test]
    fn layers_need_exr() {
        let plane = Plane::filled(2, 2, [0.0f32; 3]);
        let layer = NamedLayer {
            name: "diffuse.key".into(),
            plane: &plane,
        };
        assert!(encode(Format::Pfm, &plane, View::Linear, &[layer]).is_err());
    }

    #[test]
    fn a_write_replaces_the_whole_file_and_leaves_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bin");
        write_bytes_atomic(&path, &[1; 1000]).unwrap();
        write_bytes_atomic(&path, &[2; 10]).unwrap();
        assert_eq!(fs::read(&path).unwrap(), [2; 10]);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_refused_write_is_an_io_error_and_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let missing = folder.path().join("missing/a.png");
        let picture = Plane::filled(2, 2, [0.0f32; 3]);
        let error = write_picture(&missing, &picture, View::Linear, &[]).unwrap_err();
        assert!(matches!(
            error,
            Error::Io {
                action: "write",
                ..
            }
        ));
        // A folder cannot be replaced by a file.
        let occupied = folder.path().join("b.png");
        fs::create_dir(&occupied).unwrap();
        assert!(write_bytes_atomic(&occupied, b"x").is_err());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn targets_are_checked_before_the_work() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("file"), b"x").unwrap();
        for good in ["a.png", "file"] {
            assert!(check_target(&at(good), "--output").is_ok(), "{good}");
        }
        assert!(check_target("a.png".as_ref(), "--output").is_ok());
        assert!(check_target("-".as_ref(), "--output").is_ok());
        for (bad, expected) in [
            ("missing/a.png", "there is no folder"),
            ("file/a.png", "is a file, not a folder"),
            ("", "is a folder, expected a file"),
        ] {
            let error = check_target(&at(bad), "--output").unwrap_err();
            assert!(error.to_string().contains(expected), "{error}");
        }
        assert!(check_folder(&at("a/b/c"), "--output").is_ok());
        assert!(check_folder(folder.path(), "--output").is_ok());
        assert!(check_folder(&at("file"), "--output").is_err());
        assert!(check_folder(&at("file/a"), "--output").is_err());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn links_keep_pointing_and_devices_stay_devices() {
        let folder = tempfile::tempdir().unwrap();
        let (real, link) = (folder.path().join("real"), folder.path().join("link"));
        fs::write(&real, b"old").unwrap();
        std::os::unix::fs::symlink(&real, &link).unwrap();
        write_bytes_atomic(&link, b"new").unwrap();
        assert_eq!(fs::read(&real).unwrap(), b"new");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        write_bytes_atomic("/dev/null".as_ref(), b"gone").unwrap();
        assert!(!fs::metadata("/dev/null").unwrap().is_file());
    }
}
