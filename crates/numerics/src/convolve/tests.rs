use super::*;

fn plane(width: usize, height: usize) -> Vec<f32> {
    (0..width * height).map(|k| ((k * 7919) % 1013) as f32 * if k % 97 == 5 { 1e4 } else { 0.01 }).collect()
}

fn kernel(radius: usize) -> Kernel {
    Kernel::new(radius, |i, j| 1.0 / (1.0 + (i * i + j * j) as f64) + if i + j == 0 { 2.0 } else { 0.0 })
}

/// Results against the double sum that defines a convolution, on planes smaller and larger than a block, and thin ones.
#[test]
fn blocks_give_the_sum_that_defines_a_convolution() {
    for (width, height, radius) in [(1, 1, 0), (5, 3, 4), (40, 90, 9), (700, 70, 20), (3, 1100, 3)] {
        let source = plane(width, height);
        let kernel = kernel(radius);
        let mut target = vec![0.0; source.len()];
        Convolver::<f64>::new(&kernel, width, height).apply(&source, &mut target, |to, v| *to = v as f32);
        let r = radius as i64;
        for k in (0..source.len()).step_by(37) {
            let (x, y) = ((k % width) as i64, (k / width) as i64);
            let mut want = 0.0;
            for j in -r..r + 1 {
                for i in -r..r + 1 {
                    let (u, v) = (x + i, y + j);
                    if (0..width as i64).contains(&u) && (0..height as i64).contains(&v) {
                        let weight = kernel.weight(i.unsigned_abs() as usize, j.unsigned_abs() as usize);
                        want += weight * f64::from(source[v as usize * width + u as usize]);
                    }
                }
            }
            let off = (f64::from(target[k]) - want).abs();
            assert!(off <= 1e-6 * want, "{width} {height} {radius}: {} {want}", target[k]);
        }
    }
}

#[test]
fn same_bits_on_any_threads_and_tier() {
    let (width, height) = (900, 1300);
    let source = plane(width, height);
    let run = |threads: usize, isa: Isa| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let mut convolver = Convolver::<f64>::new(&kernel(30), width, height);
        convolver.isa = isa;
        let mut target = vec![0.0; source.len()];
        pool.install(|| convolver.apply(&source, &mut target, |to, v| *to = v as f32));
        target
    };
    let want = run(1, Isa::Baseline);
    for isa in Isa::available() {
        assert!(run(3, isa) == want, "{}", isa.name());
    }
}

/// Single precision rounds by some 1e-7 of the root mean square of a block, and has the same bits everywhere, too.
#[test]
fn single_precision_is_as_good_as_it_says() {
    let (width, height) = (900, 700);
    let source: Vec<f32> = (0..width * height).map(|k| 1.0 + ((k * 7919) % 1013) as f32).collect();
    let kernel = Kernel::new(40, |i, j| 1.0 / (1.0 + (i * i + j * j) as f64));
    let sum = kernel.sum();
    let kernel = kernel.scaled(1.0 / sum);
    let mut want = vec![0.0; source.len()];
    Convolver::<f64>::new(&kernel, width, height).apply(&source, &mut want, |to, v| *to = v as f32);
    let root_mean_square = (want.iter().map(|v| v * v).sum::<f32>() / want.len() as f32).sqrt();
    let mut before: Option<Vec<f32>> = None;
    for isa in Isa::available() {
        let mut convolver = Convolver::<f32>::new(&kernel, width, height);
        convolver.isa = isa;
        let mut got = vec![0.0; source.len()];
        convolver.apply(&source, &mut got, |to, v| *to = v);
        let worst = got.iter().zip(&want).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(worst < 2e-6 * root_mean_square, "{worst} of {root_mean_square}");
        assert!(before.is_none_or(|before| before == got), "{}", isa.name());
        before = Some(got);
    }
}

/// A point 1e7 times as bright as the rest must not disturb it beyond what it sheds.
#[test]
fn shadows_survive_highlights() {
    let mut source = vec![1.0_f32; 300 * 300];
    source[150 * 300 + 150] = 1e7;
    let kernel = Kernel::new(2, |i, j| if i + j == 0 { 0.6 } else { 0.4 / 24.0 });
    let mut target = vec![0.0; source.len()];
    Convolver::<f64>::new(&kernel, 300, 300).apply(&source, &mut target, |to, v| *to = v as f32);
    assert!((target[150 * 300 + 154] - 1.0).abs() < 1e-6, "{}", target[150 * 300 + 154]);
}

#[test]
fn kernels_sum_over_all_four_quarters() {
    let kernel = Kernel::new(1, |i, j| [[1.0, 0.5], [0.5, 0.25]][j][i]);
    assert_eq!(kernel.sum(), 4.0);
    assert_eq!(kernel.clone().cropped(0).sum(), 1.0);
    assert_eq!(kernel.scaled(2.0).sum(), 8.0);
}

/// A kernel that is the same at opposite places and nowhere else.
#[test]
fn slanted_kernels_keep_their_slant() {
    let mut source = vec![0.0; 40 * 30];
    source[15 * 40 + 20] = 1.0;
    let weight =
        |i: isize, j: isize| if i == 2 * j && j.abs() < 4 { 1.0 / (1.0 + j.unsigned_abs() as f64) } else { 0.0 };
    let mut target = vec![0.0; source.len()];
    Convolver::<f64>::of(6, weight, 40, 30).apply(&source, &mut target, |to, v| *to = v as f32);
    for (at, found) in target.iter().enumerate() {
        let want = weight(at as isize % 40 - 20, at as isize / 40 - 15);
        assert!((f64::from(*found) - want).abs() < 1e-7, "{at}: {found} {want}");
    }
}
