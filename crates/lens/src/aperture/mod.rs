//! What limits the light at a surface besides its round rim: rectangles, polygons, the blades of an iris, masks.
//!
//! An aperture is flat: it looks at x and y of the point where the light meets its surface, in the surface's frame.

mod iris;
mod mask;
mod params;

pub use iris::{Iris, Opening};
pub use mask::Mask;
pub(crate) use params::ApertureKeys;
pub use params::{ApertureEntry, ApertureForm, read};

use iris::Blades;
use spectra_core::loss::{ALIVE, Loss};
use spectra_core::{Isa, RayBatch};
use spectra_masks::Drawing;

/// Limits the light at a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Aperture {
    /// Its form.
    pub shape: Shape,
    /// Its center in the frame of the surface, mm.
    pub center_mm: [f64; 2],
    /// Whether it stops what falls inside of it, in place of what falls outside.
    pub obscures: bool,
}

/// Form of an aperture, about its center.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Between two circles; `inner_mm` may be 0, `outer_mm` infinite.
    Ring {
        /// Inner radius, mm.
        inner_mm: f64,
        /// Outer radius, mm.
        outer_mm: f64,
    },
    /// A rectangle along x and y.
    Rectangle {
        /// Half its width, mm.
        half_width_mm: f64,
        /// Half its height, mm.
        half_height_mm: f64,
    },
    /// An ellipse along x and y.
    Ellipse {
        /// Half its width, mm.
        half_width_mm: f64,
        /// Half its height, mm.
        half_height_mm: f64,
    },
    /// A polygon, by the even-odd rule: corners in order, mm.
    Polygon(Vec<[f64; 2]>),
    /// The blades of a stop; sized by the surface's semi-diameter.
    Iris(Iris),
    /// A picture: white passes, black stops, gray passes in part.
    Mask(Mask),
    /// A drawing: outlines that pass.
    Drawing(Drawing),
}

impl Aperture {
    /// The part of the light that passes at a point of the surface, mm: 0 or 1, between them for a gray mask.
    /// `semi_diameter_mm` is the surface's, which sizes an iris.
    #[must_use]
    pub fn transmittance(&self, x_mm: f64, y_mm: f64, semi_diameter_mm: Option<f64>) -> f64 {
        let (x, y) = (x_mm - self.center_mm[0], y_mm - self.center_mm[1]);
        let inside = match &self.shape {
            Shape::Ring { inner_mm, outer_mm } => {
                let r2 = x * x + y * y;
                f64::from(r2 >= inner_mm * inner_mm && r2 <= outer_mm * outer_mm)
            }
            Shape::Rectangle { half_width_mm, half_height_mm } => {
                f64::from(x.abs() <= *half_width_mm && y.abs() <= *half_height_mm)
            }
            Shape::Ellipse { half_width_mm, half_height_mm } => {
                let (a, b) = (x / half_width_mm, y / half_height_mm);
                f64::from(a * a + b * b <= 1.0)
            }
            Shape::Polygon(corners) => f64::from(is_inside(corners, x, y)),
            Shape::Iris(iris) => f64::from(semi_diameter_mm.is_none_or(|size| iris.opening(size).contains(x, y))),
            Shape::Mask(mask) => mask.transmittance(x, y),
            Shape::Drawing(drawing) => drawing.transmittance(x, y),
        };
        if self.obscures { 1.0 - inside } else { inside }
    }

    /// Whether it looks the same from all azimuths.
    #[must_use]
    pub fn is_round(&self) -> bool {
        self.center_mm == [0.0; 2] && matches!(self.shape, Shape::Ring { .. })
    }

    /// Its edge in the frame of the surface as closed rings, outer ones counter-clockwise and holes clockwise, with curves and sides in
    /// some `pieces` each. `None` for what has no edge (a gray mask) or one that is not closed within itself.
    #[must_use]
    pub fn rings(&self, semi_diameter_mm: Option<f64>, pieces: u32) -> Option<Vec<Vec<[f64; 2]>>> {
        let around = |a: f64, b: f64| -> Vec<[f64; 2]> {
            let count = 24 * pieces;
            (0..count)
                .map(|i| {
                    let (sin, cos) = spectra_core::math::sin_cos_turns(f64::from(i) / f64::from(count));
                    [a * cos, b * sin]
                })
                .collect()
        };
        let cut = |corners: &[[f64; 2]]| -> Vec<[f64; 2]> {
            let sides = corners.iter().zip(corners.iter().cycle().skip(1));
            sides
                .flat_map(|(a, b)| {
                    (0..pieces).map(move |i| [0, 1].map(|k| a[k] + (b[k] - a[k]) * f64::from(i) / f64::from(pieces)))
                })
                .collect()
        };
        let mut rings = match &self.shape {
            Shape::Ring { inner_mm, outer_mm } => {
                let mut rings = vec![around(*outer_mm, *outer_mm)];
                if *inner_mm > 0.0 {
                    rings.push(around(*inner_mm, *inner_mm).into_iter().rev().collect());
                }
                rings
            }
            Shape::Rectangle { half_width_mm: a, half_height_mm: b } => {
                vec![cut(&[[-a, -b], [*a, -b], [*a, *b], [-a, *b]])]
            }
            Shape::Ellipse { half_width_mm, half_height_mm } => vec![around(*half_width_mm, *half_height_mm)],
            Shape::Polygon(corners) => {
                let twice: f64 =
                    corners.iter().zip(corners.iter().cycle().skip(1)).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum();
                let mut ring = cut(corners);
                if twice < 0.0 {
                    ring.reverse();
                }
                vec![ring]
            }
            Shape::Iris(iris) => vec![iris.opening(semi_diameter_mm?).outline(2 * pieces)],
            Shape::Drawing(drawing) => drawing.rings()?,
            Shape::Mask(_) => return None,
        };
        if rings.iter().flatten().flatten().any(|v| !v.is_finite()) {
            return None;
        }
        for ring in &mut rings {
            ring.iter_mut().for_each(|p| (0..2).for_each(|k| p[k] += self.center_mm[k]));
            if self.obscures {
                ring.reverse();
            }
        }
        Some(rings)
    }

