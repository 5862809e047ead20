//! Mistakes in the lighting equation, in what goes into it, and in the rasterizer around it.

use super::super::change::Triangles;
use super::{Group, Mistake, Mode, Of};
use crate::gl::SpecularModel;
use crate::lighting::Early;
use crate::scene::LightSpace;
use crate::trace::Normals;

/// The table of this group.
pub(super) fn mistakes() -> Vec<Mistake> {
    let mut all = equation();
    all.extend(ambient());
    all.extend(lights());
    all.extend(vectors());
    all.extend(raster());
    all
}

const LIGHTING: Mistake = Mistake {
    name: "",
    group: Group::Lighting,
    title: "",
    what: "",
    remedy: "",
    of: Of::Any,
    amount: None,
    make: |_| false,
};

fn equation() -> Vec<Mistake> {
    vec![
        Mistake {
            name: "reflection-for-half-vector",
            title: "V·R in place of N·H",
            what: "The highlight is (V·R)^n, the lecture's form, where the scene asks for OpenGL's (N·H)^s. At the same \
                   exponent it is half as wide, and it does not stretch at grazing light.",
            remedy: "Take the half vector H = (L + V) / |L + V| and raise N·H to the shininess; or set \
                     light_model.specular_model = \"reflection\" if V·R is what you want.",
            make: |c| {
                let model = &mut c.scene.light_model.specular_model;
                std::mem::replace(model, SpecularModel::Reflection) == SpecularModel::HalfVector
            },
            ..LIGHTING
        },
        Mistake {
            name: "half-vector-for-reflection",
            title: "N·H in place of V·R",
            what: "The highlight is (N·H)^s, OpenGL's form, where the scene asks for the lecture's (V·R)^n. At the same \
                   exponent it is twice as wide.",
            remedy: "Mirror L at the normal, R = 2 (N·L) N − L, and raise V·R to the exponent; or set \
                     light_model.specular_model = \"half-vector\" if N·H is what you want.",
            make: |c| {
                let model = &mut c.scene.light_model.specular_model;
                std::mem::replace(model, SpecularModel::HalfVector) == SpecularModel::Reflection
            },
            ..LIGHTING
        },
        Mistake {
            name: "clamp-per-light",
            title: "Each light is clamped to 1",
            what: "What one light gives is limited to [0, 1] before the lights are added. A clamped picture shows it only \
                   where the sum is weakened later: in mirrors and through glass.",
            remedy: "Add all terms of all lights without a limit, and clamp the sum once, at the end.",
            make: |c| {
                c.lighting(|f| f.early = Early::ClampLight);
                true
            },
            ..LIGHTING
        },
        Mistake {
            name: "clamp-per-term",
            title: "Each term is clamped to 1",
            what: "Ambient, diffuse and specular are each limited to [0, 1] before they are added, light by light. A clamped \
                   picture shows it only where the sum is weakened later: in mirrors and through glass.",
            remedy: "Add all terms of all lights without a limit, and clamp the sum once, at the end.",
            make: |c| {
                c.lighting(|f| f.early = Early::ClampTerm);
                true
            },
            ..LIGHTING
        },
        Mistake {
            name: "specular-on-unlit-side",
            title: "Highlights on sides that the light does not reach",
            what: "The specular term is kept where N·L <= 0. H and R point to some direction there, too, and a light from \
                   behind leaves a glint, or a hard edge in it.",
            remedy: "Leave out a light's specular term, not only its diffuse one, wherever N·L <= 0.",
            make: |c| {
                c.lighting(|f| f.ungated_specular = true);
                true
            },
            ..LIGHTING
        },
        Mistake {
            name: "specular-missing",
            title: "No specular term",
            what: "There are no highlights: the term K_S I_L is left out, or the specular colour of light or material is black.",
            remedy: "Add the specular term of each light, with the light's and the material's specular colours. A light's \
                     specular colour is its diffuse one where the scene names none.",
            make: |c| {
                let lit = |c: &[f64; 3]| c.iter().any(|x| *x != 0.0);
                c.lights(|light| lit(&std::mem::take(&mut light.source.specular)))
            },
            ..LIGHTING
        },
        Mistake {
            name: "exponent-four-times",
            title: "Exponents four times too large",
            what: "Highlights are half as wide as they should be: the exponents are four times the scene's. Near the peak, \
                   (N·H)^4n looks like (V·R)^n, so exponents are sometimes converted where nothing asks for it.",
            remedy: "Use the shininess as the scene states it, with the specular form that the scene names.",
            make: |c| c.sides(|m| scale(&mut m.shininess, 4.0)),
            ..LIGHTING
        },
        Mistake {
            name: "exponent-a-quarter",
            title: "Exponents four times too small",
            what: "Highlights are twice as wide as they should be: the exponents are a quarter of the scene's. Near the \
                   peak, (V·R)^(s/4) looks like (N·H)^s, so exponents are sometimes converted where nothing asks for it.",
            remedy: "Use the shininess as the scene states it, with the specular form that the scene names.",
            make: |c| c.sides(|m| scale(&mut m.shininess, 0.25)),
            ..LIGHTING
        },
    ]
}

