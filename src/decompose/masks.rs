//! Where the silhouettes are: the part of a picture in which the two renderers may see different objects.
//!
//! In: the object that each renderer sees at each pixel ([`Frame::object`](crate::frame::Frame)). Out: one mask. Its
//! complement is the interior, in which both see the same object and so do all neighbours, so that what differs there
//! differs by light.

use crate::frame::Plane;

/// Pixels at a silhouette: within one pixel, diagonals included, of a change of object in either picture, or where the
/// pictures show different objects, the background being one.
///
/// Both planes have the same size.
///
/// ```
/// use rastray::decompose::silhouette;
/// use rastray::frame::{NONE, Plane};
/// let row = |data: [u32; 6]| Plane { width: 6, height: 1, data: data.to_vec() };
/// let mask = silhouette(&row([NONE, NONE, NONE, 4, 4, 4]), &row([NONE, NONE, NONE, 4, 4, 9]));
/// assert_eq!(mask.data, [false, false, true, true, true, true]);
/// ```
pub fn silhouette(a: &Plane<u32>, b: &Plane<u32>) -> Plane<bool> {
    let mut mask = a.map(|_| false);
    for (i, marked) in mask.data.iter_mut().enumerate() {
        *marked = a.data[i] != b.data[i] || changes(a, i) || changes(b, i);
    }
    mask
}

/// Whether one of the eight neighbours shows another object.
fn changes(objects: &Plane<u32>, pixel: usize) -> bool {
    let (x, y) = (pixel % objects.width, pixel / objects.width);
    let near = |at: usize, end: usize| at.saturating_sub(1)..(at + 2).min(end);
    near(y, objects.height)
        .flat_map(|j| near(x, objects.width).map(move |i| (i, j)))
        .any(|(i, j)| *objects.at(i, j) != objects.data[pixel])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::NONE;

    fn objects(rows: [&str; 5]) -> Plane<u32> {
        let number = |c: u8| if c == b'.' { NONE } else { u32::from(c) };
        Plane {
            width: rows[0].len(),
            height: rows.len(),
            data: rows
                .iter()
                .flat_map(|row| row.bytes().map(number))
                .collect(),
        }
    }

    fn drawn(mask: &Plane<bool>) -> Vec<String> {
        let mark = |m: &bool| if *m { '#' } else { '-' };
        let rows = mask.data.chunks(mask.width);
        rows.map(|row| row.iter().map(mark).collect()).collect()
    }

    #[test]
    fn a_silhouette_is_two_pixels_wide_and_widened_by_what_one_renderer_sees_alone() {
        let a = objects(["........", ".aaaa...", ".aaaa...", ".aaaa...", "........"]);
        let one = ["######--", "######--", "##--##--", "######--", "######--"];
        assert_eq!(drawn(&silhouette(&a, &a)), one);
        // The other renderer's object is a column wider.
        let b = objects(["........", ".aaaaa..", ".aaaaa..", ".aaaaa..", "........"]);
        let both = ["#######-", "#######-", "##--###-", "#######-", "#######-"];
        assert_eq!(drawn(&silhouette(&a, &b)), both);
        assert_eq!(silhouette(&a, &b), silhouette(&b, &a));
    }

    #[test]
    fn one_object_everywhere_has_no_silhouette_and_two_have_one_everywhere() {
        let (a, b) = (objects(["aaa"; 5]), objects(["bbb"; 5]));
        assert!(silhouette(&a, &a).data.iter().all(|m| !m));
        assert!(silhouette(&a, &b).data.iter().all(|m| *m));
    }
}
