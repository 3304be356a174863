//! What all programs mean by a lens, in millimeters and degrees.

/// A lens as a file states it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Prescription {
    /// Name for people; may be empty.
    pub name: String,
    /// Maker, where known.
    pub maker: Option<String>,
    /// Patent and example, where known.
    pub patent: Option<String>,
    /// Year of design, where known.
    pub year: Option<i32>,
    /// Spectral line of stated indices, where it is not d.
    pub reference_line: Option<String>,
    /// Surfaces and coordinate breaks, in the order of the light. The object and the image are none of them.
    pub items: Vec<Item>,
    /// Wavelengths that the file asks for.
    pub wavelengths: Vec<Wavelength>,
    /// Which of them is the primary one.
    pub primary: Option<usize>,
    /// Fields that the file asks for.
    pub fields: Option<Fields>,
    /// What sets the size of the beam in the file.
    pub system_aperture: Option<SystemAperture>,
    /// Distance of the object in front of the first surface, mm; `None` is infinity.
    pub object_distance_mm: Option<f64>,
    /// Where the sizes that clip come from, as a lens file of ours says it: `stated`, `computed`, `guessed`, or `fitted to ...`.
    pub rims: Option<String>,
    /// Whether the size of the stop is that of the beam that the file asks for, and not a figure of its own.
    pub stop_is_computed: bool,
    /// What else is worth telling of the file.
    pub remarks: Vec<String>,
    /// What could not be carried.
    pub left_out: Vec<Note>,
}

/// Something that could not be carried.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// Line of the file, from 1; 0 where there is no line.
    pub line: usize,
    /// What it is, one line.
    pub text: String,
    /// Whether light goes another way without it than in the program that wrote the file.
    pub alters: bool,
}

impl std::fmt::Display for Note {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.line > 0 {
            write!(f, "line {}: ", self.line)?;
        }
        f.write_str(&self.text)
    }
}

/// One step along the axis.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// A surface.
    Surface(Box<Surface>),
    /// The axis moves for everything that follows.
    Break(CoordinateBreak),
}

impl Item {
    /// Distance to the next item along the (new) z axis, mm.
    #[must_use]
    pub fn thickness_mm(&self) -> f64 {
        match self {
            Self::Surface(surface) => surface.thickness_mm,
            Self::Break(axis) => axis.thickness_mm,
        }
    }

    /// The same, to be changed.
    pub(crate) fn thickness_mm_mut(&mut self) -> &mut f64 {
        match self {
            Self::Surface(surface) => &mut surface.thickness_mm,
            Self::Break(axis) => &mut axis.thickness_mm,
        }
    }
}

/// A move of the axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CoordinateBreak {
    /// Where to and by which angles.
    pub by: Displacement,
    /// Rotate about z, y, x in that order, then shift; instead of shift, then rotate about x, y, z.
    pub tilt_first: bool,
    /// Distance to the next item along the new z axis, mm.
    pub thickness_mm: f64,
}

/// A shift and a rotation. Right-handed: a positive tilt about x turns y toward z.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Displacement {
    /// Shift along x and y, mm.
    pub decenter_mm: [f64; 2],
    /// Rotation about x, then the new y, then the new z, degrees.
    pub tilt_deg: [f64; 3],
}

impl Displacement {
    /// Whether nothing is displaced.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.decenter_mm == [0.0; 2] && self.tilt_deg == [0.0; 3]
    }
}

/// A surface in its place.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// Its form.
    pub shape: Shape,
    /// Distance to the next vertex, mm; of the last surface, to the image plane.
    pub thickness_mm: f64,
    /// Medium behind it; of a mirror, the one in front goes on whatever this says.
    pub medium: Medium,
    /// Whether it reflects.
    pub mirror: bool,
    /// Whether it is the aperture stop (also of [`Shape::Stop`]).
    pub stop: bool,
    /// Radius outside of which light is stopped, mm.
    pub semi_diameter_mm: Option<f64>,
    /// Edge of the element for drawing, mm; stops nothing.
    pub outer_semi_diameter_mm: Option<f64>,
    /// What light must pass besides.
    pub apertures: Vec<Aperture>,
    /// Displacement of this surface alone, followers are not moved.
    pub displacement: Displacement,
    /// What the file says of it in words; may be empty.
    pub comment: String,
}

