//! The pilot: finds where on the front of the lens the light of each path enters, and how many rays each path needs.
//!
//! Places on the source are expensive to draw, and finding out what a ray from there carries can be even more expensive (a picture with
//! depth is traversed). Places are therefore drawn once and shared by all paths, and only rays that come through are evaluated. In the
//! first round all paths share the directions, too; this round tells whether to go on.
//!
//! Three to six rounds find where light enters. In two further rounds rays are shared out as those of the picture will be, the second better
//! than the first. Cells of the front get rays by the root of the mean square of what they bring, as a fraction of the ghosts'
//! light in its block of 32 x 32 pixels. The rays of all rounds form one set, as dense as they are together.

use super::guide::{Aim, Guide, Lit};
use super::path_cells::{self, PathCells, Piece};
use super::pilot_hit::{self, Contribution, PilotHit};
use super::pilot_rays::{PilotRays, Sorted};
use super::{Ghosts, PathPlan};
use crate::Workers;
use crate::error::RenderError;
use crate::pipeline::ThreadState;
use spectra_core::batch::pixel_and_channel;
use spectra_core::loss::ALIVE;
use spectra_core::numbers::{Dimension, StageKey};
use spectra_core::workers::map_pieces;
use spectra_core::{Loss, RayBatch};

/// Number of rays for each path and round with one zone, in the rounds that look where the light of each path enters.
const RAYS: usize = 4096;
/// Number of rays for each path and round that each further zone adds.
const RAYS_MORE: usize = 256;
/// Number of rounds of a path at least. There are more while some rays passed some surfaces but none passed all.
const LEAST_ROUNDS: u64 = 3;
/// Number of rounds in which zones add rays. Later ones look closer at a narrow entrance, which all zones share.
const ZONE_ROUNDS: u64 = 2;
/// Number of rounds at most.
const ROUNDS: u64 = 6;
/// Number of further rounds, which find where noise is. Their rays are shared out like those of the picture.
const SHARED: u64 = 2;
/// Number of rays of each further round, as a fraction of those of a sample.
const SHARED_RAYS: f64 = 0.32;
/// Largest number of rays of each further round. It does not depend on the number of samples, because otherwise a picture that is continued
/// would be a different one.
const SHARED_MOST: f64 = (3_u64 << 18) as f64;
/// Number of streams of random numbers of each path.
const STREAMS: u64 = ROUNDS + SHARED;
/// Divisor for the rays of paths of more than two reflections, which are many and have little light.
const OF_MORE: usize = 4;
/// Number of rays in a batch.
const BATCH: usize = 256;
/// Side of a block, pixels.
const BLOCK: usize = 32;
/// Fraction of the brightest block's light below which a block need not be as clean as brighter ones.
const DIM: f64 = 1e-4;
/// Number of batches of each path that tell whether to go on.
const SCOUTS: usize = 4;
/// Factor by which the first batches must find ghosts too dim before the search ends. They see little of ghosts that enter through a narrow
/// area.
const DOUBT: f64 = 2.0;

/// The results of the pilot.
pub(super) struct Plan {
    /// Guides of each path, and the variance of one of its rays.
    pub ways: Vec<(Vec<Guide>, f64)>,
    /// Light of the brightest block, W/m2: the mean over its pixels, summed over the channels.
    pub brightest: f64,
}

impl Plan {
    /// Creates a plan without a search: rays go all over the front, with variances that give all paths equally many rays.
    pub fn even(ghosts: &Ghosts) -> Self {
        let way = |way: &PathPlan| (way.guides.clone(), way.cost());
        Self { ways: ghosts.plan.ways.iter().map(way).collect(), brightest: 0.0 }
    }
}

/// The blocks of the frame.
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

    /// Sums contributions, given with their blocks, to the light of each block.
    fn light(&self, parts: impl Iterator<Item = (usize, f64)>) -> Vec<f64> {
        let mut light = vec![0.0; self.count()];
        parts.for_each(|(block, part)| light[block] += part);
        light
    }

    /// Returns the light of the brightest block, W/m2.
    fn brightest(&self, light: &[f64]) -> f64 {
        let pixels = |block: usize| {
            let (column, row) = (block % self.across() * BLOCK, block / self.across() * BLOCK);
            ((self.width - column).min(BLOCK) * (self.height - row).min(BLOCK)) as f64
        };
        let mean = |(block, light): (usize, &f64)| light / (pixels(block) * self.pixel_mm2);
        light.iter().enumerate().map(mean).fold(0.0, f64::max)
    }
}

