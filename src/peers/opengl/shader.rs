//! The lighting equation in GLSL 1.20, for what fixed function does not have.
//!
//! In: the shape of a scene's model (numbers of lights, specular form, viewer, clamps). Out: a program that evaluates GL
//! 2.1 section 2.14.1, or the lecture's (V.R)^n, at vertices (fixed function interpolates and adds the secondary colour) or
//! at fragments (position, normal and vertex colour interpolated, the normal renormalised). Positions come from
//! `ftransform`, so that depth and coverage are fixed function's own. This text is the driver's side of the comparison: it
//! shares nothing with `lighting`, whose answers it is to be held against.

use super::api::{self, Gl};
use super::state::rgba;
use crate::gl::{ColorControl, LightModel, LightSource, Material, SpecularModel};

/// Where the equation is evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stage {
    /// At vertices.
    Vertex,
    /// At fragments.
    Fragment,
}

/// Vectors of four that each light takes.
const VECTORS_PER_LIGHT: usize = 6;
/// Room for everything else, in components.
const OTHER_COMPONENTS: usize = 256;

/// How many lights fit into the driver's uniforms.
pub(super) fn light_limit(gl: &Gl) -> usize {
    let limits = [
        api::MAX_VERTEX_UNIFORM_COMPONENTS,
        api::MAX_FRAGMENT_UNIFORM_COMPONENTS,
    ];
    let least = limits.into_iter().map(|name| gl.integer(name)).min();
    let components = usize::try_from(least.unwrap_or(0)).unwrap_or(0);
    components.saturating_sub(OTHER_COMPONENTS) / (4 * VECTORS_PER_LIGHT)
}

/// A linked program, in use until it is dropped.
pub(super) struct Program<'a> {
    gl: &'a Gl,
    name: u32,
}

impl<'a> Program<'a> {
    /// Compiles, links and uses the equation for a model and lights in eye space.
    ///
    /// # Errors
    /// The driver's remarks.
    pub(super) fn new(
        gl: &'a Gl,
        stage: Stage,
        model: &LightModel,
        lights: &[LightSource],
        clamp: bool,
    ) -> Result<Self, String> {
        let program = Self {
            gl,
            name: gl.create_program(),
        };
        let head = definitions(model, lights.len(), clamp);
        match stage {
            Stage::Vertex => {
                program.add(api::VERTEX_SHADER, &[&head, EQUATION, AT_VERTICES])?;
            }
            Stage::Fragment => {
                program.add(api::VERTEX_SHADER, &["#version 120\n", PASS_ON])?;
                program.add(api::FRAGMENT_SHADER, &[&head, EQUATION, AT_FRAGMENTS])?;
            }
        }
        gl.link(program.name)
            .map_err(|log| format!("the driver cannot link the lighting program: {log}"))?;
        gl.use_program(program.name);
        program.set_lights(lights);
        program.set("scene_ambient", &[rgba(model.ambient, 1.0)]);
        Ok(program)
    }

    fn add(&self, kind: u32, parts: &[&str]) -> Result<(), String> {
        let shader = self.gl.create_shader(kind);
        let compiled = self.gl.compile(shader, &parts.concat());
        self.gl.attach_shader(self.name, shader);
        // A shader lives on as long as the program that it is attached to.
        self.gl.delete_shader(shader);
        compiled.map_err(|log| format!("the driver cannot compile the lighting equation: {log}"))
    }

    fn set(&self, name: &str, values: &[[f32; 4]]) {
        self.gl.uniform(self.name, name, values);
    }

