//! Properties of the equation: same bits everywhere, closed forms, boundaries, poison.

use super::*;
use crate::frame::sum_in_order;
use crate::lanes::elementary::tests::Random;

/// A light of every kind, with every class of power and attenuation.
fn lights(random: &mut Random, signed: bool) -> Vec<gl::LightSource> {
    let low = if signed { -1.0 } else { 0.0 };
    (0..12)
        .map(|i| {
            let mut color = || [0; 3].map(|_| random.between(low, 1.5));
            let (ambient, diffuse, specular) = (color(), color(), color());
            let mut place = || [0; 3].map(|_| random.between(-4.0, 4.0));
            let ([x, y, z], axis) = (place(), place());
            gl::LightSource {
                ambient: if i % 3 == 0 { [0.0; 3] } else { ambient },
                diffuse,
                specular: if i == 7 { [0.0; 3] } else { specular },
                position: [x, y, z + 3.0, f64::from(i % 4 != 0)],
                spot_direction: [axis[0], axis[1], axis[2] - 3.0],
                spot_exponent: [0.0, 1.0, 17.5, 300.0][i % 4],
                spot_cutoff_deg: [180.0, 90.0, 60.0, 35.0, 0.0][i % 5],
                attenuation: if i % 2 == 0 {
                    [1.0, 0.0, 0.0]
                } else {
                    [0.0, 0.3, 0.1]
                },
            }
        })
        .collect()
}

fn points<R: Real>(random: &mut Random, n: usize, lengths: bool) -> Points<R> {
    let mut points = Points::default();
    for i in 0..n {
        let mut place = |scale: f64| [0; 3].map(|_| random.between(-scale, scale));
        let position = place(3.0).map(R::from_f64);
        let [x, y, z] = place(0.8);
        let normal = normalize([x, y, z + 0.5]).0.map(R::from_f64);
        let normal = if i == 5 { [R::ZERO; 3] } else { normal };
        points.push(position, normal, to_viewer(position, i % 3 != 0));
        if lengths {
            points.normal_length.push(R::from_f64(0.5 + (i % 5) as f64));
        }
    }
    points
}

fn bits<R: Real>(lists: &[Vec<R>; 3]) -> Vec<R::Bits> {
    lists.iter().flatten().map(|x| x.to_bits()).collect()
}

/// S_L that differs by light, point and component, with zeros and ones among them.
struct Patterned;
impl<R: Real> Visibility<R> for Patterned {
    fn query(&mut self, light: usize, seen: &Illumination<R>, out: &mut [Vec<R>; 3]) {
        for (c, list) in out.iter_mut().enumerate() {
            for (i, s) in list.iter_mut().enumerate() {
                if seen.facing[i] {
                    *s = R::from_f64(((light + 2 * i + c) % 5) as f64 / 4.0);
                }
            }
        }
    }
}

struct Constant(f64);
impl<R: Real> Visibility<R> for Constant {
    fn query(&mut self, _: usize, _: &Illumination<R>, out: &mut [Vec<R>; 3]) {
        for list in out {
            list.fill(R::from_f64(self.0));
        }
    }
}

struct Setup<R> {
    rig: Rig<R>,
    material: gl::Material,
    points: Points<R>,
    signed: bool,
}

type Terms<R> = Vec<[Vec<R>; 3]>;

impl<R: Real> Setup<R> {
    fn sum(&self, isa: Isa, visibility: Option<&mut dyn Visibility<R>>) -> [Vec<R>; 3] {
        let mut out = Default::default();
        let Self {
            rig,
            material,
            points,
            signed,
        } = self;
        shade(
            isa,
            rig,
            material,
            points,
            visibility,
            *signed,
            Sink::Sum(&mut out),
        );
        out
    }

    fn record(&self, isa: Isa, visibility: Option<&mut dyn Visibility<R>>) -> Terms<R> {
        let mut out = Vec::new();
        let Self {
            rig,
            material,
            points,
            signed,
        } = self;
        shade(
            isa,
            rig,
            material,
            points,
            visibility,
            *signed,
            Sink::Record(&mut out),
        );
        out
    }

    fn split(&self, isa: Isa) -> [[Vec<R>; 3]; 2] {
        let (mut first, mut second) = Default::default();
        let Self {
            rig,
            material,
            points,
            signed,
        } = self;
        let sink = Sink::Split(&mut first, &mut second);
        shade(isa, rig, material, points, None, *signed, sink);
        [first, second]
    }
}