fn ambient() -> Vec<Mistake> {
    vec![
        Mistake {
            name: "ambient-missing",
            title: "No scene ambient",
            what: "The scene's ambient light is missing: what no light reaches is black.",
            remedy: "Add K_A I_AL, the material's ambient colour times light_model.ambient (0.2 where the scene is silent).",
            make: |c| std::mem::take(&mut c.scene.light_model.ambient) != [0.0; 3],
            ..LIGHTING
        },
        Mistake {
            name: "ambient-doubled",
            title: "Scene ambient twice",
            what: "The scene's ambient light is added twice, once on its own and once more in some loop.",
            remedy: "Add K_A I_AL once a point, outside the loop over lights.",
            make: |c| {
                let ambient = &mut c.scene.light_model.ambient;
                *ambient = ambient.map(|x| 2.0 * x);
                *ambient != [0.0; 3]
            },
            ..LIGHTING
        },
        Mistake {
            name: "ambient-per-light",
            title: "Scene ambient once a light",
            what: "The scene's ambient light is added in the loop over lights: once for each of them.",
            remedy: "Add K_A I_AL once a point, outside the loop over lights.",
            make: |c| {
                let lights = c.scene.enabled_lights().count();
                let ambient = &mut c.scene.light_model.ambient;
                *ambient = ambient.map(|x| lights as f64 * x);
                lights > 2 && *ambient != [0.0; 3]
            },
            ..LIGHTING
        },
        Mistake {
            name: "light-ambient-missing",
            title: "No ambient term of the lights",
            what: "Lights have an ambient colour of their own in this scene, and it is left out.",
            remedy: "Add, for each light, its ambient colour times the material's, attenuated and in the cone, never shadowed.",
            make: |c| c.lights(|light| std::mem::take(&mut light.source.ambient) != [0.0; 3]),
            ..LIGHTING
        },
        Mistake {
            name: "light-ambient-unscaled",
            title: "Ambient of the lights neither attenuated nor in the cone",
            what: "A light's ambient colour is added at full strength everywhere. OpenGL weakens it with the distance and \
                   cuts it off at the cone, as the light's other terms.",
            remedy: "Multiply all three terms of a light by its attenuation and spot factor.",
            make: |c| {
                let mut sum = c.scene.light_model.ambient;
                let any = c.lights(|light| {
                    let source = &light.source;
                    let point = source.position[3] != 0.0 && source.attenuation != [1.0, 0.0, 0.0];
                    source.ambient != [0.0; 3] && (point || source.spot_cutoff_deg < 180.0)
                });
                for light in c.scene.lights.iter_mut().filter(|light| light.enabled) {
                    let ambient = std::mem::take(&mut light.source.ambient);
                    sum = [0, 1, 2].map(|k| sum[k] + ambient[k]);
                }
                c.scene.light_model.ambient = sum;
                any
            },
            ..LIGHTING
        },
    ]
}

fn lights() -> Vec<Mistake> {
    let mut all = places();
    all.extend(cones());
    all
}

