//! Meshes written in the scene file: `positions` and `indices`, and `quad` with four corners.

use super::Reader;
use crate::error::Error;
use crate::import::document::{Node, Value};
use crate::import::keys::Range;
use crate::import::polygon::{self, Doubts};
use crate::import::reader::Section;
use crate::math::{DVec2, DVec3};
use crate::scene::Mesh;

impl<'a> Reader<'a> {
    pub(super) fn inline(&mut self, section: &Section<'a>) -> Result<Mesh, Error> {
        let positions = tuples::<3>(section, "positions")?.unwrap_or_default();
        let count = positions.len();
        let mut mesh = Mesh {
            positions: positions.into_iter().map(DVec3::from_array).collect(),
            ..Mesh::default()
        };
        if let Some(normals) = tuples::<3>(section, "normals")? {
            one_each(section, "normals", normals.len(), count)?;
            mesh.normals = normals.into_iter().map(DVec3::from_array).collect();
        }
        if let Some(texcoords) = tuples::<2>(section, "texcoords")? {
            one_each(section, "texcoords", texcoords.len(), count)?;
            mesh.texcoords = texcoords.into_iter().map(DVec2::from_array).collect();
        }
        if let Some(colors) = colors(section)? {
            one_each(section, "colors", colors.len(), count)?;
            mesh.colors = colors;
        }
        mesh.triangles = match section.list("indices", "a list of vertex numbers")? {
            Some(items) => {
                let mut doubts = Doubts::default();
                let triangles = indices(section, items, &mut mesh, &mut doubts)?;
                self.crossed(section, "indices", &doubts);
                triangles
            }
            None if count.is_multiple_of(3) => {
                let triangle = |i: u32| [3 * i, 3 * i + 1, 3 * i + 2];
                (0..count as u32 / 3).map(triangle).collect()
            }
            None => {
                let message = format!(
                    "without `indices` every three make a triangle; {count} is no multiple of 3"
                );
                return Err(section.error_at("positions", message));
            }
        };
        if mesh.triangles.is_empty() {
            return Err(section.error("the mesh has no triangle"));
        }
        match section.bool("smooth")? {
            Some(true) => mesh.normals = mesh.area_weighted_normals(),
            Some(false) => mesh.normals.clear(),
            None => {}
        }
        Ok(mesh)
    }

    /// Notes about faces that cross themselves.
    fn crossed(&mut self, section: &Section<'a>, key: &str, doubts: &Doubts) {
        let span = section.get(key).map(|node| &node.span);
        for (message, first) in doubts.messages() {
            self.note(span, format!("{key}: {message} (face {first})"));
        }
    }

    /// A quad of four corners, cut so that no triangle turns over where it is planar.
    pub(super) fn corner_quad(&mut self, section: &Section<'a>) -> Result<Mesh, Error> {
        let (mesh, doubts) = quad(section)?;
        self.crossed(section, "points", &doubts);
        Ok(mesh)
    }
}

