//! Scenes at random.

use std::sync::Arc;

use proptest::collection::vec;
use proptest::option;
use proptest::prelude::*;
use proptest::sample::select;
use rastray::gl::{self, LightSource, ShadeModel, SpecularModel};
use rastray::math::{DAffine3, DMat3, DVec3};
use rastray::scene::tessellate::tessellate;
use rastray::scene::{
    Camera, Curve, Fresnel, Geometry, Light, LightSpace, Material, Mesh, Object, Optics, Profile,
    Projection, Scene, Shadow, Shape, Snap, Tir,
};

// ---- numbers -----------------------------------------------------------------------------------------------------------

/// Half of them multiples of 1/2, so that surfaces share planes, edges and corners.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![(-4i32..=4).prop_map(|i| f64::from(i) / 2.0), -2.0..2.0f64]
}

fn point() -> impl Strategy<Value = DVec3> {
    [coordinate(), coordinate(), coordinate()].prop_map(DVec3::from_array)
}

/// A length: mostly ordinary, now and then nearly nothing or very large.
fn length() -> impl Strategy<Value = f64> {
    prop_oneof![
        6 => 0.2..1.5f64,
        3 => select(vec![0.5, 1.0, 2.0]),
        1 => select(vec![1e-12, 1e-7, 1e-3, 300.0, 1e6]),
    ]
}

/// Of any length but 0.
fn direction() -> impl Strategy<Value = DVec3> {
    let axes = vec![
        DVec3::X,
        DVec3::NEG_X,
        DVec3::Y,
        DVec3::NEG_Y,
        DVec3::Z,
        DVec3::NEG_Z,
    ];
    let any = [-1.0..1.0f64, -1.0..1.0, -1.0..1.0].prop_map(DVec3::from_array);
    prop_oneof![
        select(axes),
        any.prop_filter("a direction", |d| d.length() > 1e-3),
    ]
}

fn grey_or_color() -> impl Strategy<Value = [f64; 3]> {
    let x = || 0.0..1.0f64;
    prop_oneof![select(vec![[0.0; 3], [1.0; 3], [0.5; 3]]), [x(), x(), x()]]
}

// ---- forms -------------------------------------------------------------------------------------------------------------

fn plain_shape() -> impl Strategy<Value = Shape> {
    let tiles = (1u32..4, 1u32..4).prop_map(|(u, v)| [u, v]);
    prop_oneof![
        (point(), length()).prop_map(|(center, radius)| Shape::Sphere { center, radius }),
        (point(), [length(), length(), length()]).prop_map(|(min, size)| Shape::Box {
            min,
            max: min + DVec3::from_array(size),
        }),
        (point(), direction(), length(), direction(), length(), tiles).prop_map(
            |(corner, u, a, v, b, tiles)| Shape::Patch {
                corner,
                edge_u: a * u,
                edge_v: b * v,
                tiles,
            }
        ),
        (point(), direction(), length()).prop_map(|(center, normal, radius)| Shape::Disk {
            center,
            normal,
            radius,
        }),
        (point(), direction(), length(), length(), any::<bool>()).prop_map(
            |(base, axis, height, radius, caps)| Shape::Cylinder {
                base,
                top: base + height * axis,
                radius,
                caps,
            }
        ),
        (point(), direction(), length(), length(), any::<bool>()).prop_map(
            |(base, axis, height, radius, cap)| Shape::Cone {
                base,
                apex: base + height * axis,
                radius,
                cap,
            }
        ),
        (point(), direction(), length(), 0.01..0.99f64).prop_map(|(center, axis, major, share)| {
            Shape::Torus {
                center,
                axis,
                major,
                minor: share * major,
            }
        }),
    ]
}

fn revolution() -> impl Strategy<Value = Shape> {
    let curve = select(vec![Curve::Polyline, Curve::Smooth, Curve::Bezier]);
    let points = vec([0.0..1.5f64, -1.0..1.0f64], 2..8);
    let ends = select(vec![(false, false), (true, false), (true, true)]);
    let profile = (curve, points, ends).prop_filter_map("a profile", |(curve, points, ends)| {
        let mut points = points;
        let last = match curve {
            Curve::Bezier => (points.len() - 1) / 3 * 3,
            _ => points.len() - 1,
        };
        points.truncate(last + 1);
        // Ends on the axis close it.
        if ends.0 {
            points[0][0] = 0.0;
        }
        if ends.1 {
            points[last][0] = 0.0;
        }
        Profile::new(curve, &points).ok()
    });
    (point(), direction(), profile).prop_map(|(base, axis, profile)| Shape::Revolution {
        base,
        axis,
        profile: Arc::new(profile),
    })
}

