//! What is done to a batch on each leg of a route, as a list of operations.
//!
//! A surface may move, bend, absorb, coat, scatter and clip light, and a batch may carry its optical path and its polarization,
//! or have a ledger. Most surfaces do few of these. So the list for a leg is made once for each kind of batch ([`Mode`]), when
//! the first such batch follows the route. A trace then runs through the list without tests. Each operation is a loop over the
//! batch in `kernels`, `transmission`, `scatter` or in the surface itself.

use spectra_core::numbers::StageKey;
use spectra_lens::Pose;

/// What a batch asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Mode {
    /// Whether it is noted how rays meet surfaces, so that they can be weighed.
    pub notes: bool,
    /// Whether it carries its optical path.
    pub carries_path: bool,
    /// Whether it carries its polarization.
    pub is_polarized: bool,
    /// Whether a ledger books where light goes.
    pub books: bool,
}

impl Mode {
    /// Number of different modes.
    pub const COUNT: usize = 16;

    /// Returns the number of this mode, below [`Mode::COUNT`].
    pub fn number(self) -> usize {
        let flags = [self.notes, self.carries_path, self.is_polarized, self.books];
        flags.iter().enumerate().map(|(i, flag)| usize::from(*flag) << i).sum()
    }
}

/// One thing that is done to a batch on a leg. Notes are copies of the batch in front of a surface, in [`Work`](super::Work).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Operation {
    /// Brings rays into the frame of the element by a rotation. A shift along the axis is left to the surface.
    Reframe(Pose),
    /// Takes the rays through a prism, with all that it does to them.
    PassPrism,
    /// Notes where rays are.
    NotePositions,
    /// Notes the directions of rays.
    NoteDirections,
    /// Selects the random numbers of the surface.
    Draw(StageKey),
    /// Moves rays to the surface, clips them at its rim and bends them.
    Meet,
    /// Measures the way to the surface and the angles there, if the surface does not do that itself.
    Measure,
    /// Bends rays once more by the rings that turning left on the surface.
    BendByRings,
    /// Ends rays that met the surface behind them.
    EndBehind,
    /// Adds the way to the surface to the optical path.
    LengthenPath,
    /// Adds the phase of the surface to the optical path.
    AddPhase,
    /// Absorbs light on the way to the surface, by a table.
    Absorb(usize),
    /// Weighs rays by what was absorbed so far.
    WeighAbsorbed,
    /// Ends all light: the surface reflects nothing.
    ReflectNothing,
    /// Weighs rays and sets their polarization, by what the surface passes or reflects.
    Polarize,
    /// Weighs rays by what a refracting surface reflects.
    Reflect,
    /// Weighs rays by what the surface passes, or a mirror reflects.
    Pass,
    /// Clips rays at an aperture of the element.
    Clip(usize),
    /// Scatters rays by the layers on the surface.
    Scatter,
    /// Dims rays by what the layers on the surface stop or scatter.
    Dim,
    /// Books what rays lost since the last booking.
    Book(LossAccount),
}

/// The account in which a loss is recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LossAccount {
    /// Light that became heat: at rims, in glass, in mirrors.
    Absorbed,
    /// Light that goes on elsewhere: what a refracting surface reflects, or what it passes if the route reflects there.
    Elsewhere,
}

/// The operations of a route for one mode.
#[derive(Clone, Debug, Default)]
pub(super) struct Program {
    operations: Vec<Operation>,
    /// Where the operations of each leg end.
    ends: Vec<usize>,
}

impl Program {
    /// Joins the operations of each leg.
    pub fn new(legs: impl Iterator<Item = Vec<Operation>>) -> Self {
        let mut program = Self::default();
        for operations in legs {
            program.operations.extend(operations);
            program.ends.push(program.operations.len());
        }
        program
    }

    /// Returns the operations of a leg.
    pub fn of_leg(&self, step: usize) -> &[Operation] {
        let start = if step == 0 { 0 } else { self.ends[step - 1] };
        &self.operations[start..self.ends[step]]
    }
}
