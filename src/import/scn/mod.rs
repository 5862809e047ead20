//! Princeton's .scn, the scene format of the courses COS 426 and COS 526, in both dialects and with GAPS's `group`.
//!
//! In: a scene file and what it includes. Out: materials and objects in world space, and the rest (image, camera, light
//! model, lights) as the text of a TOML document, so that `--set` reaches it as it does any scene file's.
//!
//! The mapping is the course's own viewer, which is fixed-function OpenGL, wherever GL has a word for it: scene ambient =
//! `ambient` (black where unstated), light diffuse = specular = its colour, light ambient 0, attenuation = ca, la, qa
//! (none for `dir_light`), cutoff = degrees(sc), exponent = sd. The optics are the course's tracer: mirror weight = ks,
//! transmission = kt, index ir. So is the highlight, (V.R)^n, since that is what the course teaches; the viewer's is
//! `--set light_model.specular_model=half-vector`. `xfov`, half of the horizontal angle, stays with the scene, so that
//! the vertical one fits whatever size the picture gets.
//!
//! Angles are radians, matrices row by row. Groups are flattened: an object's transform is the product of its groups'.
//! Lights and the camera are not moved by groups, as in both of the course's readers. A negative material number is the
//! group's material; an included file starts with none and numbers its own. Neighbouring triangles of one material
//! become one mesh, so that a solid made of them is one solid to refraction.
//!
//! What the course leaves open: the default camera stands 3 half diagonals off the tight bounds (the course's grow in
//! rotated groups), lines included. A box without thickness becomes a patch that faces the eye. Refraction follows this
//! program's rule for nested media; the course's tracer knows only vacuum outside.
//!
//! Not read, each with a note or an error: lines, textures, the extent of area lights, particles, `obb`, a mesh's own
//! materials.

mod command;
mod lights;
mod mesh;
mod off;
mod ray;
mod shapes;
mod surface;
mod view;

use std::collections::HashMap;
use std::sync::Arc;

use super::lexer::{Lexer, Token};
use super::native::Contents;
use super::text::{self, Home};
use crate::error::{Error, Note, Place};
use crate::math::color::Rgb;
use crate::math::{DAffine3, DMat3, DVec3};
use crate::scene::fit::Bounds;
use crate::scene::{Geometry, Mesh, Object};
use command::Command;
use view::View;

/// Most characters of a scene and its includes together.
const MAX_TEXT: u64 = 64 << 20;
/// Deepest include, and most includes.
const MAX_INCLUDE_DEPTH: usize = 16;
const MAX_INCLUDES: usize = 256;
/// Deepest group.
const MAX_GROUP_DEPTH: usize = 1024;
/// Most objects and lights.
const MAX_OBJECTS: usize = 1 << 20;
const MAX_LIGHTS: usize = 4096;
/// Notes about one kind of thing stop at so many.
const MAX_NOTES: usize = 64;

/// What a scene file holds.
pub(crate) struct Loaded {
    /// Materials, objects and the horizontal angle.
    pub(crate) contents: Contents,
    /// Image, camera, light model and lights as TOML.
    pub(crate) document: String,
    pub(crate) notes: Vec<Note>,
}

/// Loads a scene file.
pub(crate) fn load(home: &Home, file: &str) -> Result<Loaded, Error> {
    let mut reader = Reader::new(home);
    reader.file(file, DAffine3::IDENTITY)?;
    reader.finish(file)
}

/// A reading under way.
struct Reader<'h> {
    home: &'h Home,
    contents: Contents,
    notes: Vec<Note>,
    /// `[light.NAME]` sections so far, and how many of them.
    lights: String,
    light_count: usize,
    view: Option<View>,
    background: Option<Rgb>,
    ambient: Option<Rgb>,
    /// How many commands of each word made something.
    counts: HashMap<&'static str, usize>,
    /// Material of what has none.
    default_material: Option<usize>,
    material_of_name: HashMap<String, usize>,
    meshes: HashMap<String, Arc<Mesh>>,
    mesh_triangles: u64,
    /// The object that a further triangle may join.
    open_triangles: Option<usize>,
    /// Patches that stand for boxes without thickness.
    flat_boxes: Vec<usize>,
    /// Lines: where the first stands, and their ends' bounds.
    first_line: Option<Place>,
    line_bounds: Option<Bounds>,
    /// Files under reading, outermost first; how many were read, and of how many characters.
    open_files: Vec<String>,
    includes: usize,
    text_read: u64,
}

/// A file under reading.
struct File {
    /// From the scene file's folder.
    path: String,
    /// Its materials so far, as indices into the scene's.
    materials: Vec<usize>,
    /// Open groups; the file itself is the first.
    groups: Vec<Group>,
}