/// A batch aimed at the lens, and the zone and aim of each ray.
struct Aimed {
    rays: RayBatch,
    aims: Vec<(usize, Aim)>,
}

struct Pilot<'a> {
    ghosts: &'a Ghosts,
    /// Channels in which noise is measured.
    judged: Vec<usize>,
    blocks: Blocks,
    /// Rays on the source, without a direction.
    placed: Vec<RayBatch>,
    /// Rays from the source, aimed all over the front.
    everywhere: Vec<Aimed>,
}

/// Returns an error if the caller no longer wants the result.
fn wanted(workers: &dyn Workers) -> Result<(), RenderError> {
    if workers.should_stop() { Err(RenderError::Stopped) } else { Ok(()) }
}

/// Searches all paths. `None` if no block has more light than `matters`.
pub(super) fn search(
    ghosts: &Ghosts,
    matters: Option<f64>,
    workers: &dyn Workers,
) -> Result<Option<Plan>, RenderError> {
    let pilot = &Pilot::new(ghosts);
    let (ways, fresh) = (&ghosts.plan.ways, || ghosts.state(BATCH));
    // Number of batches of a path, given the number for a pair of reflections.
    let of = |way: &PathPlan, batches: usize| if way.is_of_pair() { batches } else { batches.div_ceil(OF_MORE) };
    let first = |batches: usize| {
        map_pieces(workers, ways.len(), fresh, move |state, at| {
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
            .flat_map(|((_, came), way)| pilot_hit::light(came, (of(way, SCOUTS) * BATCH) as f64, Contribution::all));
        let light = pilot.blocks.light(parts);
        if is_dim(pilot.blocks.brightest(&light), DOUBT) {
            return Ok(None);
        }
    }
    let all = pilot.placed.len();
    let first = first(all)?;
    let closer = |lit: &[Lit]| -> Vec<Guide> { lit.iter().map(Lit::closer).collect() };
    let mut sights = map_pieces(workers, ways.len(), fresh, |state, at| {
        wanted(workers)?;
        let (mut guides, mut sight) = (closer(&first[at].0), PilotRays::default());
        for round in 1..ROUNDS {
            let most = if round < ZONE_ROUNDS { all } else { all.min(RAYS / BATCH) };
            let batches = of(&ways[at], most);
            let (lit, came) = pilot.round(state, &ways[at], &guides, Some(stream(at, round)), batches);
            let next = closer(&lit);
            sight.add(std::mem::replace(&mut guides, next), (batches * BATCH) as f64, came);
            if round + 1 >= LEAST_ROUNDS && !Lit::are_on_the_way(&lit) {
                break;
            }
        }
        Ok::<_, RenderError>(sight)
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
        let came = map_pieces(workers, ways.len(), fresh, |state, at| {
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

/// Returns the stream of random numbers of a round of a path.
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

    /// Computes the guides with the least noise, as far as the pilot has seen.
    fn best(&self, sights: &[PilotRays], workers: &dyn Workers) -> Result<Plan, RenderError> {
        let ways = &self.ghosts.plan.ways;
        let parts = |of: fn(&Contribution) -> f64| sights.iter().flat_map(move |sight| sight.light(of));
        let light = self.blocks.light(parts(Contribution::judged));
        // Noise is relative to a block's light, or to a light so dim that nobody looks at it.
        let least = 0.5 * DIM * light.iter().fold(0.0_f64, |most, light| most.max(*light));
        let over: Vec<f64> = light.iter().map(|light| light.max(least).powi(2).recip()).collect();
        // One over the effective number of rays: as many as if all were equally bright.
        let mut few = vec![0.0; self.blocks.count()];
        for (block, part) in parts(Contribution::judged) {
            few[block] += over[block] * part * part;
        }
        let known = |(few, light): (&f64, &f64)| (*light > least).then(|| few.recip());
        let rays: Vec<Option<f64>> = few.iter().zip(&light).map(known).collect();
        let sort = |(): &mut (), at: usize| wanted(workers).map(|()| sights[at].sorted(&over));
        let sorted: Vec<Sorted> = map_pieces(workers, sights.len(), || (), sort)?;
        let (mut paths, mut pieces, mut first) = (Vec::new(), Vec::new(), 0);
        for (sorted, way) in sorted.iter().zip(ways) {
            paths.push(PathCells { zones: &sorted.trees, first, cost: way.cost() });
            let piece = |(cell, block, square): &(u32, u32, f64)| Piece {
                cell: first + *cell as usize,
                block: *block as usize,
                square: *square,
            };
            pieces.extend(sorted.pieces.iter().map(piece));
            first += sorted.leaves();
        }
        let weights = path_cells::weights(&pieces, &paths, &rays);
        let ways = sorted.iter().map(|sorted| sorted.guides(&weights)).collect();
        Ok(Plan { ways, brightest: self.blocks.brightest(&self.blocks.light(parts(Contribution::all))) })
    }

    /// Traces one round of a path with this many batches. Returns where light came through, and each ray that came through. `stream` is the
    /// stream of random numbers of the directions; `None` uses the directions that all paths share, all over the front.
    fn round(
        &self,
        state: &mut ThreadState,
        way: &PathPlan,
        guides: &[Guide],
        stream: Option<u64>,
        batches: usize,
    ) -> (Vec<Lit>, Vec<PilotHit>) {
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
            // Where one guide serves all zones, use that one.
            let aimed = |ray: usize| {
                let (zone, aim) = batch.aims[ray];
                (zone.min(guides.len() - 1), aim)
            };
            let passed = self.through(state, way, &batch.rays, |ray, tag, brought| {
                let (zone, aim) = aimed(ray);
                lit[zone].add(aim.place);
                let block = self.blocks.of(pixel_and_channel(tag).0);
                came.push(PilotHit { zone, aim, block, brought: brought.times(aim.density) });
            });
            for (ray, surfaces) in passed.into_iter().enumerate() {
                let (zone, aim) = aimed(ray);
                lit[zone].went(aim.place, surfaces);
            }
        }
        (lit, came)
    }

    /// Returns a batch aimed by guides.
    fn aimed(&self, at: usize, guides: &[Guide], stream: u64) -> Aimed {
        let [mut a, mut b] = [[0.0; BATCH]; 2];
        for (dimension, numbers) in [(Dimension::PupilU, &mut a), (Dimension::PupilV, &mut b)] {
            let first = (at * BATCH) as u64;
            self.ghosts.numbers.fill(self.ghosts.pipeline.isa, stream, first, dimension as u32, numbers);
        }
        aimed(self.ghosts, self.placed[at % self.placed.len()].clone(), guides, [&a, &b])
    }

    /// Traces a batch along a path. Calls `came` with the number, the tag and the contribution of each ray that brings light to the frame.
    /// Returns the number of surfaces that each ray passed.
    fn through(
        &self,
        state: &mut ThreadState,
        way: &PathPlan,
        from: &RayBatch,
        mut came: impl FnMut(usize, u32, Contribution),
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
        ghosts.receive().receive(&mut state.rays);
        state.settle(ghosts.pipeline.isa);
        // Only rays that came through are asked for the light that they carry.
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
        ghosts.emit().radiate(&mut lit);
        let carries = |number: u32| {
            let at = number as usize;
            if lit.states()[at] == ALIVE { lit.weights()[at] } else { 0.0 }
        };
        state
            .rays
            .weight_columns()
            .weight
            .iter_mut()
            .zip(&numbers)
            .for_each(|(weight, number)| *weight *= carries(*number));
        let brought = ghosts.contributions(state);
        let channels = ghosts.pipeline.responses.channels();
        for ((number, tag), brought) in numbers.iter().zip(state.rays.tags()).zip(brought.chunks_exact(channels)) {
            let brought = Contribution {
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
