//! Runs the operations of a route over a batch.

use super::kernels::{Count, Leave, Reframe};
use super::program::{LossAccount, Mode, Operation};
use super::route::{Leg, Move, Route};
use super::work::columns;
use super::{Tracer, Work};
use crate::ledger::{StepLedger, living};
use crate::scatter::{self, ScatterEvent};
use crate::transmission::RaysBefore;
use spectra_core::surface::{Action, Interface, Travel};
use spectra_core::{Loss, LossCounts, RayBatch};
use spectra_lens::onion::Bent;
use spectra_lens::scatter::Shares;

/// A caller that looks at rays behind each element.
type Observer<'a> = &'a mut dyn FnMut(usize, &RayBatch);

impl Tracer {
    /// Traces a batch straight through the lens. Forward, it enters in the frame of the lens and leaves in the frame of the image
    /// plane; backward it is the other way round.
    pub fn trace(&self, rays: &mut RayBatch, work: &mut Work, travel: Travel) {
        self.follow(if travel == Travel::Forward { &self.forward } else { &self.backward }, rays, work);
    }

    /// Traces a batch along a route. At the front, rays enter and leave in the frame of the lens; at the rear, in the frame of
    /// the image plane.
    pub fn follow(&self, route: &Route, rays: &mut RayBatch, work: &mut Work) {
        self.run(route, rays, work, None);
    }

    /// Traces a batch along a route and calls `seen` behind each element. `seen` gets the element's index, and the rays at the
    /// points where they met it, in the frame of its [`Element::pose`](spectra_lens::Element::pose).
    pub fn follow_each(
        &self,
        route: &Route,
        rays: &mut RayBatch,
        work: &mut Work,
        mut seen: impl FnMut(usize, &RayBatch),
    ) {
        self.run(route, rays, work, Some(&mut seen));
    }

    fn run(&self, route: &Route, rays: &mut RayBatch, work: &mut Work, mut observer: Option<Observer<'_>>) {
        let mode = self.prepare(route, rays, work);
        let program = self.program(route, mode);
        if let Some((ledger, booked)) = &mut work.ledger {
            ledger.steps.resize(route.legs.len(), StepLedger::default());
            ledger.launched += living(rays);
            booked.note(rays);
        }
        let mut alive = rays.len();
        for (step, leg) in route.legs.iter().enumerate() {
            let operations = program.of_leg(step);
            let ended: usize = operations.iter().map(|op| self.apply(*op, rays, work, (route, step))).sum();
            rays.set_surface(leg.at as u32 + 1);
            if let Some(seen) = &mut observer {
                work.weigh_absorbed(rays);
                seen(leg.at, rays);
            }
            if ended > 0 {
                self.count(rays, leg.at as u32 + 1, &mut work.losses);
                alive -= ended;
                if work.compact && alive * 2 < rays.len() {
                    work.weigh_absorbed(rays);
                    rays.compact();
                    self.refractive_indices(rays, work);
                    if let Some((_, booked)) = &mut work.ledger {
                        booked.note(rays);
                    }
                }
            }
        }
        work.weigh_absorbed(rays);
        if let Some((ledger, _)) = &mut work.ledger {
            ledger.arrived += living(rays);
        }
        let index = work.media[route.outside].n.slice(rays.len());
        let shift_mm = match route.out {
            Move::Shift(shift_mm) => shift_mm,
            Move::Turn(pose) => {
                rays.isa().run(Reframe { rays, pose });
                0.0
            }
        };
        rays.isa().run(Leave { rays, index, shift_mm: -shift_mm });
    }

    /// Evaluates the indices of media for a batch, makes room for notes if the route needs them, and returns the mode of the batch.
    pub(super) fn prepare(&self, route: &Route, rays: &RayBatch, work: &mut Work) -> Mode {
        let turns = route.legs.iter().any(|leg| leg.turns);
        let (carries_path, is_polarized) = (rays.optical_path_mm().is_some(), rays.is_polarized());
        let needs_notes = turns || carries_path || is_polarized;
        if needs_notes && work.before.is_none() {
            work.before = Some(self.before(work.capacity));
        }
        self.refractive_indices(rays, work);
        Mode { notes: work.before.is_some(), carries_path, is_polarized, books: work.ledger.is_some() }
    }

    /// Applies an operation of a leg to a batch and returns how many rays ended by it.
    pub(super) fn apply(
        &self,
        operation: Operation,
        rays: &mut RayBatch,
        work: &mut Work,
        (route, step): (&Route, usize),
    ) -> usize {
        let isa = rays.isa();
        let leg = &route.legs[step];
        match operation {
            Operation::Meet => return self.meet(rays, work, leg),
            Operation::Clip(aperture) => return self.clip(rays, leg, aperture),
            Operation::BendByRings => return self.bend_by_rings(rays, work, leg),
            Operation::EndBehind => return RaysBefore::end_behind(rays, leg.number()),
            Operation::Scatter => return self.scatter(rays, work, leg, step),
            Operation::PassPrism => return self.pass_prism(rays, work, leg, step),
            Operation::Reframe(pose) => isa.run(Reframe { rays, pose }),
            Operation::Draw(stage) => rays.set_stage(stage),
            Operation::LengthenPath => {
                let n = work.media[leg.before].n.slice(rays.len());
                RaysBefore::lengthen(rays, n);
            }
            Operation::AddPhase => self.add_phase(rays, work, route, step),
            Operation::ReflectNothing => rays.weight_columns().weight.fill(0.0),
            Operation::Dim => self.dim(rays, work, leg, step),
            Operation::WeighAbsorbed => work.weigh_absorbed(rays),
            Operation::Book(account) => book(rays, work, step, account),
            Operation::NotePositions
            | Operation::NoteDirections
            | Operation::Measure
            | Operation::Absorb(_)
            | Operation::Polarize
            | Operation::Reflect
            | Operation::Pass => self.weigh(operation, rays, work, leg),
        }
        0
    }

