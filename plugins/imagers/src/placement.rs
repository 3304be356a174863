//! Position and shape of a frame: shifted across the axis, tilted, curved. Curving keeps areas on the frame.

use glam::{DMat3, DQuat, DVec3};
use spectra_core::math;

/// The shape of a frame. A radius is positive if its center lies behind the frame (at larger z).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FrameShape {
    /// A flat frame.
    Flat,
    /// A frame curved along x; x on the frame is the length of the arc.
    Cylinder {
        /// Radius, mm.
        radius_mm: f64,
    },
    /// A part of a sphere. A point on the frame is given by its azimuth and by the length of the chord from the center, so
    /// that equal areas stay equal (J. H. Lambert, 1772).
    Sphere {
        /// Radius, mm.
        radius_mm: f64,
    },
}

impl FrameShape {
    /// Returns the smallest absolute radius, in mm, at which a frame of this size spans no more than 60 degrees to each side.
    pub(crate) fn least_radius_mm(self, width_mm: f64, height_mm: f64) -> f64 {
        match self {
            Self::Flat => 0.0,
            Self::Cylinder { .. } => 0.5 * width_mm / std::f64::consts::FRAC_PI_3,
            Self::Sphere { .. } => 0.5 * (width_mm * width_mm + height_mm * height_mm).sqrt(),
        }
    }

    /// Returns the point of the surface at (`x`, `y`) on the frame, and the unit normal there toward the lens. Coordinates are in
    /// mm.
    fn at(self, x: f64, y: f64) -> (DVec3, DVec3) {
        match self {
            Self::Flat => (DVec3::new(x, y, 0.0), DVec3::NEG_Z),
            Self::Cylinder { radius_mm: r } => {
                let (sin, cos) = (math::sin(x / r), math::cos(x / r));
                // 1 - cos without cancellation.
                let half = math::sin(0.5 * x / r);
                (DVec3::new(r * sin, y, 2.0 * r * half * half), DVec3::new(sin, 0.0, -cos))
            }
            Self::Sphere { radius_mm: r } => {
                let chord2 = x * x + y * y;
                let k = (1.0 - chord2 / (4.0 * r * r)).sqrt();
                let point = DVec3::new(x * k, y * k, chord2 / (2.0 * r));
                (point, point / r - DVec3::Z)
            }
        }
    }

    /// Intersects the front of the frame with a ray toward larger z. Returns the point and its position (x, y) on the frame, both
    /// in mm. `None` if the ray misses.
    fn meet(self, from: DVec3, way: DVec3) -> Option<(DVec3, f64, f64)> {
        // Start in the tangent plane, so that the near crossing is the small root.
        let on_plane = from - way * (from.z / way.z);
        let (p, r) = match self {
            Self::Flat => {
                let point = DVec3::new(on_plane.x, on_plane.y, 0.0);
                return (way.z > 0.0).then_some((point, point.x, point.y));
            }
            Self::Cylinder { radius_mm: r } => {
                let a = way.x * way.x + way.z * way.z;
                (near(on_plane, way, a, on_plane.x * way.x - r * way.z, on_plane.x * on_plane.x), r)
            }
            Self::Sphere { radius_mm: r } => {
                let (b, c) = (on_plane.dot(way) - r * way.z, on_plane.x * on_plane.x + on_plane.y * on_plane.y);
                (near(on_plane, way, 1.0, b, c), r)
            }
        };
        let (x, y) = match self {
            Self::Sphere { .. } => {
                // Convert to the length of the chord, along the azimuth of the point.
                let k = (1.0 - p.length_squared() / (4.0 * r * r)).sqrt();
                (p.x / k, p.y / k)
            }
            _ => (r * math::asin(p.x / r), p.y),
        };
        let (_, normal) = self.at(x, y);
        // On the half that faces the lens, and from the front. False if the ray misses, since all values are then NaN.
        (p.z / r < 1.0 && way.dot(normal) < 0.0).then_some((p, x, y))
    }
}

/// Returns the point of a ray at the near root of a t^2 + 2 b t + c = 0.
fn near(from: DVec3, way: DVec3, a: f64, b: f64, c: f64) -> DVec3 {
    let root = (b * b - a * c).sqrt();
    from - way * (c / (b + if b < 0.0 { -root } else { root }))
}

/// Shift, tilt and curvature of a frame, in the coordinates of the nominal image plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    center_mm: DVec3,
    /// Columns are the axes of the frame.
    rotation: DMat3,
    bend: FrameShape,
}

impl Placement {
    /// A flat frame in the nominal image plane with its center on the axis.
    pub const NOMINAL: Self = Self { center_mm: DVec3::ZERO, rotation: DMat3::IDENTITY, bend: FrameShape::Flat };

    /// Creates a frame whose center is shifted by `shift_mm` along x and y. It is turned about its center by the angles
    /// `tilt_rad`, right-handed: first about x, then about the y axis that was turned with it. `bend` is its shape.
    #[must_use]
    pub fn new(shift_mm: [f64; 2], tilt_rad: [f64; 2], bend: FrameShape) -> Self {
        let [(sx, cx), (sy, cy)] = tilt_rad.map(|t| (math::sin(t), math::cos(t)));
        let about_x = DMat3::from_cols(DVec3::X, DVec3::new(0.0, cx, sx), DVec3::new(0.0, -sx, cx));
        let about_y = DMat3::from_cols(DVec3::new(cy, 0.0, -sy), DVec3::Y, DVec3::new(sy, 0.0, cy));
        // Exactly upright if there is no tilt.
        let rotation = if tilt_rad == [0.0; 2] { DMat3::IDENTITY } else { about_x * about_y };
        Self { center_mm: DVec3::new(shift_mm[0], shift_mm[1], 0.0), rotation, bend }
    }

    /// Returns the point (mm, coordinates of the nominal image plane) and the unit normal toward the lens at (x, y) on the
    /// frame, mm.
    #[must_use]
    pub fn at(&self, x_mm: f64, y_mm: f64) -> (DVec3, DVec3) {
        let (point, normal) = self.bend.at(x_mm, y_mm);
        (self.center_mm + self.rotation * point, self.rotation * normal)
    }

    /// Intersects a ray toward the imager with the front of the frame. The ray passes through `from_mm` along the unit direction
    /// `way`. Returns the point, in coordinates of the nominal image plane, and its position (x, y) on the frame, all in mm.
    /// `None` if the ray misses the frame's surface.
    #[must_use]
    pub fn meet(&self, from_mm: DVec3, way: DVec3) -> Option<(DVec3, f64, f64)> {
        let back = self.rotation.transpose();
        let (point, x, y) = self.bend.meet(back * (from_mm - self.center_mm), back * way)?;
        Some((self.center_mm + self.rotation * point, x, y))
    }

    /// Returns three unit vectors at the point (x, y) of the frame: along x and along y on its surface, and away from the lens.
    /// They are in coordinates of the nominal image plane.
    #[must_use]
    pub fn axes(&self, x_mm: f64, y_mm: f64) -> DMat3 {
        let away = -self.bend.at(x_mm, y_mm).1;
        self.rotation * DMat3::from_quat(DQuat::from_rotation_arc(DVec3::Z, away))
    }
}
