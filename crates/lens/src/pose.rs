//! Poses: the position of a surface along the axis and its decenter, tilt and reversal.
//!
//! A lens file states thicknesses, bends of the axis (`coordinate-break`), and displacements of single surfaces and of groups.
//! [`Lens::arrange`](crate::Lens::arrange) converts them to one pose per surface, and the tracer knows only poses. The pose of a reversed
//! surface is turned by half a turn, so no kind of surface needs to know about reversal. Apertures that are not round are evaluated at the
//! point where the light met the surface, after the surface has acted.

use glam::{DMat3, DVec3};
use spectra_core::math;

/// A position and an orientation: converts points from a local frame to the frame of the lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Origin of the local frame, mm in the frame of the lens.
    pub origin_mm: DVec3,
    /// Rotation whose columns are the local axes in the frame of the lens.
    pub rotation: DMat3,
}

impl Pose {
    /// The pose of the lens frame itself, without shift or rotation.
    pub const IDENTITY: Self = Self { origin_mm: DVec3::ZERO, rotation: DMat3::IDENTITY };

    /// Converts a local point to the frame of the lens, mm.
    #[must_use]
    pub fn point(&self, local_mm: DVec3) -> DVec3 {
        self.origin_mm + self.rotation * local_mm
    }

    /// Converts a local direction to the frame of the lens.
    #[must_use]
    pub fn direction(&self, local: DVec3) -> DVec3 {
        self.rotation * local
    }

    /// Converts a point from the frame of the lens to the local frame, mm.
    #[must_use]
    pub fn local_point(&self, point_mm: DVec3) -> DVec3 {
        self.rotation.transpose() * (point_mm - self.origin_mm)
    }

    /// Converts a direction from the frame of the lens to the local frame.
    #[must_use]
    pub fn local_direction(&self, direction: DVec3) -> DVec3 {
        self.rotation.transpose() * direction
    }

    /// Combines two poses: `inner` is a pose in this local frame, and the result is the same pose in the frame of the lens.
    #[must_use]
    pub fn then(&self, inner: &Self) -> Self {
        Self { origin_mm: self.point(inner.origin_mm), rotation: self.rotation * inner.rotation }
    }

    /// Returns the inverse pose, which converts from the frame of the lens to the local frame.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.transpose();
        Self { origin_mm: -(rotation * self.origin_mm), rotation }
    }

    /// Returns the pose moved by `distance_mm` along its local z axis.
    #[must_use]
    pub fn advanced(&self, distance_mm: f64) -> Self {
        // On the axis no multiplication is done, so a lens without tilts keeps its sums bit for bit.
        let origin_mm = if self.rotation == DMat3::IDENTITY {
            DVec3::new(self.origin_mm.x, self.origin_mm.y, self.origin_mm.z + distance_mm)
        } else {
            self.origin_mm + distance_mm * self.rotation.z_axis
        };
        Self { origin_mm, ..*self }
    }

    /// Returns whether the pose lies on the axis of the lens and has no rotation.
    #[must_use]
    pub fn is_on_axis(&self) -> bool {
        self.rotation == DMat3::IDENTITY && self.origin_mm.x == 0.0 && self.origin_mm.y == 0.0
    }

    /// Returns the pose with its z axis reversed and x and y unchanged. The frame becomes left-handed; a picture in it stays
    /// unmirrored.
    #[must_use]
    pub fn facing_back(&self) -> Self {
        let r = self.rotation;
        Self { rotation: DMat3::from_cols(r.x_axis, r.y_axis, -r.z_axis), ..*self }
    }

    /// Returns the pose turned by half a turn about its own y axis.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let r = self.rotation;
        Self { rotation: DMat3::from_cols(-r.x_axis, r.y_axis, -r.z_axis), ..*self }
    }
}

/// A decenter and a tilt of one surface, of a group, or of the axis itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Displacement {
    /// Shift along x and y, mm.
    pub decenter_mm: [f64; 2],
    /// Right-handed rotations about x, y and z, rad.
    pub tilt_rad: [f64; 3],
    /// Order of shift and tilts. If true, the tilts about z, y and x (in that order) come before the shift; if false, the shift
    /// comes first, then the tilts about x, y and z.
    pub tilt_first: bool,
}

