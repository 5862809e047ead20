//! Matrix modes and stacks, and the matrices that GL and GLU make (GL 2.1 section 2.11.2; GLU 1.3 section 4.1).
//!
//! Matrices multiply from the right: the transform stated last is applied to vertices first. Angles in degrees, f64.

use super::{Context, GlError};
use crate::math::{DMat4, DVec3};

/// Deepest modelview stack (GL asks for 32 or more).
pub const MAX_MODELVIEW_STACK_DEPTH: usize = 64;
/// Deepest projection stack (GL asks for 2 or more).
pub const MAX_PROJECTION_STACK_DEPTH: usize = 8;

/// Which stack the matrix commands work on. GL's texture stack is left out: there are no textures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MatrixMode {
    /// Object to eye (the default).
    #[default]
    ModelView,
    /// Eye to clip.
    Projection,
}

/// One stack; the last matrix is the current one.
#[derive(Clone, Debug)]
pub(super) struct Stack {
    matrices: Vec<DMat4>,
    most: usize,
}

impl Stack {
    /// One identity.
    pub(super) fn new(most: usize) -> Self {
        Self {
            matrices: vec![DMat4::IDENTITY],
            most,
        }
    }

    /// The current matrix.
    pub(super) fn top(&self) -> DMat4 {
        self.matrices.last().copied().unwrap_or(DMat4::IDENTITY)
    }

    fn set(&mut self, matrix: DMat4) {
        if let Some(top) = self.matrices.last_mut() {
            *top = matrix;
        }
    }
}

impl Context {
    /// Chooses the stack that the following commands work on.
    pub fn matrix_mode(&mut self, mode: MatrixMode) {
        if self.outside() {
            self.matrix_mode = mode;
        }
    }

    /// Keeps a copy of the current matrix below it. Error `StackOverflow` where the stack is full.
    pub fn push_matrix(&mut self) {
        if !self.outside() {
            return;
        }
        let stack = self.stack_mut();
        if stack.matrices.len() == stack.most {
            self.error(GlError::StackOverflow);
        } else {
            let top = stack.top();
            stack.matrices.push(top);
        }
    }

    /// Goes back to the matrix below. Error `StackUnderflow` where there is none.
    pub fn pop_matrix(&mut self) {
        if !self.outside() {
            return;
        }
        let stack = self.stack_mut();
        if stack.matrices.len() == 1 {
            self.error(GlError::StackUnderflow);
        } else {
            stack.matrices.pop();
        }
    }

    /// The current matrix becomes the identity.
    pub fn load_identity(&mut self) {
        self.load(DMat4::IDENTITY);
    }

    /// The current matrix becomes this one: 16 numbers column by column, as GL takes them.
    pub fn load_matrix(&mut self, columns: &[f64; 16]) {
        self.load(DMat4::from_cols_array(columns));
    }

    /// The current matrix is multiplied from the right.
    pub fn mult_matrix(&mut self, columns: &[f64; 16]) {
        self.multiply(DMat4::from_cols_array(columns));
    }

    /// Moves.
    pub fn translate(&mut self, x: f64, y: f64, z: f64) {
        self.multiply(DMat4::from_translation(DVec3::new(x, y, z)));
    }

    /// Turns by degrees about an axis of any length but 0 (which turns nothing).
    pub fn rotate(&mut self, degrees: f64, x: f64, y: f64, z: f64) {
        let axis = crate::math::float::normalize([x, y, z]).0;
        if axis != [0.0; 3] {
            let (sin, cos) = libm::sincos(degrees.to_radians());
            let (a, rest) = (DVec3::from_array(axis), 1.0 - cos);
            // GL 2.1 section 2.11.2: a a^T (1 - cos) + cos I + sin [a]x, column by column.
            let column = |unit: DVec3| {
                (rest * a.dot(unit) * a + cos * unit + sin * a.cross(unit)).extend(0.0)
            };
            self.multiply(DMat4::from_cols(
                column(DVec3::X),
                column(DVec3::Y),
                column(DVec3::Z),
                DVec3::ZERO.extend(1.0),
            ));
        }
    }

    /// Scales along the axes.
    pub fn scale(&mut self, x: f64, y: f64, z: f64) {
        self.multiply(DMat4::from_cols_array(&[
            x, 0.0, 0.0, 0.0, 0.0, y, 0.0, 0.0, 0.0, 0.0, z, 0.0, 0.0, 0.0, 0.0, 1.0,
        ]));
    }

