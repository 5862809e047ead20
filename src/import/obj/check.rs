//! The end of a scan: indices that point nowhere, files that draw nothing, notes about what was dropped.

use std::collections::HashSet;
use std::ops::Range;

use super::scan::{DROPPED, NONE, Scan, Scanner, is_keyword};
use super::words::{Words, line_at, place};
use crate::error::{Error, Note, Place};

impl Scanner<'_> {
    /// What is wrong with a corner that could not be read.
    pub(super) fn corner_error(&self, word: Range<usize>) -> Error {
        let text = self.text(&word);
        let scan = &self.scan;
        let lists = [
            ("vertex", scan.positions.len()),
            ("texture coordinate", scan.texcoords.len()),
            ("normal", scan.normals.len()),
        ];
        for (part, (name, count)) in text.split('/').zip(lists) {
            let message = match part.parse::<i64>() {
                Ok(0) => format!("{name} 0: indices count from 1"),
                Ok(i) if i < 0 => format!("{name} {i}: there are only {count} so far"),
                Ok(i) if i >= i64::from(NONE) => format!("{name} {i} is out of range"),
                _ => continue,
            };
            return self.error(word, message);
        }
        let message = format!("expected a corner v, v/vt, v//vn or v/vt/vn, found `{text}`");
        self.error(word, message)
    }

    /// The scan, if it holds together.
    pub(super) fn finish(mut self) -> Result<Scan, Error> {
        if self.scan.faces.is_empty() {
            return Err(self.no_face());
        }
        self.check_indices()?;
        self.check_unusable()?;
        self.note_oddities();
        for (name, count, span) in std::mem::take(&mut self.scan.dropped) {
            let known = DROPPED.contains(&name.as_str());
            let what = if known {
                "is not drawn"
            } else {
                "is no OBJ statement"
            };
            let message = match count {
                1 => format!("`{name}` {what}: dropped"),
                _ => format!("`{name}` {what}: dropped {count} times"),
            };
            self.scan.notes.push(Note {
                place: Some(place(self.file, self.bytes, span)),
                message,
            });
        }
        Ok(self.scan)
    }

    /// The file draws nothing: what to say depends on what it holds instead.
    fn no_face(&self) -> Error {
        let first = self.scan.unusable.first().map(|item| &item.wrong);
        let thin = self.scan.thin.as_ref().map(|(_, wrong)| wrong);
        if let Some(wrong) = first.or(thin) {
            return self.wrong(wrong);
        }
        let strange = self
            .scan
            .dropped
            .iter()
            .find(|d| !DROPPED.contains(&d.0.as_str()));
        match strange {
            Some((name, _, span)) if self.scan.positions.is_empty() => {
                let message =
                    format!("expected an OBJ statement (v, vt, vn, f, ...), found `{name}`");
                self.error(span.clone(), message)
            }
            _ => Error::input(Place::file(self.file), "the mesh has no face"),
        }
    }

    /// What could not be read is a note where no face needs it, and an error where one does. A normal that is not finite has
    /// no length, so faces compute theirs; a texture coordinate that is not is 0, since textures are not drawn.
    fn check_unusable(&mut self) -> Result<(), Error> {
        for (keyword, list) in [
            ("v", &self.scan.corners),
            ("vt", &self.scan.corner_texcoords),
            ("vn", &self.scan.corner_normals),
        ] {
            let items = || self.scan.unusable.iter().filter(|u| u.keyword == keyword);
            let Some(first) = items().next() else {
                continue;
            };
            let strict = |index: &u32| {
                let fits = |u: &&super::scan::Unusable| u.index == *index;
                items().find(fits).filter(|u| !u.infinite || keyword == "v")
            };
            let known: HashSet<u32> = items().map(|u| u.index).collect();
            let mut used = list.iter().filter(|index| known.contains(*index));
            if let Some(needed) = used.find_map(strict) {
                return Err(self.wrong(&needed.wrong));
            }
            let many = match items().count() {
                1 => String::new(),
                n => format!(" (the first of {n})"),
            };
            let message = format!("`{keyword}` cannot be used: {}{many}", first.wrong.message);
            let place = Some(place(self.file, self.bytes, first.wrong.span.clone()));
            self.scan.notes.push(Note { place, message });
        }
        Ok(())
    }

    fn note_oddities(&mut self) {
        if let Some((count, wrong)) = self.scan.thin.take() {
            let message = match count {
                1 => format!("{}: not drawn", wrong.message),
                n => format!("{}: not drawn, as are {} more", wrong.message, n - 1),
            };
            let place = Some(place(self.file, self.bytes, wrong.span));
            self.scan.notes.push(Note { place, message });
        }
        if let Some((count, span)) = self.scan.stray.take() {
            let many = if count > 1 {
                format!(" ({count} times)")
            } else {
                String::new()
            };
            let message = format!(
                "the `\\` at the end of this line does not join the next one to it, which is a statement of its own{many}"
            );
            let place = Some(place(self.file, self.bytes, span));
            self.scan.notes.push(Note { place, message });
        }
    }

    fn check_indices(&self) -> Result<(), Error> {
        let scan = &self.scan;
        let lists: [(&str, &[u32], usize); 3] = [
            ("vertex", &scan.corners, scan.positions.len()),
            (
                "texture coordinate",
                &scan.corner_texcoords,
                scan.texcoords.len(),
            ),
            ("normal", &scan.corner_normals, scan.normals.len()),
        ];
        for (name, indices, count) in lists {
            let beyond = |i: &u32| *i != NONE && *i as usize >= count;
            if let Some(corner) = indices.iter().position(beyond) {
                let message = format!(
                    "{name} {}: there are only {count}",
                    u64::from(indices[corner]) + 1
                );
                return Err(self.error(self.corner_span(corner), message));
            }
        }
        Ok(())
    }

    /// Where a corner stands: its face's line is read again.
    fn corner_span(&self, corner: usize) -> Range<usize> {
        let faces = &self.scan.faces;
        let face = faces.partition_point(|f| f.end as usize <= corner);
        let first = face.checked_sub(1).map_or(0, |f| faces[f].end as usize);
        let start = faces[face].line as usize;
        let end = line_at(self.bytes, start, is_keyword).end;
        let mut words = Words::new(self.bytes, start..end);
        words.nth(corner - first + 1).unwrap_or(start..start + 1)
    }
}
