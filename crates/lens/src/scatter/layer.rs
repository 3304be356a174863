//! Layers of haze, dust or scratches on a surface, and how much light they leave.

use super::Lobe;
use crate::Aperture;

/// The kind of a layer on a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LayerKind {
    /// A film of fine droplets or grains that scatters light.
    Haze,
    /// Grains that stop and diffract light.
    Dust,
    /// Lines that stop and diffract light.
    Scratches,
}

impl LayerKind {
    /// Returns the key of this kind of layer in a lens file.
    #[must_use]
    pub fn key(self) -> &'static str {
        match self {
            Self::Haze => "haze",
            Self::Dust => "dust",
            Self::Scratches => "scratches",
        }
    }
}

/// One layer on a surface that stops and scatters light.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Kind of the layer: haze, dust or scratches.
    pub soil: LayerKind,
    /// Fraction of the light that the layer stops, at points where it lies.
    pub stopped: f64,
    /// Fraction of the light that the layer scatters, at points where it lies.
    pub scattered: f64,
    /// Where the layer lies: all over the surface if empty, otherwise where all of these apertures let light pass.
    pub places: Vec<Aperture>,
    /// Distribution of the steps by which the layer changes the direction of light.
    pub lobe: Lobe,
}

impl Layer {
    /// Density of the layer at a point of the surface, mm: 0 to 1.
    fn there(&self, x_mm: f64, y_mm: f64, semi_diameter_mm: Option<f64>) -> f64 {
        self.places.iter().map(|place| place.transmittance(x_mm, y_mm, semi_diameter_mm)).product()
    }
}

/// The fractions of light that the layers of a surface let through at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shares {
    /// Fraction of the light that no layer stops, whether or not it is scattered.
    pub open: f64,
    /// Fraction of the light that no layer stops or scatters.
    pub straight: f64,
}

impl Shares {
    /// Computes the fractions at a point of the surface (mm). `semi_diameter_mm` is the semi-diameter of the surface.
    pub fn at(layers: &[Layer], [x, y]: [f64; 2], semi_diameter_mm: Option<f64>) -> Self {
        let mut all = Self { open: 1.0, straight: 1.0 };
        for layer in layers {
            let there = layer.there(x, y, semi_diameter_mm);
            all.open *= 1.0 - layer.stopped * there;
            all.straight *= 1.0 - (layer.stopped + layer.scattered) * there;
        }
        all.straight = all.straight.max(0.0);
        all
    }

    /// Returns the largest fraction of light that these layers can scatter at any point.
    pub fn most_scattered(layers: &[Layer]) -> f64 {
        // Of two layers that stop light, one may leave less for the other to scatter.
        1.0 - layers.iter().map(|layer| 1.0 - layer.scattered).product::<f64>()
    }
}

/// Selects the layer that scatters a ray at a point of the surface (mm). `number` is a random number in [0, 1). Returns `None` if
/// no layer scatters there.
pub fn which(layers: &[Layer], [x, y]: [f64; 2], semi_diameter_mm: Option<f64>, number: f64) -> Option<&Layer> {
    let part = |layer: &Layer| layer.scattered * layer.there(x, y, semi_diameter_mm);
    let mut left = number * layers.iter().map(part).sum::<f64>();
    let mut last = None;
    for layer in layers {
        let own = part(layer);
        if own > 0.0 {
            last = Some(layer);
            if left < own {
                break;
            }
            left -= own;
        }
    }
    last
}
