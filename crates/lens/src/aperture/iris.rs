//! The opening between the blades of an iris.

use spectra_core::batch::Columns;
use spectra_core::isa::Vectorized;
use spectra_core::loss::ALIVE;
use spectra_core::math;

/// The blades of an iris that forms a stop.
///
/// The opening has one corner between each two blades; each side is an arc of the blade's radius, or straight. The opening is a
/// circle if the blade's radius equals the radius of the opening, as in most lenses wide open. Stopped down it becomes a polygon
/// with bulging sides. The semi-diameter of the stop is the radius of the circle of equal area, so an f-number means the same
/// amount of light whatever the blades.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Iris {
    /// Number of blades, at least 3.
    pub blades: u32,
    /// Radius of curvature of each blade's edge, mm; infinite for straight blades. A radius smaller than the opening counts as round.
    pub blade_radius_mm: f64,
    /// Rotation of the opening, in rad, counterclockwise seen with +x right and +y up. At 0 a corner lies on +y.
    pub rotation_rad: f64,
}

/// The opening of an iris at one size. Each edge of a blade lies on a circle, or on a line if blades are straight. The opening is
/// the area inside all of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Opening {
    /// Unit vectors from the center to the middle of each side.
    sides: Vec<[f64; 2]>,
    /// Center and radius of each side's arc, both in mm. The center is a distance along the side's unit vector, zero or negative.
    /// `None` if the sides are straight, at `apothem_mm`.
    arc: Option<(f64, f64)>,
    apothem_mm: f64,
    corner_mm: f64,
}

impl Iris {
    /// Returns the opening whose area equals the area of a circle with the radius `semi_diameter_mm`.
    #[must_use]
    pub fn opening(&self, semi_diameter_mm: f64) -> Opening {
        let corner_mm = self.corner_radius_mm(semi_diameter_mm);
        let half = std::f64::consts::PI / f64::from(self.blades);
        let sides = (0..self.blades).map(|k| {
            let a = self.rotation_rad + std::f64::consts::FRAC_PI_2 + half * f64::from(2 * k + 1);
            [math::cos(a), math::sin(a)]
        });
        let apothem_mm = corner_mm * math::cos(half);
        let arc = self.blade_radius_mm.is_finite().then(|| {
            let radius = self.blade_radius_mm.max(corner_mm);
            let chord = corner_mm * math::sin(half);
            (apothem_mm - (radius * radius - chord * chord).max(0.0).sqrt(), radius)
        });
        Opening { sides: sides.collect(), arc, apothem_mm, corner_mm }
    }

    /// Distance of the corners from the center, mm.
    fn corner_radius_mm(&self, semi_diameter_mm: f64) -> f64 {
        let want = std::f64::consts::PI * semi_diameter_mm * semi_diameter_mm;
        if self.blade_radius_mm <= semi_diameter_mm {
            return semi_diameter_mm;
        }
        // The triangle of three blades, the longest polygon, has its corners at 1.56 times the circle's radius.
        let (mut low, mut high) = (semi_diameter_mm, 1.6 * semi_diameter_mm);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.area_mm2(middle) < want {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }

    /// Area of the opening with its corners at this distance from the center, mm^2: a polygon, and a circular segment on each side.
    fn area_mm2(&self, corner_mm: f64) -> f64 {
        let n = f64::from(self.blades);
        let half = std::f64::consts::PI / n;
        let polygon = n * corner_mm * corner_mm * math::sin(half) * math::cos(half);
        if !self.blade_radius_mm.is_finite() {
            return polygon;
        }
        let radius = self.blade_radius_mm.max(corner_mm);
        let angle = 2.0 * math::asin((corner_mm * math::sin(half) / radius).min(1.0));
        polygon + n * 0.5 * radius * radius * (angle - math::sin(angle))
    }
}

impl Opening {
    /// Returns whether a point, x and y in mm from the center, lies in the opening.
    #[must_use]
    pub fn contains(&self, x_mm: f64, y_mm: f64) -> bool {
        if x_mm * x_mm + y_mm * y_mm > self.corner_mm * self.corner_mm {
            return false;
        }
        self.sides.iter().all(|[ex, ey]| match self.arc {
            Some((center, radius)) => {
                let (x, y) = (x_mm - center * ex, y_mm - center * ey);
                x * x + y * y <= radius * radius
            }
            None => x_mm * ex + y_mm * ey <= self.apothem_mm,
        })
    }

