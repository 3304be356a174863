//! Outlines: polygons around the light that passes.
//!
//! An outline is a fan of triangles about the middle of its zone, of nearly equal areas. There is one outline for each zone of angle,
//! depth, azimuth and wavelength. Two numbers of the unit square choose a triangle and a point in it by the concentric map. It maps equal
//! areas to equal areas and neighbors to neighbors, so strata stay strata.
//!
//! The last 0.3 % of the squared radius is stretched over a ring 2.5 % wide around the outline. Each triangle gets a share of the ring by
//! its area, so the ring is filled evenly even if triangles differ. Light that the outline missed is found there, at about 16 times the
//! weight, so the estimate has no bias.

use super::measure::whole;
use super::star_region::CORNERS;

/// Fraction of the rays that go to the outline itself, for rays aimed at all that passes ([`AimPart::Whole`](super::AimPart::Whole)).
pub(super) const INSIDE: f64 = 0.9969;
/// Width of the ring around the outline, as a fraction of the outline's radius.
pub(super) const RING: f64 = 0.025;
/// Number of entries of one outline: its corners, the first one twice, its motion and growth over its wavelength and depth zones, and
/// [`thin`].
pub(super) const STRIDE: usize = CORNERS + 5;
/// Number of steps of the azimuth's measure in [`Outlines::turns`].
pub(super) const TURN_STEPS: usize = 4096;

/// Computes the fraction of a triangle's numbers that go to the ring, per mm^2 of twice the triangle's area.
pub(super) fn thin(corners: &[[f32; 2]]) -> f32 {
    let doubled = corners.windows(2).map(|pair| {
        let ([ax, ay], [bx, by]) = (pair[0].map(f64::from), pair[1].map(f64::from));
        ax * by - ay * bx
    });
    let sum: f64 = doubled.sum();
    if sum > 0.0 { ((1.0 - INSIDE) * CORNERS as f64 / sum) as f32 } else { 0.0 }
}

/// The wavelength zones of a band. They are narrower where glass disperses more.
#[derive(Clone, Copy, Debug)]
pub(super) struct Colors {
    pub from_nm: f64,
    pub to_nm: f64,
    /// Number of zones.
    pub zones: usize,
}

impl Colors {
    /// Returns the wavelengths between zones, including the ends of the band, nm.
    pub fn nodes_nm(&self) -> Vec<f64> {
        let at = |k: usize| {
            // The root of x (1.6 - 0.6 x) = share.
            let share = k as f64 / self.zones as f64;
            let x = (1.6 - (2.56 - 2.4 * share).max(0.0).sqrt()) / 1.2;
            self.from_nm + x * (self.to_nm - self.from_nm)
        };
        if self.to_nm <= self.from_nm {
            return vec![self.from_nm];
        }
        (0..=self.zones).map(at).collect()
    }

    /// Returns the zone of a wavelength, nm.
    #[inline(always)]
    pub fn zone(&self, nm: f64) -> usize {
        whole(self.at(nm), (self.zones - 1) as f64)
    }

    /// Returns the position of a wavelength, in zones from the lower end of the band. Wavelengths outside the band count as its ends.
    #[inline(always)]
    pub fn at(&self, nm: f64) -> f64 {
        let x = (nm - self.from_nm) * (1.0 / (self.to_nm - self.from_nm));
        // A band of zero width has a zone, too.
        let x = if x > 0.0 { x } else { 0.0 };
        let x = if x < 1.0 { x } else { 1.0 };
        x * (1.6 - 0.6 * x) * self.zones as f64
    }
}

/// All outlines of a pupil table.
#[derive(Clone, Debug)]
pub(super) struct Outlines {
    pub colors: Colors,
    /// Number of zones of the angle.
    pub zones: usize,
    /// Number of zones of the azimuth.
    pub azimuths: usize,
    /// Zone of each step of the azimuth's measure; empty if the table itself has zones of the azimuth or there is only one.
    pub turns: Vec<u16>,
    /// Whether corners are given along x and y of the lens; otherwise along and across the plane of the point.
    pub turned: bool,
    /// The entries, by depth, azimuth, angle and wavelength. First come the corners about the middle of the zone, then the shifts from the
    /// lower to the upper end of its wavelengths and of its depths, along and across the plane of the point, mm. Then come the growths over
    /// both, as fractions, and [`thin`].
    pub corners: Vec<[f32; 2]>,
}

impl Outlines {
    /// Returns the outlines enlarged, so that everything inside may be moved by `margin_mm`.
    pub fn widened(mut self, margin_mm: f64) -> Self {
        for outline in self.corners.chunks_exact_mut(STRIDE) {
            // When an outline is scaled, each edge moves out in proportion to its distance from the center.
            let (outline, more) = outline.split_at_mut(CORNERS + 1);
            let nearest = outline.windows(2).filter_map(|pair| {
                let ([ax, ay], [bx, by]) = (pair[0].map(f64::from), pair[1].map(f64::from));
                let length = ((bx - ax) * (bx - ax) + (by - ay) * (by - ay)).sqrt();
                (length > 0.0).then(|| (ax * by - ay * bx) / length)
            });
            let nearest = nearest.fold(f64::INFINITY, f64::min);
            let by = if nearest > 0.0 && nearest.is_finite() { 1.0 + margin_mm / nearest } else { 1.0 };
            outline.iter_mut().flatten().for_each(|c| *c = (f64::from(*c) * by) as f32);
            more[STRIDE - CORNERS - 2][0] = thin(outline);
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zones_of_wavelength_begin_at_their_nodes() {
        let colors = Colors { from_nm: 350.0, to_nm: 830.0, zones: 4 };
        let nodes = colors.nodes_nm();
        assert!((nodes[0] - 350.0).abs() < 1e-9 && (nodes[4] - 830.0).abs() < 1e-9);
        for k in 0..4 {
            assert!(nodes[k + 1] - nodes[k] > 50.0);
            assert_eq!(colors.zone(nodes[k] + 0.01), k);
            assert_eq!(colors.zone(nodes[k + 1] - 0.01), k);
        }
        assert_eq!((colors.zone(0.0), colors.zone(1e4)), (0, 3));
        let one = Colors { from_nm: 550.0, to_nm: 550.0, zones: 1 };
        assert_eq!(one.zone(550.0), 0);
    }
}
