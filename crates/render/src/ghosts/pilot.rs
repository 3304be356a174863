//! The pilot: where on the front of the lens the light of each path comes in, and how much each path needs.
//!
//! Places of the source are dear to draw, and what a ray from one carries can be dearer still (a picture with depth is walked through).
//! So places are drawn once and shared by all paths, and only rays that come through are asked what they carry. In the first round all
//! paths share the directions too; it says whether going on is worth it.

use super::guide::{Aim, Found, Guide};
use super::{Ghosts, Way};
use crate::Workers;
use crate::error::RenderError;
use crate::pipeline::ThreadState;
use spectra_core::batch::pixel_and_channel;
use spectra_core::loss::ALIVE;
use spectra_core::numbers::{Dimension, StageKey};
use spectra_core::workers::each_of;
use spectra_core::{Loss, RayBatch};

/// Rays for each path and round, of one zone and of each further one, and rounds: the last one says how much comes.
const RAYS: usize = 4096;
const RAYS_MORE: usize = 256;
const ROUNDS: u64 = 3;
/// Paths of more than two reflections are many, and have little light: this part of the rays.
const OF_MORE: usize = 4;
/// Rays of a batch.
const BATCH: usize = 256;
/// Pixels of a block, across and down.
const BLOCK: usize = 32;
/// Blocks that have less than this part of the brightest one need not be as clean as those that have more.
const DIM: f64 = 1e-4;
/// Batches of each path that say whether going on is worth it. They see little of what is narrow: only what they find this many times too
/// dim is left at that.
const SCOUTS: usize = 4;
const DOUBT: f64 = 2.0;

/// What the pilot finds.
pub(super) struct Plan {
    /// For each path its guides, and the variance of one of its rays.
    pub ways: Vec<(Vec<Guide>, f64)>,
    /// The brightest block, W/m2 in the mean of its pixels and the sum of its channels.
    pub brightest: f64,
}

impl Plan {
    /// Without a search: all over the front, and such variances that all paths get as many rays.
    pub fn even(ghosts: &Ghosts) -> Self {
        let way = |way: &Way| (way.guides.clone(), way.cost());
        Self { ways: ghosts.plan.ways.iter().map(way).collect(), brightest: 0.0 }
    }
}

/// A ray that came through: its zone, its aim, the block that it reached, and what it brought but for the density of its aim.
type Seen = (usize, Aim, usize, f64);

/// Blocks of the frame.
struct Blocks {
    width: usize,
    height: usize,
    pixel_mm2: f64,
}

impl Blocks {
    fn across(&self) -> usize {
        self.width.div_ceil(BLOCK)
    }

    fn count(&self) -> usize {
        self.across() * self.height.div_ceil(BLOCK)
    }

    fn of(&self, pixel: u32) -> usize {
        let pixel = pixel as usize;
        pixel / self.width / BLOCK * self.across() + pixel % self.width / BLOCK
    }

    /// What came to each: of each path what was seen, by so many batches.
    fn light<'a>(&self, paths: impl Iterator<Item = (&'a Vec<Seen>, usize)>) -> Vec<f64> {
        let mut light = vec![0.0; self.count()];
        for (seen, batches) in paths {
            let rays = (batches * BATCH) as f64;
            seen.iter().for_each(|(_, aim, block, value)| light[*block] += value / aim.density / rays);
        }
        light
    }

    /// The brightest of them, W/m2.
    fn brightest(&self, light: &[f64]) -> f64 {
        let pixels = |block: usize| {
            let (column, row) = (block % self.across() * BLOCK, block / self.across() * BLOCK);
            ((self.width - column).min(BLOCK) * (self.height - row).min(BLOCK)) as f64
        };
        let mean = |(block, light): (usize, &f64)| light / (pixels(block) * self.pixel_mm2);
        light.iter().enumerate().map(mean).fold(0.0, f64::max)
    }
}

/// A batch on its way into the lens, and the zone and aim of each ray.
struct Aimed {
    rays: RayBatch,
    aims: Vec<(usize, Aim)>,
}

struct Pilot<'a> {
    ghosts: &'a Ghosts,
    blocks: Blocks,
    /// On the source, without a direction.
    placed: Vec<RayBatch>,
    /// The same, all over the front.
    everywhere: Vec<Aimed>,
}