    /// Returns the edge of the opening as points (mm from its center), counterclockwise. Each side is cut into `pieces` pieces.
    #[must_use]
    pub fn outline(&self, pieces: u32) -> Vec<[f64; 2]> {
        let half = std::f64::consts::PI / self.sides.len() as f64;
        let mut outline = Vec::with_capacity(self.sides.len() * pieces as usize);
        for [ex, ey] in &self.sides {
            for i in 0..pieces {
                let part = f64::from(i) / f64::from(pieces) * 2.0 - 1.0;
                // Along the side's unit vector, and across it.
                let (along, across) = match self.arc {
                    Some((center, radius)) => {
                        let angle = part * math::asin((self.corner_mm * math::sin(half) / radius).min(1.0));
                        (center + radius * math::cos(angle), radius * math::sin(angle))
                    }
                    None => (self.apothem_mm, part * self.corner_mm * math::sin(half)),
                };
                outline.push([along * ex - across * ey, along * ey + across * ex]);
            }
        }
        outline
    }

    /// Distance of the corners of the opening from its center, mm.
    #[must_use]
    pub fn corner_radius_mm(&self) -> f64 {
        self.corner_mm
    }
}

/// Kernel that ends the rays that blades stop and returns their number.
pub(super) struct Blades<'a> {
    pub opening: &'a Opening,
    pub center_mm: [f64; 2],
    pub obscures: bool,
    /// State of a ray that ends.
    pub stopped: u64,
    pub columns: Columns<'a>,
}

/// Number of rays that are tested against one side at once.
const AT_ONCE: usize = 64;

impl Vectorized for Blades<'_> {
    type Output = usize;

    #[inline(always)]
    fn run(self) -> usize {
        let Self { opening, center_mm: [x0, y0], obscures, stopped, columns } = self;
        let passes = u64::from(!obscures);
        let mut ended = 0;
        let rays = columns.x.chunks(AT_ONCE).zip(columns.y.chunks(AT_ONCE));
        for ((x, y), state) in rays.zip(columns.state.chunks_mut(AT_ONCE)) {
            let inside = opening.contain(x, y, [x0, y0]);
            for (state, inside) in state.iter_mut().zip(inside) {
                let ends = *state == ALIVE && inside != passes;
                *state = if ends { stopped } else { *state };
                ended += usize::from(ends);
            }
        }
        ended
    }
}