fn bezier() -> impl Strategy<Value = Shape> {
    let number = 0u32..18;
    let patch = vec(number, 16).prop_map(|n| {
        let mut patch = [0; 16];
        patch.copy_from_slice(&n);
        patch
    });
    (vec(point(), 18), vec(patch, 1..3)).prop_map(|(points, patches)| Shape::Bezier {
        points: points.into(),
        patches: patches.into(),
    })
}

fn shape() -> impl Strategy<Value = Shape> {
    prop_oneof![8 => plain_shape(), 2 => revolution(), 1 => bezier()]
}

/// Triangles at random, with shared vertices; sometimes with normals, sometimes with colours.
fn soup() -> impl Strategy<Value = Mesh> {
    let corner = 0u32..9;
    let triangles = vec([corner.clone(), corner.clone(), corner], 1..12);
    let colors = option::of(vec(grey_or_color(), 9));
    (
        vec(point(), 9),
        option::of(vec(direction(), 9)),
        colors,
        triangles,
    )
        .prop_map(|(positions, normals, colors, triangles)| Mesh {
            positions,
            normals: normals.unwrap_or_default(),
            colors: colors
                .into_iter()
                .flatten()
                .map(|[r, g, b]| [r, g, b, 1.0])
                .collect(),
            triangles,
            ..Mesh::default()
        })
}

fn geometry() -> impl Strategy<Value = Geometry> {
    prop_oneof![
        5 => shape().prop_map(Geometry::Shape),
        2 => soup().prop_map(|mesh| Geometry::Mesh(Arc::new(mesh))),
        // A closed mesh, where the shape is closed.
        2 => plain_shape().prop_map(|s| Geometry::Mesh(Arc::new(tessellate(&s, 6, 1)))),
    ]
}

/// Turned, stretched, mirrored, sheared; now and then nearly flat.
fn place() -> impl Strategy<Value = DAffine3> {
    let factor = prop_oneof![
        6 => 0.4..1.6f64,
        3 => -1.6..-0.4f64,
        1 => select(vec![1e-9, 1e-4, 100.0]),
    ];
    let factors = [factor.clone(), factor.clone(), factor].prop_map(DVec3::from_array);
    let turned = (direction(), 0.0..6.3f64, factors, -0.6..0.6f64, point());
    prop_oneof![
        2 => Just(DAffine3::IDENTITY),
        2 => point().prop_map(DAffine3::from_translation),
        3 => turned.prop_map(|(axis, angle, factors, shear, by)| {
            let mut matrix3 = DMat3::from_axis_angle(axis.normalize(), angle) * DMat3::from_diagonal(factors);
            matrix3.y_axis += shear * matrix3.x_axis;
            DAffine3 { matrix3, translation: by }
        }),
    ]
}

/// A form in its places; materials are chosen later, by number.
type Thing = (Geometry, DAffine3, u8);

/// One object, several that share a form, solids in each other, or solids side by side.
fn things() -> impl Strategy<Value = Vec<Thing>> {
    let one = (geometry(), place(), any::<u8>()).prop_map(|thing| vec![thing]);
    let shared = (geometry(), vec((place(), any::<u8>()), 2..4)).prop_map(|(form, places)| {
        let copy = |(place, m)| (form.clone(), place, m);
        places.into_iter().map(copy).collect()
    });
    let shells = vec((0.3..1.0f64, any::<u8>(), any::<bool>()), 2..4);
    let nested = (point(), place(), shells).prop_map(|(center, place, shells)| {
        let mut radius = 1.5;
        let shell = |(share, m, round): (f64, u8, bool)| {
            radius *= share;
            let (min, max) = (center - 0.57 * radius, center + 0.57 * radius);
            let shape = match round {
                true => Shape::Sphere { center, radius },
                false => Shape::Box { min, max },
            };
            (Geometry::Shape(shape), place, m)
        };
        shells.into_iter().map(shell).collect()
    });
    let stack = (point(), place(), vec((length(), any::<u8>()), 2..4));
    let touching = stack.prop_map(|(corner, place, layers)| {
        let mut bottom = corner;
        let layer = |(height, m)| {
            let (min, max) = (bottom, bottom + DVec3::new(1.5, height, 1.5));
            bottom.y = max.y;
            (Geometry::Shape(Shape::Box { min, max }), place, m)
        };
        layers.into_iter().map(layer).collect()
    });
    prop_oneof![6 => one, 1 => shared, 2 => nested, 2 => touching]
}