/// Many combinations of shininess, form, sign, normal length and number of points.
fn setups<R: Real>() -> Vec<Setup<R>> {
    let mut random = Random(11);
    let mut list = Vec::new();
    for (i, shininess) in [0.0, 1.0, 32.0, 2500.0, 0.3, 64.0].into_iter().enumerate() {
        let signed = i % 2 == 1;
        let model = gl::LightModel {
            specular_model: if i % 3 == 2 {
                gl::SpecularModel::Reflection
            } else {
                gl::SpecularModel::HalfVector
            },
            color_control: if i < 3 {
                gl::ColorControl::SeparateSpecular
            } else {
                gl::ColorControl::Single
            },
            ..gl::LightModel::default()
        };
        list.push(Setup {
            rig: Rig::new(&lights(&mut random, signed), &model),
            material: gl::Material {
                emission: [0.0, 0.1, 0.2],
                specular: [0.9, 0.5, 0.25],
                shininess,
                ..gl::Material::default()
            },
            points: points(&mut random, [1, 7, 131, 300, 16, 523][i], i == 4),
            signed,
        });
    }
    list
}

fn same_bits_at_every_instruction_set<R: Real>() {
    for (i, setup) in setups::<R>().iter().enumerate() {
        let sum = bits(&setup.sum(Isa::Scalar, None));
        let shadowed = bits(&setup.sum(Isa::Scalar, Some(&mut Patterned)));
        let terms: Vec<_> = setup.record(Isa::Scalar, None).iter().map(bits).collect();
        let split = setup.split(Isa::Scalar).map(|list| bits(&list));
        for isa in Isa::available() {
            let at = format!("setup {i}, {}", isa.name());
            assert!(bits(&setup.sum(isa, None)) == sum, "{at}: sum");
            assert!(
                bits(&setup.sum(isa, Some(&mut Patterned))) == shadowed,
                "{at}: shadowed"
            );
            let found: Vec<_> = setup.record(isa, None).iter().map(bits).collect();
            assert!(found == terms, "{at}: terms");
            assert!(
                setup.split(isa).map(|list| bits(&list)) == split,
                "{at}: split"
            );
        }
    }
}

#[test]
fn instruction_sets_agree_bit_for_bit() {
    same_bits_at_every_instruction_set::<f32>();
    same_bits_at_every_instruction_set::<f64>();
}

fn sum_equals_record<R: Real>() {
    let isa = Isa::detect();
    for setup in setups::<R>() {
        for shadows in [false, true] {
            let (sum, terms) = if shadows {
                let sum = setup.sum(isa, Some(&mut Patterned));
                (sum, setup.record(isa, Some(&mut Patterned)))
            } else {
                (setup.sum(isa, None), setup.record(isa, None))
            };
            for i in 0..setup.points.len() {
                let of_point = terms.iter().map(|t| [0, 1, 2].map(|c| t[c][i]));
                let expected = sum_in_order(of_point, setup.signed);
                for c in 0..3 {
                    assert!(sum[c][i].to_bits() == expected[c].to_bits(), "point {i}");
                }
            }
        }
    }
}

#[test]
fn the_sum_is_the_sum_of_the_recorded_terms() {
    sum_equals_record::<f32>();
    sum_equals_record::<f64>();
}

#[test]
fn visibility_one_changes_no_bit_and_zero_leaves_plus_zero() {
    let isa = Isa::detect();
    for setup in setups::<f32>() {
        let open = setup.sum(isa, None);
        assert_eq!(bits(&setup.sum(isa, Some(&mut Constant(1.0)))), bits(&open));
        let unshadowed = setup.record(isa, None);
        let shadowed = setup.record(isa, Some(&mut Constant(0.0)));
        for (k, (dark, lit)) in shadowed.iter().zip(&unshadowed).enumerate() {
            if k < 2 || k % 3 == 2 {
                assert_eq!(bits(dark), bits(lit)); // emission, scene ambient, ambient of a light
            } else {
                assert!(dark.iter().flatten().all(|x| x.to_bits() == 0), "layer {k}");
            }
        }
    }
}

