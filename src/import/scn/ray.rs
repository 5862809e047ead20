//! Meshes in the course's .ray files: `#vertex` with position, normal and texture coordinates, `#shape_triangle` with a
//! material number and three vertex numbers from 0.
//!
//! The material number is not used: the `mesh` command has one of its own. Some files leave it out. Normals of no length
//! stand for "none": where some vertices have one and some have none, the others get area-weighted normals. Whatever
//! else such a file may hold (cameras, lights, other shapes) is dropped with a note.

use super::mesh::settle_normals;
use crate::error::{Error, Note};
use crate::import::lexer::{Lexer, Token};
use crate::math::{DVec2, DVec3};
use crate::scene::Mesh;

/// Reads the text of a file.
pub(super) fn read(file: &str, text: &str, notes: &mut Vec<Note>) -> Result<Mesh, Error> {
    let mut lexer = Lexer::new(file, text);
    let mut mesh = Mesh::default();
    let mut dropped: Option<(u64, Token<'_>)> = None;
    let mut dropping = false;
    while let Some(token) = lexer.next() {
        match token.text {
            "#vertex" => vertex(&mut lexer, &mut mesh)?,
            "#shape_triangle" => triangle(&mut lexer, &mut mesh)?,
            other if other.starts_with('#') => {
                let (count, first) = dropped.unwrap_or((0, token));
                dropped = Some((count + 1, first));
                dropping = true;
                continue;
            }
            _ if dropping => continue,
            _ => return Err(lexer.expected("#vertex or #shape_triangle", Some(&token))),
        }
        dropping = false;
    }
    if let Some((count, token)) = dropped {
        let message = match count {
            1 => format!("`{}` is no part of a mesh: dropped", token.text),
            _ => format!(
                "`{}` and {} more are no part of a mesh: dropped",
                token.text,
                count - 1
            ),
        };
        let place = Some(lexer.place(&token));
        notes.push(Note { place, message });
    }
    if mesh.triangles.is_empty() {
        return Err(Error::input(lexer.end(), "the mesh has no face"));
    }
    settle_normals(&mut mesh);
    Ok(mesh)
}

fn vertex(lexer: &mut Lexer<'_>, mesh: &mut Mesh) -> Result<(), Error> {
    let mut numbers = [0.0; 8];
    for x in &mut numbers {
        *x = lexer
            .number("one of eight numbers: position, normal, texture coordinates")?
            .0;
    }
    let [x, y, z, nx, ny, nz, s, t] = numbers;
    mesh.positions.push(DVec3::new(x, y, z));
    mesh.normals.push(DVec3::new(nx, ny, nz));
    mesh.texcoords.push(DVec2::new(s, t));
    Ok(())
}

/// The material number, which is not used, and three vertex numbers; or those alone.
fn triangle(lexer: &mut Lexer<'_>, mesh: &mut Mesh) -> Result<(), Error> {
    let what = "a vertex number";
    let mut found = Vec::with_capacity(4);
    for _ in 0..3 {
        found.push(lexer.integer(what)?);
    }
    if lexer
        .peek()
        .is_some_and(|token| !token.text.starts_with('#'))
    {
        found.push(lexer.integer(what)?);
    }
    let mut corners = [0; 3];
    let vertices = mesh.positions.len();
    for (corner, (index, token)) in corners.iter_mut().zip(&found[found.len() - 3..]) {
        match usize::try_from(*index) {
            Ok(i) if i < vertices => *corner = i as u32,
            _ => {
                let message = format!("vertex {index}: there are {vertices} so far, from 0");
                return Err(lexer.error(token, message));
            }
        }
    }
    let [a, b, c] = corners;
    if a != b && b != c && c != a {
        mesh.triangles.push(corners);
    }
    Ok(())
}
