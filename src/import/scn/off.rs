//! OFF meshes: header, counts, vertices, faces of any size. Flat: the course's tools light them by face.
//!
//! Read: `OFF` with the prefixes ST, C and N, a missing header word, comments, counts on the header's line, faces of
//! three corners and more. Texture coordinates and normals are kept. Colours are dropped with a note, and so are faces
//! of one or two corners. Refused: binary files, 4OFF and nOFF.

use super::mesh::settle_normals;
use crate::error::{Error, Note};
use crate::import::lexer::{Lexer, Token};
use crate::import::polygon;
use crate::math::{DVec2, DVec3};
use crate::scene::Mesh;

/// What a header announces for every vertex.
#[derive(Clone, Copy, Debug, Default)]
struct Header {
    texcoords: bool,
    normals: bool,
}

/// A reading under way.
struct Reader<'a> {
    lexer: Lexer<'a>,
    mesh: Mesh,
    /// Lines with more numbers than the format asks for, or faces of too few corners: how many, and the first.
    colors: Option<(u64, Token<'a>)>,
    thin: Option<(u64, Token<'a>)>,
}

/// Reads the text of a file.
pub(super) fn read(file: &str, text: &str, notes: &mut Vec<Note>) -> Result<Mesh, Error> {
    let mut reader = Reader {
        lexer: Lexer::new(file, text),
        mesh: Mesh::default(),
        colors: None,
        thin: None,
    };
    let header = reader.header()?;
    let vertices = reader.count("vertices")?;
    let faces = reader.count("faces")?;
    reader.skip_edges();
    for _ in 0..vertices {
        reader.vertex(header)?;
    }
    let mut corners = Vec::new();
    for _ in 0..faces {
        reader.face(&mut corners)?;
    }
    reader.notes(notes);
    settle_normals(&mut reader.mesh);
    if reader.mesh.triangles.is_empty() {
        return Err(Error::input(reader.lexer.end(), "the mesh has no face"));
    }
    Ok(reader.mesh)
}

impl<'a> Reader<'a> {
    /// The next word that is not in a comment stays unread.
    fn skip_comments(&mut self) {
        while let Some(token) = self.lexer.peek().filter(|t| t.text.starts_with('#')) {
            self.lexer.skip_comment(&token);
        }
    }

    /// The header word, where there is one.
    fn header(&mut self) -> Result<Header, Error> {
        self.skip_comments();
        let token = self.lexer.word("OFF")?;
        let refuse = |what: &str| Error::Unsupported {
            place: Some(Box::new(self.lexer.place(&token))),
            message: format!("{what} are not imported"),
            help: Some("convert the mesh to plain OFF or to OBJ".into()),
        };
        let Some(prefix) = token.text.strip_suffix("OFF") else {
            if token.text.parse::<u64>().is_ok() {
                // No header word: this was the count already.
                self.lexer.rewind(&token);
                return Ok(Header::default());
            }
            return Err(self.lexer.expected("OFF", Some(&token)));
        };
        if prefix.contains(['4', 'n']) {
            return Err(refuse("OFF meshes of other than three dimensions"));
        }
        let (texcoords, rest) = match prefix.strip_prefix("ST") {
            Some(rest) => (true, rest),
            None => (false, prefix),
        };
        let rest = rest.strip_prefix('C').unwrap_or(rest);
        let (normals, rest) = match rest.strip_prefix('N') {
            Some(rest) => (true, rest),
            None => (false, rest),
        };
        if !rest.is_empty() {
            return Err(self.lexer.expected("OFF", Some(&token)));
        }
        if self.lexer.peek().is_some_and(|t| t.text == "BINARY") {
            return Err(refuse("binary OFF meshes"));
        }
        Ok(Header { texcoords, normals })
    }

    fn count(&mut self, of: &str) -> Result<u64, Error> {
        self.skip_comments();
        let what = format!("the number of {of}");
        let (count, token) = self.lexer.integer(&what)?;
        u64::try_from(count).map_err(|_| self.lexer.expected(&what, Some(&token)))
    }

    /// The third count, of edges, is often left out or wrong, and nothing needs it: the rest of the line, or a line of
    /// one number.
    fn skip_edges(&mut self) {
        if self.lexer.next_on_line().is_some() {
            return self.lexer.skip_line();
        }
        self.skip_comments();
        let line = self.lexer.clone();
        self.lexer.next();
        if self.lexer.next_on_line().is_some() {
            self.lexer = line;
        }
    }

    fn vector(&mut self, what: &str) -> Result<DVec3, Error> {
        let mut xyz = [0.0; 3];
        for x in &mut xyz {
            *x = self.lexer.number(what)?.0;
        }
        Ok(DVec3::from_array(xyz))
    }

    fn vertex(&mut self, header: Header) -> Result<(), Error> {
        self.skip_comments();
        let position = self.vector("a coordinate of a vertex")?;
        self.mesh.positions.push(position);
        if header.normals {
            let normal = self.vector("a coordinate of a normal")?;
            self.mesh.normals.push(normal);
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

    fn face(&mut self, corners: &mut Vec<u32>) -> Result<(), Error> {
        self.skip_comments();
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
            let vertices = self.mesh.positions.len();
            match usize::try_from(index) {
                Ok(i) if i < vertices => corners.push(i as u32),
                _ => {
                    let message = format!("vertex {index}: there are {vertices}, counted from 0");
                    return Err(self.lexer.error(&token, message));
                }
            }
        }
        if let Some(token) = self.lexer.next_on_line() {
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
        let triangles = polygon::triangulate(corners, |i| positions[i as usize]);
        let proper = |t: &[u32; 3]| t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
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
        self.skip_comments();
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