/// Form of a surface; lengths in mm, coefficients in mm^(1-power). A radius is positive where its center lies at larger z.
#[derive(Clone, Debug, Default, PartialEq)]
#[allow(missing_docs, reason = "the fields are those of the kinds of the same names in a lens file")]
pub enum Shape {
    /// Flat.
    #[default]
    Plane,
    /// An aperture stop that bends nothing.
    Stop,
    Sphere {
        radius: f64,
    },
    /// Infinite radius is a plane.
    Conic {
        radius: f64,
        conic: f64,
    },
    /// Coefficients of r^2, r^4, ...
    EvenAsphere {
        radius: f64,
        conic: f64,
        coefficients: Vec<f64>,
    },
    /// Coefficients of r, r^2, r^3, ...
    OddAsphere {
        radius: f64,
        conic: f64,
        coefficients: Vec<f64>,
    },
    /// The straight lines run along x (`along_x`) or along y.
    Cylinder {
        radius: f64,
        along_x: bool,
    },
    /// Curve z(y) with terms y^2, y^4, ..., turned about a line parallel to y at `rotation_radius`.
    Toroid {
        radius: f64,
        conic: f64,
        coefficients: Vec<f64>,
        rotation_radius: f64,
    },
    Biconic {
        radius_x: f64,
        radius_y: f64,
        conic_x: f64,
        conic_y: f64,
    },
    /// Tangents of the angles in x-z and y-z: z = x tan_x + y tan_y.
    TiltedPlane {
        tan_x: f64,
        tan_y: f64,
    },
    ThinLens {
        focal_length: f64,
    },
    /// Lines perpendicular to the direction `direction_deg` from +y.
    Grating {
        lines_per_mm: f64,
        order: f64,
        radius: f64,
        conic: f64,
        direction_deg: f64,
    },
    /// Coefficients in mm of sag, the first one is piston.
    Zernike {
        radius: f64,
        conic: f64,
        normalization_radius: f64,
        coefficients: Vec<f64>,
        ordering: Ordering,
    },
    /// A kind of our own that no other program knows.
    Other {
        kind: String,
    },
}

impl Shape {
    /// A sphere, a conic or a plane, whichever is the simplest; a curvature of 0 or an infinite radius is a plane.
    #[must_use]
    pub fn conic(radius: f64, conic: f64) -> Self {
        if radius.is_infinite() {
            Self::Plane
        } else if conic == 0.0 {
            Self::Sphere { radius }
        } else {
            Self::Conic { radius, conic }
        }
    }
}

/// Order of Zernike terms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ordering {
    /// Noll's, orthonormal.
    Noll,
    /// Fringe (University of Arizona), amplitude 1 at the edge.
    Fringe,
}

/// A medium behind a surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Medium {
    /// Air.
    #[default]
    Air,
    /// A glass of our catalogue by its full name, with the figures that the file states beside it.
    Glass {
        /// `SCHOTT/N-BK7`.
        name: String,
        /// Index at d, where the file states one that fits.
        nd: Option<f64>,
        /// Abbe number, where the file states one that fits.
        vd: Option<f64>,
    },
    /// A glass of which figures are known only.
    Model {
        /// Index at d.
        nd: f64,
        /// Abbe number; without one there is no dispersion.
        vd: Option<f64>,
        /// Index at g, where more is known of its dispersion.
        ng: Option<f64>,
    },
    /// A name that no catalogue has, without figures: a person must say what it is.
    Unknown {
        /// As the file has it.
        name: String,
    },
}

/// Something that light must pass.
#[derive(Clone, Debug, PartialEq)]
pub struct Aperture {
    /// Its outline.
    pub shape: ApertureShape,
    /// Its center, mm.
    pub center_mm: [f64; 2],
    /// Blocks inside instead of outside.
    pub obscures: bool,
}

/// Outline of an aperture, mm.
#[derive(Clone, Debug, PartialEq)]
pub enum ApertureShape {
    /// Between two radii.
    Ring {
        /// Inner radius.
        inner: f64,
        /// Outer radius.
        outer: f64,
    },
    /// Sides parallel to x and y.
    Rectangle {
        /// Half of its width along x.
        half_width: f64,
        /// Half of its height along y.
        half_height: f64,
    },
    /// Axes parallel to x and y.
    Ellipse {
        /// Half axis along x.
        half_width: f64,
        /// Half axis along y.
        half_height: f64,
    },
    /// Corners in order.
    Polygon {
        /// Corners.
        points: Vec<[f64; 2]>,
    },
    /// One of ours that no other program knows.
    Other {
        /// Its name.
        name: String,
    },
}

/// A wavelength that a file asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wavelength {
    /// nm.
    pub nm: f64,
    /// Relative weight.
    pub weight: f64,
}

/// Points of the field that a file asks for.
#[derive(Clone, Debug, PartialEq)]
pub struct Fields {
    /// What the numbers are.
    pub kind: FieldKind,
    /// (x, y) each: degrees or mm.
    pub points: Vec<[f64; 2]>,
}

/// What field numbers are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldKind {
    /// Degrees.
    Angle,
    /// Height in object space, mm.
    ObjectHeight,
    /// Height of the paraxial image, mm.
    ParaxialImageHeight,
    /// Height of the real image, mm.
    RealImageHeight,
}

/// What sets the size of the beam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SystemAperture {
    /// Diameter of the entrance pupil, mm.
    EntrancePupilDiameter(f64),
    /// Image space f-number.
    FNumber(f64),
    /// Numerical aperture in object space.
    ObjectNumericalAperture(f64),
    /// Numerical aperture in image space.
    ImageNumericalAperture(f64),
    /// The size of the stop.
    StopSize,
}

impl Prescription {
    /// Notes something that could not be carried.
    pub(crate) fn leave_out(&mut self, line: usize, alters: bool, text: impl Into<String>) {
        self.left_out.push(Note { line, text: text.into(), alters });
    }

    /// Surfaces alone.
    pub fn surfaces(&self) -> impl Iterator<Item = &Surface> {
        self.items.iter().filter_map(|item| match item {
            Item::Surface(surface) => Some(&**surface),
            Item::Break(_) => None,
        })
    }
}
