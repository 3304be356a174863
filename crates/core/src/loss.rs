//! Losses of light: why a ray ended, at which surface, and how many rays did. Light lost, in watts, is in the ledgers of the
//! tracer and of the ghosts.

/// Why a ray ended before it reached the other side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(u8)]
pub enum Loss {
    /// The ray does not hit the surface.
    Missed = 1,
    /// The ray hits the surface outside its clear aperture.
    Vignetted = 2,
    /// The ray is totally reflected at a surface that should refract.
    TotalReflection = 3,
    /// The ray is absorbed by a black surface or a filter.
    Absorbed = 4,
    /// The ray passed the lens but missed the imager's frame.
    OutOfFrame = 5,
    /// The ray carries no light: traced backward, it misses the picture in front of the lens, or meets black.
    Unlit = 6,
}

/// State of a ray that is alive.
pub const ALIVE: u64 = 0;

impl Loss {
    /// All causes of a loss.
    pub const ALL: [Self; 6] =
        [Self::Missed, Self::Vignetted, Self::TotalReflection, Self::Absorbed, Self::OutOfFrame, Self::Unlit];

    /// Short name of the cause, used in tables and JSON.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Missed => "missed",
            Self::Vignetted => "vignetted",
            Self::TotalReflection => "tir",
            Self::Absorbed => "absorbed",
            Self::OutOfFrame => "out_of_frame",
            Self::Unlit => "unlit",
        }
    }

    /// Returns the state of a ray that ends for this cause at `surface` (1-based; 0 if no surface applies).
    #[inline(always)]
    #[must_use]
    pub fn state(self, surface: u32) -> u64 {
        (u64::from(surface) << 8) | self as u64
    }

    /// Splits a state into cause and surface; `None` while the ray is alive.
    #[inline]
    #[must_use]
    pub fn of_state(state: u64) -> Option<(Self, u32)> {
        let cause = Self::ALL.into_iter().find(|c| *c as u64 == state & 0xff)?;
        Some((cause, (state >> 8) as u32))
    }
}

/// Numbers of rays that ended, by surface and cause. Counts add up exactly, in any order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LossCounts {
    /// One row per surface number (0: no surface), one column per cause.
    rows: Vec<[u64; 7]>,
}

impl LossCounts {
    /// Counts `many` rays that ended at `surface` because of `cause`.
    pub fn add(&mut self, cause: Loss, surface: u32, many: u64) {
        let row = surface as usize;
        if self.rows.len() <= row {
            self.rows.resize(row + 1, [0; 7]);
        }
        self.rows[row][cause as usize] += many;
    }

    /// Counts the rays in `states` that have ended.
    pub fn add_states(&mut self, states: &[u64]) {
        for &state in states {
            if let Some((cause, surface)) = Loss::of_state(state) {
                self.add(cause, surface, 1);
            }
        }
    }

    /// Adds the counts of `other` to these.
    pub fn merge(&mut self, other: &Self) {
        for (surface, cause, many) in other.iter() {
            self.add(cause, surface, many);
        }
    }

    /// Iterates over the counts that are not zero: (surface, cause, rays).
    pub fn iter(&self) -> impl Iterator<Item = (u32, Loss, u64)> + '_ {
        self.rows.iter().enumerate().flat_map(|(surface, row)| {
            Loss::ALL
                .into_iter()
                .map(move |cause| (surface as u32, cause, row[cause as usize]))
                .filter(|(_, _, many)| *many > 0)
        })
    }

    /// Number of rays lost to one cause, over all surfaces.
    #[must_use]
    pub fn of_cause(&self, cause: Loss) -> u64 {
        self.rows.iter().map(|row| row[cause as usize]).sum()
    }

    /// Number of rays that ended, over all causes and surfaces.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.rows.iter().flatten().sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn state_keeps_cause_and_surface() {
        for cause in Loss::ALL {
            for surface in [0, 1, 11, 70_000] {
                assert_eq!(Loss::of_state(cause.state(surface)), Some((cause, surface)));
            }
        }
        assert_eq!(Loss::of_state(ALIVE), None);
    }

    #[test]
    fn counts_merge_exactly() {
        let mut a = LossCounts::default();
        a.add(Loss::Vignetted, 3, 5);
        let mut b = LossCounts::default();
        b.add_states(&[ALIVE, Loss::Vignetted.state(3), Loss::Missed.state(1)]);
        a.merge(&b);
        assert_eq!(a.iter().collect::<Vec<_>>(), vec![(1, Loss::Missed, 1), (3, Loss::Vignetted, 6)]);
        assert_eq!(a.total(), 7);
    }
}
