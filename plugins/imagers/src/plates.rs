//! Plane-parallel plates in front of a frame: cover glass, filters, and crystals that split every point in two.
//!
//! A plate shifts a ray sideways without changing its direction. With a plate of thickness t the ray lands
//! t (tan i - tan i') closer to the normal, with i' from Snell's law. Gaps between plates change nothing. Near the axis this
//! shifts the focus by t (1 - 1/n) away from the lens.
//!
//! A uniaxial crystal cut at 45 degrees to its axis shifts half of unpolarized light, the extraordinary ray, sideways by
//! t (ne^2 - no^2) / (ne^2 + no^2) (M. Born, E. Wolf, Principles of Optics, 15.3). The light behind it is treated as
//! unpolarized again, as it is behind the quarter-wave plate between two such plates in a camera. Two plates therefore make
//! four points.

use glam::{DVec2, DVec3};
use spectra_core::cover::{CoverPlate, CoverStack};
use spectra_core::numbers::RayNumbers;
use spectra_core::spectral::Grid;
use spectra_glass::Medium;

/// A plane-parallel plate of glass or crystal.
#[derive(Clone, Debug, PartialEq)]
pub struct Plate {
    thickness_mm: f64,
    /// Refractive index on the grid of the band; of the ordinary ray in a crystal.
    index: Vec<f64>,
    transmittance: Vec<f64>,
    /// Sideways shift of the extraordinary ray, in mm, at each wavelength of the grid. Empty for glass.
    separation_mm: Vec<f64>,
    azimuth: DVec2,
}

impl Plate {
    /// Creates a plate of the glass `medium`, `thickness_mm` thick, with the absorption of this glass. `filter` is a further
    /// transmittance as a function of the wavelength in nm. `grid` holds the wavelengths at which the plate is tabulated.
    #[must_use]
    pub fn glass(medium: &Medium, thickness_mm: f64, filter: impl Fn(f64) -> f64, grid: &Grid) -> Self {
        let passed = |w: f64| medium.internal_transmittance(w, thickness_mm).unwrap_or(1.0) * filter(w);
        Self {
            thickness_mm,
            index: grid.wavelengths_nm().map(|w| medium.index(w)).collect(),
            transmittance: grid.wavelengths_nm().map(passed).collect(),
            separation_mm: Vec::new(),
            azimuth: DVec2::X,
        }
    }

    /// Creates a plate of a uniaxial crystal whose optic axis is at 45 degrees to the plate. `ordinary` and `extraordinary` are
    /// media with its two indices. The extraordinary ray is shifted toward `azimuth_rad`, measured from the frame's +x.
    #[must_use]
    pub fn crystal(
        ordinary: &Medium,
        extraordinary: &Medium,
        thickness_mm: f64,
        azimuth_rad: f64,
        grid: &Grid,
    ) -> Self {
        let separation = |w: f64| {
            let (o, e) = (ordinary.index(w), extraordinary.index(w));
            thickness_mm * (e * e - o * o) / (e * e + o * o)
        };
        Self {
            separation_mm: grid.wavelengths_nm().map(separation).collect(),
            azimuth: DVec2::new(spectra_core::math::cos(azimuth_rad), spectra_core::math::sin(azimuth_rad)),
            ..Self::glass(ordinary, thickness_mm, |_| 1.0, grid)
        }
    }
}

/// Number of crystals whose branches are chosen by the digits of one random number; it has far more digits.
const PLATES_A_NUMBER: u32 = 16;

/// A stack of plates in front of a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Plates {
    grid: Grid,
    plates: Vec<Plate>,
}

impl Plates {
    /// Creates a stack from plates in any order, on the grid for which they were made.
    #[must_use]
    pub fn new(grid: &Grid, plates: Vec<Plate>) -> Self {
        Self { grid: *grid, plates }
    }

