//! Scenes with suns and headlamps: ghosts, stars and streaks.

use super::plane::{Plane, mean};
use super::taken::{Taken, first, ghosts, member};
use super::{Found, Promise, hold};
use spectra_core::RayBatch;
use spectra_core::glam::DVec3;
use spectra_core::loss::ALIVE;
use spectra_lens::Lens;
use spectra_render::GhostRays;
use spectra_scene::LightKind;
use spectra_tracer::{Indices, Path as LightPath, Tracer};
use std::f64::consts::PI;

/// Returns the coordinates of a point, mm, along the line from the middle to a source at these angles and perpendicular to it.
fn along(field_deg: [f64; 2], [x, y]: [f64; 2]) -> [f64; 2] {
    let [across, up] = field_deg.map(|degrees| degrees.to_radians().tan());
    let length = across.hypot(up);
    [(x * across + y * up) / length, (y * across - x * up) / length]
}

/// Returns the asymmetry of ghost light about the line from the sun through the middle, which is 0 for a lens of revolution. Within a
/// circle inside the frame: the mean signed distance from the line over the mean absolute distance.
fn one_sided(light: &Plane, field_deg: [f64; 2], radius_mm: f64) -> f64 {
    let mut sums = [0.0; 2];
    for (p, value) in light.all().filter(|(p, _)| p[0].hypot(p[1]) < radius_mm) {
        let [_, beside] = along(field_deg, p);
        sums = [sums[0] + value * beside, sums[1] + value * beside.abs()];
    }
    sums[0] / sums[1]
}

/// Returns the share of the light moved by diffraction that goes into this number of spikes around the brightest lamp. It is the
/// harmonic over the angle in a ring of these radii, mm, over the whole ring or its left half.
fn spikes(taken: &Taken, many: f64, ring_mm: [f64; 2], left_only: bool) -> f64 {
    let (star, center) = (taken.layer(LightKind::Star), lamp(taken));
    let mut sums = [0.0; 3];
    for (p, value) in star.all() {
        let (x, y) = (p[0] - center[0], p[1] - center[1]);
        let r = x.hypot(y);
        if (ring_mm[0]..ring_mm[1]).contains(&r) && (x < 0.0 || !left_only) {
            let (weight, (sin, cos)) = (value * r * r, (many * y.atan2(x)).sin_cos());
            sums = [sums[0] + weight, sums[1] + weight * cos, sums[2] + weight * sin];
        }
    }
    sums[1].hypot(sums[2]) / sums[0]
}

/// Returns the center of the brightest direct light.
fn lamp(taken: &Taken) -> [f64; 2] {
    let direct = taken.layer(LightKind::Direct);
    let mut center = direct.brightest();
    for _ in 0..3 {
        center = direct.center((center, [0.45; 2]));
    }
    center
}

/// Checks that a star has this number of spikes, and hardly as much light in other numbers.
fn star(taken: &Taken, many: f64, others: &[f64], ring_mm: [f64; 2], left_only: bool) -> Vec<Found> {
    let of = |many: f64| spikes(taken, many, ring_mm, left_only);
    let most = others.iter().map(|other| of(*other)).fold(0.0, f64::max);
    vec![
        Found::above(&format!("light in {many} spikes"), of(many), 0.3),
        Found::below("light in another number of spikes, over that", most / of(many), 0.5),
    ]
}

/// The light of a sun after one pair of reflections.
struct Ghost {
    /// Center on the picture, mm.
    center: [f64; 2],
    /// Standard deviation over both axes, mm.
    spread: f64,
    /// Light at 450, 540 and 620 nm, in arbitrary units.
    colors: [f64; 3],
}