// ---- the rest ----------------------------------------------------------------------------------------------------------

fn surface() -> impl Strategy<Value = gl::Material> {
    let shininess = select(vec![0.0, 1.0, 10.0, 128.0, 1000.0]);
    let tracked = prop::bool::weighted(0.2);
    let colors = [
        grey_or_color(),
        grey_or_color(),
        grey_or_color(),
        grey_or_color(),
    ];
    (colors, shininess, tracked).prop_map(|([e, a, d, s], shininess, tracked)| gl::Material {
        emission: e.map(|x| 0.2 * x),
        ambient: a,
        diffuse: d,
        specular: s,
        shininess,
        tracked: gl::Tracked {
            ambient: tracked,
            diffuse: tracked,
            ..gl::Tracked::default()
        },
        ..gl::Material::default()
    })
}

fn optics() -> impl Strategy<Value = Optics> {
    let fresnel = select(vec![
        Fresnel::Off,
        Fresnel::Off,
        Fresnel::Dielectric,
        Fresnel::Schlick,
    ]);
    let ior = prop_oneof![select(vec![1.0, 1.33, 1.5, 2.4, 0.6]), 0.5..3.0f64];
    let clear = (
        grey_or_color(),
        grey_or_color(),
        ior,
        prop::bool::weighted(0.2),
        fresnel,
    );
    prop_oneof![
        1 => Just(Optics::default()),
        1 => grey_or_color().prop_map(|reflection| Optics { reflection, ..Optics::default() }),
        4 => clear.prop_map(|(mirror, transmission, ior, thin, fresnel)| Optics {
            reflection: mirror.map(|x| 0.3 * x),
            transmission,
            ior,
            thin,
            fresnel,
        }),
    ]
}

fn material() -> impl Strategy<Value = Material> {
    let back = option::weighted(0.3, surface());
    (surface(), back, optics()).prop_map(|(front, back, optics)| Material {
        name: "m".into(),
        front,
        back,
        optics,
    })
}

fn light() -> impl Strategy<Value = Light> {
    let w = select(vec![0.0, 1.0, 1.0, 2.0]);
    let attenuation = select(vec![
        [1.0, 0.0, 0.0],
        [0.5, 0.1, 0.0],
        [1.0, 0.0, 0.02],
        [1e-3, 0.0, 1.0],
    ]);
    let spot = option::of((direction(), 0.0..90.0f64, 0.0..130.0f64));
    let colors = [grey_or_color(), grey_or_color(), grey_or_color()];
    let negative = prop::bool::weighted(0.05);
    let switches = (
        prop::bool::weighted(0.9),
        prop::bool::weighted(0.2),
        negative,
    );
    (point(), direction(), w, attenuation, spot, colors, switches).prop_map(
        |(
            near,
            away,
            w,
            attenuation,
            spot,
            [ambient, diffuse, specular],
            (enabled, eye, negative),
        )| {
            let at = if w == 0.0 { away } else { near + 4.0 * away };
            let mut source = LightSource {
                ambient: ambient.map(|x| 0.2 * x),
                diffuse: diffuse.map(|x| if negative { -x } else { x }),
                specular,
                position: [at.x, at.y, at.z, w],
                attenuation,
                ..LightSource::default()
            };
            if let Some((axis, cutoff, exponent)) = spot {
                source.spot_direction = axis.to_array();
                source.spot_cutoff_deg = cutoff;
                source.spot_exponent = exponent;
            }
            let space = if eye {
                LightSpace::Eye
            } else {
                LightSpace::World
            };
            Light {
                name: "l".into(),
                source,
                space,
                enabled,
            }
        },
    )
}

