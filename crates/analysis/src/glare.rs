//! Veiling glare: the part of an extended white field that a lens spreads over what should be black.
//!
//! Integral method of ISO 9358:1994: a black disk stands at the center of a field of uniform radiance that fills and exceeds the field of
//! the lens. The veiling glare index is the irradiance at the center of the disk's image divided by the irradiance there without the disk.
//! Light is followed from the image back to the field by random walks that assume no sequence of surfaces ([`spectra_tracer::Interior`]).

use serde::Serialize;
use spectra_core::workers::{Workers, map_pieces};
use spectra_glass::lines;
use spectra_lens::Lens;
use spectra_tracer::{Interior, Particle, StrayError, StrayLedger, StrayReflectances, WalkNumbers, Walker};
use std::convert::Infallible;

/// Number of walks in one piece of work.
const PIECE: usize = 4096;
/// Seed of the random numbers of the walks.
const SEED: u64 = 0x0067_6c61_7265;

/// Settings of a veiling glare measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GlareTask {
    /// Width and height of the imager, mm. The camera behind the lens is as wide as the imager.
    pub frame_mm: [f64; 2],
    /// Diameter of the image of the black disk, mm.
    pub disk_mm: f64,
    /// Diameter of the area at the center of that image where light is measured, mm.
    pub detector_mm: f64,
    /// Reflectances of everything inside that is not glass: paint and imager.
    pub matter: StrayReflectances,
    /// Wavelength, nm.
    pub wavelength_nm: f64,
    /// Number of walks.
    pub walks: usize,
}

impl GlareTask {
    /// Returns the settings for a lens on a 135 camera (36 x 24 mm) at this wavelength, nm. The image of the disk is a tenth of the frame's
    /// diagonal wide, and light is measured over the middle half of it. The lens is painted black, and the imager reflects nothing.
    #[must_use]
    pub fn new(wavelength_nm: f64) -> Self {
        let frame_mm: [f64; 2] = [36.0, 24.0];
        let diagonal = (frame_mm[0] * frame_mm[0] + frame_mm[1] * frame_mm[1]).sqrt();
        Self {
            frame_mm,
            disk_mm: 0.1 * diagonal,
            detector_mm: 0.05 * diagonal,
            matter: StrayReflectances::default(),
            wavelength_nm,
            walks: 1 << 20,
        }
    }
}

/// The veiling glare of a lens.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Glare {
    /// Veiling glare index: irradiance at the center of the black disk's image divided by the irradiance there without the disk.
    pub index: f64,
    /// Standard error of the index.
    pub standard_error: f64,
    /// Part of the index due to light that paint or imager scattered at least once. The remainder was reflected by glass alone.
    pub scattered: f64,
    /// Diffuse reflectance of the paint.
    pub paint: f64,
    /// Reflectance of the imager.
    pub imager: f64,
    /// Diameter of the image of the black disk, mm.
    pub disk_mm: f64,
    /// Width and height of the imager, mm.
    pub frame_mm: [f64; 2],
    /// Wavelength, nm.
    pub wavelength_nm: f64,
    /// Number of walks made.
    pub walks: usize,
    /// Destinations of the walks, as parts of the launched light.
    pub ledger: GlareLedger,
}

/// Destinations of the walks from the center of the black disk's image, as parts of the launched light. All other fields add up to 1 +
/// `aimed`, where `aimed` is noise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct GlareLedger {
    /// Light that reached the white field.
    pub white: f64,
    /// Light that reached the black disk.
    pub black: f64,
    /// Light absorbed by paint.
    pub paint: f64,
    /// Light absorbed by glass.
    pub glass: f64,
    /// Light absorbed by coatings.
    pub coatings: f64,
    /// Light absorbed by the imager.
    pub imager: f64,
    /// Light that was not followed to its end.
    pub not_traced: f64,
    /// Sum of the weights of aimed directions divided by that of evenly distributed ones, less 1. Its expected value is 0.
    pub aimed: f64,
}

/// The black disk in front of a lens.
#[derive(Clone, Copy, Debug)]
pub struct BlackDisk {
    /// Distance from the first vertex, mm; may be infinite.
    distance_mm: f64,
    /// Radius of the disk, mm; for a disk at infinity the tangent of its angular radius.
    radius: f64,
}

impl BlackDisk {
    /// Returns the disk in the plane of focus whose paraxial image has the diameter `image_mm`. `None` if the lens forms no
    /// image.
    #[must_use]
    pub fn of(lens: &Lens, image_mm: f64) -> Option<Self> {
        let distance_mm = lens.focused_mm;
        let scale = if distance_mm.is_finite() {
            1.0 / lens.paraxial_magnification(distance_mm, lens.reference_nm)
        } else {
            1.0 / lens.first_order(lens.reference_nm).efl_mm
        };
        let radius = (0.5 * image_mm * scale).abs();
        (radius.is_finite() && radius > 0.0).then_some(Self { distance_mm, radius })
    }