    /// Returns whether the stack has no plates.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.plates.is_empty()
    }

    /// Returns whether a plate splits points, which needs random numbers.
    #[must_use]
    pub fn splits(&self) -> bool {
        self.plates.iter().any(|plate| !plate.separation_mm.is_empty())
    }

    /// Returns how far the plates make the frame appear shifted toward the lens, in mm, near the axis and in the middle of the
    /// band.
    #[must_use]
    pub fn lift_mm(&self) -> f64 {
        self.plates.iter().map(|p| p.thickness_mm * (1.0 - 1.0 / p.index[p.index.len() / 2])).sum()
    }

    /// Returns the stack for focusing. The extraordinary rays of crystals count as ordinary ones: they form a second image that
    /// is shifted sideways but equally sharp.
    #[must_use]
    pub fn cover(&self) -> CoverStack {
        let plate = |p: &Plate| CoverPlate { thickness_mm: p.thickness_mm, index: p.index.clone() };
        CoverStack::new(&self.grid, self.plates.iter().map(plate).collect())
    }

    /// Passes a ray through the stack. `way` is its unit direction in the axes of the frame, with z away from the lens.
    ///
    /// Returns the vector (mm) from the point that the ray would reach without plates to the point where it lands, and the
    /// fraction of its light that passes. `numbers` choose between the ordinary and the extraordinary ray of each crystal;
    /// without them, the ordinary ray is followed.
    #[must_use]
    pub fn pass(&self, way: DVec3, wavelength_nm: f64, numbers: Option<RayNumbers>) -> (DVec2, f64) {
        let sideways = DVec2::new(way.x, way.y);
        let sin2 = sideways.length_squared();
        let numbers = numbers.filter(|_| self.splits());
        let (mut crystals, mut choice) = (0, 0.0);
        let (mut beside, mut passed) = (DVec2::ZERO, 1.0);
        for plate in &self.plates {
            let index = self.grid.interpolate(&plate.index, wavelength_nm).max(1.0);
            beside -= sideways * (plate.thickness_mm * (1.0 / way.z - 1.0 / (index * index - sin2).sqrt()));
            passed *= self.grid.interpolate(&plate.transmittance, wavelength_nm);
            if !plate.separation_mm.is_empty() {
                // Half of the light takes either branch. The binary digits of one number choose for several plates, so that
                // all combinations are equally frequent.
                if crystals % PLATES_A_NUMBER == 0 {
                    choice = numbers.map_or(0.0, |numbers| numbers.number(crystals / PLATES_A_NUMBER));
                }
                choice *= 2.0;
                if choice >= 1.0 {
                    choice -= 1.0;
                    beside += plate.azimuth * self.grid.interpolate(&plate.separation_mm, wavelength_nm);
                }
                crystals += 1;
            }
        }
        (beside, passed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::RayBatch;
    use spectra_core::numbers::Numbers;
    use spectra_core::spectral::BAND;
    use spectra_glass::Catalog;

    fn medium(name: &str) -> Medium {
        Catalog::bundled().medium(name).expect("bundled")
    }

    /// 2 mm of N-BK7 shift the focus of a cone by t (1 - 1/n), 0.6815 mm at the d line (n = 1.51680, SCHOTT). A steep ray
    /// lands where Snell's law at each surface says.
    #[test]
    fn cover_glass_shifts_the_focus() {
        let plates = Plates::new(&BAND, vec![Plate::glass(&medium("SCHOTT/N-BK7"), 2.0, |_| 1.0, &BAND)]);
        let nm = 587.5618;
        let slope = 1e-4_f64;
        let way = DVec3::new(slope, 0.0, 1.0).normalize();
        let (beside, passed) = plates.pass(way, nm, None);
        assert!((-beside.x / slope - 2.0 * (1.0 - 1.0 / 1.5168)).abs() < 2e-5, "{}", -beside.x / slope);
        assert!(beside.y == 0.0 && passed > 0.99 && passed <= 1.0, "{passed}");
        assert!((plates.lift_mm() - 0.6815).abs() < 2e-3, "{}", plates.lift_mm());
        let angle = 0.7_f64;
        let inside = libm::asin(libm::sin(angle) / 1.51680);
        let (beside, _) = plates.pass(DVec3::new(0.0, -libm::sin(angle), libm::cos(angle)), nm, None);
        let want = 2.0 * (libm::tan(angle) - libm::tan(inside));
        assert!((beside.y - want).abs() < 2e-5, "{} {want}", beside.y);
        // The stack for focusing gives the same values.
        let cover = plates.cover();
        assert!((cover.shift_mm(nm) + beside_of(&plates, 1e-4, nm) / 1e-4).abs() < 1e-8);
        assert!((cover.depth_mm(0.8, nm) + beside_of(&plates, 0.8, nm) / 0.8).abs() < 1e-13);
    }

    fn beside_of(plates: &Plates, slope: f64, nm: f64) -> f64 {
        plates.pass(DVec3::new(slope, 0.0, 1.0).normalize(), nm, None).0.x
    }

    /// The shifts of two plates add.
    #[test]
    fn plates_add() {
        let plate = |t: f64| Plate::glass(&medium("SCHOTT/N-BK7"), t, |_| 0.9, &BAND);
        let way = DVec3::new(0.3, 0.2, 1.0).normalize();
        let (two, passed) = Plates::new(&BAND, vec![plate(0.5), plate(0.8)]).pass(way, 500.0, None);
        let (one, _) = Plates::new(&BAND, vec![plate(1.3)]).pass(way, 500.0, None);
        assert!((two - one).length() < 1e-15 && (passed - 0.81).abs() < 0.01, "{two} {one} {passed}");
    }

    /// Quartz at 589 nm has no = 1.54424 and ne = 1.55335, so it splits by 0.005881 of its thickness. One plate makes two
    /// points of equal strength, two crossed plates four: of 2^n samples each point gets exactly its share. Without random
    /// numbers all light is ordinary.
    #[test]
    fn crystals_split_points() {
        let (o, e) = (medium("SiO2/Ghosh-o"), medium("SiO2/Ghosh-e"));
        let quartz = |azimuth: f64| Plate::crystal(&o, &e, 1.5, azimuth, &BAND);
        let n = 1 << 10;
        let mut rays = RayBatch::new(n).with_numbers();
        rays.restart(n);
        rays.number(0, &Numbers::sobol(1), "backward", 0, 0);
        let c = rays.columns_mut();
        for (plates, points) in [(vec![quartz(0.0)], 2), (vec![quartz(0.0), quartz(std::f64::consts::FRAC_PI_2)], 4)] {
            let plates = Plates::new(&BAND, plates);
            let mut counts = std::collections::BTreeMap::new();
            for i in 0..n {
                // Nearly straight on: refraction moves such rays by less than 0.01 um.
                let way = DVec3::new(1e-9 * i as f64, 0.0, 1.0).normalize();
                assert!(plates.pass(way, 589.3, None).0.length() < 1e-5);
                let (beside, _) = plates.pass(way, 589.3, c.numbers.of(i));
                let key = [beside.x, beside.y].map(|v| (v * 1e6).round() as i64);
                *counts.entry(key).or_insert(0_u32) += 1;
            }
            let places: Vec<_> = counts.keys().copied().collect();
            let near = |v: i64| v.abs() <= 30 || (v as f64 / 1e6 / (0.005_881 * 1.5) - 1.0).abs() < 0.01;
            let clusters: std::collections::BTreeSet<_> = places.iter().map(|p| p.map(|v| v.abs() > 30)).collect();
            assert!(places.iter().all(|p| p.iter().all(|v| near(*v))), "{places:?}");
            assert_eq!(clusters.len(), points);
            for cluster in clusters {
                let many: u32 = counts.iter().filter(|(p, _)| p.map(|v| v.abs() > 30) == cluster).map(|(_, c)| c).sum();
                assert_eq!(many as usize, n / points, "{cluster:?}");
            }
        }
    }
}
