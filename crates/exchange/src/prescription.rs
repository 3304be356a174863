//! The prescription of a lens: what all programs mean by a lens, in millimeters and degrees.

/// A lens as a file states it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Prescription {
    /// Name of the lens; empty if the file states none.
    pub name: String,
    /// Maker, if known.
    pub maker: Option<String>,
    /// Patent and example, if known.
    pub patent: Option<String>,
    /// Year of design, if known.
    pub year: Option<i32>,
    /// Spectral line of the stated indices; `None` for the d line.
    pub reference_line: Option<String>,
    /// Surfaces and coordinate breaks, in the order in which light meets them, without the object and the image.
    pub items: Vec<AxisItem>,
    /// Wavelengths listed in the file.
    pub wavelengths: Vec<Wavelength>,
    /// Index of the primary wavelength in `wavelengths`.
    pub primary: Option<usize>,
    /// Field points listed in the file.
    pub fields: Option<Fields>,
    /// Quantity that sets the size of the beam in the file.
    pub system_aperture: Option<SystemAperture>,
    /// Distance of the object in front of the first surface, mm; `None` is infinity.
    pub object_distance_mm: Option<f64>,
    /// Origin of the clear sizes, as written in a lens file: `stated`, `computed`, `guessed`, or `fitted to` with what was
    /// measured.
    pub rims: Option<String>,
    /// Whether the size of the stop was computed from the beam of the file, instead of being stated in the file.
    pub stop_is_computed: bool,
    /// Further remarks on the file.
    pub remarks: Vec<String>,
    /// Notes on everything that could not be carried over.
    pub left_out: Vec<Note>,
}

/// A note about something that could not be carried over.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// Line of the file, from 1; 0 if no line applies.
    pub line: usize,
    /// Description of what was left out, in one line.
    pub text: String,
    /// Whether rays run differently without it than in the program that wrote the file.
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

/// One step along the axis of a lens.
#[derive(Clone, Debug, PartialEq)]
pub enum AxisItem {
    /// A surface of the lens.
    Surface(Box<Surface>),
    /// A coordinate break, which moves the axis for everything that follows.
    Break(CoordinateBreak),
}

impl AxisItem {
    /// Distance to the next item along the z axis behind this item, mm.
    #[must_use]
    pub fn thickness_mm(&self) -> f64 {
        match self {
            Self::Surface(surface) => surface.thickness_mm,
            Self::Break(axis) => axis.thickness_mm,
        }
    }

    /// Mutable reference to the distance to the next item, mm.
    pub(crate) fn thickness_mm_mut(&mut self) -> &mut f64 {
        match self {
            Self::Surface(surface) => &mut surface.thickness_mm,
            Self::Break(axis) => &mut axis.thickness_mm,
        }
    }
}

/// A coordinate break: a shift and a rotation of the axis for all items that follow.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CoordinateBreak {
    /// Shift and rotation of the axis.
    pub by: Displacement,
    /// Order of shift and rotations. If true, rotations about z, y and x (in that order) come before the shift; if false, the
    /// shift comes first, then rotations about x, y and z.
    pub tilt_first: bool,
    /// Distance to the next item along the new z axis, mm.
    pub thickness_mm: f64,
}

/// A shift and a rotation. Right-handed: a positive tilt about x turns y toward z.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Displacement {
    /// Shift along x and y, mm.
    pub decenter_mm: [f64; 2],
    /// Rotation about x, then about the new y, then about the new z, degrees.
    pub tilt_deg: [f64; 3],
}

impl Displacement {
    /// Returns whether shift and rotation are both zero.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.decenter_mm == [0.0; 2] && self.tilt_deg == [0.0; 3]
    }
}

/// A surface with its position, medium and apertures.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// Shape of the surface.
    pub shape: SurfaceShape,
    /// Distance to the next vertex, mm; for the last surface, to the image plane.
    pub thickness_mm: f64,
    /// Medium behind the surface. For a mirror it is ignored, because the medium in front continues.
    pub medium: Medium,
    /// Whether the surface reflects.
    pub mirror: bool,
    /// Whether the surface is the aperture stop; also true for [`SurfaceShape::Stop`].
    pub stop: bool,
    /// Clear semi-diameter beyond which light is blocked, mm; `None` if no light is blocked.
    pub semi_diameter_mm: Option<f64>,
    /// Semi-diameter of the element's edge for drawings, mm; it does not block light.
    pub outer_semi_diameter_mm: Option<f64>,
    /// Further apertures that limit the light at this surface.
    pub apertures: Vec<Aperture>,
    /// Displacement of this surface alone; the surfaces that follow stay where they are.
    pub displacement: Displacement,
    /// Comment of the file on this surface; may be empty.
    pub comment: String,
}