#[test]
fn a_point_does_not_know_its_neighbours() {
    for setup in setups::<f32>() {
        let together = setup.sum(Isa::detect(), None);
        let all = &setup.points;
        for i in (0..all.len()).step_by(13) {
            let mut alone = Points::default();
            let pick = |list: &[Vec<f32>; 3]| [0, 1, 2].map(|a| list[a][i]);
            alone.push(pick(&all.position), pick(&all.normal), pick(&all.to_viewer));
            alone.normal_length.extend(all.normal_length.get(i));
            let setup = Setup {
                points: alone,
                rig: setup.rig.clone(),
                material: setup.material.clone(),
                signed: setup.signed,
            };
            let found = setup.sum(Isa::detect(), None);
            assert_eq!(
                found.map(|l| l[0].to_bits()),
                pick(&together).map(f32::to_bits)
            );
        }
    }
}

/// One light, one point at the origin looking at a viewer along +z, normal +z.
fn one(light: gl::LightSource, material: gl::Material, model: gl::LightModel) -> [f64; 5] {
    let mut points = Points::<f64>::default();
    points.push([0.0; 3], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]);
    let setup = Setup {
        rig: Rig::new(&[light], &model),
        material,
        points,
        signed: false,
    };
    let terms = setup.record(Isa::detect(), None);
    [0, 1, 2, 3, 4].map(|k| terms[k][0][0])
}

fn white() -> gl::Material {
    gl::Material {
        emission: [0.0; 3],
        ambient: [1.0; 3],
        diffuse: [1.0; 3],
        specular: [1.0; 3],
        alpha: 1.0,
        shininess: 2.0,
        ..gl::Material::default()
    }
}

fn at(x: f64, y: f64, z: f64, w: f64) -> gl::LightSource {
    gl::LightSource {
        ambient: [1.0; 3],
        position: [x, y, z, w],
        ..gl::LightSource::default()
    }
}

#[test]
fn closed_forms_of_every_term() {
    let model = gl::LightModel::default;
    // l = (3, 0, 4)/5: n.l = 0.8, h = (3, 0, 9)/sqrt(90), n.h^2 = 81/90.
    let [e, a, la, ld, ls] = one(at(3.0, 0.0, 4.0, 0.0), white(), model());
    assert_eq!([e, a, la, ld], [0.0, 0.2, 1.0, 0.8]);
    assert!((ls - 0.9).abs() < 1e-15);
    // The lecture's form: R = (-3, 0, 4)/5, V.R = 0.8, squared.
    let lecture = gl::LightModel {
        specular_model: gl::SpecularModel::Reflection,
        ..model()
    };
    let [.., ls] = one(at(3.0, 0.0, 4.0, 0.0), white(), lecture);
    assert!((ls - 0.64).abs() < 1e-15);
    // Distance 5: 1/(1 + 5 * 0.2 + 25 * 0.08) = 1/4, on ambient too.
    let light = gl::LightSource {
        attenuation: [1.0, 0.2, 0.08],
        ..at(6.0, 0.0, 8.0, 2.0)
    };
    let [_, _, la, ld, ls] = one(light.clone(), white(), model());
    assert!((la - 0.25).abs() < 1e-15 && (ld - 0.2).abs() < 1e-15 && (ls - 0.225).abs() < 1e-15);
    // A spot along -z: q = 0.8; cutoff 45 (cos 0.707) lets it in, 30 (0.866) does not.
    let spot = |cutoff: f64, exponent: f64| gl::LightSource {
        spot_cutoff_deg: cutoff,
        spot_exponent: exponent,
        ..at(3.0, 0.0, 4.0, 1.0)
    };
    for (exponent, factor) in [(0.0, 1.0), (1.0, 0.8), (3.0, 0.512)] {
        let [_, _, la, ld, _] = one(spot(45.0, exponent), white(), model());
        assert!((la - factor).abs() < 1e-15 && (ld - 0.8 * factor).abs() < 1e-15);
        assert_eq!(one(spot(30.0, exponent), white(), model())[2..], [0.0; 3]);
        // The same on a directional light: its direction of travel is (-3, 0, -4)/5.
        let directional = gl::LightSource {
            position: [3.0, 0.0, 4.0, 0.0],
            ..spot(45.0, exponent)
        };
        assert!((one(directional, white(), model())[2] - factor).abs() < 1e-15);
    }
}

