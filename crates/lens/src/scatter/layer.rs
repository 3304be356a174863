//! What lies on a surface, and what it leaves of light.

use super::Lobe;
use crate::Aperture;

/// What lies on a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Soil {
    /// A film of fine droplets or grains.
    Haze,
    /// Grains that stop light.
    Dust,
    /// Lines that stop light.
    Scratches,
}

impl Soil {
    /// Its key in a lens file.
    #[must_use]
    pub fn key(self) -> &'static str {
        match self {
            Self::Haze => "haze",
            Self::Dust => "dust",
            Self::Scratches => "scratches",
        }
    }
}

/// One layer on a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// What it is.
    pub soil: Soil,
    /// Part of the light that it stops, where it lies.
    pub stopped: f64,
    /// Part of the light that it scatters, where it lies.
    pub scattered: f64,
    /// Where it lies: all over the surface, or where all of these let light pass.
    pub places: Vec<Aperture>,
    /// Whereto it scatters.
    pub lobe: Lobe,
}

impl Layer {
    /// How much of it lies at a place of the surface, mm: 0 to 1.
    fn there(&self, x_mm: f64, y_mm: f64, semi_diameter_mm: Option<f64>) -> f64 {
        self.places.iter().map(|place| place.transmittance(x_mm, y_mm, semi_diameter_mm)).product()
    }
}

/// What the layers of a surface do to light at a place of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shares {
    /// Part that no layer stops.
    pub open: f64,
    /// Part that goes on as it came.
    pub straight: f64,
}

impl Shares {
    /// Of layers at a place, mm.
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

    /// The most that layers scatter anywhere.
    pub fn most_scattered(layers: &[Layer]) -> f64 {
        // Of two layers that stop light the one may leave less for the other.
        1.0 - layers.iter().map(|layer| 1.0 - layer.scattered).product::<f64>()
    }
}

/// The layer that scatters a ray at a place, by a number in [0, 1).
pub(crate) fn which(layers: &[Layer], [x, y]: [f64; 2], semi_diameter_mm: Option<f64>, number: f64) -> Option<&Layer> {
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
