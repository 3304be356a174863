//! The window: the plane through which the rays of one point are aimed at a lens.

use glam::DVec3;
use spectra_lens::Lens;
use spectra_lens::Section;

/// A point that light comes from, in the frame of the lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ObjectPoint {
    /// A point at a finite distance, mm.
    At(DVec3),
    /// A point at infinity, given by the unit direction in which its light runs.
    Toward(DVec3),
}

impl ObjectPoint {
    /// Returns the point at a field angle on the plane `object_mm` in front of the first vertex (infinity allowed). `field_rad`
    /// is positive if the light runs toward +y. It is measured at the paraxial entrance pupil, or at the first vertex if there is
    /// no pupil at a finite distance. At a finite distance it must be below 90 degrees.
    #[must_use]
    pub fn on_plane(lens: &Lens, object_mm: f64, field_rad: f64) -> Self {
        let (sin, cos) = (spectra_core::math::sin(field_rad), spectra_core::math::cos(field_rad));
        if object_mm == f64::INFINITY {
            return Self::Toward(DVec3::new(0.0, sin, cos));
        }
        let eye_mm = eye_z_mm(lens);
        Self::At(DVec3::new(0.0, -(object_mm + eye_mm) * sin / cos, -object_mm))
    }

    /// Returns the point at a field angle of any size (rad) on a sphere about the paraxial entrance pupil. The sphere meets the
    /// axis `object_mm` in front of the first vertex (infinity allowed).
    #[must_use]
    pub fn on_sphere(lens: &Lens, object_mm: f64, field_rad: f64) -> Self {
        let direction = DVec3::new(0.0, spectra_core::math::sin(field_rad), spectra_core::math::cos(field_rad));
        if object_mm == f64::INFINITY {
            return Self::Toward(direction);
        }
        let eye_mm = eye_z_mm(lens);
        Self::At(DVec3::new(0.0, 0.0, eye_mm) - (object_mm + eye_mm) * direction)
    }

    /// Rotates a point of the y-z section about the axis of the lens into `section`.
    #[must_use]
    pub fn in_section(self, section: Section) -> Self {
        let turned = |p: DVec3| match section {
            Section::Y => p,
            Section::X => DVec3::new(p.y, -p.x, p.z),
        };
        match self {
            Self::At(point) => Self::At(turned(point)),
            Self::Toward(direction) => Self::Toward(turned(direction)),
        }
    }
}

/// Returns z of the paraxial entrance pupil, mm; 0, the first vertex, if the pupil lies at infinity or does not exist.
fn eye_z_mm(lens: &Lens) -> f64 {
    let pupil = lens.first_order(lens.reference_nm).entrance_pupil_z_mm;
    pupil.filter(|z| z.is_finite()).unwrap_or(0.0)
}

/// Returns a radius within which light enters a lens whose first surface states no size, mm. It is four times the largest stated size
/// (usually the stop's), plus room for a pupil behind that surface.
fn far_enough_mm(lens: &Lens) -> f64 {
    let sized = lens.largest_semi_diameter_mm().map_or(0.0, |size| 4.0 * size);
    let far = sized + eye_z_mm(lens).abs();
    if far > 0.0 { far } else { 0.5 * lens.first_order(lens.reference_nm).efl_mm.abs().min(1e6) }
}

/// Factor by which a window is larger than the ball around the surface that light meets first.
const ROOM: f64 = 1.02;
/// Smallest distance of a ball from its point, in radii. A nearer ball is treated as if it were this far away.
const NEAREST: f64 = 1.05;

/// A plane across the line from a point to the lens. Each ray of the point is identified by where it crosses the plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Window {
    point: ObjectPoint,
    /// Middle of the cap of the surface that light meets first, mm.
    middle: DVec3,
    across: [DVec3; 2],
    /// Half the side of the square that contains every ray to that surface, mm.
    pub reach_mm: f64,
}

impl Window {
    /// Returns the window in front of a lens for an object point, in the frame of the lens; `None` if no light runs from there to the
    /// lens.
    pub fn before(lens: &Lens, point: ObjectPoint) -> Option<Self> {
        let first = lens.elements.first()?;
        let radius_mm = first.semi_diameter_mm.unwrap_or_else(|| far_enough_mm(lens));
        let sag_mm = first.semi_diameter_mm.and_then(|r| first.surface.sag_mm(r, 0.0)).unwrap_or(0.0);
        let sag_mm = if first.reversed { -sag_mm } else { sag_mm };
        let middle = first.pose.origin_mm + DVec3::new(0.0, 0.0, 0.5 * sag_mm);
        Self::around(point, middle, radius_mm, sag_mm)
    }