/// An open group.
struct Group {
    world_from_group: DAffine3,
    /// `None` = the default one.
    material: Option<usize>,
    name: Option<String>,
    /// Where it begins; `None` for the file itself.
    begin: Option<Place>,
}

impl File {
    /// The innermost open group.
    fn group(&self) -> Option<&Group> {
        self.groups.last()
    }

    /// The folder that it lies in, with a slash at the end.
    fn folder(&self) -> &str {
        let folder = self.path.rfind(['/', '\\']);
        folder.map_or("", |i| &self.path[..=i])
    }

    /// The path of a file that this one names.
    fn beside(&self, name: &str) -> String {
        if std::path::Path::new(name).is_absolute() {
            return name.to_owned();
        }
        format!("{}{name}", self.folder())
    }
}

impl<'h> Reader<'h> {
    fn new(home: &'h Home) -> Self {
        Self {
            home,
            contents: Contents::default(),
            notes: Vec::new(),
            lights: String::new(),
            light_count: 0,
            view: None,
            background: None,
            ambient: None,
            counts: HashMap::new(),
            default_material: None,
            material_of_name: HashMap::new(),
            meshes: HashMap::new(),
            mesh_triangles: 0,
            open_triangles: None,
            flat_boxes: Vec::new(),
            first_line: None,
            line_bounds: None,
            open_files: Vec::new(),
            includes: 0,
            text_read: 0,
        }
    }

    /// Reads a file into a group.
    fn file(&mut self, path: &str, world_from_group: DAffine3) -> Result<(), Error> {
        let name = self.home.name(path);
        let bytes = self.home.read(path, MAX_TEXT)?;
        self.text_read += bytes.len() as u64;
        if self.text_read > MAX_TEXT {
            let limit = MAX_TEXT >> 20;
            let message = format!("{name}: the scene and its includes exceed {limit} MiB");
            return Err(Error::limit(message).with_help("keep large meshes in .off or .obj files"));
        }
        let text = text::plain(&name, bytes)?;
        let mut lexer = Lexer::new(&name, &text);
        let group = Group {
            world_from_group,
            material: None,
            name: None,
            begin: None,
        };
        let mut file = File {
            path: path.to_owned(),
            materials: Vec::new(),
            groups: vec![group],
        };
        self.open_files.push(path.to_owned());
        while let Some(token) = lexer.next() {
            if token.text.starts_with('#') {
                lexer.skip_comment(&token);
                continue;
            }
            let mut command = Command::find(&mut lexer, token)?;
            self.command(&mut file, &mut command)?;
        }
        self.open_files.pop();
        self.open_triangles = None;
        match file.groups.pop().and_then(|group| group.begin) {
            Some(place) => Err(Error::input(
                place,
                "expected `end` for this group, found none",
            )),
            None => Ok(()),
        }
    }

    fn command(&mut self, file: &mut File, command: &mut Command<'_, '_>) -> Result<(), Error> {
        if command.word == "tri" {
            return self.triangle(file, command);
        }
        self.open_triangles = None;
        match command.word {
            "box" => self.cuboid(file, command),
            "sphere" => self.sphere(file, command),
            "cylinder" => self.cylinder(file, command),
            "cone" => self.cone(file, command),
            "circle" => self.circle(file, command),
            "mesh" => self.mesh(file, command),
            "line" => self.line(file, command),
            "begin" | "group" => self.begin(file, command),
            "end" => end(file, command),
            "material" => self.read_material(file, command),
            "camera" => self.camera(file, command),
            "include" => self.include(file, command),
            "background" => {
                self.background = Some(command.color("the colour")?);
                Ok(())
            }
            "ambient" => {
                self.ambient = Some(command.color("the colour")?);
                Ok(())
            }
            _ => self.light(file, command),
        }
    }

