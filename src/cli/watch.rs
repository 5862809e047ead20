//! `--watch` and `--open`: what happens around the runs of `render` and `compare`.
//!
//! Files are looked at five times a second: modification time and size, which every system has, and which also notices
//! editors that write a new file and rename it. A file that is missing for a moment is waited for.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::{Duration, SystemTime};

use rastray::error::Error;
use rastray::import;

use super::args::FollowArgs;
use super::options::Verbosity;
use super::{diagnostic, show};

/// Time between two looks.
const INTERVAL: Duration = Duration::from_millis(200);

/// What a run leaves for what follows it.
pub(super) struct Made {
    /// The files that it read.
    pub(super) inputs: Vec<PathBuf>,
    /// What to show.
    pub(super) result: PathBuf,
}

/// What changes when a file is saved; `None` while it cannot be read.
type Stamp = Option<(SystemTime, u64)>;

fn stamp(path: &Path) -> Stamp {
    let data = fs::metadata(path).ok()?;
    Some((data.modified().ok()?, data.len()))
}

/// The files of a run, as they were when it began.
#[derive(Debug, Default)]
struct Watch {
    seen: BTreeMap<PathBuf, Stamp>,
}

impl Watch {
    /// Takes note of every file as it is now.
    fn refresh(&mut self) {
        for (path, seen) in &mut self.seen {
            *seen = stamp(path);
        }
    }

    /// Adds the files of a run that began at `since`; one saved after that counts as changed.
    fn follow(&mut self, files: &[PathBuf], since: SystemTime) {
        for path in files {
            let now = stamp(path).filter(|(modified, _)| *modified <= since);
            self.seen.entry(path.clone()).or_insert(now);
        }
    }

    /// The first file that is not as it was; one that cannot be read at the moment is waited for.
    fn changed(&self) -> Option<&Path> {
        let mut differs = self.seen.iter().filter(|(path, seen)| {
            let now = stamp(path);
            now.is_some() && now != **seen
        });
        differs.next().map(|(path, _)| path.as_path())
    }

    /// Waits until a file was saved, and until it stays as it is.
    fn wait(&mut self) -> PathBuf {
        loop {
            if let Some(path) = self.changed().map(Path::to_path_buf) {
                loop {
                    self.refresh();
                    sleep(INTERVAL / 4);
                    if self.changed().is_none() {
                        return path;
                    }
                }
            }
            sleep(INTERVAL);
        }
    }
}

/// Runs once, or again and again, and shows the first result.
pub(super) fn follow(
    args: FollowArgs,
    scene: &str,
    verbosity: Verbosity,
    once: impl Fn() -> Result<Made, Error>,
) -> Result<(), Error> {
    let mut open = args.open;
    let mut show = |made: &Made| {
        if std::mem::take(&mut open) {
            show::open(&made.result);
        }
    };
    if !args.watch {
        return once().map(|made| show(&made));
    }
    let mut watch = Watch::default();
    watch.follow(&watched(scene)?, SystemTime::now());
    for run in 0.. {
        watch.refresh();
        let start = SystemTime::now();
        match once() {
            Ok(made) => {
                watch.follow(&made.inputs, start);
                show(&made);
            }
            // No saved file mends a wrong flag.
            Err(error @ Error::Parameter { .. }) if run == 0 => return Err(error),
            Err(error) => {
                diagnostic::print(&error);
                let file = error.place().map(|place| PathBuf::from(&place.file));
                let file: Vec<PathBuf> = file.into_iter().filter(|f| f.is_file()).collect();
                watch.follow(&file, start);
            }
        }
        let files = match watch.seen.len() {
            1 => scene.to_owned(),
            n => format!("{scene} and {} more", n - 1),
        };
        verbosity.say(format!("watching {files} (Ctrl-C ends)"));
        let saved = watch.wait();
        verbosity.say(format!("{} was saved", saved.display()));
    }
    Ok(())
}

/// The file of a scene, to start watching with.
fn watched(scene: &str) -> Result<Vec<PathBuf>, Error> {
    let path = PathBuf::from(scene);
    if !path.is_file() && import::shipped().iter().any(|s| s.name == scene) {
        let message = format!("the shipped scene {scene} is no file that could be saved");
        let advice = format!("rastray scenes {scene} > mine.toml makes one of it");
        return Err(Error::parameter("--watch", message).with_help(advice));
    }
    Ok(vec![path])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn saving_is_noticed_and_missing_files_are_waited_for() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str| folder.path().join(name);
        fs::write(file("a"), "one").unwrap();
        fs::write(file("b"), "one").unwrap();
        let mut watch = Watch::default();
        watch.follow(&[file("a"), file("b")], SystemTime::now());
        assert_eq!(watch.changed(), None);
        fs::write(file("b"), "longer").unwrap();
        assert_eq!(watch.changed(), Some(file("b").as_path()));
        watch.refresh();
        assert_eq!(watch.changed(), None);
        // Removed, and back with another content: as editors save.
        fs::remove_file(file("a")).unwrap();
        assert_eq!(watch.changed(), None);
        fs::write(file("a"), "three").unwrap();
        assert_eq!(watch.changed(), Some(file("a").as_path()));
        assert_eq!(watch.wait(), file("a"));
        assert_eq!(watch.changed(), None);
    }

    #[test]
    fn a_file_saved_during_the_first_run_counts() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mesh.obj");
        fs::write(&path, "v").unwrap();
        let before = SystemTime::now() - Duration::from_secs(5);
        let mut watch = Watch::default();
        watch.follow(std::slice::from_ref(&path), before);
        assert_eq!(watch.changed(), Some(path.as_path()));
    }
}