    fn set_lights(&self, lights: &[LightSource]) {
        let each = |name: &str, f: &dyn Fn(&LightSource) -> [f32; 4]| {
            let values: Vec<[f32; 4]> = lights.iter().map(f).collect();
            self.set(name, &values);
        };
        each("light_position", &|s| s.position.map(|x| x as f32));
        each("light_ambient", &|s| rgba(s.ambient, 1.0));
        each("light_diffuse", &|s| rgba(s.diffuse, 1.0));
        each("light_specular", &|s| rgba(s.specular, 1.0));
        each("light_attenuation", &|s| {
            rgba(s.attenuation, s.spot_exponent)
        });
        each("light_cone", &|s| {
            // No cosine is below -1: 180 degrees light everything. Beyond 90 degrees a cone has no meaning in GL.
            let cosine = match s.spot_cutoff_deg {
                180.0 => -2.0,
                wide if wide >= 90.0 => 0.0,
                cutoff => libm::cos(cutoff.to_radians()),
            };
            rgba(s.spot_direction, cosine)
        });
    }

    /// The materials of front and back faces.
    pub(super) fn set_materials(&self, sides: [&Material; 2]) {
        let each = |name: &str, f: &dyn Fn(&Material) -> [f32; 4]| self.set(name, &sides.map(f));
        each("material_emission", &|m| rgba(m.emission, m.shininess));
        each("material_ambient", &|m| rgba(m.ambient, 1.0));
        each("material_diffuse", &|m| rgba(m.diffuse, m.alpha));
        each("material_specular", &|m| rgba(m.specular, 1.0));
        each("follows", &|m| {
            let tracked = m.tracked;
            [
                tracked.emission,
                tracked.ambient,
                tracked.diffuse,
                tracked.specular,
            ]
            .map(|on| f32::from(u8::from(on)))
        });
    }
}

impl Drop for Program<'_> {
    fn drop(&mut self) {
        self.gl.use_program(0);
        self.gl.delete_program(self.name);
    }
}

/// The head of a shader: what its text is compiled for.
fn definitions(model: &LightModel, lights: usize, clamp: bool) -> String {
    let flag = |on: bool| u8::from(on);
    format!(
        "#version 120\n#define LIGHTS {lights}\n#define SLOTS {}\n#define LOCAL_VIEWER {}\n#define TWO_SIDED {}\n\
         #define SEPARATE {}\n#define REFLECTION {}\n#define NORMALIZE {}\n#define CLAMP {}\n",
        lights.max(1),
        flag(model.local_viewer),
        flag(model.two_sided),
        flag(model.color_control == ColorControl::SeparateSpecular),
        flag(model.specular_model == SpecularModel::Reflection),
        flag(model.normalize),
        flag(clamp),
    )
}

/// The equation at one point. `unit_normal` is the direction of `normal`, whose length counts (GL_NORMALIZE off).
const EQUATION: &str = r"
uniform vec4 light_position[SLOTS];
uniform vec4 light_ambient[SLOTS];
uniform vec4 light_diffuse[SLOTS];
uniform vec4 light_specular[SLOTS];
uniform vec4 light_attenuation[SLOTS]; // k0, k1, k2, spot exponent
uniform vec4 light_cone[SLOTS];        // axis, cosine of the cutoff
uniform vec4 material_emission[2];     // w = shininess; [0] front, [1] back
uniform vec4 material_ambient[2];
uniform vec4 material_diffuse[2];
uniform vec4 material_specular[2];
uniform vec4 follows[2];               // emission, ambient, diffuse, specular: 1 = the vertex colour in its place
uniform vec4 scene_ambient;

vec3 unit(vec3 v) {
    float l = length(v);
    return l > 0.0 ? v / l : vec3(0.0);
}

// 0^0 = 1, as everywhere here.
float power(float base, float exponent) {
    if (exponent == 0.0) return 1.0;
    return base > 0.0 ? pow(base, exponent) : 0.0;
}

