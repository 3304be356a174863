//! The pilot: where on the front of the lens the light of each path comes in, and how much each path needs.
//!
//! Places of the source are dear to draw, and what a ray from one carries can be dearer still (a picture with depth is walked through).
//! So places are drawn once and shared by all paths, and only rays that come through are asked what they carry. In the first round all
//! paths share the directions too; it says whether going on is worth it.

use super::guide::{Aim, Guide, Lit};
use super::seen::{self, Brought, Seen};
use super::shares::{self, Piece, Share};
use super::sight::{Sight, Sorted};
use super::{Ghosts, Way};
use crate::Workers;
use crate::error::RenderError;
use crate::pipeline::ThreadState;
use spectra_core::batch::pixel_and_channel;
use spectra_core::loss::ALIVE;
use spectra_core::numbers::{Dimension, StageKey};
use spectra_core::workers::each_of;
use spectra_core::{Loss, RayBatch};

/// Rays for each path and round, of one zone and of each further one, in rounds that look where the light of each path comes in: so many
/// rounds, and more while there is a zone whose rays passed some surfaces, but none all of them.
const RAYS: usize = 4096;
const RAYS_MORE: usize = 256;
const LEAST_ROUNDS: u64 = 3;
const ROUNDS: u64 = 6;
/// Rounds after those, whose rays are shared out as those of the picture will be, each better than the one before: they find where
/// noise is. Rays of each in parts of a sample's, and at most: as
/// many whatever the samples, or a picture that goes on would be another one.
const SHARED: u64 = 4;
const SHARED_RAYS: f64 = 0.16;
const SHARED_MOST: f64 = (3_u64 << 17) as f64;
/// Streams of numbers of each path.
const STREAMS: u64 = ROUNDS + SHARED;
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

    /// What came to each, of parts of light.
    fn light(&self, parts: impl Iterator<Item = (usize, f64)>) -> Vec<f64> {
        let mut light = vec![0.0; self.count()];
        parts.for_each(|(block, part)| light[block] += part);
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
    /// Channels that noise is asked of.
    judged: Vec<usize>,
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
        let parts = scouts
            .iter()
            .zip(ways)
            .flat_map(|((_, came), way)| seen::light(came, (of(way, SCOUTS) * BATCH) as f64, Brought::all));
        let light = pilot.blocks.light(parts);
        if is_dim(pilot.blocks.brightest(&light), DOUBT) {
            return Ok(None);
        }
    }
    let all = pilot.placed.len();
    let first = first(all)?;
    let closer = |lit: &[Lit]| -> Vec<Guide> { lit.iter().map(Lit::closer).collect() };
    let mut sights = each_of(workers, ways.len(), fresh, |state, at| {
        wanted(workers)?;
        let mut guides = closer(&first[at].0);
        let batches = of(&ways[at], all);
        for round in 1..ROUNDS {
            let (lit, came) = pilot.round(state, &ways[at], &guides, Some(stream(at, round)), batches);
            let done = round + 1;
            if done == ROUNDS || done >= LEAST_ROUNDS && !lit.iter().any(Lit::is_on_the_way) {
                let mut sight = Sight::default();
                sight.add(guides, (batches * BATCH) as f64, came);
                return Ok::<_, RenderError>(sight);
            }
            guides = closer(&lit);
        }
        Ok(Sight::default())
    })?;
    let divisor = ghosts.pipeline.search_divisor() as f64;
    for round in 0..SHARED {
        let plan = pilot.best(&sights, workers)?;
        if round == 0 && is_dim(plan.brightest, 1.0) {
            return Ok(None);
        }
        let needs = plan.ways.iter().zip(ways).map(|((_, variance), way)| (variance / way.cost()).sqrt());
        let sum: f64 = needs.clone().sum();
        let rays = (ghosts.rays_a_sample(matters, plan.brightest) as f64 * SHARED_RAYS).min(SHARED_MOST) / divisor;
        let batches: Vec<usize> = needs.map(|need| (rays * need / sum / BATCH as f64).round() as usize).collect();
        let came = each_of(workers, ways.len(), fresh, |state, at| {
            wanted(workers)?;
            let stream = Some(stream(at, ROUNDS + round));
            Ok::<_, RenderError>(pilot.round(state, &ways[at], &plan.ways[at].0, stream, batches[at]).1)
        })?;
        for (((sight, (guides, _)), came), batches) in sights.iter_mut().zip(plan.ways).zip(came).zip(batches) {
            sight.add(guides, (batches * BATCH) as f64, came);
        }
    }
    Ok(Some(pilot.best(&sights, workers)?))
}