fn places() -> Vec<Mistake> {
    vec![
        Mistake {
            name: "attenuation-missing",
            title: "No attenuation",
            what: "Lights do not fade with distance, although the scene gives them an attenuation.",
            remedy: "Multiply a positional light by 1 / (c + l d + q d²), d being its distance from the point.",
            make: |c| {
                c.lights(|light| {
                    let fades = light.source.attenuation != [1.0, 0.0, 0.0];
                    light.source.attenuation = [1.0, 0.0, 0.0];
                    fades && light.source.position[3] != 0.0
                })
            },
            ..LIGHTING
        },
        Mistake {
            name: "directional-attenuated",
            title: "Directional lights are attenuated, by their length",
            what: "The attenuation is applied to directional lights as well, with the length of the direction for a distance.",
            remedy: "A light with w = 0 has no distance: its attenuation is 1, whatever c, l and q are.",
            make: |c| {
                c.lights(|light| {
                    let [x, y, z, _] = light.source.position;
                    attenuate(light, (x * x + y * y + z * z).sqrt())
                })
            },
            ..LIGHTING
        },
        Mistake {
            name: "directional-attenuated-at-1",
            title: "Directional lights are attenuated, as if 1 away",
            what: "The attenuation is applied to directional lights as well, with their unit direction for a distance of 1.",
            remedy: "A light with w = 0 has no distance: its attenuation is 1, whatever c, l and q are.",
            make: |c| c.lights(|light| attenuate(light, 1.0)),
            ..LIGHTING
        },
        Mistake {
            name: "direction-as-position",
            title: "A directional light taken for a point light",
            what: "The direction of a directional light is taken for a place: the light stands there, near the origin.",
            remedy: "Where w = 0, L is (x, y, z) made unit, the same at every point. `direction` in a scene is the way the \
                     light travels, so L is its opposite.",
            make: |c| {
                c.lights(|light| std::mem::replace(&mut light.source.position[3], 1.0) == 0.0)
            },
            ..LIGHTING
        },
        Mistake {
            name: "direction-reversed",
            title: "Directional lights come from the wrong side",
            what: "The way that a directional light travels is taken for the way to the light.",
            remedy: "`direction` in a scene is the way the light travels: L is its opposite. A `position` with w = 0 is the \
                     way to the light.",
            make: |c| {
                c.lights(|light| {
                    let [x, y, z, w] = light.source.position;
                    if w == 0.0 {
                        light.source.position = [-x, -y, -z, w];
                    }
                    w == 0.0
                })
            },
            ..LIGHTING
        },
        Mistake {
            name: "position-not-divided",
            title: "Positions of lights are not divided by w",
            what: "A light's position (x, y, z, w) is used as (x, y, z).",
            remedy: "Where w is not 0, the light stands at (x/w, y/w, z/w).",
            make: |c| {
                c.lights(|light| {
                    let w = &mut light.source.position[3];
                    let divides = *w != 0.0 && *w != 1.0;
                    if divides {
                        *w = 1.0;
                    }
                    divides
                })
            },
            ..LIGHTING
        },
        Mistake {
            name: "light-follows-camera",
            title: "Lights are attached to the camera",
            what: "Positions and directions of lights are taken in eye space: the lights move with the camera. In OpenGL \
                   that is what happens when glLight is called before the view is set.",
            remedy: "Transform each light by the view before lighting in eye space (OpenGL: set the view first, then call \
                     glLight), or light in world space.",
            make: |c| {
                c.lights(|light| {
                    std::mem::replace(&mut light.space, LightSpace::Eye) == LightSpace::World
                })
            },
            ..LIGHTING
        },
        Mistake {
            name: "light-stays-in-world",
            title: "A light of the camera is left in the world",
            what: "The scene attaches a light to the camera (space = \"eye\"), and here it stands still in the world.",
            remedy: "Use position and direction of such a light in eye space as they are, without the view.",
            make: |c| {
                c.lights(|light| {
                    std::mem::replace(&mut light.space, LightSpace::World) == LightSpace::Eye
                })
            },
            ..LIGHTING
        },
    ]
}