/// Whether somebody still waits for the result.
fn wanted(workers: &dyn Workers) -> Result<(), RenderError> {
    if workers.should_stop() { Err(RenderError::Stopped) } else { Ok(()) }
}

/// Searches all paths. `None` where no block has more than `matters`.
pub(super) fn search(
    ghosts: &Ghosts,
    matters: Option<f64>,
    workers: &dyn Workers,
) -> Result<Option<Plan>, RenderError> {
    let pilot = &Pilot::new(ghosts);
    let (ways, fresh) = (&ghosts.plan.ways, || ghosts.state(BATCH));
    // Batches of a path, of so many of a pair's.
    let of = |way: &Way, batches: usize| if way.is_of_pair() { batches } else { batches.div_ceil(OF_MORE) };
    let first = |batches: usize| {
        each_of(workers, ways.len(), fresh, move |state, at| {
            wanted(workers)?;
            Ok::<_, RenderError>(pilot.round(state, &ways[at], &ways[at].guides, None, of(&ways[at], batches)))
        })
    };
    let is_dim = |brightest: f64, doubt: f64| matters.is_some_and(|matters| !(brightest > matters / doubt));
    if matters.is_some() {
        let scouts = first(SCOUTS)?;
        let seen = scouts.iter().zip(ways).map(|((_, seen), way)| (seen, of(way, SCOUTS)));
        let light = pilot.blocks.light(seen);
        if is_dim(pilot.blocks.brightest(&light), DOUBT) {
            return Ok(None);
        }
    }
    let all = pilot.placed.len();
    let first = first(all)?;
    let last = each_of(workers, ways.len(), fresh, |state, at| {
        wanted(workers)?;
        let closer = |found: &[Found]| -> Vec<Guide> { found.iter().map(Found::closer).collect() };
        let mut guides = closer(&first[at].0);
        for round in 1..ROUNDS {
            let stream = (at as u64 + 1) * ROUNDS + round;
            let (found, seen) = pilot.round(state, &ways[at], &guides, Some(stream), of(&ways[at], all));
            if round + 1 == ROUNDS {
                return Ok::<_, RenderError>((guides, seen));
            }
            guides = closer(&found);
        }
        Ok((guides, Vec::new()))
    })?;
    let light = pilot.blocks.light(last.iter().zip(ways).map(|((_, seen), way)| (seen, of(way, all))));
    let brightest = pilot.blocks.brightest(&light);
    if is_dim(brightest, 1.0) {
        return Ok(None);
    }
    let peak = light.iter().fold(0.0_f64, |a, b| a.max(*b));
    let guide = |((guides, seen), way): ((Vec<Guide>, Vec<Seen>), &Way)| {
        let mut found: Vec<Found> = guides.iter().map(Found::of).collect();
        for (zone, aim, block, value) in seen {
            found[zone].add(&guides[zone], aim, value / (light[block] + DIM * peak));
        }
        let rays = (of(way, all) * BATCH) as u64;
        let best = found.iter().map(|found| found.guide(rays));
        best.fold((Vec::new(), 0.0), |(mut guides, variance), (guide, own)| {
            guides.push(guide);
            (guides, variance + own)
        })
    };
    Ok(Some(Plan { ways: last.into_iter().zip(ways).map(guide).collect(), brightest }))
}

impl<'a> Pilot<'a> {
    fn new(ghosts: &'a Ghosts) -> Self {
        let size = ghosts.pipeline.scene.imager.size();
        let (width, height) = (size.width_px as usize, size.height_px as usize);
        let blocks = Blocks { width, height, pixel_mm2: size.pixel_area_mm2() };
        let zones = ghosts.plan.zones.count();
        let rays = RAYS + RAYS_MORE * (zones - 1);
        let mut state = ghosts.state(BATCH);
        let (mut placed, mut everywhere) = (Vec::new(), Vec::new());
        let guides = vec![Guide::everywhere(); zones];
        for first in (0..rays).step_by(BATCH) {
            ghosts.place(&mut state, (0, first as u64, BATCH), |_, _| {});
            placed.push(state.rays.clone());
            let [.., a, b] = &state.numbers;
            everywhere.push(aimed(ghosts, state.rays.clone(), &guides, [a.slice(BATCH), b.slice(BATCH)]));
        }
        Self { ghosts, blocks, placed, everywhere }
    }