/// Shape of a surface. Lengths are in mm, coefficients in mm^(1-power). A radius is positive if its center lies at larger z.
#[derive(Clone, Debug, Default, PartialEq)]
#[allow(missing_docs, reason = "the fields are those of the kinds of the same names in a lens file")]
pub enum SurfaceShape {
    /// A flat surface.
    #[default]
    Plane,
    /// An aperture stop without optical power.
    Stop,
    Sphere {
        radius: f64,
    },
    /// A conic section of revolution; an infinite radius is a plane.
    Conic {
        radius: f64,
        conic: f64,
    },
    /// A conic with terms of even powers; coefficients of r^2, r^4, ...
    EvenAsphere {
        radius: f64,
        conic: f64,
        coefficients: Vec<f64>,
    },
    /// A conic with terms of all powers; coefficients of r, r^2, r^3, ...
    OddAsphere {
        radius: f64,
        conic: f64,
        coefficients: Vec<f64>,
    },
    /// A cylinder whose straight lines run along x (`along_x`) or along y.
    Cylinder {
        radius: f64,
        along_x: bool,
    },
    /// A curve z(y) with terms y^2, y^4, ..., rotated about a line parallel to y at the distance `rotation_radius`.
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
    /// A tilted plane given by the tangents of its angles in x-z and y-z: z = x tan_x + y tan_y.
    TiltedPlane {
        tan_x: f64,
        tan_y: f64,
    },
    ThinLens {
        focal_length: f64,
    },
    /// A grating whose lines are perpendicular to the direction `direction_deg`, measured from +y.
    Grating {
        lines_per_mm: f64,
        order: f64,
        radius: f64,
        conic: f64,
        direction_deg: f64,
    },
    /// A conic with Zernike terms; coefficients in mm of sag, the first one being piston.
    Zernike {
        radius: f64,
        conic: f64,
        normalization_radius: f64,
        coefficients: Vec<f64>,
        ordering: ZernikeOrdering,
    },
    /// A kind of surface of this program that no other program has.
    Other {
        kind: String,
    },
}

impl SurfaceShape {
    /// Returns a plane, a sphere or a conic, whichever is the simplest. `radius` is in mm; infinity means a plane.
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

/// Ordering and normalization of Zernike terms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ZernikeOrdering {
    /// Noll's ordering, in which terms are orthonormal.
    Noll,
    /// Fringe ordering (University of Arizona), in which terms have amplitude 1 at the edge.
    Fringe,
}

/// The medium behind a surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Medium {
    /// Air, with the index 1.
    #[default]
    Air,
    /// A glass of the catalog by its full name, with the figures that the file states for it.
    Glass {
        /// Full name, such as `SCHOTT/N-BK7`.
        name: String,
        /// Index at the d line, if the file states one that is compatible with the glass.
        nd: Option<f64>,
        /// Abbe number, if the file states one that is compatible with the glass.
        vd: Option<f64>,
    },
    /// A glass that is defined by figures alone.
    Model {
        /// Index at the d line.
        nd: f64,
        /// Abbe number; `None` means no dispersion.
        vd: Option<f64>,
        /// Index at the g line, if the dispersion is known better than by the Abbe number.
        ng: Option<f64>,
    },
    /// A glass name that no catalog has and for which the file states no figures; the user must define it.
    Unknown {
        /// Name as written in the file.
        name: String,
    },
}

/// An aperture that limits the light at a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Aperture {
    /// Outline of the aperture.
    pub shape: ApertureShape,
    /// Center of the aperture, mm.
    pub center_mm: [f64; 2],
    /// Whether the aperture blocks light inside its outline instead of outside.
    pub obscures: bool,
}

/// Outline of an aperture, mm.
#[derive(Clone, Debug, PartialEq)]
pub enum ApertureShape {
    /// A ring between two radii.
    Ring {
        /// Inner radius.
        inner: f64,
        /// Outer radius.
        outer: f64,
    },
    /// A rectangle with sides parallel to x and y.
    Rectangle {
        /// Half of the width along x.
        half_width: f64,
        /// Half of the height along y.
        half_height: f64,
    },
    /// An ellipse with axes parallel to x and y.
    Ellipse {
        /// Semi-axis along x.
        half_width: f64,
        /// Semi-axis along y.
        half_height: f64,
    },
    /// A polygon with its corners in order.
    Polygon {
        /// Corners, mm.
        points: Vec<[f64; 2]>,
    },
    /// An aperture of this program's own lens files that other programs do not have.
    Other {
        /// Name of the aperture's shape.
        name: String,
    },
}

/// A wavelength listed in a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wavelength {
    /// Wavelength, nm.
    pub nm: f64,
    /// Relative weight.
    pub weight: f64,
}

/// Field points listed in a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Fields {
    /// Meaning of the points' coordinates.
    pub kind: FieldKind,
    /// Coordinates (x, y) of each point, in degrees or mm as `kind` says.
    pub points: Vec<[f64; 2]>,
}

/// Meaning of field coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldKind {
    /// Field angles, degrees.
    Angle,
    /// Height in object space, mm.
    ObjectHeight,
    /// Height of the paraxial image, mm.
    ParaxialImageHeight,
    /// Height of the real image, mm.
    RealImageHeight,
}

/// The quantity that sets the size of the beam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SystemAperture {
    /// Diameter of the entrance pupil, mm.
    EntrancePupilDiameter(f64),
    /// Image-space f-number.
    FNumber(f64),
    /// Numerical aperture in object space.
    ObjectNumericalAperture(f64),
    /// Numerical aperture in image space.
    ImageNumericalAperture(f64),
    /// Size of the stop, as stated at the surface of the stop.
    StopSize,
}

impl Prescription {
    /// Adds a note about something that could not be carried over.
    pub(crate) fn leave_out(&mut self, line: usize, alters: bool, text: impl Into<String>) {
        self.left_out.push(Note { line, text: text.into(), alters });
    }

    /// Iterates over the surfaces, without coordinate breaks.
    pub fn surfaces(&self) -> impl Iterator<Item = &Surface> {
        self.items.iter().filter_map(|item| match item {
            AxisItem::Surface(surface) => Some(&**surface),
            AxisItem::Break(_) => None,
        })
    }
}
