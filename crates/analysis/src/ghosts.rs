//! The ghosts of a lens one by one: light from infinity on the axis that two surfaces reflect.

use serde::Serialize;
use spectra_core::loss::ALIVE;
use spectra_core::math::sin_cos_turns;
use spectra_core::{Isa, RayBatch};
use spectra_glass::{DispersionError, lines};
use spectra_lens::{FrontOpening, Indices, Lens, Path, Route, Tracer, Travel};

/// What one path by reflections does with light from infinity on the axis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Ghost {
    /// The surfaces that reflect, in the order of the light, counted from 1.
    pub surfaces: [usize; 2],
    /// What comes to the image plane, as a part of what comes there straight.
    pub energy: f64,
    /// Where the ghost is in focus: distance of its paraxial image of infinity from the image plane, mm, positive beyond it; none
    /// where it leaves parallel.
    pub focus_mm: Option<f64>,
    /// Its paraxial focal length, mm: an object's image in that focus is so much larger or smaller than the lens's own; negative is
    /// the other way up.
    pub focal_length_mm: Option<f64>,
    /// Diameter of the disk that it makes of a point at infinity on the image plane, mm.
    pub size_mm: f64,
    /// `energy` at the lines C', e and F', over that at e: red, green, blue.
    pub color: [f64; 3],
}

/// Rays across the front, and the height of the paraxial one, mm.
const RAYS: usize = 4096;
const PARAXIAL_MM: f64 = 1e-3;
/// A slope below which light is parallel.
const PARALLEL: f64 = 1e-12;

/// All ghosts of two reflections of a lens as it is set, brightest first; figures but color are for this wavelength, nm. Empty where
/// nothing reflects.
///
/// # Errors
/// A medium has no index there or at a line.
pub fn ghosts(lens: &Lens, wavelength_nm: f64, isa: Isa) -> Result<Vec<Ghost>, DispersionError> {
    let tracer = |nm: f64| Tracer::new(lens, Indices::At(nm), isa).map(|tracer| (nm, tracer));
    let main = tracer(wavelength_nm)?;
    let colors = [lines::C_PRIME, lines::E, lines::F_PRIME].map(|line| tracer(line.wavelength_nm));
    let [red, green, blue] = colors;
    let colors = [red?, green?, blue?];
    let radius_mm = FrontOpening::of(lens).map_or(0.0, |opening| opening.radius_mm());
    let straight = Path::through(main.1.surfaces(), Travel::Forward);
    let light = |(nm, tracer): &(f64, Tracer), path: &Path| disk(tracer, &tracer.route(path), *nm, radius_mm);
    let own = light(&main, &straight).0;
    let own_colors = colors.each_ref().map(|color| light(color, &straight).0);
    let mut all: Vec<Ghost> = Path::ghosts(main.1.surfaces(), &main.1.reflecting(), 2)
        .iter()
        .map(|path| {
            let (energy, size_mm) = light(&main, path);
            let by_color: Vec<f64> = colors.iter().zip(own_colors).map(|(c, own)| light(c, path).0 / own).collect();
            let over = |of: f64| if by_color[1] > 0.0 { of / by_color[1] } else { 0.0 };
            let (focus_mm, focal_length_mm) = focus(&main.1, &main.1.route(path), wavelength_nm);
            let mut surfaces = path.reflections().map(|at| at + 1);
            Ghost {
                surfaces: std::array::from_fn(|_| surfaces.next().unwrap_or(0)),
                energy: if own > 0.0 { energy / own } else { 0.0 },
                focus_mm,
                focal_length_mm,
                size_mm,
                color: [over(by_color[0]), 1.0, over(by_color[2])],
            }
        })
        .collect();
    all.sort_by(|a, b| b.energy.total_cmp(&a.energy).then(a.surfaces.cmp(&b.surfaces)));
    Ok(all)
}

/// Parallel light across the front: what arrives of it, and the diameter of the disk that it makes on the image plane, mm.
fn disk(tracer: &Tracer, route: &Route, wavelength_nm: f64, radius_mm: f64) -> (f64, f64) {
    let mut rays = RayBatch::new(RAYS);
    rays.restart(RAYS);
    let c = rays.columns_mut();
    for i in 0..RAYS {
        // Of equal areas, turned on by the golden section (H. Vogel, 1979).
        let r = radius_mm * ((i as f64 + 0.5) / RAYS as f64).sqrt();
        let turns = i as f64 * 0.618_033_988_749_894_9;
        let (sin, cos) = sin_cos_turns(turns - turns.floor());
        (c.x[i], c.y[i], c.z[i], c.l[i], c.m[i], c.n[i]) = (r * cos, r * sin, -1.0, 0.0, 0.0, 1.0);
        c.wavelength_nm[i] = wavelength_nm;
    }
    tracer.follow(route, &mut rays, &mut tracer.work_in_place(RAYS));
    let ([x, y, z], [l, m, n]) = (rays.positions(), rays.directions());
    let (mut sum, mut farthest) = (0.0, 0.0_f64);
    for i in (0..RAYS).filter(|i| rays.states()[*i] == ALIVE && n[*i] > 0.0 && rays.weights()[*i] > 0.0) {
        let way = -z[i] / n[i];
        let (x, y) = (x[i] + way * l[i], y[i] + way * m[i]);
        sum += rays.weights()[i];
        farthest = farthest.max((x * x + y * y).sqrt());
    }
    (sum, 2.0 * farthest)
}

/// Paraxial focus behind the image plane, mm, and focal length, mm.
fn focus(tracer: &Tracer, route: &Route, wavelength_nm: f64) -> (Option<f64>, Option<f64>) {
    let mut rays = RayBatch::new(1);
    rays.restart(1);
    let c = rays.columns_mut();
    (c.x[0], c.y[0], c.z[0], c.l[0], c.m[0], c.n[0]) = (PARAXIAL_MM, 0.0, -1.0, 0.0, 0.0, 1.0);
    c.wavelength_nm[0] = wavelength_nm;
    tracer.follow(route, &mut rays, &mut tracer.work_in_place(1));
    let slope = rays.directions()[0][0] / rays.directions()[2][0];
    if rays.loss(0).is_some() || slope.abs() < PARALLEL {
        return (None, None);
    }
    let height = rays.positions()[0][0] - slope * rays.positions()[2][0];
    (Some(-height / slope), Some(-PARAXIAL_MM / slope))
}
