//! The parts of an outline, core and rim, to which rays are sent separately.
//!
//! A ray that ends adds noise. The core is 98.6 % of the outline's area, where almost no rays end. The rim is the rest of the outline and
//! the ring around it. For every 16 rays to the core one ray goes to the rim and stands for 16, with a small weight; in the ring it has
//! about 13 times the weight of a ray of the core.

/// The part of the passing region that rays are aimed at. The light through the core and the light through the rim add up to the whole.
/// Few rays of the core end on their way. In the rim, where outlines contain more than passes, a few rays of small weight measure how much.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AimPart {
    /// The whole region: core and rim.
    Whole,
    /// Everything except the rim.
    Core,
    /// The rim, including the ring around the outline. A ray weighs [`RIM_EVERY`] times its share: one ray goes there for that many to the
    /// core.
    Rim,
}

/// Number of rays to the core for each ray to the rim.
pub const RIM_EVERY: u32 = 16;