#[test]
fn boundaries() {
    let model = gl::LightModel::default;
    let zero_power = gl::Material {
        shininess: 0.0,
        ..white()
    };
    // n.l = 0: no diffuse, and the gate keeps the highlight off, whatever the exponent.
    assert_eq!(
        one(at(1.0, 0.0, 0.0, 0.0), zero_power.clone(), model())[2..],
        [1.0, 0.0, 0.0]
    );
    assert_eq!(
        one(at(1.0, 0.0, -1.0, 1.0), zero_power.clone(), model())[2..],
        [1.0, 0.0, 0.0]
    );
    // 0^0 = 1 under the gate.
    assert_eq!(one(at(0.0, 0.0, 1.0, 0.0), zero_power, model())[4], 1.0);
    // Light at the point: direction zero, distance zero.
    assert_eq!(
        one(at(0.0, 0.0, 0.0, 1.0), white(), model())[2..],
        [1.0, 0.0, 0.0]
    );
    let singular = gl::LightSource {
        attenuation: [0.0, 0.0, 1.0],
        ..at(0.0, 0.0, 0.0, 1.0)
    };
    // 1/0 on ambient; 0 times infinity is 0 on the others.
    assert_eq!(
        one(singular, white(), model())[2..],
        [f64::INFINITY, 0.0, 0.0]
    );
    let spot = |cutoff: f64, direction: [f64; 3]| gl::LightSource {
        spot_cutoff_deg: cutoff,
        spot_direction: direction,
        ..at(0.0, 0.0, 2.0, 1.0)
    };
    // On the axis at cutoff 0; perpendicular at cutoff 90; both edges are inside.
    assert_eq!(one(spot(0.0, [0.0, 0.0, -3.0]), white(), model())[3], 1.0);
    assert_eq!(one(spot(0.0, [0.0, 1e-9, -3.0]), white(), model())[3], 0.0);
    assert_eq!(one(spot(90.0, [1.0, 0.0, 0.0]), white(), model())[3], 1.0);
    assert_eq!(one(spot(90.0, [0.0, 0.0, 1.0]), white(), model())[3], 0.0);
    assert_eq!(one(spot(45.0, [0.0, 0.0, 0.0]), white(), model())[3], 0.0);
    // A light on the other side of the viewer: half vector zero, highlight zero, no NaN.
    let mut points = Points::<f32>::default();
    points.push([0.0; 3], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]);
    let setup = Setup {
        rig: Rig::new(&[at(0.0, 0.0, 1.0, 0.0)], &model()),
        material: white(),
        points,
        signed: false,
    };
    assert_eq!(setup.record(Isa::detect(), None)[4][0][0], 0.0);
}

#[test]
fn positions_are_divided_by_any_w() {
    let reference = Light::<f32>::resolve(&at(1.0, 2.0, 3.0, 1.0));
    for w in [-1.0, 1e-30, -1e-30, 1e30, 0.125] {
        let light = Light::<f32>::resolve(&at(w, 2.0 * w, 3.0 * w, w));
        assert_eq!(light, reference, "{w}");
    }
    // Beyond f32: far along the same direction, still finite.
    let Light::Point(far) = Light::<f32>::resolve(&at(3.0, 0.0, -4.0, -1e-60)) else {
        panic!("a point light");
    };
    assert!(far.position_eye.iter().all(|x| x.is_finite()));
    assert!((far.position_eye[0] / far.position_eye[2] + 0.75).abs() < 1e-6);
    assert!(far.position_eye[0] < 0.0);
}

/// Scaling a scene by a power of two, attenuation with it, changes no bit.
#[test]
fn scale_invariance() {
    let mut random = Random(5);
    let sources = lights(&mut random, false);
    let base = points::<f32>(&mut random, 64, false);
    let colors = |k: i32| {
        let s = 2f64.powi(k);
        let scaled: Vec<_> = sources
            .iter()
            .map(|light| {
                let [x, y, z, w] = light.position;
                let [constant, linear, quadratic] = light.attenuation;
                gl::LightSource {
                    position: [x * s, y * s, z * s, w],
                    attenuation: [constant, linear / s, quadratic / s / s],
                    ..light.clone()
                }
            })
            .collect();
        let mut points = base.clone();
        for list in &mut points.position {
            list.iter_mut().for_each(|x| *x *= s as f32);
        }
        let setup = Setup {
            rig: Rig::new(&scaled, &gl::LightModel::default()),
            material: white(),
            points,
            signed: false,
        };
        bits(&setup.sum(Isa::detect(), None))
    };
    let expected = colors(0);
    for k in [-60, -20, -1, 1, 26, 60] {
        assert!(colors(k) == expected, "2^{k}");
    }
}