    /// One round of a path by so many batches: what its guides found, and each ray that came through. `stream` are the numbers of the
    /// directions; `None` for those that all paths share, all over the front.
    fn round(
        &self,
        state: &mut ThreadState,
        way: &Way,
        guides: &[Guide],
        stream: Option<u64>,
        batches: usize,
    ) -> (Vec<Found>, Vec<Seen>) {
        let mut found: Vec<Found> = guides.iter().map(Found::of).collect();
        let mut seen = Vec::new();
        let mut own;
        for (at, shared) in self.everywhere.iter().enumerate().take(batches) {
            let batch = match stream {
                None => shared,
                Some(stream) => {
                    own = self.aimed(at, guides, stream);
                    &own
                }
            };
            for (ray, tag, value) in self.through(state, way, &batch.rays) {
                let (zone, aim) = batch.aims[ray];
                // Where one guide is for all zones, that.
                let zone = zone.min(guides.len() - 1);
                // Without what the density makes of it.
                let value = value.abs() * aim.density;
                found[zone].add(&guides[zone], aim, value);
                seen.push((zone, aim, self.blocks.of(pixel_and_channel(tag).0), value));
            }
        }
        (found, seen)
    }

    /// A batch aimed by guides.
    fn aimed(&self, at: usize, guides: &[Guide], stream: u64) -> Aimed {
        let [mut a, mut b] = [[0.0; BATCH]; 2];
        for (dimension, numbers) in [(Dimension::PupilU, &mut a), (Dimension::PupilV, &mut b)] {
            let first = (at * BATCH) as u64;
            self.ghosts.numbers.fill(self.ghosts.pipeline.isa, stream, first, dimension as u32, numbers);
        }
        aimed(self.ghosts, self.placed[at].clone(), guides, [&a, &b])
    }

    /// Follows a path: number, tag and value of each ray that brings light to the frame.
    fn through(&self, state: &mut ThreadState, way: &Way, from: &RayBatch) -> Vec<(usize, u32, f64)> {
        let ghosts = self.ghosts;
        state.rays = from.clone();
        let c = state.rays.columns_mut();
        c.weight.fill(1.0);
        (0..).zip(c.tag).for_each(|(number, tag)| *tag = number);
        ghosts.pipeline.tracer.follow(&way.route, &mut state.rays, &mut state.work);
        let numbers = state.rays.tags().to_vec();
        state.rays.set_stage(StageKey::IMAGER);
        ghosts.receive().receive(&mut state.rays, ghosts.pipeline.isa);
        state.settle(ghosts.pipeline.isa);
        // What they carry is asked only of those that came.
        let mut lit = from.clone();
        let c = lit.columns_mut();
        let unlit = Loss::Unlit.state(0);
        let mut came = vec![unlit; c.state.len()];
        numbers
            .iter()
            .zip(state.rays.weights())
            .filter(|(_, w)| **w != 0.0)
            .for_each(|(n, _)| came[*n as usize] = ALIVE);
        if came.iter().all(|state| *state == unlit) {
            return Vec::new();
        }
        c.state.iter_mut().zip(&came).filter(|(_, came)| **came == unlit).for_each(|(state, _)| *state = unlit);
        lit.set_stage(StageKey::SOURCE);
        ghosts.emit().radiate(&mut lit, ghosts.pipeline.isa);
        let carries = |number: u32| {
            let at = number as usize;
            if lit.states()[at] == ALIVE { lit.weights()[at] } else { 0.0 }
        };
        state.rays.weighing().weight.iter_mut().zip(&numbers).for_each(|(weight, number)| *weight *= carries(*number));
        let brought = ghosts.brought(state).into_iter().zip(numbers);
        brought.filter(|((_, value), _)| *value != 0.0).map(|((tag, value), n)| (n as usize, tag, value)).collect()
    }
}

fn aimed(ghosts: &Ghosts, mut rays: RayBatch, guides: &[Guide], numbers: [&[f64]; 2]) -> Aimed {
    let mut aims = Vec::with_capacity(rays.len());
    ghosts.aim(&mut rays, guides, numbers, |zone, aim| aims.push((zone, aim)));
    Aimed { rays, aims }
}
