//! Veiling glare: how much of an extended white field a lens spreads over what should be black.
//!
//! The integral method of ISO 9358:1994: a black disk at the middle of a field of uniform radiance that fills and exceeds the lens's
//! own. The veiling glare index is the irradiance at the middle of the disk's image over the irradiance there without the disk. Light
//! is followed from the image back to the field, by walks that know no order of surfaces ([`spectra_lens::Interior`]).

use serde::Serialize;
use spectra_core::workers::{Workers, each_of};
use spectra_glass::lines;
use spectra_lens::{Chance, Interior, Lens, Particle, StrayError, StrayLedger, StrayMatter, Walker};
use std::convert::Infallible;

/// Walks of one piece of work.
const PIECE: usize = 4096;
/// Numbers of walks are drawn by this seed.
const SEED: u64 = 0x676c_6172_65;

/// What veiling glare is measured with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GlareTask {
    /// Width and height of the imager, mm: the camera behind the lens is as wide.
    pub frame_mm: [f64; 2],
    /// Diameter of the image of the black disk, mm.
    pub disk_mm: f64,
    /// Diameter of the place in its middle where light is measured, mm.
    pub detector_mm: f64,
    /// What reflects light beside glass.
    pub matter: StrayMatter,
    /// Wavelength, nm.
    pub wavelength_nm: f64,
    /// How many walks.
    pub walks: usize,
}

impl GlareTask {
    /// Behind a lens on a 135 camera: a disk a tenth as large as the frame's diagonal, measured over the middle half of its image,
    /// a lens with black paint and an imager that reflects nothing.
    #[must_use]
    pub fn new(wavelength_nm: f64) -> Self {
        let frame_mm: [f64; 2] = [36.0, 24.0];
        let diagonal = (frame_mm[0] * frame_mm[0] + frame_mm[1] * frame_mm[1]).sqrt();
        Self {
            frame_mm,
            disk_mm: 0.1 * diagonal,
            detector_mm: 0.05 * diagonal,
            matter: StrayMatter::default(),
            wavelength_nm,
            walks: 1 << 20,
        }
    }
}

/// The veiling glare of a lens.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Glare {
    /// Veiling glare index: irradiance at the middle of the black disk's image over that without the disk.
    pub index: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// Of the index: light that paint or imager scattered at least once; what is left was reflected by glass alone.
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
    /// Walks that were made.
    pub walks: usize,
    /// Where they ended, as parts of what set out.
    pub ledger: GlareLedger,
}

/// Where walks ended that set out from the middle of the black disk's image, as parts of them; `front` and the others add up to 1 but
/// for `aimed`, which is noise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct GlareLedger {
    /// Came to the white field.
    pub white: f64,
    /// Came to the black disk.
    pub black: f64,
    /// Absorbed by paint.
    pub paint: f64,
    /// Absorbed by glass.
    pub glass: f64,
    /// Absorbed by coatings.
    pub coatings: f64,
    /// Absorbed by the imager.
    pub imager: f64,
    /// Not followed to the end.
    pub not_traced: f64,
    /// Sum of the weights of directions that were chosen, over that of even ones, less 1.
    pub aimed: f64,
}

/// The black disk in front of a lens.
#[derive(Clone, Copy, Debug)]
pub struct BlackDisk {
    /// Distance from the first vertex, mm; infinite.
    distance_mm: f64,
    /// Its radius, mm; at infinity the tangent of the angle.
    radius: f64,
}

impl BlackDisk {
    /// The disk whose image has this diameter, mm, by first order. `None` where the lens has no image.
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

    /// Whether light along this line, either way, is the disk's.
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

/// Sums over walks, each of which brings `black` (light of the field beside the disk) and `all`.
#[derive(Clone, Copy, Default)]
struct Sums {
    black: f64,
    all: f64,
    scattered: f64,
    squares: [f64; 3],
    ledger: StrayLedger,
}

/// Why there is no figure.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GlareError {
    /// The lens is not one whose stray light is known.
    #[error(transparent)]
    Stray(#[from] StrayError),
    /// The lens has no image of the black disk.
    #[error("the lens makes no image of distant objects, so no black disk has one")]
    NoImage,
    /// No light came through.
    #[error("no light comes from the field to the middle of the image")]
    Dark,
}

/// The veiling glare index of a lens as it is set: the same bits on any workers.
///
/// # Errors
/// [`GlareError`]
pub fn glare(lens: &Lens, task: &GlareTask, workers: &dyn Workers) -> Result<Glare, GlareError> {
    let interior = Interior::new(lens, task.frame_mm, [task.wavelength_nm; 2], task.matter)?;
    let disk = BlackDisk::of(lens, task.disk_mm).ok_or(GlareError::NoImage)?;
    let piece = |walker: &mut Walker<'_>, piece: usize| -> Result<Sums, Infallible> {
        walker.ledger = StrayLedger::default();
        walker.set_wavelength(task.wavelength_nm);
        let mut sums = Sums::default();
        for walk in piece * PIECE..((piece + 1) * PIECE).min(task.walks) {
            let mut chance = Chance::new(SEED, walk as u64);
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
    let pieces = each_of(workers, task.walks.div_ceil(PIECE), || Walker::new(&interior), piece);
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
    // Of a ratio: the spread of black - index all, which is 0 on average.
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

/// The wavelength that glare is measured at where none is asked for, nm: near the peak of the eye's sensitivity.
#[must_use]
pub fn usual_wavelength_nm() -> f64 {
    lines::E.wavelength_nm
}