impl Opening {
    /// Tests several points, at most [`AT_ONCE`], like [`Opening::contains`], relative to a center, mm: 1 for those inside, 0 for the
    /// others.
    #[inline(always)]
    fn contain(&self, x_mm: &[f64], y_mm: &[f64], [x0, y0]: [f64; 2]) -> [u64; AT_ONCE] {
        // If there are fewer points, the rest are at the center.
        let (mut x, mut y, mut inside) = ([0.0; AT_ONCE], [0.0; AT_ONCE], [1_u64; AT_ONCE]);
        x.iter_mut().zip(x_mm).for_each(|(own, x)| *own = x - x0);
        y.iter_mut().zip(y_mm).for_each(|(own, y)| *own = y - y0);
        let end2 = self.corner_mm * self.corner_mm;
        for k in 0..AT_ONCE {
            inside[k] &= u64::from(x[k] * x[k] + y[k] * y[k] <= end2);
        }
        for [ex, ey] in &self.sides {
            if let Some((center, radius)) = self.arc {
                let (cx, cy, radius2) = (center * ex, center * ey, radius * radius);
                for k in 0..AT_ONCE {
                    let (x, y) = (x[k] - cx, y[k] - cy);
                    inside[k] &= u64::from(x * x + y * y <= radius2);
                }
            } else {
                for k in 0..AT_ONCE {
                    inside[k] &= u64::from(x[k] * ex + y[k] * ey <= self.apothem_mm);
                }
            }
        }
        inside
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(opening: &Opening, half_mm: f64) -> f64 {
        let n = 1000;
        let at = |i: usize| ((i as f64 + 0.5) / f64::from(n) * 2.0 - 1.0) * half_mm;
        let inside = (0..n * n).filter(|k| opening.contains(at((k % n) as usize), at((k / n) as usize))).count();
        inside as f64 / f64::from(n * n) * 4.0 * half_mm * half_mm
    }

    /// Counting points, the area of the opening equals that of the stop's circle, whatever the blades.
    #[test]
    fn the_area_is_the_circles() {
        for blades in [3, 5, 6, 9, 15] {
            for blade_radius_mm in [5.0, 6.0, 20.0, f64::INFINITY] {
                let iris = Iris { blades, blade_radius_mm, rotation_rad: 0.3 };
                let opening = iris.opening(5.0);
                let want = std::f64::consts::PI * 25.0;
                let got = area(&opening, 8.5);
                assert!((got / want - 1.0).abs() < 2e-3, "{iris:?}: {got} {want}");
            }
        }
    }

    /// The outline runs along the edge of the opening.
    #[test]
    fn the_outline_is_the_edge() {
        for blade_radius_mm in [5.0, 7.0, f64::INFINITY] {
            let opening = Iris { blades: 7, blade_radius_mm, rotation_rad: 0.3 }.opening(5.0);
            let outline = opening.outline(5);
            assert_eq!(outline.len(), 35);
            let mut twice = 0.0;
            for (a, b) in outline.iter().zip(outline.iter().cycle().skip(1)) {
                let by = |part: f64| opening.contains(a[0] * part, a[1] * part);
                assert!(by(1.0 - 1e-9) && !by(1.0 + 1e-9), "{blade_radius_mm}: {a:?}");
                twice += a[0] * b[1] - a[1] * b[0];
            }
            assert!((0.5 * twice / (std::f64::consts::PI * 25.0) - 1.0).abs() < 6e-3, "{twice}");
        }
    }

    /// Testing many points at once gives the same result as testing each alone.
    #[test]
    fn points_are_held_at_once_as_alone() {
        for blade_radius_mm in [5.0, 7.0, f64::INFINITY] {
            let opening = Iris { blades: 7, blade_radius_mm, rotation_rad: 0.3 }.opening(5.0);
            let at = |i: usize| (i as f64 + 0.5) / 40.0 * 12.0 - 6.0;
            let (x, y): (Vec<f64>, Vec<f64>) = (0..1600).map(|k| (at(k % 40), at(k / 40))).unzip();
            let center = [0.5, -0.25];
            let parts = x.chunks(AT_ONCE - 5).zip(y.chunks(AT_ONCE - 5));
            let many = parts.flat_map(|(x, y)| opening.contain(x, y, center).into_iter().take(x.len()));
            let alone = x.iter().zip(&y).map(|(x, y)| u64::from(opening.contains(x - center[0], y - center[1])));
            let (many, alone): (Vec<u64>, Vec<u64>) = (many.collect(), alone.collect());
            assert_eq!(many, alone);
            assert!(many.iter().sum::<u64>() > 300);
        }
    }

    /// Blades with the radius of the opening make a circle; straight blades make a regular polygon with a corner on +y.
    #[test]
    fn round_wide_open_and_straight_when_it_should() {
        let round = Iris { blades: 6, blade_radius_mm: 5.0, rotation_rad: 0.0 }.opening(5.0);
        for k in 0..100 {
            let a = std::f64::consts::TAU * f64::from(k) / 100.0;
            let (x, y) = (math::cos(a), math::sin(a));
            assert!(round.contains(4.999 * x, 4.999 * y) && !round.contains(5.001 * x, 5.001 * y));
        }
        let straight = Iris { blades: 6, blade_radius_mm: f64::INFINITY, rotation_rad: 0.0 }.opening(5.0);
        // A hexagon of side a has the area 3 sqrt(3) / 2 a^2, and its corners at a.
        let a = (std::f64::consts::PI * 25.0 / (1.5 * 3.0_f64.sqrt())).sqrt();
        assert!((straight.corner_radius_mm() - a).abs() < 1e-9);
        assert!(straight.contains(0.0, a * 0.9999) && !straight.contains(a * 0.9, 0.0));
    }
}
