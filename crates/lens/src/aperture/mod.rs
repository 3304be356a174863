//! Apertures that limit the light at a surface besides its round rim: rectangles, polygons, the blades of an iris, masks.
//!
//! An aperture is flat: it looks only at x and y of the point where light meets its surface, in the frame of the surface.

mod iris;
mod mask;
mod params;

pub use iris::{Iris, Opening};
pub use mask::Mask;
pub(crate) use params::ApertureKeys;
pub use params::{ApertureEntry, ApertureForm, read};

use iris::Blades;
use spectra_core::RayBatch;
use spectra_core::loss::{ALIVE, Loss};
use spectra_masks::Drawing;

/// An aperture that limits the light at a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Aperture {
    /// Shape of the aperture.
    pub shape: ApertureShape,
    /// Center of the aperture in the frame of the surface, mm.
    pub center_mm: [f64; 2],
    /// Whether the aperture stops light inside its shape. If false, it stops light outside its shape.
    pub obscures: bool,
}

/// The shape of an aperture, relative to the aperture's center.
#[derive(Clone, Debug, PartialEq)]
pub enum ApertureShape {
    /// The area between two circles; `inner_mm` may be 0, `outer_mm` infinite.
    Ring {
        /// Inner radius, mm.
        inner_mm: f64,
        /// Outer radius, mm.
        outer_mm: f64,
    },
    /// A rectangle along x and y.
    Rectangle {
        /// Half the width of the rectangle, mm.
        half_width_mm: f64,
        /// Half the height of the rectangle, mm.
        half_height_mm: f64,
    },
    /// An ellipse along x and y.
    Ellipse {
        /// Half the width of the ellipse, mm.
        half_width_mm: f64,
        /// Half the height of the ellipse, mm.
        half_height_mm: f64,
    },
    /// A polygon, filled by the even-odd rule: corners in order, mm.
    Polygon(Vec<[f64; 2]>),
    /// The opening between the blades of a stop, sized by the surface's semi-diameter.
    Iris(Iris),
    /// A picture: white passes light, black stops it, gray passes a part.
    Mask(Mask),
    /// A drawing whose outlines pass light.
    Drawing(Drawing),
}

impl Aperture {
    /// Returns the fraction of the light that passes at a point of the surface (mm): 0 or 1, or a value between for a gray mask.
    /// `semi_diameter_mm`, the semi-diameter of the surface, sets the size of an iris.
    #[must_use]
    pub fn transmittance(&self, x_mm: f64, y_mm: f64, semi_diameter_mm: Option<f64>) -> f64 {
        let (x, y) = (x_mm - self.center_mm[0], y_mm - self.center_mm[1]);
        let inside = match &self.shape {
            ApertureShape::Ring { inner_mm, outer_mm } => {
                let r2 = x * x + y * y;
                f64::from(r2 >= inner_mm * inner_mm && r2 <= outer_mm * outer_mm)
            }
            ApertureShape::Rectangle { half_width_mm, half_height_mm } => {
                f64::from(x.abs() <= *half_width_mm && y.abs() <= *half_height_mm)
            }
            ApertureShape::Ellipse { half_width_mm, half_height_mm } => {
                let (a, b) = (x / half_width_mm, y / half_height_mm);
                f64::from(a * a + b * b <= 1.0)
            }
            ApertureShape::Polygon(corners) => f64::from(is_inside(corners, x, y)),
            ApertureShape::Iris(iris) => {
                f64::from(semi_diameter_mm.is_none_or(|size| iris.opening(size).contains(x, y)))
            }
            ApertureShape::Mask(mask) => mask.transmittance(x, y),
            ApertureShape::Drawing(drawing) => drawing.transmittance(x, y),
        };
        if self.obscures { 1.0 - inside } else { inside }
    }

    /// Returns whether the aperture is symmetric about the axis.
    #[must_use]
    pub fn is_round(&self) -> bool {
        self.center_mm == [0.0; 2] && matches!(self.shape, ApertureShape::Ring { .. })
    }

