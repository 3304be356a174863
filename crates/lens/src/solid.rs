//! Prisms: solids with flat faces, in which light goes to the nearest face rather than from surface to surface in a fixed order.
//!
//! A prism (`kind: prism`) is one element of the lens but not a surface. The outline is a polygon in the y-z plane, extruded
//! along x. The tracer passes rays through it one by one. Light enters at the first face that it meets. Inside it goes from face
//! to face, at most 256 times, and is reflected totally or by silver until a face refracts it out. Light that then meets the
//! prism again enters it again. Each face weighs light by the prism's own coating or that of the lens. Where light passes a face,
//! the part that the face reflects is not followed and is recorded as lost elsewhere. Light keeps its polarization from face to
//! face, whether or not the batch carries polarization.
//!
//! The axis is traced through the prism once, at the reference line. Everything behind the prism is placed on the axis where it leaves.
//! First-order optics uses the length of the axis inside the prism divided by the index.
//!
//! **Limits.** Prisms take no part in ghosts: a scene that asks for ghosts through a prism gets a warning. A lens with a prism cannot be
//! reversed.

use crate::coating::{Amplitudes, Coating, Polarizing};
use crate::pose::{Displacement, Pose};
use glam::{DVec2, DVec3};
use spectra_core::Loss;
use spectra_core::math;

/// Largest number of faces that a ray may meet in one prism.
const MOST_FACES: usize = 256;
/// A ray that meets a face nearer than this starts on that face, mm.
const ON_THE_FACE_MM: f64 = 1e-9;
/// Smallest sine of the angle between a ray and the edges of the prism. A ray nearly parallel to them never meets the outline.
const ALONG: f64 = 1e-9;
/// The axis counts as undeviated if the y component of its unit direction is smaller than this; the rest is rounding.
const STRAIGHT: f64 = 1e-12;

/// A prism with flat faces: a polygon in the y-z plane, extruded along x.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    /// Corners in the y-z plane of the prism's frame, mm: y, z. The outline runs so that the inside lies to the left of each face, seen
    /// with y to the right and z upward.
    corners: Vec<DVec2>,
    /// Outward unit normals of the faces, (y, z). Face k runs from corner k to the next corner.
    normals: Vec<DVec2>,
    /// Whether each face is silvered and reflects as a mirror.
    silvered: Vec<bool>,
    /// Half the width along x, mm; infinite if the prism has no end.
    half_width_mm: f64,
    /// Glass of the prism: index into [`crate::Lens::media`].
    pub medium: usize,
    /// Pose of the axis where it leaves the prism, in the prism's frame: z along the light, x unchanged.
    pub exit: Pose,
    /// Length of the axis inside the prism, mm.
    pub inside_mm: f64,
    /// Length of the axis inside the prism over the index of its glass (relative to the medium outside), mm. First-order optics
    /// uses this length.
    pub reduced_mm: f64,
}

/// The reason why corners form no valid prism, or why the axis does not pass it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SolidError {
    /// Fewer than three corners, or two of them in the same place.
    #[error("a prism has three corners or more, no two of them in the same place")]
    Corners,
    /// Two faces of the outline cross; their numbers, from 1.
    #[error("faces {0} and {1} of the prism cross")]
    Crossing(usize, usize),
    /// The axis of the lens does not hit the prism.
    #[error("the axis does not meet the prism")]
    Beside,
    /// The axis of the lens never leaves the prism.
    #[error("light along the axis does not leave the prism")]
    Trapped,
}

/// A ray that has passed through a prism.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassedRay {
    /// Point where the ray leaves the prism, mm in the frame of the prism.
    pub position: DVec3,
    /// Unit direction of the ray where it leaves the prism.
    pub direction: DVec3,
    /// Path length from the start of the ray to the point of entry, mm; negative if that point lies behind the start.
    pub outside_mm: f64,
    /// Path length inside the glass, mm.
    pub inside_mm: f64,
}

