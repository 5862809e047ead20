//! The sheets of the atlas: which scenes, which values.

use super::Change;

/// One sheet before it is drawn.
pub(super) struct SheetPlan {
    pub(super) name: &'static str,
    pub(super) title: &'static str,
    pub(super) text: &'static str,
    scenes: &'static [&'static str],
    changes: &'static [Change],
}

impl SheetPlan {
    /// Scene by scene, every setting; or a few of the first scene.
    pub(super) fn cells(&self, quick: bool) -> Vec<(&'static str, Change)> {
        let last = self.changes.len() - 1;
        let kept = |i: usize| !quick || i == 0 || i == last / 2 || i == last;
        let scenes = if quick {
            &self.scenes[..1]
        } else {
            self.scenes
        };
        let settings = || {
            self.changes
                .iter()
                .enumerate()
                .filter(move |(i, _)| kept(*i))
        };
        let cells = scenes.iter();
        cells
            .flat_map(|scene| settings().map(move |(_, change)| (*scene, *change)))
            .collect()
    }
}

/// Every sheet, in the order of the page.
pub(super) const SHEETS: &[SheetPlan] = &[
    SheetPlan {
        name: "shininess",
        title: "Shininess",
        text: "Every shiny material gets the exponent. Half an ulp of the cosine would be worth 3 % at a million; sine and \
               cosine of the angle are taken apart near the peak, so that it is not.",
        scenes: &["highlight", "06-peakiness"],
        changes: &[
            Change::Shininess(0.0),
            Change::Shininess(0.5),
            Change::Shininess(1.0),
            Change::Shininess(8.0),
            Change::Shininess(128.0),
            Change::Shininess(1e3),
            Change::Shininess(1e4),
            Change::Shininess(1e5),
            Change::Shininess(1e6),
        ],
    },
    SheetPlan {
        name: "scale",
        title: "Scale",
        text: "The whole scene, camera and lights with it, is made smaller or larger, and attenuation follows. There is no \
               absolute epsilon, so that every picture is the same.",
        scenes: &["whitted", "lights"],
        changes: &[
            Change::Scale(1e-6),
            Change::Scale(1e-4),
            Change::Scale(1e-2),
            Change::Scale(1.0),
            Change::Scale(1e2),
            Change::Scale(1e4),
            Change::Scale(1e7),
        ],
    },
    SheetPlan {
        name: "light-distance",
        title: "A light comes close",
        text: "A point light stands before the surface in the middle of the picture, nearer and nearer, at last on it. The \
               direction to a light at distance d knows no more than the position of the surface does: half an ulp over d.",
        scenes: &["lights", "01-point-light"],
        changes: &[
            Change::LightDistance(1.0),
            Change::LightDistance(1e-1),
            Change::LightDistance(1e-2),
            Change::LightDistance(1e-3),
            Change::LightDistance(1e-4),
            Change::LightDistance(1e-6),
            Change::LightDistance(0.0),
        ],
    },
    SheetPlan {
        name: "grazing",
        title: "Grazing light",
        text: "One distant light, this many degrees above the horizontal, and a little gloss on everything. At 0 the ground's n.l is 0, \
               and what is 0 does not light; a hair above, the whole highlight is there. The jump is the model's own.",
        scenes: &["14-shadow", "whitted"],
        changes: &[
            Change::Grazing(10.0),
            Change::Grazing(1.0),
            Change::Grazing(0.1),
            Change::Grazing(1e-2),
            Change::Grazing(1e-4),
            Change::Grazing(1e-6),
            Change::Grazing(0.0),
        ],
    },
    SheetPlan {
        name: "near-far",
        title: "Near and far",
        text: "The planes that the view is cut at. Depth is kept as near over distance, so that a far plane at infinity costs \
               nothing.",
        scenes: &["whitted", "14-shadow"],
        changes: &[
            Change::NearFar(1e-6, 10.0),
            Change::NearFar(1e-6, 1e7),
            Change::NearFar(1e-6, f64::INFINITY),
            Change::NearFar(1.0, 1e7),
            Change::NearFar(6.0, 8.5),
            Change::NearFar(7.0, f64::INFINITY),
        ],
    },
    SheetPlan {
        name: "transforms",
        title: "Crushed and sheared",
        text: "Round shapes and meshes are pressed towards a slanting plane, to the given fraction, or sheared along x. Normals \
               go through the inverse transpose, whose condition is the inverse of the fraction.",
        scenes: &["whitted", "teapot"],
        changes: &[
            Change::Squash(1.0),
            Change::Squash(1e-1),
            Change::Squash(1e-2),
            Change::Squash(1e-4),
            Change::Squash(1e-6),
            Change::Squash(1e-8),
            Change::Shear(10.0),
            Change::Shear(1e3),
            Change::Shear(1e6),
        ],
    },
    SheetPlan {
        name: "field-of-view",
        title: "Field of view",
        text: "The camera turns to a straight outline and closes in, or opens. At a thousandth of a \
               degree a pixel is as wide as three half ulps of f32 at the scene's distance.",
        scenes: &["whitted", "07-diffuse"],
        changes: &[
            Change::FieldOfView(1e-3),
            Change::FieldOfView(1e-2),
            Change::FieldOfView(0.1),
            Change::FieldOfView(1.0),
            Change::FieldOfView(45.0),
            Change::FieldOfView(120.0),
            Change::FieldOfView(170.0),
            Change::FieldOfView(179.0),
        ],
    },
    SheetPlan {
        name: "needles",
        title: "Needles",
        text: "Every object becomes a mesh, and every triangle three: one of them this many times longer than wide.",
        scenes: &["07-diffuse", "teapot"],
        changes: &[
            Change::Needles(10.0),
            Change::Needles(1e2),
            Change::Needles(1e3),
            Change::Needles(1e4),
            Change::Needles(1e6),
        ],
    },
];
