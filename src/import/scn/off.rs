//! OFF meshes: header, counts, vertices, faces of any size. Flat: the course's tools light them by face.
//!
//! Read: `OFF` with the prefixes ST, C and N in any order, a missing header word, comments, counts on the header's line
//! or glued to it, faces of three corners and more. Texture coordinates and normals are kept. Colours are dropped with a
//! note, and so are faces of one or two corners. Refused: binary files, 4OFF and nOFF.
//!
//! The format is free: line ends are blanks, so that several vertices or faces may share a line. In the wild, numbers that
//! the header does not announce follow them to the end of the line, colours mostly. So the file is read free first, and
//! if that does not end with the last face exactly, by lines.

use super::mesh::settle_normals;
use crate::error::{Error, Note, Place};
use crate::import::lexer::{Lexer, Token};
use crate::import::polygon::{self, Doubts};
use crate::math::{DVec2, DVec3};
use crate::scene::Mesh;

/// What a header announces for every vertex.
#[derive(Clone, Copy, Debug, Default)]
struct Header {
    texcoords: bool,
    normals: bool,
    /// Four numbers (red, green, blue, alpha) in a free file.
    colors: bool,
    vertices: u64,
    faces: u64,
}

/// Which lists have nothing but what the header announces, so that line ends in them are blanks.
#[derive(Clone, Copy, Debug)]
struct Free {
    vertices: bool,
    faces: bool,
}

/// From the strictest to the most forgiving.
const WAYS: [Free; 4] = [
    Free {
        vertices: true,
        faces: true,
    },
    Free {
        vertices: true,
        faces: false,
    },
    Free {
        vertices: false,
        faces: true,
    },
    Free {
        vertices: false,
        faces: false,
    },
];

/// A reading under way.
struct Reader<'a> {
    lexer: Lexer<'a>,
    mesh: Mesh,
    /// Lines with more numbers than the format asks for, or faces of too few corners: how many, and the first.
    colors: Option<(u64, Token<'a>)>,
    thin: Option<(u64, Token<'a>)>,
    doubts: Doubts,
    /// How many vertices the file has; new ones may follow.
    vertices: usize,
}

/// Reads the text of a file.
pub(super) fn read(file: &str, text: &str, notes: &mut Vec<Note>) -> Result<Mesh, Error> {
    let mut lexer = Lexer::new(file, text);
    let header = header(&mut lexer)?;
    let mut result = Err(Error::input(lexer.end(), "the mesh has no face"));
    for free in WAYS {
        let mut reader = Reader {
            lexer: lexer.clone(),
            mesh: Mesh::default(),
            colors: None,
            thin: None,
            doubts: Doubts::default(),
            vertices: 0,
        };
        let read = reader.lists(header, free);
        // Only the last way may leave something.
        let whole = read.is_ok() && reader.at_end();
        result = read.map(|()| reader);
        if whole {
            break;
        }
    }
    let mut reader = result?;
    reader.notes(notes);
    settle_normals(&mut reader.mesh);
    if reader.mesh.triangles.is_empty() {
        return Err(Error::input(reader.lexer.end(), "the mesh has no face"));
    }
    Ok(reader.mesh)
}

/// The next word that is not in a comment stays unread.
fn skip_comments(lexer: &mut Lexer<'_>) {
    while let Some(token) = lexer.peek().filter(|t| t.text.starts_with('#')) {
        lexer.skip_comment(&token);
    }
}

/// The header: its word, where there is one, and the counts.
fn header(lexer: &mut Lexer<'_>) -> Result<Header, Error> {
    skip_comments(lexer);
    let token = lexer.word("OFF")?;
    let mut header = prefixes(lexer, &token)?;
    header.vertices = count(lexer, "vertices")?;
    header.faces = count(lexer, "faces")?;
    skip_edges(lexer);
    Ok(header)
}

/// What the header word announces; a count in its place or behind it is unread.
fn prefixes<'a>(lexer: &mut Lexer<'a>, token: &Token<'a>) -> Result<Header, Error> {
    let mut header = Header::default();
    let refuse = |what: &str| Error::Unsupported {
        place: Some(Box::new(lexer.place(token))),
        message: format!("{what} are not imported"),
        help: Some("convert the mesh to plain OFF or to OBJ".into()),
    };
    let number = |text: &str| text.parse::<u64>().is_ok();
    let Some((mut prefix, behind)) = token.text.split_once("OFF") else {
        if number(token.text) {
            // No header word: this was the count already.
            lexer.rewind(token);
            return Ok(header);
        }
        return Err(lexer.expected("OFF", Some(token)));
    };
    if prefix.contains(['4', 'n']) {
        return Err(refuse("OFF meshes of other than three dimensions"));
    }
    while !prefix.is_empty() {
        let (flag, letters) = match prefix.as_bytes()[0] {
            b'C' => (&mut header.colors, "C"),
            b'N' => (&mut header.normals, "N"),
            _ => (&mut header.texcoords, "ST"),
        };
        let Some(rest) = prefix.strip_prefix(letters).filter(|_| !*flag) else {
            return Err(lexer.expected("OFF", Some(token)));
        };
        (*flag, prefix) = (true, rest);
    }
    match behind {
        "" if lexer.peek().is_some_and(|t| t.text == "BINARY") => Err(refuse("binary OFF meshes")),
        "" => Ok(header),
        count if number(count) => {
            let start = token.start + token.text.len() - count.len();
            lexer.rewind(&Token { text: count, start });
            Ok(header)
        }
        _ => Err(lexer.expected("OFF", Some(token))),
    }
}

