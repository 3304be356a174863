//! The parts of an outline, core and rim, to which rays are sent separately.
//!
//! A ray that ends adds noise. The core is 98.6 % of the outline's area, where almost no rays end. The rim is the rest of the outline and
//! the ring around it. For every 16 rays to the core one ray goes to the rim and stands for 16, with a small weight; in the ring it has
//! about 13 times the weight of a ray of the core.

/// The part of the passing region at which rays are aimed. The light through the core and the light through the rim add up to the
/// whole. Few rays of the core end on their way. In the rim, where outlines contain more than passes, a few rays of small weight
/// measure how much passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AimPart {
    /// The whole region: core and rim.
    Whole,
    /// The core: everything except the rim.
    Core,
    /// The rim, including the ring around the outline. One ray goes there for [`RIM_EVERY`] rays to the core, so its weight is
    /// multiplied by [`RIM_EVERY`].
    Rim,
}

/// Number of rays to the core for each ray to the rim.
pub const RIM_EVERY: u32 = 16;