fn cones() -> Vec<Mistake> {
    vec![
        Mistake {
            name: "spot-angle-halved",
            title: "Cones of spot lights half as wide",
            what: "The cutoff is taken for the whole angle of the cone: the pool of light is half as wide as it should be.",
            remedy: "The cutoff is half of the cone's angle: the angle between its axis and its edge.",
            make: |c| c.lights(|light| cone(light, 0.5)),
            ..LIGHTING
        },
        Mistake {
            name: "spot-angle-doubled",
            title: "Cones of spot lights twice as wide",
            what: "The cone is twice as wide as it should be, as if the cutoff were doubled on its way into the cosine.",
            remedy: "Compare with the cosine of the cutoff itself: it is the angle between the cone's axis and its edge.",
            make: |c| c.lights(|light| cone(light, 2.0)),
            ..LIGHTING
        },
        Mistake {
            name: "spot-exponent-missing",
            title: "Spot lights do not fade towards their edge",
            what: "The spot exponent is left out: inside its cone the light is equally bright.",
            remedy: "Multiply by (−L·D)^e, D being the unit axis of the cone and e spot_exponent.",
            make: |c| {
                c.lights(|light| {
                    let fades = std::mem::take(&mut light.source.spot_exponent) != 0.0;
                    fades && light.source.spot_cutoff_deg < 180.0
                })
            },
            ..LIGHTING
        },
        Mistake {
            name: "spot-cone-missing",
            title: "Spot lights shine everywhere",
            what: "The cone of spot lights is left out, and with it the fading towards its edge: they are point lights.",
            remedy: "Where −L·D is below the cosine of the cutoff, the light gives nothing.",
            make: |c| {
                c.lights(|light| {
                    std::mem::replace(&mut light.source.spot_cutoff_deg, 180.0) < 180.0
                })
            },
            ..LIGHTING
        },
    ]
}

fn vectors() -> Vec<Mistake> {
    vec![
        Mistake {
            name: "normals-not-normalised",
            title: "Normals are not made unit length",
            what: "Normals enter the equation with the length that a transform, interpolation or the shape's own formula \
                   leaves them: too bright where they are longer than 1, too dark where they are shorter.",
            remedy: "Divide the normal by its length after every transform and every interpolation; for a sphere, \
                     N = (P − C) / r.",
            make: |c| {
                let normalized = std::mem::take(&mut c.scene.light_model.normalize);
                c.scene.light_model.rescale_normal = false;
                c.raster.normals_unnormalized = true;
                c.trace.normals = Normals::Unnormalized;
                normalized
            },
            ..LIGHTING
        },
        Mistake {
            name: "normals-by-model-matrix",
            title: "Normals transformed like points",
            what: "Normals are multiplied by the model matrix itself. Where it stretches one direction more than another, \
                   they no longer stand upright on the surface, and light falls as on another one.",
            remedy: "Multiply normals by the inverse transpose of the matrix's upper-left 3 x 3, then make them unit length.",
            make: |c| {
                c.triangles = Triangles::NormalsByModelMatrix;
                c.trace.normals = Normals::ByModelMatrix;
                true
            },
            ..LIGHTING
        },
        Mistake {
            name: "infinite-viewer",
            title: "Infinite viewer",
            what: "V is (0, 0, 1) in eye space everywhere, OpenGL's default, where the scene asks for a viewer at the eye: \
                   highlights sit elsewhere, the more so towards the rim of the picture.",
            remedy: "Take V from the point to the eye (OpenGL: GL_LIGHT_MODEL_LOCAL_VIEWER), or set \
                     light_model.local_viewer = false.",
            make: |c| std::mem::take(&mut c.scene.light_model.local_viewer),
            ..LIGHTING
        },
        Mistake {
            name: "local-viewer",
            title: "Local viewer",
            what: "V goes from each point to the eye, where the scene asks for OpenGL's infinite viewer, (0, 0, 1).",
            remedy: "Use V = (0, 0, 1) in eye space, or set light_model.local_viewer = true.",
            make: |c| !std::mem::replace(&mut c.scene.light_model.local_viewer, true),
            ..LIGHTING
        },
        Mistake {
            name: "two-sided-missing",
            title: "Back faces are lit as front faces",
            what: "The scene asks for two-sided lighting, and back faces are lit with the front's normal and material.",
            remedy: "Where a face shows its back, light it with the opposite normal and the back material.",
            make: |c| std::mem::take(&mut c.scene.light_model.two_sided),
            ..LIGHTING
        },
        Mistake {
            name: "two-sided-added",
            title: "Back faces are lit with their normal turned round",
            what: "Normals are turned towards the viewer, two-sided lighting, where the scene asks for OpenGL's default: \
                   both sides are lit with the front's normal.",
            remedy: "Use the normal as it is on both sides, or set light_model.two_sided = true.",
            make: |c| !std::mem::replace(&mut c.scene.light_model.two_sided, true),
            ..LIGHTING
        },
    ]
}

