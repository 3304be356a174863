//! Parts of what passes that rays go to one by one.

/// Which part of what passes rays go to. What comes through the core and what comes through the rim add up to the whole: few rays
/// of the core end on their way, and where outlines hold more than passes, the rim, a few rays of small weight find out how much.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AimPart {
    /// All of it.
    Whole,
    /// All but the rim.
    Core,
    /// The rim, and what was overlooked around it. A ray weighs [`RIM_EVERY`] times its share: one is to go there for so many to the core.
    Rim,
}

/// One ray goes to the rim for so many to the core.
pub const RIM_EVERY: u32 = 16;