/// Ordinary, among the objects, far away with a tiny angle, very wide, or parallel.
fn camera() -> impl Strategy<Value = Camera> {
    let projection = prop_oneof![
        6 => (10.0..50.0f64, Just(6.0)),
        2 => (20.0..120.0f64, Just(0.5)),
        1 => (150.0..178.0f64, Just(4.0)),
        1 => (0.01..0.3f64, Just(1e3)),
        1 => (1e-6..1e-4f64, Just(3e6)),
    ]
    .prop_map(|(fovy_deg, distance)| (Projection::Perspective { fovy_deg }, distance));
    let parallel = (1.0..6.0f64).prop_map(|height| (Projection::Orthographic { height }, 5.0));
    let lens = prop_oneof![5 => projection, 1 => parallel];
    let range = (
        select(vec![1e-6, 0.01, 0.05, 0.45]),
        option::weighted(0.2, 1.5..20.0f64),
    );
    (point(), direction(), lens, range).prop_map(|(target, away, (projection, distance), range)| {
        let away = away.normalize();
        let up = if away.x.abs() < 0.9 {
            DVec3::X
        } else {
            DVec3::Y
        };
        Camera {
            eye: target + distance * away,
            target,
            up,
            projection,
            near: range.0,
            far: range.1.map(|far| far * distance),
        }
    })
}

/// Moves the camera, as it looks, to the middle of a triangle of some object: most scenes are to be seen.
fn look_at(scene: &mut Scene) {
    let Some(object) = scene
        .objects
        .get(scene.trace.depth as usize % scene.objects.len())
    else {
        return;
    };
    let tessellated;
    let mesh = match &object.geometry {
        Geometry::Mesh(mesh) => &**mesh,
        Geometry::Shape(shape) => {
            tessellated = tessellate(shape, 4, 1);
            &tessellated
        }
    };
    let corners = mesh.triangles[mesh.triangles.len() / 2].map(|i| mesh.positions[i as usize]);
    let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
    let by = object.world_from_object.transform_point3(middle) - scene.camera.target;
    scene.camera.eye += by;
    scene.camera.target += by;
}

/// A scene of a few small pixels.
pub(crate) fn scene() -> impl Strategy<Value = Scene> {
    let depth = prop_oneof![1 => 0u32..2, 5 => 2u32..=8];
    let trace = (depth, any::<[bool; 3]>(), select(vec![1, 1, 1, 2, 4]));
    let raster = (
        select(vec![Snap::Bits8, Snap::Bits12, Snap::Exact]),
        any::<[bool; 4]>(),
    );
    let world = (
        vec(things(), 1..4),
        vec(material(), 1..4),
        vec(light(), 1..4),
    );
    (world, camera(), grey_or_color(), trace, raster).prop_map(
        |((things, materials, lights), camera, background, trace, raster)| {
            let mut scene = Scene::default();
            (scene.image.width, scene.image.height) = (12, 9);
            (scene.image.background, scene.image.samples) = (background, trace.2);
            scene.camera = camera;
            let (depth, [filtered, reflect, cut], _) = trace;
            scene.trace.depth = depth;
            scene.trace.shadow = if filtered {
                Shadow::Filtered
            } else {
                Shadow::Opaque
            };
            scene.trace.tir = if reflect { Tir::Reflect } else { Tir::None };
            scene.trace.weight_cutoff = if cut { 1e-3 } else { 0.0 };
            let (snap, [flat, two_sided, local_viewer, lecture]) = raster;
            scene.raster.snap = snap;
            scene.raster.shading = if flat {
                ShadeModel::Flat
            } else {
                ShadeModel::Gouraud
            };
            scene.light_model.two_sided = two_sided;
            scene.light_model.local_viewer = local_viewer;
            if lecture {
                scene.light_model.specular_model = SpecularModel::Reflection;
            }
            let count = materials.len();
            for (number, (geometry, place, m)) in things.into_iter().flatten().enumerate() {
                let first = usize::from(m);
                scene.objects.push(Object {
                    name: format!("o{number}"),
                    geometry,
                    materials: vec![first % count, (first + 1) % count],
                    world_from_object: place,
                    tessellation: None,
                    priority: 0,
                });
            }
            (scene.materials, scene.lights) = (materials, lights);
            look_at(&mut scene);
            scene
        },
    )
}