    /// Returns the edge of the aperture as closed rings (mm, frame of the surface): outer rings counterclockwise, holes
    /// clockwise. `semi_diameter_mm`, the semi-diameter of the surface, is needed only for an iris. Each side, or each 24th of a
    /// circle, is cut into `pieces`; each side of an iris into twice as many; a drawing keeps its own corners. Returns `None` for
    /// a gray mask, for an iris without a semi-diameter, and for an edge that is not closed or not finite.
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
            ApertureShape::Ring { inner_mm, outer_mm } => {
                let mut rings = vec![around(*outer_mm, *outer_mm)];
                if *inner_mm > 0.0 {
                    rings.push(around(*inner_mm, *inner_mm).into_iter().rev().collect());
                }
                rings
            }
            ApertureShape::Rectangle { half_width_mm: a, half_height_mm: b } => {
                vec![cut(&[[-a, -b], [*a, -b], [*a, *b], [-a, *b]])]
            }
            ApertureShape::Ellipse { half_width_mm, half_height_mm } => vec![around(*half_width_mm, *half_height_mm)],
            ApertureShape::Polygon(corners) => {
                let twice: f64 =
                    corners.iter().zip(corners.iter().cycle().skip(1)).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum();
                let mut ring = cut(corners);
                if twice < 0.0 {
                    ring.reverse();
                }
                vec![ring]
            }
            ApertureShape::Iris(iris) => vec![iris.opening(semi_diameter_mm?).outline(2 * pieces)],
            ApertureShape::Drawing(drawing) => drawing.rings()?,
            ApertureShape::Mask(_) => return None,
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

    /// Radius about the vertex outside which no light passes, mm; infinite if the aperture obscures or is an iris.
    #[must_use]
    pub fn reach_mm(&self) -> f64 {
        if self.obscures {
            return f64::INFINITY;
        }
        let [x, y] = self.center_mm;
        let reach = match &self.shape {
            ApertureShape::Ring { outer_mm, .. } => *outer_mm,
            ApertureShape::Rectangle { half_width_mm: a, half_height_mm: b } => (a * a + b * b).sqrt(),
            ApertureShape::Ellipse { half_width_mm, half_height_mm } => half_width_mm.max(*half_height_mm),
            ApertureShape::Polygon(corners) => corners.iter().map(|[x, y]| (x * x + y * y).sqrt()).fold(0.0, f64::max),
            ApertureShape::Iris(_) => f64::INFINITY,
            ApertureShape::Mask(mask) => mask.reach_mm(),
            ApertureShape::Drawing(drawing) => drawing.reach_mm(),
        };
        reach + (x * x + y * y).sqrt()
    }

    /// Returns the opening between the blades. `None` unless the aperture is an iris and the semi-diameter of the surface (mm) is
    /// given.
    pub fn opening(&self, semi_diameter_mm: Option<f64>) -> Option<Opening> {
        match &self.shape {
            ApertureShape::Iris(iris) => semi_diameter_mm.map(|size| iris.opening(size)),
            _ => None,
        }
    }

    /// Ends the live rays of the batch that the aperture stops, and multiplies the weights of the others by its transmittance.
    /// The rays are in the frame of the surface. `number` is the number of the surface, recorded in rays that end. Returns how
    /// many ended.
    pub fn clip(&self, rays: &mut RayBatch, number: u32, semi_diameter_mm: Option<f64>) -> usize {
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

    /// Ends the live rays of the batch that miss the opening of an iris, like [`Aperture::clip`]. `opening` comes from
    /// [`Aperture::opening`]. Returns how many ended.
    pub fn clip_by(&self, opening: &Opening, rays: &mut RayBatch, number: u32) -> usize {
        let isa = rays.isa();
        let Self { center_mm, obscures, .. } = *self;
        let stopped = Loss::Vignetted.state(number);
        isa.run(Blades { opening, center_mm, obscures, stopped, columns: rays.columns_mut() })
    }
}

/// Tells by the even-odd rule whether a point lies inside a polygon (M. Shimrat, "Algorithm 112", Comm. ACM 5, 1962).
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

    /// Returns the area that passes, mm^2, counted on a square grid of points.
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
            (ApertureShape::Ring { inner_mm: 2.0, outer_mm: 5.0 }, pi * 21.0),
            (ApertureShape::Rectangle { half_width_mm: 3.0, half_height_mm: 1.5 }, 18.0),
            (ApertureShape::Ellipse { half_width_mm: 3.0, half_height_mm: 1.5 }, pi * 4.5),
            (ApertureShape::Polygon(vec![[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]]), 6.0),
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