    /// glFrustum. Error `InvalidValue` unless 0 < near, 0 < far, near != far, left != right, bottom != top.
    pub fn frustum(&mut self, left: f64, right: f64, bottom: f64, top: f64, near: f64, far: f64) {
        let (w, h, d) = (right - left, top - bottom, far - near);
        if !(near > 0.0 && far > 0.0 && [w, h, d].iter().all(|x| *x != 0.0 && x.is_finite())) {
            return self.error(GlError::InvalidValue);
        }
        self.multiply(DMat4::from_cols_array(&[
            2.0 * near / w,
            0.0,
            0.0,
            0.0,
            0.0,
            2.0 * near / h,
            0.0,
            0.0,
            (right + left) / w,
            (top + bottom) / h,
            -(far + near) / d,
            -1.0,
            0.0,
            0.0,
            -2.0 * far * near / d,
            0.0,
        ]));
    }

    /// glOrtho. Error `InvalidValue` unless left != right, bottom != top, near != far.
    pub fn ortho(&mut self, left: f64, right: f64, bottom: f64, top: f64, near: f64, far: f64) {
        let (w, h, d) = (right - left, top - bottom, far - near);
        if !([w, h, d].iter().all(|x| *x != 0.0 && x.is_finite())) {
            return self.error(GlError::InvalidValue);
        }
        self.multiply(DMat4::from_cols_array(&[
            2.0 / w,
            0.0,
            0.0,
            0.0,
            0.0,
            2.0 / h,
            0.0,
            0.0,
            0.0,
            0.0,
            -2.0 / d,
            0.0,
            -(right + left) / w,
            -(top + bottom) / h,
            -(far + near) / d,
            1.0,
        ]));
    }

    /// gluPerspective: the full vertical angle in degrees, in (0, 180). Where GLU would do nothing, error `InvalidValue`.
    pub fn perspective(&mut self, fovy_deg: f64, aspect: f64, near: f64, far: f64) {
        let angle_ok = fovy_deg > 0.0 && fovy_deg < 180.0;
        if !(angle_ok && aspect > 0.0 && near > 0.0 && far > 0.0) {
            return self.error(GlError::InvalidValue);
        }
        let top = near * libm::tan(fovy_deg.to_radians() / 2.0);
        let right = top * aspect;
        self.frustum(-right, right, -top, top, near, far);
    }

    /// gluLookAt. Error `InvalidValue` where the view has no direction, or lies along `up`.
    pub fn look_at(&mut self, eye: [f64; 3], center: [f64; 3], up: [f64; 3]) {
        let unit = |v: DVec3| DVec3::from_array(crate::math::float::normalize(v.to_array()).0);
        let eye = DVec3::from_array(eye);
        let forward = unit(DVec3::from_array(center) - eye);
        let side = unit(forward.cross(unit(DVec3::from_array(up))));
        if side == DVec3::ZERO {
            return self.error(GlError::InvalidValue);
        }
        let turned = DMat4::from_cols(
            side.extend(0.0),
            side.cross(forward).extend(0.0),
            (-forward).extend(0.0),
            DVec3::ZERO.extend(1.0),
        )
        .transpose();
        self.multiply(turned * DMat4::from_translation(-eye));
    }

    /// The current matrix of a stack, column by column (GL_MODELVIEW_MATRIX, GL_PROJECTION_MATRIX).
    pub fn matrix(&self, mode: MatrixMode) -> [f64; 16] {
        match mode {
            MatrixMode::ModelView => self.modelview.top(),
            MatrixMode::Projection => self.projection.top(),
        }
        .to_cols_array()
    }

    fn stack_mut(&mut self) -> &mut Stack {
        match self.matrix_mode {
            MatrixMode::ModelView => &mut self.modelview,
            MatrixMode::Projection => &mut self.projection,
        }
    }

    fn load(&mut self, matrix: DMat4) {
        if self.outside() {
            self.stack_mut().set(matrix);
        }
    }

    fn multiply(&mut self, right: DMat4) {
        if self.outside() {
            let stack = self.stack_mut();
            stack.set(stack.top() * right);
        }
    }
}