/// Visibility: asked once a light, for all points, only where a light can matter.
#[test]
fn the_hook_is_asked_only_for_lights_that_matter() {
    struct Asked(Vec<usize>);
    impl Visibility<f32> for Asked {
        fn query(&mut self, light: usize, seen: &Illumination<f32>, out: &mut [Vec<f32>; 3]) {
            assert_eq!(seen.facing.len(), 600);
            assert!(
                out.iter()
                    .all(|list| list.len() == 600 && list.iter().all(|x| *x == 1.0))
            );
            self.0.push(light);
        }
    }
    let dark = gl::LightSource {
        diffuse: [0.0; 3],
        specular: [0.0; 3],
        ..at(0.0, 0.0, 1.0, 1.0)
    };
    let sources = [
        at(0.0, 0.0, 5.0, 1.0),
        dark,
        at(0.0, 0.0, -1.0, 0.0),
        at(0.0, 0.0, 1.0, 0.0),
    ];
    let rig = Rig::new(&sources, &gl::LightModel::default());
    let mut points = Points::<f32>::default();
    for _ in 0..600 {
        points.push([0.0; 3], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]);
    }
    let (mut asked, mut out) = (Asked(Vec::new()), Default::default());
    let sink = Sink::Sum(&mut out);
    let hook: &mut dyn Visibility<f32> = &mut asked;
    let found = shade(
        Isa::detect(),
        &rig,
        &white(),
        &points,
        Some(hook),
        false,
        sink,
    );
    assert_eq!(asked.0, [0, 3]);
    let expected = Counters {
        points: 600,
        light_evaluations: 2400,
        light_vector_roots: 600,
        // Three lights have a specular colour, one of them shines from below.
        half_vectors: 1200,
        pow_calls: 1200,
        visibility_queries: 1200,
        ..Counters::default()
    };
    assert_eq!(found, expected);
}

/// Any number anywhere may be NaN, infinite, denormal or huge: no panic, no NaN in any term or sum.
#[test]
fn poison() {
    let poisons = [
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        -0.0,
        1e-45,
        3.4e38,
        -3.4e38,
        1e300,
    ];
    let base = gl::LightSource {
        attenuation: [1.0, 0.5, 0.25],
        spot_cutoff_deg: 60.0,
        spot_exponent: 3.0,
        ..at(0.5, 0.0, 2.0, 1.0)
    };
    let mut cases = Vec::new();
    for p in poisons {
        for field in 0..18 {
            let (mut light, mut material) = (base.clone(), white());
            match field {
                0..4 => light.position[field] = p,
                4..7 => light.attenuation[field - 4] = p,
                7..10 => light.spot_direction[field - 7] = p,
                10 => light.spot_exponent = p,
                11 => light.spot_cutoff_deg = p,
                12 => light.diffuse[0] = p,
                13 => light.ambient[1] = p,
                14 => material.shininess = p,
                15 => material.specular[2] = p,
                16 => material.emission[0] = p,
                _ => material.ambient[0] = p,
            }
            cases.push((light, material));
        }
    }
    for (light, material) in cases {
        for signed in [false, true] {
            let mut points = Points::<f32>::default();
            points.push([0.0; 3], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]);
            for p in poisons {
                points.push([p as f32, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]);
            }
            let setup = Setup {
                rig: Rig::new(
                    &[light.clone(), at(0.0, 0.0, 1.0, 0.0)],
                    &gl::LightModel::default(),
                ),
                material: material.clone(),
                points,
                // Negative infinities among the colours are what `signed` is for.
                signed: signed || !material_is_positive(&material, &light),
            };
            let sum = setup.sum(Isa::detect(), None);
            assert!(
                sum.iter().flatten().all(|x| !x.is_nan()),
                "{light:?} {material:?}"
            );
            let terms = setup.record(Isa::detect(), None);
            let numbers = terms.iter().flatten().flatten();
            assert!(
                numbers.into_iter().all(|x| !x.is_nan()),
                "{light:?} {material:?}"
            );
        }
    }
}

fn material_is_positive(material: &gl::Material, light: &gl::LightSource) -> bool {
    let colors = [
        material.emission,
        material.ambient,
        material.specular,
        light.ambient,
        light.diffuse,
    ];
    colors.iter().flatten().all(|x| *x >= 0.0)
}