fn raster() -> Vec<Mistake> {
    const RASTER: Mistake = Mistake {
        group: Group::Raster,
        of: Of::Raster,
        ..LIGHTING
    };
    vec![
        Mistake {
            name: "affine-interpolation",
            title: "Interpolation without perspective",
            what: "Colours, or positions and normals, are interpolated evenly in the window. On triangles that recede from \
                   the eye they slide towards the far end, and neighbouring triangles do not fit.",
            remedy: "Interpolate a/w and 1/w, and divide: (Σ b a/w) / (Σ b 1/w), b being the weights in the window.",
            make: |c| {
                c.raster.affine = true;
                true
            },
            ..RASTER
        },
        Mistake {
            name: "vertex-colours-not-clamped",
            title: "Vertex colours are clamped too late",
            what: "Colours above 1 are interpolated and clamped at the pixel. OpenGL clamps them at the vertex, so that \
                   bright spots are smaller and darker there.",
            remedy: "Clamp the colour of each vertex to [0, 1] before it is interpolated (OpenGL 2.1, section 2.14.6); \
                     leave it out if it is Phong shading that you want.",
            of: Of::Only(Mode::Gouraud),
            make: |c| std::mem::take(&mut c.clamp),
            ..RASTER
        },
        Mistake {
            name: "first-vertex-provokes",
            title: "Flat triangles take the colour of their first corner",
            what: "A flat triangle has the colour of its first corner. OpenGL takes the last one.",
            remedy: "Use the last corner of each triangle (OpenGL: glProvokingVertex with GL_LAST_VERTEX_CONVENTION).",
            of: Of::Only(Mode::Flat),
            make: |c| {
                c.triangles = Triangles::FirstProvokes;
                true
            },
            ..RASTER
        },
        Mistake {
            name: "no-depth-test",
            title: "No depth test",
            what: "What is drawn last shows, not what is nearest.",
            remedy: "Keep the depth of each pixel and draw only what is nearer (OpenGL: glEnable(GL_DEPTH_TEST), a depth \
                     buffer, and its clearing in every frame).",
            make: |c| std::mem::take(&mut c.scene.raster.depth_test),
            ..RASTER
        },
    ]
}

/// Multiplies; says whether that changes anything.
fn scale(x: &mut f64, by: f64) -> bool {
    *x *= by;
    *x != 0.0
}

/// Makes a cone wider or narrower, to at most a half space.
fn cone(light: &mut crate::scene::Light, by: f64) -> bool {
    let cutoff = &mut light.source.spot_cutoff_deg;
    let has_cone = *cutoff < 180.0;
    if has_cone {
        *cutoff = (*cutoff * by).min(90.0);
    }
    has_cone
}

/// Weakens a directional light as if it were so far away.
fn attenuate(light: &mut crate::scene::Light, distance: f64) -> bool {
    let source = &mut light.source;
    let [constant, linear, quadratic] = source.attenuation;
    let factor = 1.0 / (constant + distance * (linear + distance * quadratic));
    let applies = source.position[3] == 0.0 && factor.is_finite();
    if applies {
        for color in [
            &mut source.ambient,
            &mut source.diffuse,
            &mut source.specular,
        ] {
            *color = color.map(|x| x * factor);
        }
    }
    applies
}