fn count(lexer: &mut Lexer<'_>, of: &str) -> Result<u64, Error> {
    skip_comments(lexer);
    let what = format!("the number of {of}");
    let (count, token) = lexer.integer(&what)?;
    u64::try_from(count).map_err(|_| lexer.expected(&what, Some(&token)))
}

/// The third count, of edges, is often left out or wrong, and nothing needs it: one more number on the line, or a
/// line of one number.
fn skip_edges(lexer: &mut Lexer<'_>) {
    if let Some(token) = lexer.next_on_line() {
        // What follows the count on its line is the first vertex already, in a free file.
        if token.text.starts_with('#') {
            lexer.skip_comment(&token);
        }
        return;
    }
    skip_comments(lexer);
    let line = lexer.clone();
    lexer.next();
    if lexer.next_on_line().is_some() {
        *lexer = line;
    }
}

impl<'a> Reader<'a> {
    /// The vertices and faces.
    fn lists(&mut self, header: Header, free: Free) -> Result<(), Error> {
        for _ in 0..header.vertices {
            self.vertex(header, free.vertices)?;
        }
        self.vertices = self.mesh.positions.len();
        let mut corners = Vec::new();
        for number in 1..=header.faces {
            self.face(&mut corners, free.faces, number as usize)?;
        }
        Ok(())
    }

    fn at_end(&mut self) -> bool {
        skip_comments(&mut self.lexer);
        self.lexer.peek().is_none()
    }

    fn vector(&mut self, what: &str) -> Result<DVec3, Error> {
        let mut xyz = [0.0; 3];
        for x in &mut xyz {
            *x = self.lexer.number(what)?.0;
        }
        Ok(DVec3::from_array(xyz))
    }

    fn vertex(&mut self, header: Header, free: bool) -> Result<(), Error> {
        skip_comments(&mut self.lexer);
        let position = self.vector("a coordinate of a vertex")?;
        self.mesh.positions.push(position);
        if header.normals {
            let normal = self.vector("a coordinate of a normal")?;
            self.mesh.normals.push(normal);
        }
        if free {
            return self.rest_of_vertex(header);
        }
        let [mut before, mut last] = [None, None];
        while let Some(token) = self.lexer.next_on_line() {
            if token.text.starts_with('#') {
                self.lexer.skip_comment(&token);
            } else {
                (before, last) = (last, Some(token));
            }
        }
        // Texture coordinates stand last, after a colour.
        if header.texcoords {
            let pair = [before, last].map(|t| t.and_then(|t| t.text.parse().ok()));
            let [Some(u), Some(v)] = pair else {
                let what = "two texture coordinates at the end of the line";
                return Err(self.lexer.expected(what, last.as_ref()));
            };
            let uv = DVec2::new(u, v);
            if !uv.is_finite() {
                let what = "finite texture coordinates";
                return Err(self.lexer.expected(what, last.as_ref()));
            }
            self.mesh.texcoords.push(uv);
        } else if let Some(token) = last {
            self.colors = Some(counted(self.colors, token));
        }
        Ok(())
    }