void equation(vec3 position, vec3 normal, vec3 unit_normal, vec3 color, int side, out vec4 primary, out vec3 secondary) {
    vec3 emission = follows[side].x > 0.5 ? color : material_emission[side].rgb;
    vec3 ambient = follows[side].y > 0.5 ? color : material_ambient[side].rgb;
    vec3 diffuse = follows[side].z > 0.5 ? color : material_diffuse[side].rgb;
    vec3 specular = follows[side].w > 0.5 ? color : material_specular[side].rgb;
    vec3 to_viewer = vec3(0.0, 0.0, 1.0);
#if LOCAL_VIEWER
    to_viewer = unit(-position);
#endif
    primary = vec4(emission + ambient * scene_ambient.rgb, material_diffuse[side].a);
    secondary = vec3(0.0);
    for (int i = 0; i < LIGHTS; ++i) {
        vec4 place = light_position[i];
        vec4 k = light_attenuation[i];
        vec3 toward = place.xyz;
        float factor = 1.0;
        if (place.w != 0.0) {
            toward = place.xyz / place.w - position;
            float d = length(toward);
            factor = 1.0 / (k.x + k.y * d + k.z * d * d);
        }
        vec3 to_light = unit(toward);
        if (light_cone[i].w > -1.5) {
            float q = dot(-to_light, unit(light_cone[i].xyz));
            factor *= q < 0.0 || q < light_cone[i].w ? 0.0 : power(q, k.w);
        }
        primary.rgb += factor * ambient * light_ambient[i].rgb;
        float n_dot_l = dot(normal, to_light);
        if (n_dot_l > 0.0) {
            primary.rgb += factor * n_dot_l * diffuse * light_diffuse[i].rgb;
#if REFLECTION
            float cosine = dot(to_viewer, 2.0 * dot(unit_normal, to_light) * unit_normal - to_light);
#else
            float cosine = dot(normal, unit(to_light + to_viewer));
#endif
            float peak = power(max(cosine, 0.0), material_emission[side].w);
            secondary += factor * peak * specular * light_specular[i].rgb;
        }
    }
#if !SEPARATE
    primary.rgb += secondary;
    secondary = vec3(0.0);
#endif
}
";

/// Per vertex: GL clamps, selects the side and interpolates, as behind fixed function.
const AT_VERTICES: &str = r"
void main() {
    vec3 normal = gl_Normal;
#if NORMALIZE
    normal = unit(normal);
#endif
    vec3 position = gl_Vertex.xyz / gl_Vertex.w;
    vec3 secondary;
    equation(position, normal, unit(normal), gl_Color.rgb, 0, gl_FrontColor, secondary);
    gl_FrontSecondaryColor = vec4(secondary, 0.0);
#if TWO_SIDED
    equation(position, -normal, unit(-normal), gl_Color.rgb, 1, gl_BackColor, secondary);
    gl_BackSecondaryColor = vec4(secondary, 0.0);
#endif
    gl_Position = ftransform();
}
";

/// Position, normal and vertex colour for the fragments, and as GL's colour whether GL takes the triangle for front or
/// back: `gl_FrontFacing` is always false in softpipe (Mesa 22.3.6), while fixed function's choice between the two colours
/// is right.
const PASS_ON: &str = r"
varying vec3 eye_position;
varying vec3 eye_normal;
varying vec3 vertex_color;
void main() {
    vertex_color = gl_Color.rgb;
    eye_position = gl_Vertex.xyz / gl_Vertex.w;
    eye_normal = gl_Normal;
    gl_FrontColor = vec4(1.0);
    gl_BackColor = vec4(0.0);
    gl_Position = ftransform();
}
";

/// Per fragment: the clamps stand here, since GL's own follow the sum.
const AT_FRAGMENTS: &str = r"
varying vec3 eye_position;
varying vec3 eye_normal;
varying vec3 vertex_color;
void main() {
    vec3 normal = unit(eye_normal);
    vec4 primary;
    vec3 secondary;
#if TWO_SIDED
    if (gl_Color.a < 0.5) {
        equation(eye_position, -normal, -normal, vertex_color, 1, primary, secondary);
    } else {
        equation(eye_position, normal, normal, vertex_color, 0, primary, secondary);
    }
#else
    equation(eye_position, normal, normal, vertex_color, 0, primary, secondary);
#endif
#if CLAMP
    primary = clamp(primary, 0.0, 1.0);
    secondary = clamp(secondary, 0.0, 1.0);
    primary.rgb = clamp(primary.rgb + secondary, 0.0, 1.0);
    secondary = vec3(0.0);
#endif
    gl_FragColor = vec4(primary.rgb + secondary, primary.a);
}
";
