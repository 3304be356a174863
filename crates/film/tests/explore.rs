use spectra_film::emulsion::Emulsion;
use spectra_film::positive::Positive;
use spectra_film::stock::Stock;
use spectra_scene::FileResources;
use spectra_spectrum::*;
fn stock(n: &str) -> Stock {
    Stock::load(n, &FileResources::beside("/nowhere".as_ref())).unwrap_or_else(|e| panic!("{e}"))
}
#[test]
fn explore() {
    for n in Stock::bundled() {
        let s = stock(n);
        println!(
            "{n}: {:?} {:?} {:?}",
            s.iso,
            s.developments().collect::<Vec<_>>(),
            s.layers.iter().map(|l| l.developments[0].curve.speed_point()).collect::<Vec<_>>()
        );
        let t = std::time::Instant::now();
        let e = Emulsion::new(&s, s.developments().next().unwrap()).unwrap();
        println!("   emulsion {:?} ranges {:?}", t.elapsed(), (0..e.layers()).map(|i| e.range(i)).collect::<Vec<_>>());
        if let Some(iso) = s.iso {
            println!("  gray {:?}", e.neutral((10.0 / iso).log10()));
        }
    }
    let neg = stock("kodak-vision3-250d-5207");
    let e = Emulsion::new(&neg, "normal").unwrap();
    let pr = stock("kodak-vision-2383");
    let pe = Emulsion::new(&pr, "normal").unwrap();
    let lamp = Emission::blackbody(3200.0).unwrap();
    let light = illuminant("D55").unwrap();
    let t = std::time::Instant::now();
    let p = Positive::printed(&e, 0.04, &pr, pe.clone(), &lamp, &light).unwrap();
    println!("tables {:?}", t.elapsed());
    let scan = Positive::scanned(&neg, &e, 0.04).unwrap();
    let table = Positive::transmitted(&neg, &e, &light).unwrap();
    for stops in -6..=7 {
        let x = (0.04f64).log10() + stops as f64 * 0.30103;
        let a = e.neutral(x);
        let s = |v: [f64; 3]| v.map(|v| (v * 1000.0).round() / 1000.0);
        println!(
            "{stops:3} amounts {:?} print {:?} shown {:?} scan {:?} table {:?}",
            s([a[0], a[1], a[2]]),
            p.print_amounts(&a).unwrap(),
            s(p.shown(&a)),
            s(scan.shown(&a)),
            s(table.shown(&a))
        );
    }
    // colorchecker
    let day = illuminant("D55").unwrap();
    let ch = neg.channels(&BAND).unwrap();
    let ek = stock("kodak-ektachrome-100d");
    let ee = Emulsion::new(&ek, "normal").unwrap();
    let ech = ek.channels(&BAND).unwrap();
    let proj = Positive::transmitted(&ek, &ee, &light).unwrap();
    for name in [
        "dark-skin",
        "light-skin",
        "blue-sky",
        "foliage",
        "blue",
        "green",
        "red",
        "yellow",
        "magenta",
        "cyan",
        "white",
        "neutral-8",
        "neutral-6.5",
        "neutral-5",
        "neutral-3.5",
        "black",
    ] {
        let r = find_reflectance(&format!("colorchecker#{name}")).unwrap();
        let pow = (&day * &r).to_power(&BAND);
        let base = day.to_power(&BAND);
        let lum: Vec<f64> = BAND.wavelengths_nm().map(|w| 683.0 * v_lambda().at(w)).collect();
        let k = 0.04 / 0.18 / base.seen_by(&lum);
        let a: Vec<f64> =
            ch.iter().enumerate().map(|(i, c)| e.amount(i, (pow.seen_by(&c.response) * k).log10())).collect();
        let k2 = 0.1 / 0.18 / base.seen_by(&lum);
        let a2: Vec<f64> =
            ech.iter().enumerate().map(|(i, c)| ee.amount(i, (pow.seen_by(&c.response) * k2).log10())).collect();
        let u = |v: [f64; 3]| RgbSpace::srgb().encode(v).map(to_u8);
        let xyz = xyz_of_reflectance(&r, &day, Observer::cie_1931_2deg()).unwrap();
        let w = xyz_of_light(&day, Observer::cie_1931_2deg()).unwrap();
        let truth =
            u(RgbSpace::srgb()
                .from_xyz(Adaptation::Cat16.adapt(xyz, w, [0.95047, 1.0, 1.08883]).map(|v| v / w[1] * 1.0)));
        println!(
            "{name:12} true {:?} print {:?} scan {:?} ekta {:?}",
            truth,
            u(p.shown(&a)),
            u(scan.shown(&a)),
            u(proj.shown(&a2))
        );
    }
}