    fn begin(&mut self, file: &mut File, command: &mut Command<'_, '_>) -> Result<(), Error> {
        let name = match command.word {
            "group" => Some(command.name("the name")?.text.to_owned()),
            _ => None,
        };
        let material = self.stated_material(file, command)?;
        let (m, tokens) = command.numbers::<16>("the matrix")?;
        if m[12..] != [0.0, 0.0, 0.0, 1.0] {
            let message = "expected 0 0 0 1 as the last row of the matrix (no projection)";
            return Err(command
                .error(&tokens[12], message)
                .with_help("numbers stand row by row; the translation is the last of each row"));
        }
        if file.groups.len() > MAX_GROUP_DEPTH {
            let message =
                format!("groups stand inside each other more than {MAX_GROUP_DEPTH} deep");
            return Err(command.error(&command.token, message));
        }
        let column = |i: usize| DVec3::new(m[i], m[4 + i], m[8 + i]);
        let linear = DMat3::from_cols(column(0), column(1), column(2));
        let parent_from_group = DAffine3::from_mat3_translation(linear, column(3));
        let parent = file
            .group()
            .map_or(DAffine3::IDENTITY, |g| g.world_from_group);
        let world_from_group = parent * parent_from_group;
        let det = world_from_group.matrix3.determinant();
        if !(world_from_group.is_finite() && det.is_finite()) {
            let message = "the matrices of the groups together leave the number range";
            return Err(command.error(&tokens[0], message));
        }
        if det == 0.0 {
            let message = "the matrix flattens what is in the group";
            return Err(command.error(&tokens[0], message));
        }
        let outer = file.group().and_then(|g| g.name.as_ref());
        let name = match (outer, name) {
            (Some(outer), Some(name)) => Some(format!("{outer}.{name}")),
            (outer, name) => name.or(outer.cloned()),
        };
        file.groups.push(Group {
            world_from_group,
            material,
            name,
            begin: Some(command.lexer.place(&command.token)),
        });
        Ok(())
    }

    fn include(&mut self, file: &File, command: &mut Command<'_, '_>) -> Result<(), Error> {
        let token = command.name("the file")?;
        let path = self.found(file, command, &token);
        let refuse = |message: String| Err(command.error(&token, message));
        if self.open_files.contains(&path) {
            return refuse(format!("{} includes itself", self.home.name(&path)));
        }
        if self.open_files.len() >= MAX_INCLUDE_DEPTH {
            return refuse(format!(
                "files include each other more than {MAX_INCLUDE_DEPTH} deep"
            ));
        }
        self.includes += 1;
        if self.includes > MAX_INCLUDES {
            return refuse(format!("the scene includes more than {MAX_INCLUDES} files"));
        }
        if !self.home.exists(&path) {
            let message = format!("there is no file {}", self.home.name(&path));
            let help = "a file is looked for beside the one that includes it";
            return Err(command.error(&token, message).with_help(help));
        }
        let world_from_group = file
            .group()
            .map_or(DAffine3::IDENTITY, |g| g.world_from_group);
        self.file(&path, world_from_group)
    }

    /// Adds an object to the innermost group.
    fn push(
        &mut self,
        file: &File,
        command: &Command<'_, '_>,
        geometry: Geometry,
        material: usize,
    ) -> Result<(), Error> {
        if self.contents.objects.len() >= MAX_OBJECTS {
            let message = format!("the scene has more than {MAX_OBJECTS} objects");
            return Err(command.error(&command.token, message));
        }
        let count = self.count(command.word);
        let group = file.group();
        let own = format!("{}{count}", command.word);
        let name = match group.and_then(|g| g.name.as_ref()) {
            Some(outer) => format!("{outer}.{own}"),
            None => own,
        };
        self.contents.objects.push(Object {
            name,
            geometry,
            materials: vec![material],
            world_from_object: group.map_or(DAffine3::IDENTITY, |g| g.world_from_group),
            tessellation: None,
            priority: 0,
        });
        Ok(())
    }

    /// The path of a file that a file names, or of the one that it most likely means, with a note.
    fn found(&mut self, file: &File, command: &Command<'_, '_>, token: &Token<'_>) -> String {
        let path = file.beside(token.text);
        if self.home.exists(&path) {
            return path;
        }
        let found = self.home.find(file.folder(), token.text.as_bytes());
        let found = found.and_then(|(found, _)| found.into_os_string().into_string().ok());
        let Some(found) = found else {
            return path;
        };
        let message = format!("{}: {} is read", token.text, self.home.name(&found));
        self.note_at(command, "file", message);
        found
    }

    /// Counts what a word makes, from 1.
    fn count(&mut self, word: &'static str) -> usize {
        let count = self.counts.entry(word).or_default();
        *count += 1;
        *count
    }

    fn note(&mut self, place: Option<Place>, message: impl Into<String>) {
        let message = message.into();
        self.notes.push(Note { place, message });
    }

    /// A note at a command, unless its kind had many already.
    fn note_at(&mut self, command: &Command<'_, '_>, kind: &'static str, message: String) {
        if self.count(kind) <= MAX_NOTES {
            let place = command.lexer.place(&command.token);
            self.note(Some(place), message);
        }
    }
}

fn end(file: &mut File, command: &Command<'_, '_>) -> Result<(), Error> {
    if file.groups.len() < 2 {
        return Err(command.error(&command.token, "there is no open group to end"));
    }
    file.groups.pop();
    Ok(())
}
