//! A path made ready: frames, actions and media, step by step.

use crate::Element;
use crate::path::{Act, Path, PathStep};
use crate::pose::Pose;
use crate::scatter::{self, Layer, Shares};
use glam::DMat3;
use spectra_core::numbers::StageKey;
use spectra_core::surface::{Action, Travel};

/// How rays come from one frame into the next.
#[derive(Clone, Copy, Debug)]
pub(super) enum Move {
    /// Both stand alike on one line along z: the next origin lies this far, mm.
    Shift(f64),
    /// Anything else: the pose of the frame they are in, seen from the next one.
    Turn(Pose),
}

impl Move {
    fn between(from: &Pose, to: &Pose) -> Self {
        let aside = from.origin_mm - to.origin_mm;
        if from.rotation == to.rotation && from.rotation == DMat3::IDENTITY && aside.x == 0.0 && aside.y == 0.0 {
            return Self::Shift(to.origin_mm.z - from.origin_mm.z);
        }
        Self::Turn(to.inverse().then(from))
    }
}

/// Where the image plane stands.
#[derive(Clone, Copy, Debug)]
pub(super) struct ImagePlane {
    pub(super) pose: Pose,
    /// Length of the axis to it from the first vertex, mm.
    pub(super) along_axis_mm: f64,
    /// Whether light that runs forward arrives along the axis, 1, or behind an odd number of mirrors against it, -1.
    pub(super) sense: f64,
}

/// Whether light that runs forward arrives at an element along the axis, 1, or behind an odd number of mirrors, where thicknesses are
/// negative, against it, -1.
pub(super) fn arrives(element: &Element) -> f64 {
    if element.along != element.reversed { 1.0 } else { -1.0 }
}

/// A path made ready: where each surface stands seen from the one before, what it does, and between which media.
#[derive(Clone, Debug)]
pub struct Route {
    /// From which side it enters.
    pub(super) enters: Travel,
    pub(super) legs: Vec<Leg>,
    /// Into the frame in which the light leaves.
    pub(super) out: Move,
    /// The medium that it leaves into.
    pub(super) outside: usize,
}

impl Route {
    /// How many elements it goes by.
    #[must_use]
    pub fn steps(&self) -> usize {
        self.legs.len()
    }
}

/// One step of a [`Route`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Leg {
    /// The element, also the place of its booking.
    pub(super) at: usize,
    /// Into the frame of the surface.
    pub(super) into: Move,
    /// Length of the axis, along the light, from the vertex before, mm: from the first vertex or the image plane for the first leg.
    pub(super) length_mm: f64,
    pub(super) action: Action,
    /// Whether a refracting surface reflects.
    pub(super) turns: bool,
    /// Direction of travel along the surface's own z.
    pub(super) travel: Travel,
    /// Media: the one that the light comes through, the one that it goes on in, and the one on the other side.
    pub(super) before: usize,
    pub(super) after: usize,
    pub(super) beyond: usize,
    /// Whether the way here lies within the lens, where glass absorbs.
    pub(super) inside: bool,
    /// Whether the light was reflected before, so that it may run away from this surface.
    pub(super) turned: bool,
    /// What the surface draws its numbers by, if it does.
    pub(super) stage: Option<StageKey>,
    /// Where scattered light is traced: what lies on it.
    pub(super) soiled: Option<scatter::Place>,
}

/// A path made ready; for light that is scattered at least once by these layers of elements, if there are any.
pub(super) fn route(elements: &[Element], image: &ImagePlane, path: &Path, layers: Option<&[Vec<Layer>]>) -> Route {
    let end = |at_front: bool| if at_front { &Pose::IDENTITY } else { &image.pose };
    // Where the light comes from along the axis, and the sense of forward light in the gap behind that place.
    let (mut along_mm, mut forward) =
        if path.enters() == Travel::Forward { (0.0, 1.0) } else { (image.along_axis_mm, image.sense) };
    let mut frame = end(path.enters() == Travel::Forward);
    let mut outside = 0;
    let mut legs: Vec<Leg> = Vec::with_capacity(path.steps().len());
    for PathStep { element: at, act, travel } in path.steps() {
        let element = &elements[*at];
        let (before, beyond) = match travel {
            Travel::Forward => (element.medium_before, element.medium_after),
            Travel::Backward => (element.medium_after, element.medium_before),
        };
        let turns = *act == Act::Reflect && element.action == Action::Refract;
        let after = if turns { before } else { beyond };
        legs.push(Leg {
            at: *at,
            into: Move::between(frame, &element.pose),
            length_mm: match travel {
                Travel::Forward => (element.along_axis_mm - along_mm) * arrives(element),
                Travel::Backward => (along_mm - element.along_axis_mm) * forward,
            },
            action: if turns { Action::Reflect } else { element.action },
            turns,
            travel: sense(element, *travel),
            before,
            after,
            beyond,
            inside: !legs.is_empty(),
            turned: legs.iter().any(|leg| leg.turns),
            stage: element.surface.draws().then(|| {
                let same = elements[..*at].iter().filter(|e| e.surface.draws() && e.kind == element.kind).count();
                let visits = legs.iter().filter(|leg| leg.at == *at).count();
                StageKey::new(&element.kind, (visits as u64) << 32 | same as u64)
            }),
            soiled: None,
        });
        (frame, outside, along_mm, forward) = (&element.pose, after, element.along_axis_mm, arrives(element));
    }
    if let Some(layers) = layers {
        let most = |leg: &Leg| if leg.turns { 0.0 } else { Shares::most_scattered(&layers[leg.at]) };
        let all: f64 = legs.iter().map(most).sum();
        let mut from = 0.0;
        for leg in &mut legs {
            let own = most(leg);
            if own > 0.0 {
                let upto = from + own / all;
                leg.soiled =
                    Some(scatter::Place { stage: StageKey::new("scatter", leg.at as u64), first: [from, upto] });
                from = upto;
            }
        }
    }
    Route { enters: path.enters(), legs, out: Move::between(frame, end(path.leaves() == Travel::Backward)), outside }
}

/// The sense in which light meets a surface, along the surface's own z: behind a mirror, or where the surface is turned
/// round, it is the other one.
fn sense(element: &Element, travel: Travel) -> Travel {
    // Backward, a mirror is met from where light leaves it forward: on the same side.
    let forward = match travel {
        Travel::Forward => element.along,
        Travel::Backward => element.along == (element.action == Action::Reflect),
    };
    if forward { Travel::Forward } else { Travel::Backward }
}
