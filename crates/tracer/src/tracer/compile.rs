//! Makes the list of operations of a route.

use super::Tracer;
use super::program::{LossAccount, Mode, Operation, Program};
use super::route::{Leg, Move, Route};
use crate::transmission::Passage;

impl Tracer {
    /// Returns the operations of a route for batches of a mode.
    pub(super) fn program<'r>(&self, route: &'r Route, mode: Mode) -> &'r Program {
        route.programs[mode.number()].get_or_init(|| {
            Program::new(route.legs.iter().map(|leg| {
                let mut operations = Vec::new();
                self.compile(leg, mode, &mut operations);
                operations
            }))
        })
    }

    /// Appends the operations of a leg.
    fn compile(&self, leg: &Leg, mode: Mode, operations: &mut Vec<Operation>) {
        let element = &self.elements[leg.at];
        if let Move::Turn(pose) = leg.into {
            operations.push(Operation::Reframe(pose));
        }
        if element.solid.is_some() {
            operations.push(Operation::PassPrism);
            return;
        }
        self.compile_meeting(leg, mode, operations);
        if mode.carries_path {
            operations.push(Operation::LengthenPath);
            if mode.notes && element.surface.has_phase() {
                operations.push(Operation::AddPhase);
            }
        }
        if mode.notes {
            self.compile_weighing(leg, mode, operations);
        }
        operations.extend((0..element.apertures.len()).map(Operation::Clip));
        if mode.books {
            operations.push(Operation::Book(LossAccount::Absorbed));
        }
        // What a surface reflects although it should pass it, it reflects beneath what lies on it.
        if !self.layers[leg.at].is_empty() && !leg.turns {
            let scatters = leg.soiled.is_some() && mode.notes;
            operations.push(if scatters { Operation::Scatter } else { Operation::Dim });
        }
    }

    /// Returns the table by which a medium absorbs light on the way to an element.
    fn absorption_before(&self, leg: &Leg) -> Option<usize> {
        self.absorptions.as_ref().filter(|_| leg.inside)?.table_of(leg.before)
    }

    /// Appends what brings rays to the surface of a leg and bends them.
    fn compile_meeting(&self, leg: &Leg, mode: Mode, operations: &mut Vec<Operation>) {
        let element = &self.elements[leg.at];
        let needs_way = self.absorption_before(leg).is_some() || mode.carries_path || leg.turned;
        let reflects = self.passages[leg.at].reflects();
        let measures = mode.notes && !element.surface.records_intersection() && (needs_way || reflects);
        let is_phased = mode.carries_path && element.surface.has_phase();
        let has_rings = element.onion_rings.is_some();
        if measures {
            operations.push(Operation::NotePositions);
        }
        if mode.notes && (measures || is_phased || leg.soiled.is_some() || has_rings || mode.is_polarized) {
            operations.push(Operation::NoteDirections);
        }
        operations.extend(leg.stage.map(Operation::Draw));
        operations.push(Operation::Meet);
        if measures {
            operations.push(Operation::Measure);
        }
        if mode.notes && has_rings {
            operations.push(Operation::BendByRings);
        }
        if mode.notes && leg.turned {
            operations.push(Operation::EndBehind);
        }
        if mode.books {
            operations.push(Operation::Book(LossAccount::Absorbed));
        }
    }

    /// Appends what weighs rays at the surface of a leg and on the way to it.
    fn compile_weighing(&self, leg: &Leg, mode: Mode, operations: &mut Vec<Operation>) {
        let passage = &self.passages[leg.at];
        if let Some(table) = self.absorption_before(leg) {
            operations.push(Operation::Absorb(table));
            if mode.books {
                operations.extend([Operation::WeighAbsorbed, Operation::Book(LossAccount::Absorbed)]);
            }
        }
        if leg.turns && *passage == Passage::All {
            operations.push(Operation::ReflectNothing);
        } else if mode.is_polarized {
            operations.push(Operation::Polarize);
        } else if leg.turns {
            operations.push(Operation::Reflect);
        } else if *passage != Passage::All {
            operations.push(Operation::Pass);
        }
        if mode.books {
            let is_mirror = matches!(passage, Passage::Mirror(_));
            operations.push(Operation::Book(if is_mirror { LossAccount::Absorbed } else { LossAccount::Elsewhere }));
        }
    }
}
