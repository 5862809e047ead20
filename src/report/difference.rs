//! Differences of pictures: as maps, and of what 8-bit files store.

use rastray_compare::{CompareError, Map, Reduction, magnitude_map, signed_map};

use crate::error::Error;
use crate::frame::Plane;
use crate::math::color::quantize8;

/// What `rastray_compare` made of pictures; non-empty, finite planes of one size it cannot refuse, and if it does, that is said.
///
/// # Errors
/// [`Error::Limit`] with its reason.
pub fn compared<T>(result: Result<T, CompareError>) -> Result<T, Error> {
    result.map_err(|e| Error::limit(format!("cannot compare the pictures: {e}")))
}

/// The signed map of a difference.
///
/// # Errors
/// As [`compared`].
pub fn signed(difference: &Plane<[f64; 3]>) -> Result<Map, Error> {
    let Plane {
        width,
        height,
        data,
    } = difference;
    compared(signed_map(*width, *height, data, Reduction::Largest))
}

/// The false-colour map of a difference's magnitude.
///
/// # Errors
/// As [`compared`].
pub fn magnitude(difference: &Plane<[f64; 3]>) -> Result<Map, Error> {
    let Plane {
        width,
        height,
        data,
    } = difference;
    compared(magnitude_map(*width, *height, data, Reduction::Largest))
}

/// A value as an 8-bit file stores it: a fraction of 255.
fn stored(x: f32) -> f64 {
    f64::from(quantize8(x)) / 255.0
}

/// Test minus reference, of what 8-bit files of them store.
pub fn stored_difference(test: &Plane<[f32; 3]>, reference: &Plane<[f32; 3]>) -> Plane<[f64; 3]> {
    let pairs = test.data.iter().zip(&reference.data);
    Plane {
        width: test.width,
        height: test.height,
        data: pairs
            .map(|(t, r)| [0, 1, 2].map(|c| stored(t[c]) - stored(r[c])))
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_difference_is_of_stored_values() {
        let plane = |x: f32| Plane::filled(1, 1, [x; 3]);
        let d = stored_difference(&plane(2.0), &plane(0.5 / 255.0 - 1e-4));
        assert_eq!(d.data[0], [1.0; 3]);
    }
}