/// Traces all pairs of reflections in a lens with rays over its front.
fn traced(lens: &Lens, field_deg: [f64; 2]) -> Vec<Ghost> {
    const SIDE: usize = 24;
    let tracer = Tracer::new(lens, Indices::Band { min_nm: 400.0, max_nm: 700.0 }).expect("known glass");
    let radius = lens.elements[0].semi_diameter_mm.expect("stated");
    // Light from the right and above goes left and down, and the picture is rotated by half a turn.
    let [x, y] = field_deg.map(|degrees| -degrees.to_radians().tan());
    let direction = DVec3::new(x, y, 1.0).normalize();
    let side = |k: usize| (2.0 * (k as f64 + 0.5) / SIDE as f64 - 1.0) * radius;
    let front = (0..SIDE * SIDE).map(|k| DVec3::new(side(k % SIDE), side(k / SIDE), 0.0));
    let starts: Vec<DVec3> = front.filter(|p| p.length() < radius).map(|p| p - 30.0 * direction).collect();
    let (mut rays, mut work) = (RayBatch::new(starts.len()), tracer.work(starts.len()));
    let mut all = Vec::new();
    for path in LightPath::ghosts(tracer.surfaces(), &tracer.reflecting(), 2) {
        let route = tracer.route(&path);
        let (mut sums, mut colors) = ([0.0; 4], [0.0; 3]);
        for (color, nm) in colors.iter_mut().zip([450.0, 540.0, 620.0]) {
            rays.restart(starts.len());
            let columns = rays.columns_mut();
            for (k, start) in starts.iter().enumerate() {
                (columns.x[k], columns.y[k], columns.z[k]) = (*start).into();
                (columns.l[k], columns.m[k], columns.n[k]) = direction.into();
            }
            columns.weight.fill(1.0);
            columns.wavelength_nm.fill(nm);
            tracer.follow(&route, &mut rays, &mut work);
            let ([x, y, z], [l, m, n]) = (rays.positions(), rays.directions());
            // Rays that ended may be left out of the batch.
            for k in (0..rays.len()).filter(|k| rays.states()[*k] == ALIVE) {
                let (x, y, w) = (z[k] * l[k] / n[k] - x[k], z[k] * m[k] / n[k] - y[k], rays.weights()[k]);
                *color += w;
                sums = [sums[0] + w, sums[1] + w * x, sums[2] + w * y, sums[3] + w * (x * x + y * y)];
            }
        }
        let center = [sums[1] / sums[0], sums[2] / sums[0]];
        let variance = sums[3] / sums[0] - center[0] * center[0] - center[1] * center[1];
        all.push(Ghost { center, spread: variance.max(0.0).sqrt(), colors });
    }
    all.retain(|ghost| ghost.colors[1] > 0.0);
    all
}

/// Returns figures of the small ghosts in the frame, without those more than 300 times dimmer than the brightest: their number, their
/// extent along the line, mm, and blue and red over green.
fn chain(lens: &Lens, field_deg: [f64; 2]) -> (usize, f64, f64) {
    let mut small = traced(lens, field_deg);
    small.retain(|g| g.spread < 1.2 && g.center[0].abs() < 18.0 && g.center[1].abs() < 12.0);
    let bright = |ghost: &Ghost| ghost.colors[1] / (ghost.spread * ghost.spread);
    let least = small.iter().map(bright).fold(0.0, f64::max) / 300.0;
    small.retain(|ghost| bright(ghost) > least);
    let places: Vec<f64> = small.iter().map(|ghost| along(field_deg, ghost.center)[0]).collect();
    let reach = places.iter().fold([f64::MAX, f64::MIN], |[low, high], at| [low.min(*at), high.max(*at)]);
    let sum = |k: usize| small.iter().map(|ghost| ghost.colors[k]).sum::<f64>();
    (small.len(), reach[1] - reach[0], 0.5 * (sum(0) + sum(2)) / sum(1))
}

const BIOTAR_DEG: [f64; 2] = [18.5, 11.0];
const FISHEYE_DEG: [f64; 2] = [47.0, 22.0];
const ZOOM_DEG: [f64; 2] = [13.1, 7.7];

/// Returns blue and red over green in the layers of a film.
fn violet(light: &Taken, window: super::plane::Window) -> f64 {
    let [red, green, blue] = ["red", "green", "blue"].map(|name| light.channel(name).mean(window));
    0.5 * (blue + red) / green
}

