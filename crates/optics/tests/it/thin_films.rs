//! Reflectance and transmittance of surfaces with and without films, against another program's figures: `xtask/thin_films.py`.

use spectra_lens::{Coating, Stack, StackLayer};
use std::path::Path;
use std::sync::Arc;

#[test]
fn reflectances_are_those_of_tmm() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/thin-films.csv");
    let text = std::fs::read_to_string(file).expect("a table");
    let (mut held, mut worst) = (0, 0.0_f64);
    for row in text.lines().skip(1) {
        let fields: Vec<&str> = row.split(',').collect();
        let number = |at: usize| fields[at].parse::<f64>().expect("a number");
        let (before, after) = (number(1), number(2));
        let layers: Vec<[f64; 3]> = fields[3]
            .split('/')
            .filter(|layer| !layer.is_empty())
            .map(|layer| {
                let figures: Vec<f64> = layer.split(' ').map(|f| f.parse().expect("a number")).collect();
                figures.try_into().expect("thickness, n, k")
            })
            .collect();
        // A coating is stated from the air on, whichever way light comes.
        let from_air: Vec<[f64; 3]> =
            if before < after { layers.clone() } else { layers.iter().rev().copied().collect() };
        let stack = from_air.iter().map(|[d, n, k]| StackLayer::constant(*d, *n, *k)).collect();
        let mut coatings = vec![Coating::Stack(Arc::new(Stack::new(stack)))];
        match layers[..] {
            [] => coatings.push(Coating::Bare),
            [[thickness_nm, index, 0.0]] => coatings.push(Coating::Layer { index, thickness_nm }),
            _ => {}
        }
        let cosine = number(5).to_radians().cos();
        for coating in coatings {
            let reflected = coating.reflectance(before, after, cosine, number(4));
            let passed = coating.transmittance(before, after, cosine, number(4));
            let got = [reflected.s, reflected.p, passed.s, passed.p];
            for (got, want) in got.into_iter().zip((6..10).map(number)) {
                worst = worst.max((got - want).abs());
                assert!((got - want).abs() < 1e-9, "{row}: {got:e}");
            }
            held += 1;
        }
    }
    assert!(held == 764, "{held}");
    println!("largest difference {worst:e}");
}
