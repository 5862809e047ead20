//! Scenes that long runs have found, and what was wrong with them.

use rastray::frame::NONE;
use rastray::gl::ShadeModel;
use rastray::lanes::Isa;
use rastray::raster::Options;

use crate::common::precise::{assembled, rasterize, rasterizer};
use crate::common::text::import;

/// A road that runs from far ahead to far behind the eye, one unit wide, looked down at from a height of one: pixel (x, y)
/// shows it where its ray meets the ground within 1/2 of the middle.
///
/// What was wrong: sides ran from the snapped end to the vertex behind the eye. Snapping moves the far end by up to 1/512 px, which is `ahead` / (512 f)
/// units there (f = focal length in pixels); an edge is the plane through the eye and both ends, so it moves by a good part
/// of those units where it passes the eye, too: pixels, where one end is far ahead and the other behind.
#[test]
fn a_road_past_the_eye_keeps_its_width() {
    let (width, height, f) = (48u32, 36u32, 18.0 / libm::tan(22.5f64.to_radians()));
    for ahead in [10.0, 300.0, 20_000.0] {
        let text = format!(
            "[image]\nwidth = {width}\nheight = {height}\n\
             [camera]\neye = [0, 1, 0]\ntarget = [0, 0, -1]\nnear = 1e-3\n\
             [object.road]\npositions = [[-0.5, 0, {ahead}], [0.5, 0, {ahead}], [0.5, 0, -{ahead}], [-0.5, 0, -{ahead}]]\n\
             indices = [[0, 1, 2, 3]]\n"
        );
        let scene = import(&text).expect("a scene").scene;
        let assembly = assembled::<f64>(&scene, None).expect("two triangles");
        let options = Options {
            shading: ShadeModel::Flat,
            clamp: false,
            layers: false,
            isa: Isa::Scalar,
        };
        let plan = rasterizer(&scene, &assembly);
        let frame = rasterize::<f64>(&plan, &options).expect("drawn").0;
        for y in 0..height {
            for x in 0..width {
                let right = (f64::from(x) + 0.5 - 24.0) / f;
                let up = (18.0 - f64::from(y) - 0.5) / f;
                // Forward is (0, -1, -1) / sqrt 2, up (0, 1, -1) / sqrt 2: the ray falls by (1 - up) / sqrt 2 in each step.
                let reach = std::f64::consts::SQRT_2 / (1.0 - up);
                let on_road = (right * reach).abs() < 0.5;
                let from_edge = ((right * reach).abs() - 0.5).abs() / reach * f;
                let drawn = *frame.primitive.at(x as usize, y as usize) != NONE;
                assert!(
                    drawn == on_road || from_edge < 2.0 / 256.0,
                    "ahead {ahead}: pixel {x} {y}, {from_edge} px from the edge"
                );
            }
        }
    }
}

/// A triangle of which one corner lies just beyond the near plane, and the next behind the eye.
///
/// What was wrong: the side between them ended where it meets the near plane, next to the snapped corner, and so had the direction
/// of what snapping had moved. Snapped or not, the same pixels are covered but for those at edges.
#[test]
fn a_corner_at_the_near_plane_keeps_its_triangle() {
    let covered = |depth: f64, snap: &str| {
        let text = format!(
            "[image]\nwidth = 200\nheight = 200\n\
             [camera]\neye = [0, 0, 0]\ntarget = [0, 0, -1]\nfovy = 90\nnear = 1\n[raster]\nsnap = {snap}\n\
             [object.o]\npositions = [[0.1003, 0.2017, -{depth:.9}], [0.3, 0.2, 1], [-3, -2, -5], [3, -2.5, -5]]\n\
             indices = [[0, 1, 2], [0, 3, 1]]\n"
        );
        let scene = import(&text).expect("a scene").scene;
        let assembly = assembled::<f64>(&scene, None).expect("two triangles");
        let options = Options {
            shading: ShadeModel::Flat,
            clamp: false,
            layers: false,
            isa: Isa::Scalar,
        };
        let plan = rasterizer(&scene, &assembly);
        let frame = rasterize::<f64>(&plan, &options).expect("drawn").0;
        frame.primitive.data.iter().filter(|p| **p != NONE).count()
    };
    for depth in [1.0 + 1e-7, 1.0 + 1e-6, 1.0001, 1.001, 1.01] {
        let exact = covered(depth, "\"exact\"");
        let snapped = covered(depth, "8");
        assert!(exact > 1500, "{exact}");
        assert!(
            exact.abs_diff(snapped) <= 4,
            "{depth}: {snapped} of {exact}"
        );
    }
}