fn quad(section: &Section<'_>) -> Result<(Mesh, Doubts), Error> {
    let points = tuples::<3>(section, "points")?.unwrap_or_default();
    if points.len() != 4 {
        let message = format!("expected four corners, found {}", points.len());
        return Err(section.error_at("points", message));
    }
    let positions: Vec<DVec3> = points.into_iter().map(DVec3::from_array).collect();
    let cut = polygon::triangulate(4, |i| positions[i]);
    let mut mesh = Mesh {
        positions,
        texcoords: [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
            .map(DVec2::from)
            .to_vec(),
        ..Mesh::default()
    };
    mesh.triangles = cut.add_crossings(&mut mesh, &[0, 1, 2, 3]);
    let mut doubts = Doubts::default();
    doubts.add(cut.doubt, 1);
    Ok((mesh, doubts))
}

fn one_each(section: &Section<'_>, key: &str, found: usize, count: usize) -> Result<(), Error> {
    if found == count {
        return Ok(());
    }
    let message = format!("expected one for each of {count} positions, found {found}");
    Err(section.error_at(key, message))
}

/// N-tuples of finite numbers, written flat or nested.
pub(super) fn tuples<const N: usize>(
    section: &Section<'_>,
    key: &str,
) -> Result<Option<Vec<[f64; N]>>, Error> {
    let Some(items) = section.list(key, &format!("a list of {N} numbers each"))? else {
        return Ok(None);
    };
    let nested = matches!(items.first().map(|n| &n.value), Some(Value::List(_)));
    let expected = format!("{N} numbers");
    if nested {
        let tuple = |node: &Node| section.array::<N>(key, node, &expected);
        return items.iter().map(tuple).collect::<Result<_, _>>().map(Some);
    }
    if !items.len().is_multiple_of(N) {
        let message = format!("expected {N} numbers each, found {} numbers", items.len());
        return Err(section.error_at(key, message));
    }
    let mut tuples = Vec::with_capacity(items.len() / N);
    for chunk in items.chunks_exact(N) {
        let mut tuple = [0.0; N];
        for (x, node) in tuple.iter_mut().zip(chunk) {
            *x = section.number_of(key, node, Range::Any)?;
        }
        tuples.push(tuple);
    }
    Ok(Some(tuples))
}

/// Colours of three or four numbers each, the same for all; flat lists are read as triples where that fits the positions.
fn colors(section: &Section<'_>) -> Result<Option<Vec<[f64; 4]>>, Error> {
    let Some(items) = section.list("colors", "a list of colours")? else {
        return Ok(None);
    };
    let components = match items.first().map(|n| &n.value) {
        Some(Value::List(first)) => first.len(),
        _ => {
            let positions = tuples::<3>(section, "positions")?.map_or(0, |p| p.len());
            if items.len() == 4 * positions { 4 } else { 3 }
        }
    };
    if components == 4 {
        return tuples::<4>(section, "colors");
    }
    let opaque = |list: Vec<[f64; 3]>| list.into_iter().map(|[r, g, b]| [r, g, b, 1.0]).collect();
    Ok(tuples::<3>(section, "colors")?.map(opaque))
}

/// Triangles from flat triples, or from nested faces of three corners and more.
fn indices(
    section: &Section<'_>,
    items: &[Node],
    mesh: &mut Mesh,
    doubts: &mut Doubts,
) -> Result<Vec<[u32; 3]>, Error> {
    let count = mesh.positions.len();
    let corner = |node: &Node| match count.checked_sub(1) {
        Some(last) => section.integer_of("indices", node, 0, last as u32),
        None => Err(section.error_at("positions", "expected at least three")),
    };
    if matches!(items.first().map(|n| &n.value), Some(Value::List(_))) {
        let mut triangles = Vec::new();
        for (number, node) in items.iter().enumerate() {
            let expected = "a face of three or more vertex numbers";
            let Value::List(face) = &node.value else {
                return Err(section.mismatch("indices", node, expected));
            };
            if face.len() < 3 || face.len() > polygon::MAX_CORNERS {
                return Err(section.mismatch("indices", node, expected));
            }
            let face: Vec<u32> = face.iter().map(corner).collect::<Result<_, _>>()?;
            let cut = polygon::triangulate(face.len(), |i| mesh.positions[face[i] as usize]);
            doubts.add(cut.doubt, number + 1);
            triangles.extend(cut.add_crossings(mesh, &face));
        }
        return Ok(triangles);
    }
    if !items.len().is_multiple_of(3) {
        let message = format!("expected three a triangle, found {} numbers", items.len());
        return Err(section.error_at("indices", message));
    }
    let triangle = |c: &[Node]| Ok([corner(&c[0])?, corner(&c[1])?, corner(&c[2])?]);
    items.chunks_exact(3).map(triangle).collect()
}