    /// Applies an operation that takes notes or weighs rays by them.
    fn weigh(&self, operation: Operation, rays: &mut RayBatch, work: &mut Work, leg: &Leg) {
        let Some(notes) = &mut work.before else { return };
        let passage = &self.passages[leg.at];
        let len = rays.len();
        let [before, after, beyond] = [leg.before, leg.after, leg.beyond].map(|m| work.media[m].n.slice(len));
        match operation {
            Operation::NotePositions => notes.note_positions(rays),
            Operation::NoteDirections => notes.note_directions(rays),
            Operation::Measure => notes.measure(rays, leg.shift_mm()),
            Operation::Absorb(table) => notes.absorb(rays, table),
            Operation::Polarize => notes.polarize(rays, passage, leg.action == Action::Reflect, [before, beyond]),
            Operation::Reflect => RaysBefore::reflect(rays, passage, before, beyond),
            _ => notes.pass(rays, passage, [leg.before, leg.after], [before, after]),
        }
    }

    /// Moves rays to the surface of a leg, clips them at its rim and bends them.
    fn meet(&self, rays: &mut RayBatch, work: &Work, leg: &Leg) -> usize {
        let len = rays.len();
        let interface = Interface {
            number: leg.number(),
            shift_mm: leg.shift_mm(),
            clip_radius2_mm2: self.clips[leg.at],
            action: leg.action,
            travel: leg.travel,
            before: columns(&work.media[leg.before], len),
            after: columns(&work.media[leg.after], len),
        };
        self.elements[leg.at].surface.interact(rays, &interface)
    }

    /// Clips rays at an aperture of the element of a leg.
    fn clip(&self, rays: &mut RayBatch, leg: &Leg, aperture: usize) -> usize {
        let element = &self.elements[leg.at];
        match &self.openings[leg.at][aperture] {
            Some(opening) => element.apertures[aperture].clip_by(opening, rays, leg.number()),
            None => element.apertures[aperture].clip(rays, leg.number(), element.semi_diameter_mm),
        }
    }

    /// Bends rays by the rings on the surface of a leg.
    fn bend_by_rings(&self, rays: &mut RayBatch, work: &Work, leg: &Leg) -> usize {
        let (Some(rings), Some(notes)) = (&self.elements[leg.at].onion_rings, &work.before) else { return 0 };
        let len = rays.len();
        let n = [leg.before, leg.after].map(|medium| work.media[medium].n.slice(len));
        let (before, mirror) = (notes.directions(len), leg.action == Action::Reflect);
        let ended = rings.bend(rays, &Bent { before, n, mirror, number: leg.number() });
        notes.measure_angles(rays);
        ended
    }

    /// Scatters rays by the layers on the surface of a leg.
    fn scatter(&self, rays: &mut RayBatch, work: &mut Work, leg: &Leg, step: usize) -> usize {
        let (Some(place), Some(notes)) = (&leg.soiled, &work.before) else { return 0 };
        let len = rays.len();
        let meeting = ScatterEvent {
            layers: &self.layers[leg.at],
            semi_diameter_mm: self.elements[leg.at].semi_diameter_mm,
            before: notes.directions(len),
            n: [leg.before, leg.after].map(|medium| work.media[medium].n.slice(len)),
            mirror: leg.action == Action::Reflect,
            coating: self.passages[leg.at].coating(),
            number: leg.number(),
        };
        let ended = scatter::scatter(rays, place, &meeting);
        book(rays, work, step, LossAccount::Absorbed);
        ended
    }

    /// Dims rays by what the layers on the surface of a leg stop and scatter, and books the two apart.
    fn dim(&self, rays: &mut RayBatch, work: &mut Work, leg: &Leg, step: usize) {
        let (layers, semi_diameter_mm) = (&self.layers[leg.at], self.elements[leg.at].semi_diameter_mm);
        if work.ledger.is_none() {
            return scatter::dim(rays, layers, semi_diameter_mm, |shares| shares.straight);
        }
        scatter::dim(rays, layers, semi_diameter_mm, |shares| shares.open);
        book(rays, work, step, LossAccount::Absorbed);
        let straight = |Shares { open, straight }| if open > 0.0 { straight / open } else { 0.0 };
        scatter::dim(rays, layers, semi_diameter_mm, straight);
        if let Some((ledger, booked)) = &mut work.ledger {
            booked.settle(rays, &mut ledger.steps[step], |s| &mut s.scattered);
        }
    }

    /// Counts the rays that ended at a surface, by cause.
    fn count(&self, rays: &RayBatch, number: u32, losses: &mut LossCounts) {
        let causes = [Loss::Missed, Loss::Vignetted, Loss::TotalReflection, Loss::Absorbed];
        let many = rays.isa().run(Count { states: rays.states(), wanted: causes.map(|cause| cause.state(number)) });
        for (cause, many) in causes.into_iter().zip(many).filter(|(_, many)| *many > 0) {
            losses.add(cause, number, many);
        }
    }
}

/// Books what rays lost since the last booking, if a ledger is kept.
pub(super) fn book(rays: &mut RayBatch, work: &mut Work, step: usize, account: LossAccount) {
    if let Some((ledger, booked)) = &mut work.ledger {
        booked.settle(rays, &mut ledger.steps[step], |s| match account {
            LossAccount::Absorbed => &mut s.absorbed,
            LossAccount::Elsewhere => &mut s.elsewhere,
        });
    }
}