impl Displacement {
    /// The displacement without shift or tilt.
    pub const NONE: Self = Self { decenter_mm: [0.0; 2], tilt_rad: [0.0; 3], tilt_first: false };

    /// Returns whether this displacement has neither shift nor tilt.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.decenter_mm == [0.0; 2] && self.tilt_rad == [0.0; 3]
    }

    /// Returns the pose of the displaced frame in the original frame.
    #[must_use]
    pub fn pose(&self) -> Pose {
        let shift = DVec3::new(self.decenter_mm[0], self.decenter_mm[1], 0.0);
        let [x, y, z] = [about_x(self.tilt_rad[0]), about_y(self.tilt_rad[1]), about_z(self.tilt_rad[2])];
        if self.tilt_first {
            let rotation = z * y * x;
            Pose { origin_mm: rotation * shift, rotation }
        } else {
            Pose { origin_mm: shift, rotation: x * y * z }
        }
    }
}

/// A bend of the axis in front of a surface. Everything behind the bend moves with the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisBreak {
    /// Shift and tilt of the axis.
    pub displacement: Displacement,
    /// Distance along the new axis to the next surface or break, mm.
    pub thickness_mm: f64,
}

/// Returns the sine and cosine, exact at multiples of a quarter turn, so that a fold by 90 degrees stays one.
fn sin_cos(angle_rad: f64) -> (f64, f64) {
    let quarters = angle_rad / std::f64::consts::FRAC_PI_2;
    if quarters.fract() == 0.0 && quarters.abs() < 1e9 {
        return match (quarters as i64).rem_euclid(4) {
            0 => (0.0, 1.0),
            1 => (1.0, 0.0),
            2 => (0.0, -1.0),
            _ => (-1.0, 0.0),
        };
    }
    (math::sin(angle_rad), math::cos(angle_rad))
}

fn about_x(angle_rad: f64) -> DMat3 {
    let (s, c) = sin_cos(angle_rad);
    DMat3::from_cols(DVec3::X, DVec3::new(0.0, c, s), DVec3::new(0.0, -s, c))
}

fn about_y(angle_rad: f64) -> DMat3 {
    let (s, c) = sin_cos(angle_rad);
    DMat3::from_cols(DVec3::new(c, 0.0, -s), DVec3::Y, DVec3::new(s, 0.0, c))
}

fn about_z(angle_rad: f64) -> DMat3 {
    let (s, c) = sin_cos(angle_rad);
    DMat3::from_cols(DVec3::new(c, s, 0.0), DVec3::new(-s, c, 0.0), DVec3::Z)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A right-handed quarter turn about x takes y to z and z to -y, and so on cyclically.
    #[test]
    fn rotations_are_right_handed() {
        let quarter = std::f64::consts::FRAC_PI_2;
        assert_eq!(about_x(quarter) * DVec3::Y, DVec3::Z);
        assert_eq!(about_y(quarter) * DVec3::Z, DVec3::X);
        assert_eq!(about_z(quarter) * DVec3::X, DVec3::Y);
    }

    /// The two orders differ, and one undoes the other when all signs are reversed.
    #[test]
    fn tilt_first_undoes_decenter_first() {
        let there = Displacement { decenter_mm: [3.0, -2.0], tilt_rad: [0.3, -0.7, 1.1], tilt_first: false };
        let back = Displacement { decenter_mm: [-3.0, 2.0], tilt_rad: [-0.3, 0.7, -1.1], tilt_first: true };
        let both = there.pose().then(&back.pose());
        let p = DVec3::new(1.0, 2.0, 3.0);
        assert!((both.point(p) - p).length() < 1e-14);
        assert!((there.pose().inverse().point(there.pose().point(p)) - p).length() < 1e-14);
    }

    #[test]
    fn reversing_twice_is_nothing() {
        let pose = Displacement { decenter_mm: [1.0, 2.0], tilt_rad: [0.1, 0.2, 0.3], tilt_first: false }.pose();
        assert_eq!(pose.reversed().reversed(), pose);
        assert_eq!(pose.reversed().rotation.z_axis, -pose.rotation.z_axis);
    }
}
