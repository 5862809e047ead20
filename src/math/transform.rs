//! Matrices between spaces, composed in f64.

use super::{DAffine3, DMat3, DVec3};

/// Inverse transpose of the linear part: takes object normals to the target space (GL 2.1 section 2.11.3).
/// A singular matrix gives the cofactor matrix, whose direction is the limit of the inverse transpose.
pub fn normal_matrix(m: &DAffine3) -> DMat3 {
    let m3 = m.matrix3;
    let cofactor = DMat3::from_cols(
        m3.y_axis.cross(m3.z_axis),
        m3.z_axis.cross(m3.x_axis),
        m3.x_axis.cross(m3.y_axis),
    );
    let det = m3.determinant();
    if det == 0.0 {
        cofactor
    } else {
        cofactor * (1.0 / det)
    }
}

/// What makes of a normal of the target space the one that the model matrix itself would have given: M M^T, since the
/// object normal is along M^T n. A mistake (GL 2.1 section 2.11.3 asks for the inverse transpose), for [`crate::trace`] and
/// for assemblies that show it.
pub fn model_matrix_normal(m: &DMat3) -> DMat3 {
    *m * m.transpose()
}

/// GL_RESCALE_NORMAL's factor: 1 / length of row 3 of the inverse modelview (GL 2.1 section 2.11.3).
pub fn rescale_factor(eye_from_object: &DMat3) -> f64 {
    let inverse = eye_from_object.inverse();
    let row = DVec3::new(inverse.x_axis.z, inverse.y_axis.z, inverse.z_axis.z);
    let length = row.length();
    if length > 0.0 && length.is_finite() {
        1.0 / length
    } else {
        1.0
    }
}

/// Whether the transform mirrors (negative determinant).
pub fn mirrors(m: &DAffine3) -> bool {
    m.matrix3.determinant() < 0.0
}