    /// Radius about the vertex outside of which nothing passes, mm.
    #[must_use]
    pub fn reach_mm(&self) -> f64 {
        if self.obscures {
            return f64::INFINITY;
        }
        let [x, y] = self.center_mm;
        let reach = match &self.shape {
            Shape::Ring { outer_mm, .. } => *outer_mm,
            Shape::Rectangle { half_width_mm: a, half_height_mm: b } => (a * a + b * b).sqrt(),
            Shape::Ellipse { half_width_mm, half_height_mm } => half_width_mm.max(*half_height_mm),
            Shape::Polygon(corners) => corners.iter().map(|[x, y]| (x * x + y * y).sqrt()).fold(0.0, f64::max),
            Shape::Iris(_) => f64::INFINITY,
            Shape::Mask(mask) => mask.reach_mm(),
            Shape::Drawing(drawing) => drawing.reach_mm(),
        };
        reach + (x * x + y * y).sqrt()
    }

    /// What the blades leave open, if it is an iris of a surface of this size.
    pub(crate) fn opening(&self, semi_diameter_mm: Option<f64>) -> Option<Opening> {
        match &self.shape {
            Shape::Iris(iris) => semi_diameter_mm.map(|size| iris.opening(size)),
            _ => None,
        }
    }

    /// Ends the living rays of the batch, in the frame of the surface, that it stops, and weighs the others. Returns
    /// how many ended.
    pub(crate) fn clip(&self, rays: &mut RayBatch, number: u32, semi_diameter_mm: Option<f64>) -> usize {
        let stopped = Loss::Vignetted.state(number);
        let c = rays.columns_mut();
        let mut ended = 0;
        for i in 0..c.x.len() {
            if c.state[i] != ALIVE {
                continue;
            }
            let passes = self.transmittance(c.x[i], c.y[i], semi_diameter_mm);
            if passes > 0.0 {
                c.weight[i] *= passes;
            } else {
                c.state[i] = stopped;
                ended += 1;
            }
        }
        ended
    }

    /// The same by what its blades leave open.
    pub(crate) fn clip_by(&self, opening: &Opening, rays: &mut RayBatch, number: u32, isa: Isa) -> usize {
        let Self { center_mm, obscures, .. } = *self;
        let stopped = Loss::Vignetted.state(number);
        isa.run(Blades { opening, center_mm, obscures, stopped, columns: rays.columns_mut() })
    }
}

/// Even-odd rule (M. Shimrat, "Algorithm 112", Comm. ACM 5, 1962).
fn is_inside(corners: &[[f64; 2]], x: f64, y: f64) -> bool {
    let mut inside = false;
    let mut before = corners.len() - 1;
    for (at, [cx, cy]) in corners.iter().enumerate() {
        let [bx, by] = corners[before];
        if (*cy > y) != (by > y) && x < (bx - cx) * (y - cy) / (by - cy) + cx {
            inside = !inside;
        }
        before = at;
    }
    inside
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::math;

    /// The share of a square of points that passes is the share of the area, within three standard errors.
    fn share(aperture: &Aperture, half_mm: f64) -> f64 {
        let n = 400;
        let at = |i: usize| ((i as f64 + 0.5) / n as f64 * 2.0 - 1.0) * half_mm;
        let passed: f64 = (0..n * n).map(|k| aperture.transmittance(at(k % n), at(k / n), Some(5.0))).sum::<f64>();
        passed / (n * n) as f64 * 4.0 * half_mm * half_mm
    }

    #[test]
    fn areas_are_those_of_geometry() {
        let pi = std::f64::consts::PI;
        let cases = [
            (Shape::Ring { inner_mm: 2.0, outer_mm: 5.0 }, pi * 21.0),
            (Shape::Rectangle { half_width_mm: 3.0, half_height_mm: 1.5 }, 18.0),
            (Shape::Ellipse { half_width_mm: 3.0, half_height_mm: 1.5 }, pi * 4.5),
            (Shape::Polygon(vec![[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]]), 6.0),
        ];
        for (shape, area) in cases {
            let mut aperture = Aperture { shape, center_mm: [0.5, -0.25], obscures: false };
            let got = share(&aperture, 6.0);
            assert!((got / area - 1.0).abs() < 0.01, "{aperture:?}: {got} {area}");
            aperture.obscures = true;
            assert!((share(&aperture, 6.0) + got - 144.0).abs() < 1e-9);
            assert_eq!(aperture.reach_mm(), f64::INFINITY);
        }
    }

    #[test]
    fn a_star_is_even_odd() {
        // A pentagram drawn in one line: its middle is crossed twice.
        let tip = |k: usize| {
            let a = std::f64::consts::TAU * (k as f64 * 2.0 / 5.0 + 0.25);
            [math::cos(a), math::sin(a)]
        };
        let star: Vec<_> = (0..5).map(tip).collect();
        assert!(!is_inside(&star, 0.0, 0.0) && is_inside(&star, 0.0, 0.7) && !is_inside(&star, 0.0, -0.7));
    }
}
