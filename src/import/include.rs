//! `include = ["materials.toml"]`: the materials of other files, as if they stood before the file's own.
//!
//! In: a document and its home. Out: the same document with the included `[material.NAME]` sections in front of its own
//! and without `include`, each section still knowing its file. Paths are relative to the file that names them. An
//! included file holds materials and further includes, nothing else; it is read once, however often it is named. A name
//! that stands twice is an error, as in one file. Which convention the materials are read in is the scene file's word.

use std::collections::HashMap;

use super::document::{Document, Key, Node, Value};
use super::reader::{mismatch, table};
use super::text::{self, Home, MAX_TEXT};
use crate::error::Error;

/// Deepest include.
const MAX_DEPTH: usize = 16;
/// Most files.
const MAX_FILES: usize = 256;

/// Reading includes.
struct Includes<'a> {
    document: &'a mut Document,
    home: &'a Home,
    /// Files under reading, outermost first, by the name that messages use.
    open: Vec<String>,
    /// Every file read so far.
    read: Vec<String>,
    characters: u64,
    /// The materials, in the order of their files.
    materials: Vec<(Key, Node)>,
    /// The file that each material stands in.
    file_of: HashMap<String, String>,
}

/// Replaces `include` by what it names.
pub(super) fn resolve(document: &mut Document, home: &Home) -> Result<(), Error> {
    let Value::Table(entries) = &mut document.root.value else {
        return Ok(());
    };
    let Some(index) = entries.iter().position(|(key, _)| key.name == "include") else {
        return Ok(());
    };
    let (key, list) = entries.remove(index);
    let file = document.whole().file;
    let mut includes = Includes {
        document,
        home,
        open: vec![file],
        read: Vec::new(),
        characters: 0,
        materials: Vec::new(),
        file_of: HashMap::new(),
    };
    includes.list(&list, "")?;
    let (materials, file_of) = (includes.materials, includes.file_of);
    splice(document, &key, materials, &file_of)
}

/// Puts included materials in front of the document's own.
fn splice(
    document: &mut Document,
    key: &Key,
    mut materials: Vec<(Key, Node)>,
    file_of: &HashMap<String, String>,
) -> Result<(), Error> {
    let own = |(key, _): &(Key, Node)| key.name == "material";
    if let Some(node) = entries(&document.root).iter().find(|entry| own(entry)) {
        for (key, _) in entries(&node.1) {
            check_new(document, key, file_of)?;
        }
    }
    let Value::Table(sections) = &mut document.root.value else {
        return Ok(());
    };
    match sections.iter_mut().find(|entry| own(entry)) {
        Some((_, node)) => {
            // Anything but a table is the reader's to refuse.
            if let Value::Table(found) = &mut node.value {
                materials.append(found);
                *found = materials;
            }
        }
        None => {
            let name = "material".into();
            let span = key.span.clone();
            let value = Value::Table(materials);
            let node = Node {
                span: span.clone(),
                value,
            };
            sections.push((Key { name, span }, node));
        }
    }
    Ok(())
}

/// The entries of a table; none of anything else.
fn entries(node: &Node) -> &[(Key, Node)] {
    match &node.value {
        Value::Table(entries) => entries,
        _ => &[],
    }
}

/// Refuses a name that an included file has.
fn check_new(
    document: &Document,
    key: &Key,
    file_of: &HashMap<String, String>,
) -> Result<(), Error> {
    let Some(file) = file_of.get(&key.name) else {
        return Ok(());
    };
    let message = format!("there is a material `{}` in {file} already", key.name);
    let help = format!(
        "give it another name; --set material.{}.KEY=VALUE changes single values of an included one",
        key.name
    );
    Err(document.error(&key.span, message).with_help(help))
}

impl Includes<'_> {
    /// Reads the files of a list, which stands in a file of this folder.
    fn list(&mut self, list: &Node, folder: &str) -> Result<(), Error> {
        let expected = "a list of file names, [\"materials.toml\"]";
        let Value::List(items) = &list.value else {
            return Err(mismatch(self.document, "include", list, expected));
        };
        for item in items {
            let Value::Text(name) = &item.value else {
                return Err(mismatch(self.document, "include", item, "a file name"));
            };
            let path = match std::path::Path::new(name).is_absolute() {
                true => name.clone(),
                false => format!("{folder}{name}"),
            };
            self.file(item, path)?;
        }
        Ok(())
    }

    /// Reads a file, which `item` names.
    fn file(&mut self, item: &Node, path: String) -> Result<(), Error> {
        let file = self.home.name(&path);
        let refuse = |this: &Self, message: String| this.document.error(&item.span, message);
        if self.open.contains(&file) {
            return Err(refuse(self, format!("include: {file} includes itself")));
        }
        if self.read.contains(&file) {
            return Ok(());
        }
        if self.open.len() > MAX_DEPTH || self.read.len() >= MAX_FILES {
            let message = format!("include: more than {MAX_DEPTH} deep, or {MAX_FILES} files");
            return Err(refuse(self, message));
        }
        if !self.home.exists(&path) {
            let error = refuse(self, format!("include: there is no file {file}"));
            return Err(error.with_help("a file is looked for beside the one that includes it"));
        }
        let text = text::utf8(&file, self.home.read(&path, MAX_TEXT)?)?;
        self.characters += text.len() as u64;
        if self.characters > MAX_TEXT {
            let limit = MAX_TEXT >> 20;
            let message = format!("{file}: the included files together exceed {limit} MiB");
            return Err(Error::limit(message));
        }
        let root = self.document.add_included(&file, text)?;
        self.open.push(file.clone());
        self.read.push(file.clone());
        let folder = path.rfind(['/', '\\']).map_or("", |i| &path[..=i]);
        for (key, node) in table(self.document, &root, "the file")? {
            match key.name.as_str() {
                "include" => self.list(node, folder)?,
                "material" => self.take(node, &file)?,
                name => {
                    let message = format!("an included file holds materials only, found `{name}`");
                    return Err(self.document.error(&key.span, message));
                }
            }
        }
        self.open.pop();
        Ok(())
    }

    /// Takes over the materials of a file.
    fn take(&mut self, node: &Node, file: &str) -> Result<(), Error> {
        for (key, node) in table(self.document, node, "material")? {
            check_new(self.document, key, &self.file_of)?;
            self.file_of.insert(key.name.clone(), file.to_owned());
            self.materials.push((key.clone(), node.clone()));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The scenes inside the program include files inside the program.
    #[test]
    fn embedded_files_are_found_and_named() {
        let text = "include = [\"vase.obj\"]\n".to_owned();
        let error = Document::parse("x.toml", text, &Home::Embedded, &[]).unwrap_err();
        assert!(error.to_string().starts_with("vase.obj"), "{error}");
        let text = "include = [\"none.toml\"]\n".to_owned();
        let error = Document::parse("x.toml", text, &Home::Embedded, &[]).unwrap_err();
        let message = "x.toml:1:12: include: there is no file none.toml";
        assert_eq!(error.to_string(), message);
    }
}