/// The numbers of a round of a path.
fn stream(path: usize, round: u64) -> u64 {
    (path as u64 + 1) * STREAMS + round
}

impl<'a> Pilot<'a> {
    fn new(ghosts: &'a Ghosts) -> Self {
        let size = ghosts.pipeline.scene.imager.size();
        let (width, height) = (size.width_px as usize, size.height_px as usize);
        let blocks = Blocks { width, height, pixel_mm2: size.pixel_area_mm2() };
        let zones = ghosts.plan.zones.count();
        let rays = (RAYS + RAYS_MORE * (zones - 1)) / ghosts.pipeline.search_divisor();
        let mut state = ghosts.state(BATCH);
        let (mut placed, mut everywhere) = (Vec::new(), Vec::new());
        let guides = vec![Guide::everywhere(); zones];
        for first in (0..rays).step_by(BATCH) {
            ghosts.place(&mut state, (0, first as u64, BATCH), |_, _| {});
            placed.push(state.rays.clone());
            let [.., a, b] = &state.numbers;
            everywhere.push(aimed(ghosts, state.rays.clone(), &guides, [a.slice(BATCH), b.slice(BATCH)]));
        }
        Self { ghosts, judged: ghosts.pipeline.judged_channels(), blocks, placed, everywhere }
    }

    /// The guides with the least noise, as far as was seen.
    fn best(&self, sights: &[Sight], workers: &dyn Workers) -> Result<Plan, RenderError> {
        let ways = &self.ghosts.plan.ways;
        let parts = |of: fn(&Brought) -> f64| sights.iter().flat_map(move |sight| sight.light(of));
        let light = self.blocks.light(parts(Brought::judged));
        // Noise is a part of a block's light, or of light so dim that nobody looks at it.
        let least = 0.5 * DIM * light.iter().fold(0.0_f64, |most, light| most.max(*light));
        let over: Vec<f64> = light.iter().map(|light| light.max(least).powi(2).recip()).collect();
        // One over the number of rays, as many as were all alike.
        let mut few = vec![0.0; self.blocks.count()];
        for (block, part) in parts(Brought::judged) {
            few[block] += over[block] * part * part;
        }
        let known = |(few, light): (&f64, &f64)| (*light > least).then(|| few.recip());
        let rays: Vec<Option<f64>> = few.iter().zip(&light).map(known).collect();
        let sort = |(): &mut (), at: usize| wanted(workers).map(|()| sights[at].sorted(&over));
        let sorted: Vec<Sorted> = each_of(workers, sights.len(), || (), sort)?;
        let (mut paths, mut pieces, mut first) = (Vec::new(), Vec::new(), 0);
        for (sorted, way) in sorted.iter().zip(ways) {
            paths.push(Share { zones: &sorted.trees, first, cost: way.cost() });
            let piece = |(cell, block, square): &(u32, u32, f64)| Piece {
                cell: first + *cell as usize,
                block: *block as usize,
                square: *square,
            };
            pieces.extend(sorted.pieces.iter().map(piece));
            first += sorted.leaves();
        }
        let weights = shares::weights(&pieces, &paths, &rays);
        let ways = sorted.iter().map(|sorted| sorted.guides(&weights)).collect();
        Ok(Plan { ways, brightest: self.blocks.brightest(&self.blocks.light(parts(Brought::all))) })
    }

    /// One round of a path by so many batches: where light came, and each ray that came through. `stream` are the numbers of the
    /// directions; `None` for those that all paths share, all over the front.
    fn round(
        &self,
        state: &mut ThreadState,
        way: &Way,
        guides: &[Guide],
        stream: Option<u64>,
        batches: usize,
    ) -> (Vec<Lit>, Vec<Seen>) {
        let mut lit: Vec<Lit> = guides.iter().map(Lit::of).collect();
        let mut came = Vec::new();
        let mut own;
        for (at, shared) in self.everywhere.iter().cycle().enumerate().take(batches) {
            let batch = match stream {
                None => shared,
                Some(stream) => {
                    own = self.aimed(at, guides, stream);
                    &own
                }
            };
            // Where one guide is for all zones, that.
            let aimed = |ray: usize| {
                let (zone, aim) = batch.aims[ray];
                (zone.min(guides.len() - 1), aim)
            };
            let passed = self.through(state, way, &batch.rays, |ray, tag, brought| {
                let (zone, aim) = aimed(ray);
                lit[zone].add(aim.place);
                let block = self.blocks.of(pixel_and_channel(tag).0);
                came.push(Seen { zone, aim, block, brought: brought.times(aim.density) });
            });
            for (ray, surfaces) in passed.into_iter().enumerate() {
                let (zone, aim) = aimed(ray);
                lit[zone].went(aim.place, surfaces);
            }
        }
        (lit, came)
    }