    /// Whether the straight line of a ray, continued both ways, meets the disk.
    #[must_use]
    pub fn holds(&self, ray: &Particle) -> bool {
        let (p, d) = (ray.position, ray.direction);
        if d.z == 0.0 {
            return false;
        }
        let [x, y] = if self.distance_mm.is_finite() {
            let t = (-self.distance_mm - p.z) / d.z;
            [p.x + t * d.x, p.y + t * d.y]
        } else {
            [d.x / d.z, d.y / d.z]
        };
        x * x + y * y <= self.radius * self.radius
    }
}

/// Sums over walks. Each walk adds to `black` (light of the field outside the disk) and to `all`.
#[derive(Clone, Copy, Default)]
struct Sums {
    black: f64,
    all: f64,
    scattered: f64,
    squares: [f64; 3],
    ledger: StrayLedger,
}

/// Why the veiling glare could not be measured.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GlareError {
    /// The stray light of this lens cannot be computed.
    #[error(transparent)]
    Stray(#[from] StrayError),
    /// The lens forms no image of the black disk.
    #[error("the lens makes no image of distant objects, so no black disk has one")]
    NoImage,
    /// No light came through the lens.
    #[error("no light comes from the field to the middle of the image")]
    Dark,
}

/// Measures the veiling glare index of a lens as it is set. The result is the same to the bit for any number of workers.
///
/// # Errors
/// [`GlareError`].
pub fn glare(lens: &Lens, task: &GlareTask, workers: &dyn Workers) -> Result<Glare, GlareError> {
    let interior = Interior::new(lens, task.frame_mm, [task.wavelength_nm; 2], task.matter)?;
    let disk = BlackDisk::of(lens, task.disk_mm).ok_or(GlareError::NoImage)?;
    let piece = |walker: &mut Walker<'_>, piece: usize| -> Result<Sums, Infallible> {
        walker.ledger = StrayLedger::default();
        walker.set_wavelength(task.wavelength_nm);
        let mut sums = Sums::default();
        for walk in piece * PIECE..((piece + 1) * PIECE).min(task.walks) {
            let mut chance = WalkNumbers::new(SEED, walk as u64);
            let (u, v) = (chance.number(), chance.number());
            let (x, y) = spectra_core::math::concentric_disk(u, v);
            let from = [x, y].map(|c| 0.5 * task.detector_mm * c);
            let Some(out) = walker.from_imager(from, &mut chance) else { continue };
            let all = out.weight;
            let black = if disk.holds(&out) { 0.0 } else { all };
            sums.black += black;
            sums.all += all;
            sums.scattered += if out.scattered > 0 { black } else { 0.0 };
            sums.squares =
                [sums.squares[0] + black * black, sums.squares[1] + black * all, sums.squares[2] + all * all];
        }
        sums.ledger = walker.ledger;
        Ok(sums)
    };
    let pieces = map_pieces(workers, task.walks.div_ceil(PIECE), || Walker::new(&interior), piece);
    let sums = pieces.unwrap_or_default().into_iter().fold(Sums::default(), |mut sum, s| {
        sum.black += s.black;
        sum.all += s.all;
        sum.scattered += s.scattered;
        sum.squares = std::array::from_fn(|k| sum.squares[k] + s.squares[k]);
        sum.ledger.add(&s.ledger);
        sum
    });
    if !(sums.all > 0.0) {
        return Err(GlareError::Dark);
    }
    let index = sums.black / sums.all;
    // Standard error of a ratio: the spread of black - index * all, whose mean is 0.
    let [bb, ba, aa] = sums.squares;
    let spread = (bb - 2.0 * index * ba + index * index * aa).max(0.0).sqrt();
    let part = |of: f64| of / sums.ledger.launched;
    Ok(Glare {
        index,
        standard_error: spread / sums.all,
        scattered: sums.scattered / sums.all,
        paint: task.matter.paint,
        imager: task.matter.imager + task.matter.imager_mirror,
        disk_mm: task.disk_mm,
        frame_mm: task.frame_mm,
        wavelength_nm: task.wavelength_nm,
        walks: task.walks,
        ledger: GlareLedger {
            white: part(sums.black),
            black: part(sums.all - sums.black),
            paint: part(sums.ledger.paint),
            glass: part(sums.ledger.glass),
            coatings: part(sums.ledger.coatings),
            imager: part(sums.ledger.imager),
            not_traced: part(sums.ledger.not_traced),
            aimed: part(sums.ledger.aimed),
        },
    })
}

/// Default wavelength of a veiling glare measurement, nm: line e, near the peak of the eye's sensitivity.
#[must_use]
pub fn usual_wavelength_nm() -> f64 {
    lines::E.wavelength_nm
}