/// GL 2.1 section 2.14.3: a vertex with a colour is lit as with the material that the colour overwrites, to the last bit.
fn vertex_colours_are_overwritten_materials<R: Real>(signed: bool) {
    let mut random = Random(23);
    let rig = Rig::<R>::new(&lights(&mut random, signed), &gl::LightModel::default());
    let low = if signed { -1.0 } else { 0.0 };
    for mask in 0..16 {
        let material = gl::Material {
            emission: [0.25, 0.0, 0.125],
            specular: [0.5; 3],
            shininess: 20.0,
            tracked: gl::Tracked {
                emission: mask & 1 != 0,
                ambient: mask & 2 != 0,
                diffuse: mask & 4 != 0,
                specular: mask & 8 != 0,
            },
            ..gl::Material::default()
        };
        // More than one chunk, and no multiple of any width.
        let mut all = points::<R>(&mut random, 300, mask % 3 == 0);
        for _ in 0..300 {
            all.push_color([0; 3].map(|_| R::from_f64(random.between(low, 1.5))));
        }
        let run = |material: &gl::Material, points: &Points<R>| {
            let (mut sum, mut first, mut second) = Default::default();
            let mut terms = Vec::new();
            let isa = Isa::detect();
            let go = |sink| {
                shade(
                    isa,
                    &rig,
                    material,
                    points,
                    Some(&mut Patterned),
                    signed,
                    sink,
                )
            };
            let counters = go(Sink::Sum(&mut sum));
            go(Sink::Record(&mut terms));
            go(Sink::Split(&mut first, &mut second));
            (sum, first, second, terms, counters)
        };
        let (sum, first, second, terms, _) = run(&material, &all);
        for i in (0..300).step_by(29) {
            let color = [0, 1, 2].map(|c| all.color[c][i].to_f64());
            let own = material.with_color([color[0], color[1], color[2], 1.0]);
            let at = |lists: &[Vec<R>; 3]| [lists[0][i], lists[1][i], lists[2][i]];
            // The same hook's answer for point i: its pattern goes by the place in the call.
            let mut pad = Points::default();
            for _ in 0..=i {
                pad.push(at(&all.position), at(&all.normal), at(&all.to_viewer));
                pad.normal_length.extend(all.normal_length.get(i));
            }
            let (s, f, g, t, _) = run(&own, &pad);
            let same = |a: &[Vec<R>; 3], b: &[Vec<R>; 3], what: &str| {
                for c in 0..3 {
                    let equal = a[c][i].to_bits() == b[c][i].to_bits();
                    assert!(equal, "mask {mask}, {what}, point {i}, channel {c}");
                }
            };
            same(&sum, &s, "sum");
            same(&first, &f, "primary");
            same(&second, &g, "secondary");
            for (k, (a, b)) in terms.iter().zip(&t).enumerate() {
                same(a, b, &format!("term {k}"));
            }
        }
    }
}

#[test]
fn vertex_colours_overwrite_the_material() {
    vertex_colours_are_overwritten_materials::<f32>(false);
    vertex_colours_are_overwritten_materials::<f32>(true);
    vertex_colours_are_overwritten_materials::<f64>(false);
    vertex_colours_are_overwritten_materials::<f64>(true);
}

#[test]
fn without_colours_a_tracking_material_is_white() {
    let rig = Rig::<f32>::new(&[gl::LightSource::default()], &gl::LightModel::default());
    let tracked = gl::ColorMaterial::default().tracked(false);
    let material = gl::Material {
        tracked,
        ..gl::Material::default()
    };
    let mut points = Points::default();
    points.push([0.0; 3], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]);
    let mut sum = Default::default();
    shade(
        Isa::detect(),
        &rig,
        &material,
        &points,
        None,
        false,
        Sink::Sum(&mut sum),
    );
    assert_eq!(sum[0], [1.2]); // ambient 1 * 0.2, diffuse 1 * 1
    points.push_color([0.5, 0.0, 1.0]);
    shade(
        Isa::detect(),
        &rig,
        &material,
        &points,
        None,
        false,
        Sink::Sum(&mut sum),
    );
    assert_eq!([sum[0][0], sum[1][0], sum[2][0]], [0.6, 0.0, 1.2]);
}