    /// Colour and texture coordinates, as announced.
    fn rest_of_vertex(&mut self, header: Header) -> Result<(), Error> {
        for i in 0..if header.colors { 4 } else { 0 } {
            let (_, token) = self.lexer.number("a number of a colour")?;
            if i == 0 {
                self.colors = Some(counted(self.colors, token));
            }
        }
        if header.texcoords {
            let mut uv = [0.0; 2];
            for x in &mut uv {
                *x = self.lexer.number("a texture coordinate")?.0;
            }
            self.mesh.texcoords.push(DVec2::from_array(uv));
        }
        Ok(())
    }

    fn face(&mut self, corners: &mut Vec<u32>, free: bool, number: usize) -> Result<(), Error> {
        skip_comments(&mut self.lexer);
        let what = "the number of corners of a face";
        let (count, first) = self.lexer.integer(what)?;
        let most = polygon::MAX_CORNERS as i64;
        if !(1..=most).contains(&count) {
            let what = format!("{what}, 1 to {most}");
            return Err(self.lexer.expected(&what, Some(&first)));
        }
        corners.clear();
        for _ in 0..count {
            let (index, token) = self.lexer.integer("a vertex number")?;
            let vertices = self.vertices;
            match usize::try_from(index) {
                Ok(i) if i < vertices => corners.push(i as u32),
                _ => {
                    let message = format!("vertex {index}: there are {vertices}, counted from 0");
                    return Err(self.lexer.error(&token, message));
                }
            }
        }
        if !free && let Some(token) = self.lexer.next_on_line() {
            if !token.text.starts_with('#') {
                self.colors = Some(counted(self.colors, token));
            }
            self.lexer.skip_line();
        }
        if corners.len() < 3 {
            self.thin = Some(counted(self.thin, first));
            return Ok(());
        }
        let positions = &self.mesh.positions;
        let cut = polygon::triangulate(corners.len(), |i| positions[corners[i] as usize]);
        self.doubts.add(cut.doubt, number);
        let proper = |t: &[u32; 3]| t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
        // New corners stand behind the file's vertices, which are all read.
        let triangles = cut.add_crossings(&mut self.mesh, corners);
        self.mesh
            .triangles
            .extend(triangles.iter().filter(|t| proper(t)));
        Ok(())
    }

    fn notes(&mut self, notes: &mut Vec<Note>) {
        let mut note = |token: &Token<'_>, message: String| {
            let place = Some(self.lexer.place(token));
            notes.push(Note { place, message });
        };
        if let Some((count, token)) = self.colors {
            let message = format!("colours of the mesh are not used: dropped on {count} lines");
            note(&token, message);
        }
        if let Some((count, token)) = self.thin {
            let message = format!("faces of fewer than three corners are not drawn: {count}");
            note(&token, message);
        }
        for (message, first) in self.doubts.messages() {
            let message = format!("{message} (face {first} of the file)");
            let place = Some(self.lexer.end()).map(|end| Place::file(end.file));
            notes.push(Note { place, message });
        }
        skip_comments(&mut self.lexer);
        if let Some(token) = self.lexer.peek() {
            let place = Some(self.lexer.place(&token));
            let message = "text after the last face is not read".into();
            notes.push(Note { place, message });
        }
    }
}

/// One more, and the first of them.
fn counted<'a>(so_far: Option<(u64, Token<'a>)>, token: Token<'a>) -> (u64, Token<'a>) {
    so_far.map_or((1, token), |(count, first)| (count + 1, first))
}
