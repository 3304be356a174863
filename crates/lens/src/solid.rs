//! Prisms: solids of flat faces in which light goes to the nearest one, whatever the order.
//!
//! The outline is a polygon in the y-z plane, drawn out along x. Light enters at the face that it meets first; inside it goes on from face
//! to face, reflected totally or by a silvered one, until a face lets it out; where it meets the prism again it enters again. What the
//! faces reflect of light that they let pass is not followed.

use crate::coating::{Amplitudes, Coating, Polarizing};
use crate::pose::{Displacement, Pose};
use glam::{DVec2, DVec3};
use spectra_core::Loss;
use spectra_core::math;

/// Faces that light meets at most.
const MOST_FACES: usize = 256;
/// Light that meets a face nearer than this stands on it, mm.
const ON_THE_FACE_MM: f64 = 1e-9;
/// Light along the edges of the prism never meets its outline: sine of the angle to them.
const ALONG: f64 = 1e-9;
/// The axis leaves straight where its direction is this near to the axis: rounding.
const STRAIGHT: f64 = 1e-12;

/// A prism.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    /// Corners in the y-z plane of its frame, mm: y, z. The outline runs so that the inside lies on the left of each face, seen with y
    /// to the right and z upward.
    corners: Vec<DVec2>,
    /// Outward unit normals of the faces, of which each runs from the corner of its number to the next one.
    normals: Vec<DVec2>,
    /// Which faces reflect as mirrors.
    silvered: Vec<bool>,
    /// Half the width along x, mm; infinite where the prism ends nowhere.
    half_width_mm: f64,
    /// Its glass: index into [`crate::Lens::media`].
    pub medium: usize,
    /// Where the axis leaves, in its frame: z along the light, x as it was.
    pub exit: Pose,
    /// Length of the axis inside, mm.
    pub inside_mm: f64,
    /// That over the index of the glass relative to what is outside, mm: as far as first order goes.
    pub reduced_mm: f64,
}

/// Why corners make no prism, or the axis does not pass it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SolidError {
    /// Fewer than three corners, or two of them in the same place.
    #[error("a prism has three corners or more, no two of them in the same place")]
    Corners,
    /// Faces cross.
    #[error("faces {0} and {1} of the prism cross")]
    Crossing(usize, usize),
    /// The axis passes beside.
    #[error("the axis does not meet the prism")]
    Beside,
    /// The axis stays inside.
    #[error("light along the axis does not leave the prism")]
    Trapped,
}

/// Light that passed a prism.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Passed {
    pub position: DVec3,
    pub direction: DVec3,
    /// Ways outside (of the line to the place of entry, negative backward) and inside, mm.
    pub outside_mm: f64,
    pub inside_mm: f64,
}