impl Solid {
    /// Returns the prism with all lengths multiplied by `factor`.
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            corners: self.corners.iter().map(|corner| *corner * factor).collect(),
            half_width_mm: self.half_width_mm * factor,
            exit: Pose { origin_mm: self.exit.origin_mm * factor, ..self.exit },
            inside_mm: self.inside_mm * factor,
            reduced_mm: self.reduced_mm * factor,
            ..self.clone()
        }
    }

    /// Creates a prism from its corners (y, z in mm, in the frame of the prism, in either sense of rotation). Face k runs from
    /// corner k to the next, k from 0; `silvered` lists the faces that are mirrors. `half_width_mm` is half the width along x
    /// (infinite: no ends), and `medium` the index of the glass in [`crate::Lens::media`]. `relative_index`, the index of the
    /// glass over that of the medium outside, is used to trace the optical axis through the prism.
    ///
    /// # Errors
    /// [`SolidError`] if the corners make no valid outline or the axis does not pass the prism.
    pub fn new(
        corners: Vec<[f64; 2]>,
        silvered: &[usize],
        half_width_mm: f64,
        medium: usize,
        relative_index: f64,
    ) -> Result<Self, SolidError> {
        let corners: Vec<DVec2> = corners.into_iter().map(DVec2::from).collect();
        let n = corners.len();
        let edge = |k: usize| corners[(k + 1) % n] - corners[k];
        if n < 3 || (0..n).any(|k| !(edge(k).length() > ON_THE_FACE_MM)) {
            return Err(SolidError::Corners);
        }
        for a in 0..n {
            for b in a + 2..n {
                if (a, b) != (0, n - 1) && crosses([corners[a], edge(a)], [corners[b], edge(b)]) {
                    return Err(SolidError::Crossing(a + 1, b + 1));
                }
            }
        }
        let area: f64 = (0..n).map(|k| corners[k].perp_dot(corners[(k + 1) % n])).sum();
        let sense = if area > 0.0 { 1.0 } else { -1.0 };
        let normals = (0..n).map(|k| -sense * edge(k).perp().normalize()).collect();
        let silvered = (0..n).map(|k| silvered.contains(&k)).collect();
        let (exit, inside_mm) = (Pose::IDENTITY, 0.0);
        let mut own = Self { corners, normals, silvered, half_width_mm, medium, exit, inside_mm, reduced_mm: 0.0 };
        let axis = own.pass(DVec3::ZERO, DVec3::Z, relative_index, |_| {}).map_err(|loss| match loss {
            Loss::Missed => SolidError::Beside,
            _ => SolidError::Trapped,
        })?;
        let way = if axis.direction.y.abs() < STRAIGHT {
            DVec3::new(0.0, 0.0, axis.direction.z.signum())
        } else {
            axis.direction
        };
        // A rotation about x so that z runs along the light; exact where the axis goes straight on or straight back.
        let angle = if way.y == 0.0 {
            if way.z > 0.0 { 0.0 } else { std::f64::consts::PI }
        } else {
            math::atan2(-way.y, way.z)
        };
        let turn = Displacement { tilt_rad: [angle, 0.0, 0.0], ..Displacement::NONE }.pose();
        own.exit = Pose { origin_mm: axis.position, rotation: turn.rotation };
        (own.inside_mm, own.reduced_mm) = (axis.inside_mm, axis.inside_mm / relative_index);
        Ok(own)
    }

    /// Returns the corners (y, z in mm) of a triangular prism. Two sides, each `side_mm` long, meet at the top at an apex angle
    /// of `apex_rad`. The axis meets the middle of the first side at the angle of incidence `incidence_rad`.
    #[must_use]
    pub fn of_apex(apex_rad: f64, side_mm: f64, incidence_rad: f64) -> Vec<[f64; 2]> {
        let (s, c) = (math::sin(incidence_rad), math::cos(incidence_rad));
        // Unit vectors along the first face toward the apex, and into the glass.
        let (up, inward) = (DVec2::new(c, s), DVec2::new(-s, c));
        let top = 0.5 * side_mm * up;
        let down = -up * math::cos(apex_rad) + inward * math::sin(apex_rad);
        [-top, top, top + side_mm * down].map(|corner| corner.to_array()).to_vec()
    }

    /// Returns the corners, y and z in mm, in the frame of the prism.
    #[must_use]
    pub fn corners(&self) -> Vec<[f64; 2]> {
        self.corners.iter().map(|c| c.to_array()).collect()
    }

    /// Radius of a circle about the origin of the prism that contains its outline, mm.
    #[must_use]
    pub fn reach_mm(&self) -> f64 {
        self.corners.iter().map(|c| c.length()).fold(0.0, f64::max)
    }

    /// Finds the nearest face ahead of point `p` along direction `d`, and the distance to it. Outside only faces by which the ray can enter
    /// count, inside only faces by which it can leave. Face `last` is skipped.
    fn nearest(&self, p: DVec3, d: DVec3, inside: bool, last: Option<usize>) -> Option<(usize, f64)> {
        let (p2, d2) = (DVec2::new(p.y, p.z), DVec2::new(d.y, d.z));
        let mut best: Option<(usize, f64)> = None;
        for (k, normal) in self.normals.iter().enumerate() {
            let toward = d2.dot(*normal);
            if Some(k) == last || (toward > 0.0) != inside || toward == 0.0 {
                continue;
            }
            let (a, b) = (self.corners[k], self.corners[(k + 1) % self.corners.len()]);
            let t = (a - p2).dot(*normal) / toward;
            let along = (p2 + d2 * t - a).dot(b - a) / (b - a).length_squared();
            let slack = if inside { ON_THE_FACE_MM } else { 0.0 };
            if t > -ON_THE_FACE_MM && (-slack..=1.0 + slack).contains(&along) && best.is_none_or(|(_, best)| t < best) {
                // Seen from outside, a face ends at the sides of the prism.
                if inside || (p.x + t * d.x).abs() <= self.half_width_mm {
                    best = Some((k, t));
                }
            }
        }
        best
    }

    /// Traces a ray through the prism. The ray is given in the prism's frame by any point of its line (mm) and its unit
    /// direction. `index` is the index of the glass over that of the medium outside. `face` is called for each face that the ray
    /// meets.
    ///
    /// # Errors
    /// [`Loss::Missed`] if the ray meets no face, [`Loss::Vignetted`] if it meets a ground end, and [`Loss::Absorbed`] if it
    /// cannot enter or leave the glass.
    pub fn pass(
        &self,
        position: DVec3,
        direction: DVec3,
        index: f64,
        mut face: impl FnMut(&FaceHit),
    ) -> Result<PassedRay, Loss> {
        let across = DVec2::new(direction.y, direction.z);
        let speed = across.length();
        if speed < ALONG {
            return Err(Loss::Missed);
        }
        // Go back along the line until the point is in front of the prism.
        let back =
            -(DVec2::new(position.y, position.z).dot(across) / (speed * speed)) - (self.reach_mm() + 1.0) / speed;
        let (mut p, mut d) = (position + back * direction, direction);
        let (mut outside_mm, mut inside_mm) = (back, 0.0);
        let (mut inside, mut last) = (false, None);
        for step in 0..MOST_FACES {
            let Some((k, t)) = self.nearest(p, d, inside, last) else {
                return match (inside, step) {
                    (false, 0) => Err(Loss::Missed),
                    (false, _) => Ok(PassedRay { position: p, direction: d, outside_mm, inside_mm }),
                    (true, _) => Err(Loss::Absorbed),
                };
            };
            p += d * t;
            *(if inside { &mut inside_mm } else { &mut outside_mm }) += t;
            if p.x.abs() > self.half_width_mm {
                // The ray meets a ground side of the prism.
                return Err(Loss::Vignetted);
            }
            let outward = DVec3::new(0.0, self.normals[k].x, self.normals[k].y);
            // The normal that points against the light.
            let normal = if inside { -outward } else { outward };
            let cosine = -d.dot(normal);
            let ratio = if inside { index } else { 1.0 / index };
            let inner = 1.0 - ratio * ratio * (1.0 - cosine * cosine);
            last = Some(k);
            if self.silvered[k] || inner <= 0.0 {
                if !inside {
                    // The ray meets the back of a mirror, or is totally reflected on the outside.
                    return Err(Loss::Absorbed);
                }
                face(&FaceHit {
                    direction: d,
                    normal,
                    cosine,
                    bend: if self.silvered[k] { FaceEvent::Mirror } else { FaceEvent::Total },
                });
                d = (d + 2.0 * cosine * normal).normalize();
            } else {
                face(&FaceHit {
                    direction: d,
                    normal,
                    cosine,
                    bend: if inside { FaceEvent::Out } else { FaceEvent::In },
                });
                d = (ratio * d + (ratio * cosine - inner.sqrt()) * normal).normalize();
                inside = !inside;
            }
        }
        Err(Loss::Absorbed)
    }
}

