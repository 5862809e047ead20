//! The eight ways to hold a picture: four turns, each mirrored or not, numbered as EXIF does (Exif 2.32, tag 0x0112).

use image::metadata::Orientation;

use crate::frame::Plane;

/// The number that EXIF data state; 1 (as stored) where they state none.
pub(super) fn of_exif(data: &[u8]) -> u8 {
    Orientation::from_exif_chunk(data).map_or(1, Orientation::to_exif)
}

/// What one does with a picture of this number to see it upright.
pub(super) fn describe(number: u8) -> &'static str {
    match number {
        2 => "mirrored",
        3 => "turned by 180 degrees",
        4 => "turned by 180 degrees and mirrored",
        5 => "turned by 90 degrees to the right and mirrored",
        6 => "turned by 90 degrees to the right",
        7 => "turned by 90 degrees to the left and mirrored",
        8 => "turned by 90 degrees to the left",
        _ => "shown as stored",
    }
}

/// The picture upright.
pub(super) fn upright(plane: &Plane<[f32; 3]>, number: u8) -> Plane<[f32; 3]> {
    let (w, h) = (plane.width, plane.height);
    let (width, height) = if number < 5 { (w, h) } else { (h, w) };
    let stored = |x: usize, y: usize| match number {
        2 => (w - 1 - x, y),
        3 => (w - 1 - x, h - 1 - y),
        4 => (x, h - 1 - y),
        5 => (y, x),
        6 => (y, h - 1 - x),
        7 => (w - 1 - y, h - 1 - x),
        8 => (w - 1 - y, x),
        _ => (x, y),
    };
    let pixel = |i: usize| {
        let (x, y) = stored(i % width, i / width);
        plane.data[y * w + x]
    };
    Plane {
        width,
        height,
        data: (0..width * height).map(pixel).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_are_those_of_exif() {
        // Stored: 0 1 2 over 3 4 5.
        let data = (0..6).map(|i| [i as f32; 3]).collect();
        let plane = Plane {
            width: 3,
            height: 2,
            data,
        };
        let expected = [
            "012/345", "210/543", "543/210", "345/012", "03/14/25", "30/41/52", "52/41/30",
            "25/14/03",
        ];
        for (number, expected) in (1..).zip(expected) {
            let turned = upright(&plane, number);
            let rows = turned.data.chunks(turned.width);
            let row = |row: &[[f32; 3]]| row.iter().map(|p| p[0].to_string()).collect::<String>();
            let rows: Vec<String> = rows.map(row).collect();
            assert_eq!(rows.join("/"), expected, "{number}");
        }
    }
}
