//! The light of a channel, reduced to a few wavelengths.

/// The light of a channel: wavelengths (mm) with their shares, which sum to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelLight {
    shares: Vec<[f64; 2]>,
}

/// Number of wavelengths to which a channel's light is reduced.
const WAVELENGTHS: usize = 8;

impl ChannelLight {
    /// Reduces the light that a channel sees to a few parts of equal light, each at its mean wavelength. `seen` holds pairs of a
    /// wavelength (nm) and the light seen there. `None` if the channel sees no light.
    #[must_use]
    pub fn of(seen: &[[f64; 2]]) -> Option<Self> {
        let mut sorted: Vec<[f64; 2]> = seen.iter().copied().filter(|[_, light]| *light > 0.0).collect();
        sorted.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let all: f64 = sorted.iter().map(|[_, light]| light).sum();
        if !(all > 0.0 && all.is_finite()) {
            return None;
        }
        let part = all / WAVELENGTHS as f64;
        let mut shares = Vec::new();
        let (mut filled, mut moment) = (0.0, 0.0);
        for [nm, mut light] in sorted {
            while light > 0.0 {
                let taken = light.min(part - filled);
                filled += taken;
                moment += taken * nm;
                light -= taken;
                if filled >= part * (1.0 - 1e-9) {
                    shares.push([moment / filled * 1e-6, filled / all]);
                    (filled, moment) = (0.0, 0.0);
                }
                if taken <= 0.0 {
                    break;
                }
            }
        }
        if filled > 1e-6 * part {
            shares.push([moment / filled * 1e-6, filled / all]);
        }
        let sum: f64 = shares.iter().map(|[_, share]| share).sum();
        shares.iter_mut().for_each(|[_, share]| *share /= sum);
        Some(Self { shares })
    }

    /// Creates light of a single wavelength, nm.
    #[must_use]
    pub fn line(nm: f64) -> Self {
        Self { shares: vec![[nm * 1e-6, 1.0]] }
    }

    /// Wavelengths (mm) with their shares, which sum to 1.
    #[must_use]
    pub fn shares(&self) -> &[[f64; 2]] {
        &self.shares
    }

    /// Mean wavelength of the light, mm.
    #[must_use]
    pub fn mean_mm(&self) -> f64 {
        self.shares.iter().map(|[mm, share]| mm * share).sum()
    }

    /// Shortest and longest wavelength, mm.
    pub(crate) fn range_mm(&self) -> [f64; 2] {
        self.shares.iter().fold([f64::INFINITY, 0.0], |[low, high], [mm, _]| [low.min(*mm), high.max(*mm)])
    }

    /// Reduces the light to at most four wavelengths, which is enough for wings.
    pub(crate) fn coarse(&self) -> Vec<[f64; 2]> {
        let pairs = self.shares.chunks(self.shares.len().div_ceil(4));
        pairs
            .map(|pair| {
                let share: f64 = pair.iter().map(|[_, share]| share).sum();
                [pair.iter().map(|[mm, share]| mm * share).sum::<f64>() / share, share]
            })
            .collect()
    }
}