/// A meeting of a ray with a face of a prism.
#[derive(Clone, Copy, Debug)]
pub struct FaceHit {
    /// Unit direction of the ray in front of the face.
    pub direction: DVec3,
    /// Unit normal of the face, pointing against the light.
    pub normal: DVec3,
    /// Cosine of the angle of incidence at the face.
    pub cosine: f64,
    /// Action of the face on the light.
    pub bend: FaceEvent,
}

impl FaceHit {
    /// Returns the effect of the face on s and p light, by its coating between a medium of index `n` and glass of index `inside`,
    /// or by its silver. The last argument holds the coating and the reflectance of the silver.
    pub fn polarizes(
        &self,
        [n, inside]: [f64; 2],
        wavelength_nm: f64,
        (coating, reflectance): (&Amplitudes<'_>, f64),
    ) -> Polarizing {
        let cosine = self.cosine.min(1.0);
        match self.bend {
            FaceEvent::In => coating.through(n, inside, cosine, wavelength_nm),
            FaceEvent::Out => coating.through(inside, n, cosine, wavelength_nm),
            FaceEvent::Mirror => Polarizing::evenly(reflectance, true),
            FaceEvent::Total => Amplitudes::of(&Coating::Bare).back(inside, n, cosine, wavelength_nm),
        }
    }
}

/// What light does at a face of a prism.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaceEvent {
    /// The light enters the glass.
    In,
    /// The light leaves the glass.
    Out,
    /// The light is reflected by a silvered face.
    Mirror,
    /// The light is totally reflected inside the glass.
    Total,
}

/// Whether two line segments, each given by its start and its extent, cross.
fn crosses([a, u]: [DVec2; 2], [b, v]: [DVec2; 2]) -> bool {
    let det = u.perp_dot(v);
    let (s, t) = ((b - a).perp_dot(v) / det, (b - a).perp_dot(u) / det);
    (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t)
}
