//! What each cause of a difference means, in words and with its numbers.
//!
//! One table names the causes in ladder order; figures, page and messages read it. "Global" light here is what the
//! tracer adds: shadows, mirrors and refraction. Diffuse interreflection is not modelled by either renderer.

use super::numbers::{count, percent, value};
use super::summary::Cause;

/// A cause in words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Explanation {
    /// The name as in `summary.json`.
    pub name: &'static str,
    /// What the step changes, from one rung to the next.
    pub step: &'static str,
    /// Why that makes a difference, in plain language.
    pub text: &'static str,
}

/// All causes in ladder order.
pub const CAUSES: [Explanation; 9] = [
    Explanation {
        name: "quantization",
        step: "8-bit colours become floating-point numbers",
        text: "The rasterizer's frame buffer keeps 256 steps of each channel. Every value is rounded to the nearest \
               step, so this difference is at most half a step, 1/510.",
    },
    Explanation {
        name: "clamping",
        step: "vertex colours are no longer limited to 0…1",
        text: "OpenGL limits the colour of each vertex to 0…1 before it is interpolated. Where light adds up to more \
               than 1, the surplus is lost at the vertices, and the triangle between them comes out darker and flatter.",
    },
    Explanation {
        name: "interpolation",
        step: "lighting is evaluated at every fragment instead of every vertex",
        text: "Gouraud shading evaluates the equation at the vertices and blends the results. A highlight or a \
               spotlight's edge that falls between vertices is blurred, moved or missed.",
    },
    Explanation {
        name: "coverage",
        step: "primary rays replace scan conversion, on the same triangles",
        text: "The rasterizer snaps vertices to a sub-pixel grid and follows a fill rule; a ray goes through the \
               pixel's centre. They may choose differently only at edges. Everywhere else this step is rounding.",
    },
    Explanation {
        name: "tessellation",
        step: "the true shapes replace their triangles",
        text: "The rasterizer draws curved shapes as triangles. Their outlines are polygons and their surfaces lie \
               inside the true ones, by less the finer the mesh.",
    },
    Explanation {
        name: "shadow",
        step: "lights that are blocked stop shining",
        text: "Local lighting cannot know that another object stands between a point and a light. The tracer sends a \
               shadow ray to each light and drops its diffuse and specular terms where the ray is blocked.",
    },
    Explanation {
        name: "reflection",
        step: "mirrors show their surroundings",
        text: "A mirror's colour comes from elsewhere in the scene. The tracer follows the mirrored ray and adds what \
               it finds; the rasterizer shows the surface's own colour alone.",
    },
    Explanation {
        name: "refraction",
        step: "transparent bodies show what lies behind them",
        text: "The rasterizer draws a transparent surface as an opaque one. The tracer bends the ray by the ratio of \
               the indices of refraction, follows it, and adds what it finds.",
    },
    Explanation {
        name: "display",
        step: "the traced picture is limited to 0…1 and rounded to 8 bits",
        text: "A picture file holds 0…1 in 256 steps. What is brighter than 1 is cut off, and the rest is rounded: \
               the same that OpenGL does, once, at the end.",
    },
];

/// What must be said wherever light is called global.
pub const NOT_MODELLED: &str = "Diffuse interreflection, the light that matt surfaces pass on to each other, is not \
                                modelled: neither by OpenGL's lighting nor by Whitted's tracer.";

/// What must be said wherever shares are shown.
pub const ORDER: &str = "The causes stand in ladder order, each measured on top of the ones before it. Another order \
                         would give other shares: the order is part of the answer.";

/// The explanation of a cause by its name.
pub fn explanation(name: &str) -> Option<&'static Explanation> {
    CAUSES.iter().find(|c| c.name == name)
}

/// One sentence with the numbers of a cause, for a picture of `pixels` pixels.
///
/// ```
/// use rastray::report::causes::result;
/// use rastray::report::summary::Cause;
/// let cause = Cause { name: "shadow".into(), rmse: 0.0831, max: 0.61, pixels: 12345, sum: [0.0; 3] };
/// assert_eq!(result(&cause, 640 * 480), "shadow: 12,345 pixels (4.0 %) differ, at most by 0.61, rmse 0.0831.");
/// ```
pub fn result(cause: &Cause, pixels: usize) -> String {
    format!("{}: {}", cause.name, figures(cause, pixels))
}

/// The same sentence without the cause's name, for places whose heading says it.
pub fn figures(cause: &Cause, pixels: usize) -> String {
    let share = percent(cause.pixels, pixels);
    let (max, rmse) = (value(cause.max), value(cause.rmse));
    match cause.pixels {
        0 => "no difference.".to_owned(),
        1 => format!("1 pixel ({share}) differs, at most by {max}, rmse {rmse}."),
        n => format!(
            "{} pixels ({share}) differ, at most by {max}, rmse {rmse}.",
            count(n)
        ),
    }
}

/// What a terminal shows after a comparison: the whole difference, then a line for each cause that changes something.
///
/// ```
/// use rastray::report::causes::digest;
/// use rastray::report::summary::Cause;
/// let cause = |name: &str, rmse, pixels| Cause { name: name.into(), rmse, max: 0.61, pixels, sum: [0.0; 3] };
/// let text = digest(0.0831, &[cause("clamping", 0.0, 0), cause("shadow", 0.0831, 4)], 100);
/// assert_eq!(
///     text,
///     "trace minus raster: rmse 0.0831; cause by cause, in ladder order:\n  \
///      shadow          rmse 0.0831    max 0.61       4.0 % of pixels   lights that are blocked stop shining\n  \
///      no difference:  clamping"
/// );
/// ```
pub fn digest(rmse: f64, causes: &[Cause], pixels: usize) -> String {
    let mut text = format!(
        "trace minus raster: rmse {}; cause by cause, in ladder order:",
        value(rmse)
    );
    for cause in causes.iter().filter(|c| c.pixels > 0) {
        let (name, step) = (&cause.name, explanation(&cause.name).map_or("", |e| e.step));
        let (rmse, max) = (value(cause.rmse), value(cause.max));
        let share = format!("{} of pixels", percent(cause.pixels, pixels));
        text += &format!("\n  {name:14}  rmse {rmse:9} max {max:9} {share:>16}   {step}");
    }
    let none: Vec<_> = causes.iter().filter(|c| c.pixels == 0).collect();
    if !none.is_empty() {
        let names: Vec<_> = none.iter().map(|c| c.name.as_str()).collect();
        text += &format!("\n  no difference:  {}", names.join(", "));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_the_ladder() {
        let names = CAUSES.map(|c| c.name);
        assert_eq!(
            names,
            [
                "quantization",
                "clamping",
                "interpolation",
                "coverage",
                "tessellation",
                "shadow",
                "reflection",
                "refraction",
                "display"
            ]
        );
        assert!(names.iter().all(|n| explanation(n).is_some()));
        assert_eq!(explanation("flip"), None);
    }

    #[test]
    fn results_say_none_one_and_many() {
        let mut cause = Cause {
            name: "display".into(),
            rmse: 0.0,
            max: 0.0,
            pixels: 0,
            sum: [0.0; 3],
        };
        assert_eq!(result(&cause, 100), "display: no difference.");
        (cause.pixels, cause.max, cause.rmse) = (1, 0.25, 0.0144);
        let one = "display: 1 pixel (1.0 %) differs, at most by 0.25, rmse 0.0144.";
        assert_eq!(result(&cause, 100), one);
    }
}