    /// A batch aimed by guides.
    fn aimed(&self, at: usize, guides: &[Guide], stream: u64) -> Aimed {
        let [mut a, mut b] = [[0.0; BATCH]; 2];
        for (dimension, numbers) in [(Dimension::PupilU, &mut a), (Dimension::PupilV, &mut b)] {
            let first = (at * BATCH) as u64;
            self.ghosts.numbers.fill(self.ghosts.pipeline.isa, stream, first, dimension as u32, numbers);
        }
        aimed(self.ghosts, self.placed[at % self.placed.len()].clone(), guides, [&a, &b])
    }

    /// Follows a path. `came` is given number and tag of each ray that brings light to the frame, and what it brings. Says how many
    /// surfaces each ray passed.
    fn through(
        &self,
        state: &mut ThreadState,
        way: &Way,
        from: &RayBatch,
        mut came: impl FnMut(usize, u32, Brought),
    ) -> Vec<u16> {
        let ghosts = self.ghosts;
        state.rays = from.clone();
        let c = state.rays.columns_mut();
        c.weight.fill(1.0);
        (0..).zip(c.tag).for_each(|(number, tag)| *tag = number);
        let mut passed = vec![0_u16; from.len()];
        ghosts.pipeline.tracer.follow_each(&way.route, &mut state.rays, &mut state.work, |_, rays| {
            let alive = rays.states().iter().zip(rays.tags()).filter(|(state, _)| **state == ALIVE);
            alive.for_each(|(_, number)| passed[*number as usize] += 1);
        });
        let numbers = state.rays.tags().to_vec();
        state.rays.set_stage(StageKey::IMAGER);
        ghosts.receive().receive(&mut state.rays, ghosts.pipeline.isa);
        state.settle(ghosts.pipeline.isa);
        // What they carry is asked only of those that came.
        let mut lit = from.clone();
        let c = lit.columns_mut();
        let unlit = Loss::Unlit.state(0);
        let mut arrived = vec![unlit; c.state.len()];
        numbers
            .iter()
            .zip(state.rays.weights())
            .filter(|(_, w)| **w != 0.0)
            .for_each(|(n, _)| arrived[*n as usize] = ALIVE);
        if arrived.iter().all(|state| *state == unlit) {
            return passed;
        }
        c.state
            .iter_mut()
            .zip(&arrived)
            .filter(|(_, arrived)| **arrived == unlit)
            .for_each(|(state, _)| *state = unlit);
        lit.set_stage(StageKey::SOURCE);
        ghosts.emit().radiate(&mut lit, ghosts.pipeline.isa);
        let carries = |number: u32| {
            let at = number as usize;
            if lit.states()[at] == ALIVE { lit.weights()[at] } else { 0.0 }
        };
        state.rays.weighing().weight.iter_mut().zip(&numbers).for_each(|(weight, number)| *weight *= carries(*number));
        let brought = ghosts.brought(state);
        let channels = ghosts.pipeline.responses.channels();
        for ((number, tag), brought) in numbers.iter().zip(state.rays.tags()).zip(brought.chunks_exact(channels)) {
            let brought = Brought {
                all: brought.iter().map(|value| value.abs()).sum(),
                judged: self.judged.iter().map(|channel| brought[*channel].abs()).sum(),
            };
            if brought.all != 0.0 {
                came(*number as usize, *tag, brought);
            }
        }
        passed
    }
}

fn aimed(ghosts: &Ghosts, mut rays: RayBatch, guides: &[Guide], numbers: [&[f64]; 2]) -> Aimed {
    let aims = ghosts.aim(&mut rays, guides, numbers).each().collect();
    Aimed { rays, aims }
}