impl Solid {
    /// With all lengths times `factor`.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        Self {
            corners: self.corners.iter().map(|corner| *corner * factor).collect(),
            half_width_mm: self.half_width_mm * factor,
            exit: Pose { origin_mm: self.exit.origin_mm * factor, ..self.exit },
            inside_mm: self.inside_mm * factor,
            reduced_mm: self.reduced_mm * factor,
            ..self.clone()
        }
    }

    /// By its corners (y and z in mm, either way round), the faces that are silvered (from 0), half its width along x, mm, and the index of its
    /// glass over that of what is outside, for the axis.
    ///
    /// # Errors
    /// [`SolidError`]
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
        // About x, so that z runs along the light: exact for straight and turned back.
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

    /// Corners of a prism whose two sides of this length, mm, meet at an apex of this angle, rad, above; the axis meets the middle of the
    /// first side at this angle of incidence, rad.
    #[must_use]
    pub fn of_apex(apex_rad: f64, side_mm: f64, incidence_rad: f64) -> Vec<[f64; 2]> {
        let (s, c) = (math::sin(incidence_rad), math::cos(incidence_rad));
        // Along the first face toward the apex, and into the glass.
        let (up, inward) = (DVec2::new(c, s), DVec2::new(-s, c));
        let top = 0.5 * side_mm * up;
        let down = -up * math::cos(apex_rad) + inward * math::sin(apex_rad);
        [-top, top, top + side_mm * down].map(|corner| corner.to_array()).to_vec()
    }

    /// The corners, y and z in mm of its frame.
    #[must_use]
    pub fn corners(&self) -> Vec<[f64; 2]> {
        self.corners.iter().map(|c| c.to_array()).collect()
    }

    /// The radius about its origin that holds its outline, mm.
    #[must_use]
    pub fn reach_mm(&self) -> f64 {
        self.corners.iter().map(|c| c.length()).fold(0.0, f64::max)
    }

    /// The nearest face that a ray meets beyond `from`: outside those that it enters by, inside those that it can leave by.
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
                // Outside, a face ends at its sides.
                if inside || (p.x + t * d.x).abs() <= self.half_width_mm {
                    best = Some((k, t));
                }
            }
        }
        best
    }

    /// Takes a ray through, given in its frame by any point of its line, where the index inside is `index` times that outside. `face` hears
    /// of each face that it meets.
    pub(crate) fn pass(
        &self,
        position: DVec3,
        direction: DVec3,
        index: f64,
        mut face: impl FnMut(&Face),
    ) -> Result<Passed, Loss> {
        let across = DVec2::new(direction.y, direction.z);
        let speed = across.length();
        if speed < ALONG {
            return Err(Loss::Missed);
        }
        // Back along the line to where it is in front of the prism.
        let back =
            -(DVec2::new(position.y, position.z).dot(across) / (speed * speed)) - (self.reach_mm() + 1.0) / speed;
        let (mut p, mut d) = (position + back * direction, direction);
        let (mut outside_mm, mut inside_mm) = (back, 0.0);
        let (mut inside, mut last) = (false, None);
        for step in 0..MOST_FACES {
            let Some((k, t)) = self.nearest(p, d, inside, last) else {
                return match (inside, step) {
                    (false, 0) => Err(Loss::Missed),
                    (false, _) => Ok(Passed { position: p, direction: d, outside_mm, inside_mm }),
                    (true, _) => Err(Loss::Absorbed),
                };
            };
            p += d * t;
            *(if inside { &mut inside_mm } else { &mut outside_mm }) += t;
            if p.x.abs() > self.half_width_mm {
                // The ground sides of the prism.
                return Err(Loss::Vignetted);
            }
            let outward = DVec3::new(0.0, self.normals[k].x, self.normals[k].y);
            // Against the light.
            let normal = if inside { -outward } else { outward };
            let cosine = -d.dot(normal);
            let ratio = if inside { index } else { 1.0 / index };
            let inner = 1.0 - ratio * ratio * (1.0 - cosine * cosine);
            last = Some(k);
            if self.silvered[k] || inner <= 0.0 {
                if !inside {
                    // The back of a mirror, or total reflection at the outside.
                    return Err(Loss::Absorbed);
                }
                face(&Face {
                    direction: d,
                    normal,
                    cosine,
                    bend: if self.silvered[k] { Bend::Mirror } else { Bend::Total },
                });
                d = (d + 2.0 * cosine * normal).normalize();
            } else {
                face(&Face { direction: d, normal, cosine, bend: if inside { Bend::Out } else { Bend::In } });
                d = (ratio * d + (ratio * cosine - inner.sqrt()) * normal).normalize();
                inside = !inside;
            }
        }
        Err(Loss::Absorbed)
    }
}

/// A face that light meets.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Face {
    /// Of the light in front of it.
    pub direction: DVec3,
    /// Against the light.
    pub normal: DVec3,
    /// Of the angle of incidence.
    pub cosine: f64,
    pub bend: Bend,
}

impl Face {
    /// What the face does to s and p light by its coating between a medium of index `n` and glass of index `inside`, or by its silver.
    pub(crate) fn polarizes(
        &self,
        [n, inside]: [f64; 2],
        wavelength_nm: f64,
        (coating, reflectance): (&Amplitudes<'_>, f64),
    ) -> Polarizing {
        let cosine = self.cosine.min(1.0);
        match self.bend {
            Bend::In => coating.through(n, inside, cosine, wavelength_nm),
            Bend::Out => coating.through(inside, n, cosine, wavelength_nm),
            Bend::Mirror => Polarizing::evenly(reflectance, true),
            Bend::Total => Amplitudes::of(&Coating::Bare).back(inside, n, cosine, wavelength_nm),
        }
    }
}

/// What light does at a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Bend {
    In,
    Out,
    Mirror,
    Total,
}

/// Whether two lines, each a start and a way, cross between their ends.
fn crosses([a, u]: [DVec2; 2], [b, v]: [DVec2; 2]) -> bool {
    let det = u.perp_dot(v);
    let (s, t) = ((b - a).perp_dot(v) / det, (b - a).perp_dot(u) / det);
    (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t)
}
