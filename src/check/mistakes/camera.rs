//! Mistakes in the camera.

use super::super::lens::{aspect, through};
use super::super::measure::{Finish, Turn};
use super::{Change, Group, Mistake, Of};
use crate::math::DVec2;
use crate::scene::Projection;

const CAMERA: Mistake = Mistake {
    name: "",
    group: Group::Camera,
    title: "",
    what: "",
    remedy: "",
    of: Of::Any,
    amount: None,
    make: |_| false,
};

/// The table of this group.
pub(super) fn mistakes() -> Vec<Mistake> {
    let mut all = turned();
    all.extend(angles());
    all.extend(shifted());
    all
}

fn turned() -> Vec<Mistake> {
    vec![
        Mistake {
            name: "rows-flipped",
            title: "Upside down",
            what: "The picture stands on its head: OpenGL counts rows from the bottom (glReadPixels), picture files from the \
                   top.",
            remedy: "Write the rows in the opposite order, or turn the sign of y in the primary ray.",
            make: |c| {
                c.only(Finish::Right, Some(Turn::Rows));
                true
            },
            ..CAMERA
        },
        Mistake {
            name: "columns-mirrored",
            title: "Left and right exchanged",
            what: "The picture is a mirror image: the axis to the right has the wrong sign, as in a left-handed view.",
            remedy: "Take right = forward × up (in this order), and look down −z.",
            make: |c| {
                c.only(Finish::Right, Some(Turn::Columns));
                true
            },
            ..CAMERA
        },
    ]
}

fn angles() -> Vec<Mistake> {
    vec![
        Mistake {
            name: "field-of-view-halved",
            title: "Half the field of view",
            what: "Everything is about twice as large: half of fovy (or of the orthographic height) is taken for the whole.",
            remedy: "fovy is the whole vertical angle: the upper rim is at tan(fovy / 2).",
            make: |c| widen(c, 0.5),
            ..CAMERA
        },
        Mistake {
            name: "field-of-view-doubled",
            title: "Twice the field of view",
            what: "Everything is about half as large: fovy (or the orthographic height) is taken for half of the whole, as in \
                   tan(fovy) for tan(fovy / 2).",
            remedy: "fovy is the whole vertical angle: the upper rim is at tan(fovy / 2).",
            make: |c| widen(c, 2.0),
            ..CAMERA
        },
        Mistake {
            name: "field-of-view-horizontal",
            title: "The field of view is taken across",
            what: "fovy is used for the angle from left to right. In a wide picture everything is too large.",
            remedy: "fovy is the vertical angle: half the height is tan(fovy / 2), half the width that times width / height.",
            make: |c| {
                let aspect = aspect(&c.scene);
                zoom(c, DVec2::splat(aspect))
            },
            ..CAMERA
        },
        Mistake {
            name: "aspect-missing",
            title: "The aspect ratio is left out",
            what: "The picture is squeezed or stretched sideways: a ball is no circle.",
            remedy: "Multiply x by width / height (in real numbers: 640 / 480 is 1 in integers).",
            make: |c| {
                let aspect = aspect(&c.scene);
                zoom(c, DVec2::new(aspect, 1.0))
            },
            ..CAMERA
        },
        Mistake {
            name: "aspect-inverted",
            title: "The aspect ratio is height / width",
            what: "The picture is stretched or squeezed sideways by the square of the aspect ratio.",
            remedy: "The aspect ratio is width / height.",
            make: |c| {
                let aspect = aspect(&c.scene);
                zoom(c, DVec2::new(aspect * aspect, 1.0))
            },
            ..CAMERA
        },
    ]
}

fn shifted() -> Vec<Mistake> {
    vec![
        Mistake {
            name: "half-pixel-up-left",
            title: "Pixels are seen at their upper left corner",
            what: "Everything is half a pixel too far to the right and down: rays go through the corner (x, y) of a pixel.",
            remedy: "Go through the centre, (x + 1/2, y + 1/2).",
            make: |c| shift(c, DVec2::new(1.0, -1.0)),
            ..CAMERA
        },
        Mistake {
            name: "half-pixel-down-left",
            title: "Pixels are seen at their lower left corner",
            what: "Everything is half a pixel too far to the right and up: rays go through a pixel's corner, counted from \
                   the bottom.",
            remedy: "Go through the centre, (x + 1/2, y + 1/2).",
            make: |c| shift(c, DVec2::new(1.0, 1.0)),
            ..CAMERA
        },
    ]
}

/// Another angle, or height.
fn widen(c: &mut Change, by: f64) -> bool {
    match &mut c.scene.camera.projection {
        Projection::Perspective { fovy_deg } => {
            *fovy_deg *= by;
            *fovy_deg < 180.0
        }
        Projection::Orthographic { height } => {
            *height *= by;
            true
        }
        Projection::Matrix { .. } => false,
    }
}

/// The picture scaled about its centre.
fn zoom(c: &mut Change, scale: DVec2) -> bool {
    let aspect = aspect(&c.scene);
    c.scene.camera = through(&c.scene.camera, aspect, scale, DVec2::ZERO);
    scale != DVec2::ONE
}

/// The picture moved by half a pixel (y up).
fn shift(c: &mut Change, by: DVec2) -> bool {
    let image = &c.scene.image;
    // A pixel is 2 / width of the normalized width.
    let pixel = DVec2::new(2.0 / f64::from(image.width), 2.0 / f64::from(image.height));
    c.scene.camera = through(
        &c.scene.camera,
        aspect(&c.scene),
        DVec2::ONE,
        by * pixel / 2.0,
    );
    true
}
