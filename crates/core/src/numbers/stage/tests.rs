use super::*;
use crate::{Isa, Loss, RayBatch};

/// `many` rays of one stream, from sample `first` on.
fn rays(numbers: &Numbers, estimator: &str, stream: u64, first: u64, many: usize) -> RayBatch {
    let mut rays = RayBatch::new(many).with_numbers();
    rays.restart(many);
    rays.number(0, numbers, estimator, stream, first);
    rays
}

/// Pairs that a stage draws for these rays.
fn drawn(rays: &mut RayBatch, stage: StageKey, event: u32) -> Vec<[f64; 2]> {
    rays.set_stage(stage);
    let c = rays.columns_mut();
    (0..c.x.len()).map(|i| c.numbers.of(i).expect("numbered").pair(event)).collect()
}

const A: StageKey = StageKey::new("a", 0);
const B: StageKey = StageKey::new("b", 0);

/// Every elementary interval of area 2^-8 holds one point of each aligned block of 2^8 samples: a (0, 8, 2)-net, for any stage,
/// event and stream, however many there are.
#[test]
fn each_event_is_a_net() {
    let numbers = Numbers::sobol(9);
    for (stage, event, stream, first) in [(A, 0, 0, 0), (A, 1, 5, 256), (B, 40, 7, 1 << 20), (B, 3, 7, 3 << 33)] {
        let points = drawn(&mut rays(&numbers, "backward", stream, first, 256), stage, event);
        for a in 0..=8 {
            let (nu, nv) = (1 << a, 1 << (8 - a));
            let mut seen = vec![0; 256];
            points.iter().for_each(|[u, v]| seen[(u * nu as f64) as usize * nv + (v * nv as f64) as usize] += 1);
            assert!(seen.iter().all(|s| *s == 1), "{nu} x {nv}");
        }
    }
}

/// One of n numbers in each of n strata, where the scene asks for jittered ones.
#[test]
fn strata_are_kept() {
    let points = drawn(&mut rays(&Numbers::stratified(3, 100), "backward", 4, 200, 100), A, 9);
    for coordinate in [0, 1] {
        let mut seen = vec![0; 100];
        points.iter().for_each(|p| seen[(p[coordinate] * 100.0) as usize] += 1);
        assert!(seen.iter().all(|s| *s == 1), "{seen:?}");
    }
}

/// The mean of a smooth function of 24 numbers (12 events, three stages) beyond the five of the path: with 16 times as many
/// samples the error of independent numbers falls to a fourth, that of a net to a sixteenth or less. Root mean squares over 40
/// streams, which are good to a tenth or so.
#[test]
fn means_converge_as_with_a_net() {
    let stages = [A, B, StageKey::new("a", 1)];
    let error = |numbers: &Numbers, samples: usize| {
        let squares = (0..40).map(|stream| {
            let mut rays = rays(numbers, "backward", stream, 0, samples);
            let all = stages.iter().flat_map(|s| (0..4).map(|event| (*s, event)));
            let points = all.flat_map(|(stage, event)| drawn(&mut rays, stage, event));
            let sum: f64 = points.map(|[u, v]| crate::math::exp(u) * (1.0 + v * v)).sum();
            let mean = sum / (12 * samples) as f64;
            let expected = (std::f64::consts::E - 1.0) * 4.0 / 3.0;
            (mean - expected) * (mean - expected)
        });
        (squares.sum::<f64>() / 40.0).sqrt()
    };
    let (random, sobol) = (Numbers::random(5), Numbers::sobol(5));
    let fall = |numbers: &Numbers| error(numbers, 128) / error(numbers, 2048);
    let (slow, fast) = (fall(&random), fall(&sobol));
    println!("random falls by {slow:.1}, Sobol by {fast:.1}; {:.1}", error(&random, 2048) / error(&sobol, 2048));
    assert!((2.5..6.0).contains(&slow), "{slow}");
    assert!(fast > 16.0, "{fast}");
    assert!(error(&random, 2048) > 30.0 * error(&sobol, 2048));
}