pub const SUNS: &[Promise] = &[
    Promise {
        scene: "sun-biotar",
        // The whole bare picture, and only the ghosts of the other two.
        pictures: &[
            member(
                0,
                &[
                    "imager.resolution=96",
                    "render.samples=4",
                    "render.diffraction=false",
                    "output=[{kind: exr, layers: [direct, ghosts]}]",
                ],
            ),
            ghosts(1, &["imager.resolution=48", "render.samples=8"], GhostRays::Even),
            ghosts(2, &["imager.resolution=48", "render.samples=1"], GhostRays::Even),
        ],
        says: "a chain of ghosts along the line from the sun through the middle, bare and with coatings of 1940 and 1970",
        held: |t| {
            let power = [&t[0], &t[1], &t[2]].map(|taken| taken.rendering.ledger.as_ref().expect("traced").ghosts_w);
            let light = t[0].layer(LightKind::Ghosts);
            let sun = t[0].layer(LightKind::Direct).brightest();
            let whole = ([0.0; 2], [18.0, 12.0]);
            let ghosts: f64 = light.sum();
            let far: f64 = light.all().filter(|(p, _)| along(BIOTAR_DEG, *p)[0] < 0.0).map(|(_, value)| value).sum();
            vec![
                Found::within("distance of the sun from its line, mm", along(BIOTAR_DEG, sun)[1], 0.0, 0.5),
                Found::within("asymmetry of the ghosts", one_sided(&light, BIOTAR_DEG, 11.5), 0.0, 0.1),
                Found::within("share of ghost light beyond the middle", far / ghosts, 0.5, 0.3),
                Found::above("bare over one layer", power[0] / power[1], 5.0),
                Found::above("one layer over three", power[1] / power[2], 1.3),
                Found::above("one layer: blue and red over green", violet(&t[1], whole), 1.3),
            ]
        },
    },
    Promise {
        scene: "bench/ghosts-sun",
        pictures: &[first(&["imager.resolution=48", "render.samples=8"])],
        says: "the ghosts of one sun near the edge of the frame, through an uncoated Biotar",
        held: |t| {
            let ledger = t[0].rendering.ledger.as_ref().expect("traced");
            let booked = ledger.detected_w() + ledger.lost_w() + ledger.not_traced_w;
            vec![
                Found::is("ghosts are traced", t[0].rendering.estimators.contains(&"ghosts")),
                Found::within("asymmetry of the ghosts", one_sided(&t[0].light(), BIOTAR_DEG, 11.5), 0.0, 0.1),
                Found::near("share of the light that is accounted for", booked / ledger.emitted_w, 1.0, 1e-6),
                Found::within("ghost light, % of direct light", 100.0 * ledger.ghosts_w / ledger.direct_w, 2.0, 1.0),
            ]
        },
    },
    Promise {
        scene: "sun-fisheye",
        pictures: &[
            first(&[
                "imager={kind: film, width: 12 mm, height: 4 mm, shift: [-12.5 mm, -4.7 mm], resolution: 96}",
                "film.stock=kodak-double-x-5222",
                "render.samples=2",
                "render.reflections.order=0",
                "render.diffraction=true",
                "output=[{kind: exr, layers: [direct, star]}]",
            ]),
            ghosts(0, &["imager.resolution=150", "render.samples=8"], GhostRays::Found),
        ],
        says: "a star of six spikes; toward the middle a small ghost; left of the middle a ghost in focus, a white point",
        held: |t| {
            let mut all = star(&t[0], 6.0, &[5.0, 7.0, 8.0], [0.6, 1.8], false);
            let light = t[1].light();
            let window = ([-4.0, -1.0], [3.0, 3.0]);
            let point = light.part(window).fold(([0.0; 2], 0.0), |most, one| if one.1 > most.1 { one } else { most });
            let violet_at = |at: [f64; 2], half: f64| violet(&t[1], (at, [half; 2]));
            all.extend([
                Found::above("white point over its surroundings", point.1 / light.mean(window), 8.0),
                Found::within(
                    "distance of the white point from the line, mm",
                    along(FISHEYE_DEG, point.0)[1],
                    0.0,
                    0.4,
                ),
                Found::above(
                    "ghost toward the middle: blue and red over green, over that of the point",
                    violet_at([8.4, 3.3], 1.0) / violet_at(point.0, 0.2),
                    1.2,
                ),
            ]);
            all
        },
    },
    Promise {
        scene: "sun-zoom",
        // The ghosts of the scene are searched along all 600 pairs of surfaces, which takes 15 s. Here the pairs are traced one by
        // one.
        pictures: &[first(&[
            "imager={kind: film, width: 14.4 mm, height: 4.8 mm, shift: [-11 mm, -9.56 mm], resolution: 96}",
            "film.stock=kodak-double-x-5222",
            "render.samples=2",
            "render.reflections.order=0",
            "render.diffraction=true",
            "output=[{kind: exr, layers: [direct, star]}]",
        ])],
        says: "a chain of small ghosts along the line from the sun through the middle; at f/11 the star of eight blades",
        held: |t| {
            let mut all = star(&t[0], 8.0, &[4.0, 6.0, 10.0, 12.0], [1.0, 2.2], true);
            let (many, reach, violet) = chain(&t[0].scene.lens, ZOOM_DEG);
            all.extend([
                Found::above("small ghosts", many as f64, 5.5),
                Found::above("extent along the line, mm", reach, 15.0),
                // Uncoated glass reflects all colors equally.
                Found::above("blue and red over green", violet, 1.15),
            ]);
            all
        },
    },
    Promise {
        scene: "streak-anamorphic",
        pictures: &[first(&[
            "imager.resolution=88",
            "render.samples=4",
            "output=[{kind: exr, layers: [direct, ghosts]}]",
        ])],
        says: "a streak across the frame, blue and violet",
        held: |t| {
            let (light, lamp) = (t[0].layer(LightKind::Ghosts), lamp(&t[0]));
            let row = |y: f64, half: f64| light.mean(([0.0, y], [11.0, half]));
            let beside = 0.5 * (row(lamp[1] - 1.0, 0.3) + row(lamp[1] + 1.0, 0.3));
            let streak = ([0.0, lamp[1]], [11.0, 0.2]);
            let (_, [across, _]) = light.moments(streak);
            // A window away from the lamp, whose own light is in these channels too.
            let left = ([lamp[0] - 5.0, lamp[1]], [4.0, 0.2]);
            vec![
                Found::above("row of the lamp over rows beside it", row(lamp[1], 0.2) / beside, 2.0),
                Found::above("standard deviation along the streak, mm", across.sqrt(), 3.0),
                Found::above(
                    "blue and red over green, over that of the lamp",
                    violet(&t[0], left) / violet(&t[0], (lamp, [0.3; 2])),
                    2.0,
                ),
            ]
        },
    },
    Promise {
        scene: "night-stars",
        // Two headlamps at f/16, through seven and eight blades. Film with one layer shows as many spikes as color film.
        pictures: &[member(2, HEADLAMPS), member(3, HEADLAMPS)],
        says: "stopped down, lamps get stars: 14 spikes from seven blades, 8 from eight",
        held: |t| {
            let mut all = star(&t[0], 14.0, &[6.0, 8.0, 10.0, 12.0, 16.0], [0.95, 1.6], true);
            all.extend(star(&t[1], 8.0, &[6.0, 10.0, 12.0, 14.0], [0.95, 1.6], true));
            // The share of light beyond r is wavelength times circumference over 2 pi^2 area r of the aperture. For a polygon around
            // a circle this is twice the wavelength times the f-number over pi^2 r. At f/2 it is an eighth of that.
            all.push(Found::near("light in the stars over the formula of the stop", moved(&t[1], 16.0), 1.0, 0.3));
            all
        },
    },
];

