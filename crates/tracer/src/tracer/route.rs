//! A path made ready: frames, actions and media, step by step.

use super::program::{Mode, Program};
use crate::path::{Interaction, Path, PathStep};
use crate::scatter;
use glam::DMat3;
use spectra_core::numbers::StageKey;
use spectra_core::surface::{Action, Travel};
use spectra_lens::Element;
use spectra_lens::Layer;
use spectra_lens::Pose;
use spectra_lens::scatter::Shares;
use std::sync::OnceLock;

/// The move of rays from one frame into the next.
#[derive(Clone, Copy, Debug)]
pub(super) enum Move {
    /// Both frames lie on one line along z: distance to the next origin, mm.
    Shift(f64),
    /// Any other move: pose of the present frame as seen from the next one.
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

/// The place of the image plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct ImagePlane {
    pub(super) pose: Pose,
    /// Length of the axis from the first vertex to the plane, mm.
    pub(super) along_axis_mm: f64,
    /// 1 if forward light arrives along the axis; -1 behind an odd number of mirrors, where it arrives against it.
    pub(super) sense: f64,
}

/// Returns 1 if forward light arrives at an element along the axis, and -1 behind an odd number of mirrors, where thicknesses are negative
/// and it arrives against the axis.
pub(super) fn arrives(element: &Element) -> f64 {
    if element.along != element.reversed { 1.0 } else { -1.0 }
}

/// A path that is prepared for tracing: the pose of each surface in the frame of the one before, its action, and the media on
/// both sides.
#[derive(Clone, Debug)]
pub struct Route {
    /// The side from which light enters.
    pub(super) enters: Travel,
    pub(super) legs: Vec<Leg>,
    /// The move into the frame in which light leaves.
    pub(super) out: Move,
    /// Number of the medium into which light leaves.
    pub(super) outside: usize,
    /// Operations for each mode, by its number.
    pub(super) programs: [OnceLock<Program>; Mode::COUNT],
}

impl Route {
    /// Returns the number of steps: the elements that light meets, in order.
    #[must_use]
    pub fn steps(&self) -> usize {
        self.legs.len()
    }
}

/// One step of a [`Route`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Leg {
    /// Index of the element.
    pub(super) at: usize,
    /// The move into the frame of the surface.
    pub(super) into: Move,
    /// Length of the axis, along the light, from the previous vertex, mm; for the first leg, from the first vertex or the image plane.
    pub(super) length_mm: f64,
    pub(super) action: Action,
    /// Whether a refracting surface reflects.
    pub(super) turns: bool,
    /// Direction of travel along the z axis of the surface.
    pub(super) travel: Travel,
    /// Number of the medium that the light comes through.
    pub(super) before: usize,
    /// Number of the medium in which the light goes on.
    pub(super) after: usize,
    /// Number of the medium on the other side of the surface.
    pub(super) beyond: usize,
    /// Whether the way to the surface lies inside the lens, where glass absorbs.
    pub(super) inside: bool,
    /// Whether the light was reflected before, so that it may run away from the surface.
    pub(super) turned: bool,
    /// Key by which the surface draws random numbers, if it does.
    pub(super) stage: Option<StageKey>,
    /// Place of the surface among those whose layers scatter; `None` if no scattered light is traced or the surface is clean.
    pub(super) soiled: Option<scatter::ScatterSurface>,
}

impl Leg {
    /// Returns the number of its surface, from 1.
    pub(super) fn number(&self) -> u32 {
        self.at as u32 + 1
    }

    /// Returns how far along z the vertex of its surface lies in the frame that rays are in, mm; 0 behind a rotation.
    pub(super) fn shift_mm(&self) -> f64 {
        match self.into {
            Move::Shift(shift_mm) => shift_mm,
            Move::Turn(_) => 0.0,
        }
    }
}

/// Makes a path ready. With `layers`, it is for light that these layers of the elements scatter at least once.
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
        let turns = *act == Interaction::Reflect && element.action == Action::Refract;
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
                leg.soiled = Some(scatter::ScatterSurface {
                    stage: StageKey::new("scatter", leg.at as u64),
                    first: [from, upto],
                });
                from = upto;
            }
        }
    }
    let out = Move::between(frame, end(path.leaves() == Travel::Backward));
    Route { enters: path.enters(), legs, out, outside, programs: Default::default() }
}

/// Returns the direction in which light meets a surface, along the z axis of the surface. It is reversed behind a mirror, and if the surface is
/// turned round.
fn sense(element: &Element, travel: Travel) -> Travel {
    // Backward, a mirror is met from where light leaves it forward: on the same side.
    let forward = match travel {
        Travel::Forward => element.along,
        Travel::Backward => element.along == (element.action == Action::Reflect),
    };
    if forward { Travel::Forward } else { Travel::Backward }
}