    /// Returns the window behind a lens for an image point (mm, frame of the image plane).
    pub fn behind(lens: &Lens, point_mm: DVec3) -> Option<Self> {
        let last = lens.elements.last()?;
        let radius_mm = last.semi_diameter_mm.unwrap_or_else(|| far_enough_mm(lens));
        let sag_mm = last.semi_diameter_mm.and_then(|r| last.surface.sag_mm(r, 0.0)).unwrap_or(0.0);
        let pose = lens.image_pose.inverse().then(&last.pose);
        Self::around(ObjectPoint::At(point_mm), pose.point(DVec3::new(0.0, 0.0, 0.5 * sag_mm)), radius_mm, sag_mm)
    }

    /// Returns the window toward the ball about `middle` that contains the cap of a surface.
    fn around(point: ObjectPoint, middle: DVec3, radius_mm: f64, sag_mm: f64) -> Option<Self> {
        let ball_mm = (radius_mm * radius_mm + 0.25 * sag_mm * sag_mm).sqrt();
        let (along, room) = match point {
            ObjectPoint::At(p) => {
                // Seen from close by, the outline of the ball is wider than the ball.
                let sine = ball_mm / (middle - p).length().max(NEAREST * ball_mm);
                ((middle - p).try_normalize()?, ROOM.max(1.001 / (1.0 - sine * sine).sqrt()))
            }
            ObjectPoint::Toward(d) => (d, ROOM),
        };
        let x = if along.x.abs() < 0.9 { DVec3::X } else { DVec3::Z };
        let right = (x - x.dot(along) * along).normalize();
        Some(Self { point, middle, across: [right, along.cross(right)], reach_mm: ball_mm * room })
    }

    /// Returns the square of the window that contains every ray to the lens.
    pub fn whole(&self) -> Extent {
        Extent { min: [-self.reach_mm; 2], max: [self.reach_mm; 2] }
    }

    /// Returns the ray through a point of the window (mm): its start in front of the lens (mm) and its unit direction.
    pub fn ray(&self, [a, b]: [f64; 2]) -> (DVec3, DVec3) {
        let through = self.middle + a * self.across[0] + b * self.across[1];
        match self.point {
            ObjectPoint::Toward(d) => (through - 2.0 * self.reach_mm * d, d),
            ObjectPoint::At(p) => (p, (through - p).normalize()),
        }
    }

    /// Returns the solid angle (for a point at infinity: the area) of a cell at this position, relative to an equal cell in the middle.
    pub fn share(&self, [a, b]: [f64; 2]) -> f64 {
        match self.point {
            ObjectPoint::Toward(_) => 1.0,
            ObjectPoint::At(p) => {
                let far2 = (self.middle - p).length_squared();
                let cos2 = far2 / (far2 + a * a + b * b);
                cos2 * cos2.sqrt()
            }
        }
    }
}

/// A rectangle in a window, in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// Corner with the smallest coordinates, mm.
    pub min: [f64; 2],
    /// Corner with the largest coordinates, mm.
    pub max: [f64; 2],
}

impl Extent {
    /// Returns the rectangle enlarged on each side by the fraction `part` of its size, and at least by `least_mm`.
    #[must_use]
    pub fn grown(self, part: f64, least_mm: f64) -> Self {
        let by = [0, 1].map(|k| (part * (self.max[k] - self.min[k])).max(least_mm));
        Self { min: [self.min[0] - by[0], self.min[1] - by[1]], max: [self.max[0] + by[0], self.max[1] + by[1]] }
    }

    /// Returns the area of the rectangle, mm^2.
    #[must_use]
    pub fn area_mm2(&self) -> f64 {
        (self.max[0] - self.min[0]) * (self.max[1] - self.min[1])
    }

    /// Returns the size of a cell (mm) if the rectangle is cut into `cells` by `cells`.
    pub(crate) fn cell_mm(&self, cells: usize) -> [f64; 2] {
        [0, 1].map(|k| (self.max[k] - self.min[k]) / cells as f64)
    }
}