const HEADLAMPS: &[&str] = &[
    "source.width=5.9 m",
    // The frame leaves out the right lamp of the pair, because chance decides which one is brighter.
    "imager={kind: film, width: 6 mm, height: 3.3 mm, shift: [7.3 mm, 2.4 mm], resolution: 40}",
    "film={stock: kodak-double-x-5222, exposure: 1/4 s}",
    "render.samples=2",
    "output=[{kind: exr, layers: [direct, star]}]",
];

/// Returns the light that diffraction brought to the left of the brightest lamp, over the light that an aperture of this
/// f-number sends equally to all sides.
fn moved(taken: &Taken, f_number: f64) -> f64 {
    let (star, direct, center) = (taken.layer(LightKind::Star), taken.layer(LightKind::Direct), lamp(taken));
    let lamps: Vec<([f64; 2], f64)> = direct.all().filter(|(_, value)| *value > 0.05 * direct.most()).collect();
    let (grid, light) = (&taken.scene.grid, taken.scene.source.spectrum());
    let response = &taken.scene.channels[0].response;
    let nm: Vec<f64> = grid.wavelengths_nm().zip(response).map(|(nm, r)| nm * r).collect();
    let all = 2.0 * 1e-6 * light.seen_by(&nm) / light.seen_by(response) * f_number / (PI * PI);
    let is_seen = |p: [f64; 2]| p[0] < center[0] && (0.9..1.6).contains(&(p[0] - center[0]).hypot(p[1] - center[1]));
    let sent = |p: [f64; 2]| {
        let from =
            |(at, value): &([f64; 2], f64)| value * all / (2.0 * PI * (p[0] - at[0]).hypot(p[1] - at[1]).powi(3));
        lamps.iter().map(from).sum::<f64>() * star.pixel_area_mm2()
    };
    let places: Vec<([f64; 2], f64)> = star.all().filter(|(p, _)| is_seen(*p)).collect();
    mean(places.iter().map(|(_, value)| *value)) / mean(places.iter().map(|(p, _)| sent(*p)))
}

#[test]
fn suns_and_stars() {
    hold(SUNS);
}
