//! Colour material: which terms of a material the vertex colours stand for (GL 2.1 section 2.14.3).
//!
//! In GL this is one switch of the light model, one face and one mode; while it is on, the current colour overwrites the
//! tracked terms before lighting. Here it is resolved per material and side ([`Material::tracked`]), so that one scene can
//! hold objects drawn with and without it.

use super::Material;

/// A side of polygons, as glMaterial and glColorMaterial name it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Face {
    /// GL_FRONT.
    Front,
    /// GL_BACK.
    Back,
    /// GL_FRONT_AND_BACK (the default).
    #[default]
    FrontAndBack,
}

impl Face {
    /// The one table of names: command line, scene file and reports.
    pub const NAMES: &[(&'static str, Self)] = &[
        ("front", Self::Front),
        ("back", Self::Back),
        ("front_and_back", Self::FrontAndBack),
    ];

    /// Whether the name includes a side.
    pub fn includes(self, back: bool) -> bool {
        match self {
            Self::Front => !back,
            Self::Back => back,
            Self::FrontAndBack => true,
        }
    }
}

/// Which terms follow the current colour (GL 2.1 section 2.14.3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorMaterialMode {
    /// GL_EMISSION.
    Emission,
    /// GL_AMBIENT.
    Ambient,
    /// GL_DIFFUSE, its alpha included.
    Diffuse,
    /// GL_SPECULAR.
    Specular,
    /// GL_AMBIENT_AND_DIFFUSE (the default).
    #[default]
    AmbientAndDiffuse,
}

impl ColorMaterialMode {
    /// The one table of names: command line, scene file and reports.
    pub const NAMES: &[(&'static str, Self)] = &[
        ("emission", Self::Emission),
        ("ambient", Self::Ambient),
        ("diffuse", Self::Diffuse),
        ("specular", Self::Specular),
        ("ambient_and_diffuse", Self::AmbientAndDiffuse),
    ];
}

/// What glColorMaterial sets. Enabled or not is the holder's affair.
///
/// ```
/// use rastray::gl::{ColorMaterial, ColorMaterialMode, Face};
/// let setting = ColorMaterial { face: Face::Front, mode: ColorMaterialMode::Diffuse };
/// assert!(setting.tracked(false).diffuse && !setting.tracked(false).ambient);
/// assert!(!setting.tracked(true).any());
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ColorMaterial {
    /// The sides that follow.
    pub face: Face,
    /// The terms that follow.
    pub mode: ColorMaterialMode,
}

impl ColorMaterial {
    /// The terms of one side that follow the vertex colour.
    pub fn tracked(self, back: bool) -> Tracked {
        use ColorMaterialMode::{Ambient, AmbientAndDiffuse, Diffuse, Emission, Specular};
        let on =
            |modes: &[ColorMaterialMode]| self.face.includes(back) && modes.contains(&self.mode);
        Tracked {
            emission: on(&[Emission]),
            ambient: on(&[Ambient, AmbientAndDiffuse]),
            diffuse: on(&[Diffuse, AmbientAndDiffuse]),
            specular: on(&[Specular]),
        }
    }

    /// The setting under which front and back follow with these terms; `None` where no face and mode of GL does that.
    ///
    /// ```
    /// use rastray::gl::{ColorMaterial, ColorMaterialMode, Face, Tracked};
    /// let setting = ColorMaterial { face: Face::Back, mode: ColorMaterialMode::Specular };
    /// assert_eq!(ColorMaterial::of([setting.tracked(false), setting.tracked(true)]), Some(setting));
    /// let both = Tracked { emission: true, specular: true, ..Tracked::default() };
    /// assert_eq!(ColorMaterial::of([both, both]), None);
    /// ```
    pub fn of(sides: [Tracked; 2]) -> Option<Self> {
        let modes = |face| {
            let modes = ColorMaterialMode::NAMES.iter();
            modes.map(move |&(_, mode)| Self { face, mode })
        };
        let mut settings = Face::NAMES.iter().flat_map(|&(_, face)| modes(face));
        settings.find(|setting| [false, true].map(|back| setting.tracked(back)) == sides)
    }
}

/// The terms of a material that the vertex colour overwrites; none by default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tracked {
    /// Emission is the vertex colour.
    pub emission: bool,
    /// Ambient is.
    pub ambient: bool,
    /// Diffuse and alpha are.
    pub diffuse: bool,
    /// Specular is.
    pub specular: bool,
}

impl Tracked {
    /// Whether any term follows.
    pub fn any(self) -> bool {
        self.emission || self.ambient || self.diffuse || self.specular
    }
}

/// The current colour of vertices that state none (GL 2.1 table 2.10).
pub const CURRENT_COLOR: [f64; 4] = [1.0; 4];

impl Material {
    /// The material that a vertex of this colour is lit with: tracked terms overwritten, none tracked any more.
    ///
    /// ```
    /// use rastray::gl::{ColorMaterial, Material};
    /// let material = Material { tracked: ColorMaterial::default().tracked(false), ..Material::default() };
    /// let red = material.with_color([1.0, 0.0, 0.0, 0.5]);
    /// assert_eq!((red.ambient, red.diffuse, red.alpha), ([1.0, 0.0, 0.0], [1.0, 0.0, 0.0], 0.5));
    /// assert_eq!(red.specular, material.specular);
    /// ```
    #[must_use]
    pub fn with_color(&self, color: [f64; 4]) -> Self {
        let [r, g, b, a] = color;
        let mut material = self.clone();
        let Tracked {
            emission,
            ambient,
            diffuse,
            specular,
        } = std::mem::take(&mut material.tracked);
        if emission {
            material.emission = [r, g, b];
        }
        if ambient {
            material.ambient = [r, g, b];
        }
        if diffuse {
            (material.diffuse, material.alpha) = ([r, g, b], a);
        }
        if specular {
            material.specular = [r, g, b];
        }
        material
    }
}