/// Numbers are uniform, and uncorrelated between coordinates, events, stages, streams, estimators, seeds and the dimensions of
/// the path: 36 pairs of columns, each within four standard errors.
#[test]
fn events_are_independent() {
    let n = 20_000;
    for new in [Numbers::sobol, Numbers::random, |seed| Numbers::stratified(seed, 64)] {
        let numbers = new(1);
        let one = |estimator: &str, seed, stream, stage, event| {
            drawn(&mut rays(&new(seed), estimator, stream, 0, n), stage, event)
        };
        let base = one("backward", 1, 0, A, 0);
        let mut columns: Vec<Vec<f64>> = (0..2).map(|k| base.iter().map(|p| p[k]).collect()).collect();
        let others = [
            one("backward", 1, 0, A, 1),
            one("backward", 1, 0, B, 0),
            one("backward", 1, 0, StageKey::new("a", 1), 0),
            one("backward", 1, 1, A, 0),
            one("forward", 1, 0, A, 0),
            one("backward", 2, 0, A, 0),
        ];
        columns.extend(others.iter().map(|points| points.iter().map(|p| p[0]).collect::<Vec<_>>()));
        let mut path = vec![0.0; n];
        numbers.fill(Isa::Baseline, 0, 0, 0, &mut path);
        columns.push(path);
        let se = (1.0 / 12.0 / n as f64).sqrt();
        for (i, a) in columns.iter().enumerate() {
            let mean = a.iter().sum::<f64>() / n as f64;
            assert!((mean - 0.5).abs() < 4.0 * se && a.iter().all(|u| (0.0..1.0).contains(u)), "{mean}");
            for (j, b) in columns.iter().enumerate().skip(i + 1) {
                let c = a.iter().zip(b).map(|(x, y)| (x - 0.5) * (y - 0.5)).sum::<f64>() / n as f64 * 12.0;
                assert!(c.abs() < 4.0 / (n as f64).sqrt(), "{:?}: {i} and {j}, {c}", numbers.kind);
            }
        }
    }
}

/// A ray keeps its numbers when others are dropped, in a batch of any size, and whatever another stage draws.
#[test]
fn a_ray_keeps_its_numbers() {
    for numbers in [Numbers::sobol(7), Numbers::random(7), Numbers::stratified(7, 10)] {
        let want = drawn(&mut rays(&numbers, "forward", 0, 40, 100), A, 2);
        let mut batch = rays(&numbers, "forward", 0, 40, 100);
        drawn(&mut batch, B, 2);
        let ended = batch.columns_mut().state.iter_mut().enumerate().filter(|(i, _)| i % 3 != 0);
        ended.for_each(|(_, state)| *state = Loss::Vignetted.state(1));
        batch.compact();
        let kept: Vec<_> = want.iter().copied().step_by(3).collect();
        assert_eq!(drawn(&mut batch, A, 2), kept);
        for (i, want) in want.iter().enumerate() {
            assert_eq!(drawn(&mut rays(&numbers, "forward", 0, 40 + i as u64, 1), A, 2), [*want]);
        }
    }
}

/// Two streams in one batch; a batch that starts over has no numbers until it gets them, one without columns never.
#[test]
fn numbers_are_there_where_they_were_given() {
    let numbers = Numbers::sobol(7);
    let mut both = rays(&numbers, "backward", 3, 0, 20);
    both.number(10, &numbers, "backward", 4, 0);
    let want = [3, 4].map(|stream| drawn(&mut rays(&numbers, "backward", stream, 0, 10), A, 0)).concat();
    assert_eq!(drawn(&mut both, A, 0), want);
    both.restart(20);
    assert_eq!(both.columns_mut().numbers.of(0), None);
    let mut without = RayBatch::new(1);
    without.restart(1);
    without.number(0, &numbers, "backward", 0, 0);
    assert_eq!(without.columns_mut().numbers.of(0), None);
}

/// The generator belongs to the event, and `rand_distr` draws from it: the mean of Poisson counts, within four standard errors.
#[test]
fn distributions_draw_from_the_generator() {
    use rand_distr::{Distribution, Poisson};
    let many = 20_000;
    let mut rays = rays(&Numbers::sobol(2), "backward", 0, 0, many);
    rays.set_stage(A);
    let c = rays.columns_mut();
    let poisson = Poisson::new(2.5).expect("a mean");
    let count = |i: usize, event| -> f64 { poisson.sample(&mut c.numbers.of(i).expect("numbered").generator(event)) };
    let mean = (0..many).map(|i| count(i, 0)).sum::<f64>() / many as f64;
    assert!((mean - 2.5).abs() < 4.0 * (2.5 / many as f64).sqrt(), "{mean}");
    assert!((0..100).all(|i| count(i, 0) == count(i, 0)) && (0..100).any(|i| count(i, 0) != count(i, 1)));
}
