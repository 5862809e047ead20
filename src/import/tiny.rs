//! Meshes of which nothing can be seen: those without area, and those too small for the numbers of the renderers.

use crate::error::Note;
use crate::math::DVec3;
use crate::scene::Mesh;

/// What to say of a mesh of that name, where something is wrong with its size.
pub(super) fn note(mesh: &Mesh, name: Option<&str>) -> Option<Note> {
    let low = mesh.positions.iter().copied().reduce(DVec3::min)?;
    let high = mesh.positions.iter().copied().reduce(DVec3::max)?;
    let size = (high - low).max_element();
    let smallest = f64::from(f32::MIN_POSITIVE);
    let of = name.map_or(String::new(), |name| format!(" of {name}"));
    let message = if size > 0.0 && size < smallest {
        format!(
            "the mesh{of} is {size:.1e} across, less than single precision holds ({smallest:.1e}): nothing of it will show; \
             scale it up"
        )
    } else if !mesh.triangles.iter().any(|t| has_area(mesh, t)) {
        format!("no face{of} has an area: nothing of it will show")
    } else {
        return None;
    };
    Some(Note {
        place: None,
        message,
    })
}

fn has_area(mesh: &Mesh, triangle: &[u32; 3]) -> bool {
    let [a, b, c] = triangle.map(|i| mesh.positions[i as usize]);
    (b - a).cross(c - a) != DVec3::ZERO
}
