//! The walk of one particle of light.

use super::WalkNumbers;
use super::room::{Disk, Interior, NextHit};
use glam::DVec3;
use spectra_core::math;
use spectra_lens::Coating;
use spectra_lens::scatter::{Shares, which};

/// Largest number of walls that a particle meets; the light left then is recorded as not traced.
const MOST_WALLS: usize = 4096;

/// A particle of light on a random walk, in the frame of the lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Particle {
    /// Position of the particle, mm.
    pub position: DVec3,
    /// Unit direction in which the particle travels.
    pub direction: DVec3,
    /// Amount of light that the particle represents.
    pub weight: f64,
    /// Number of times that glass surfaces, or the imager as a mirror, have reflected the particle.
    pub mirrored: u32,
    /// Number of times that paint, or the imager as a diffuse screen, has scattered the particle.
    pub scattered: u32,
    /// Number of times that haze, dust or scratches on surfaces have scattered the particle.
    pub diffused: u32,
}

impl Particle {
    /// Returns whether the particle came straight: no wall reflected it, though layers on surfaces may have scattered it.
    #[must_use]
    pub fn is_straight(&self) -> bool {
        self.mirrored == 0 && self.scattered == 0
    }
}

/// The account of where the light of walks ended, in the unit of the particles' weights: `launched + aimed` equals the sum of the
/// other entries, up to rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StrayLedger {
    /// Light that the walks started with.
    pub launched: f64,
    /// Light added by aiming scattered light at useful targets. The compensating weights make it zero apart from noise.
    pub aimed: f64,
    /// Light that left through the front.
    pub front: f64,
    /// Light absorbed by paint.
    pub paint: f64,
    /// Light absorbed by glass.
    pub glass: f64,
    /// Light absorbed by coatings and by layers on surfaces.
    pub coatings: f64,
    /// Light absorbed by the imager.
    pub imager: f64,
    /// Light of walks that were not followed to their end.
    pub not_traced: f64,
}

impl StrayLedger {
    /// Returns the sum of all light that ended somewhere.
    #[must_use]
    pub fn ended(&self) -> f64 {
        self.front + self.paint + self.glass + self.coatings + self.imager + self.not_traced
    }

    /// Adds the entries of `other` to this ledger.
    pub fn add(&mut self, other: &Self) {
        self.launched += other.launched;
        self.aimed += other.aimed;
        self.front += other.front;
        self.paint += other.paint;
        self.glass += other.glass;
        self.coatings += other.coatings;
        self.imager += other.imager;
        self.not_traced += other.not_traced;
    }
}

/// The state of one thread that traces walks: the media at the wavelength of the walk, and a ledger.
#[derive(Clone, Debug)]
pub struct Walker<'a> {
    interior: &'a Interior,
    wavelength_nm: f64,
    /// Index and absorption coefficient (1/mm) of each room.
    rooms: Vec<[f64; 2]>,
    /// Account of where all light so far has ended.
    pub ledger: StrayLedger,
}

impl<'a> Walker<'a> {
    /// Creates a walker inside a lens. Set a wavelength by [`Walker::set_wavelength`] before the first walk.
    #[must_use]
    pub fn new(interior: &'a Interior) -> Self {
        let rooms = vec![[1.0, 0.0]; interior.skins.len() + 1];
        Self { interior, wavelength_nm: 0.0, rooms, ledger: StrayLedger::default() }
    }

    /// Sets the wavelength of the light of the next walks, nm.
    pub fn set_wavelength(&mut self, wavelength_nm: f64) {
        if wavelength_nm != self.wavelength_nm {
            self.wavelength_nm = wavelength_nm;
            for room in 0..self.rooms.len() {
                self.rooms[room] = self.interior.medium(self.interior.medium_of(room), wavelength_nm);
            }
        }
    }

    /// Traces one random walk backward, from a point of the imager (mm, in its plane) to the front of the lens. Returns the
    /// particle that leaves through the front, or `None` if it does not leave there. Its mean weight over walks (`None` counts as
    /// 0) is E / (pi L), where E is the irradiance at the point in a field of uniform radiance L. At the start the mean weight is
    /// 1.
    pub fn from_imager(&mut self, [x, y]: [f64; 2], chance: &mut WalkNumbers) -> Option<Particle> {
        let position = DVec3::new(x, y, self.interior.imager_z_mm());
        let (direction, weight) = self.off_imager(position, chance);
        let start = Particle { position, direction, weight, mirrored: 0, scattered: 0, diffused: 0 };
        self.ledger.launched += weight;
        self.walk(start, self.interior.skins.len(), true, chance, &mut |_| {})
    }

    /// Traces one random walk forward, from `particle` at the front. `arrives` is called each time that the particle reaches the
    /// imager, which may happen again if the imager reflects. Returns the particle if it leaves through the front.
    pub fn from_front(
        &mut self,
        particle: Particle,
        chance: &mut WalkNumbers,
        mut arrives: impl FnMut(&Particle),
    ) -> Option<Particle> {
        self.ledger.launched += particle.weight;
        self.walk(particle, 0, false, chance, &mut arrives)
    }

    /// Draws a direction off the imager, and its weight: by Lambert's law, toward the pupil or toward the last rim, a third each.
    fn off_imager(&self, from: DVec3, chance: &mut WalkNumbers) -> (DVec3, f64) {
        let which = 3.0 * chance.number();
        let [u, v] = [chance.number(), chance.number()];
        let direction = match which as usize {
            0 => scattered(-DVec3::Z, u, v),
            k => {
                let Disk { z_mm, radius_mm } = self.interior.guides[k.min(2) - 1];
                let (a, b) = math::concentric_disk(u, v);
                (DVec3::new(radius_mm * a, radius_mm * b, z_mm) - from).normalize()
            }
        };
        let lambert = -direction.z / std::f64::consts::PI;
        let density = |disk: &Disk| {
            let t = (disk.z_mm - from.z) / direction.z;
            let at = from + direction * t;
            let inside = t > 0.0 && at.truncate().length_squared() <= disk.radius_mm * disk.radius_mm;
            let area = std::f64::consts::PI * disk.radius_mm * disk.radius_mm;
            if inside { t * t / (area * -direction.z) } else { 0.0 }
        };
        let mixed = (lambert + self.interior.guides.iter().map(density).sum::<f64>()) / 3.0;
        (direction, lambert / mixed)
    }

    fn walk(
        &mut self,
        mut particle: Particle,
        mut room: usize,
        guided: bool,
        chance: &mut WalkNumbers,
        arrives: &mut dyn FnMut(&Particle),
    ) -> Option<Particle> {
        let matter = self.interior.matter;
        for _ in 0..MOST_WALLS {
            let Some((met, way_mm, normal)) = self.interior.next(room, particle.position, particle.direction) else {
                if room == 0 {
                    self.ledger.front += particle.weight;
                    return Some(particle);
                }
                // The particle passed through a slit between rims that do not quite meet.
                self.ledger.paint += particle.weight;
                return None;
            };
            particle.position += particle.direction * way_mm;
            let [index, per_mm] = self.rooms[room];
            if per_mm > 0.0 {
                let taken = particle.weight * (1.0 - math::exp(-per_mm * way_mm));
                self.ledger.glass += taken;
                particle.weight -= taken;
            }
            let painted = match met {
                NextHit::Paint => true,
                NextHit::Imager => {
                    arrives(&particle);
                    let u = chance.number();
                    if u >= matter.imager + matter.imager_mirror {
                        self.ledger.imager += particle.weight;
                        return None;
                    }
                    if u < matter.imager {
                        let before = particle.weight;
                        if guided {
                            let (direction, weight) = self.off_imager(particle.position, chance);
                            (particle.direction, particle.weight) = (direction, before * weight);
                        } else {
                            particle.direction = scattered(normal, chance.number(), chance.number());
                        }
                        self.ledger.aimed += particle.weight - before;
                        particle.scattered += 1;
                    } else {
                        particle.direction -= 2.0 * particle.direction.dot(normal) * normal;
                        particle.mirrored += 1;
                    }
                    false
                }
                NextHit::Skin(at, clear) => {
                    if clear <= 0.0 || (clear < 1.0 && chance.number() >= clear) {
                        true
                    } else {
                        let beyond = if at == room { room + 1 } else { at };
                        let turned = self.interior.skins[at].refracts && {
                            let n_beyond = self.rooms[beyond][0];
                            let layers = &self.interior.skins[at].layers;
                            if layers.is_empty() {
                                self.bend(&mut particle, at, index, n_beyond, normal, chance)?
                            } else if index < n_beyond {
                                self.diffuse(&mut particle, at, index, normal, chance)?;
                                self.bend(&mut particle, at, index, n_beyond, normal, chance)?
                            } else {
                                let turned = self.bend(&mut particle, at, index, n_beyond, normal, chance)?;
                                if !turned {
                                    self.diffuse(&mut particle, at, n_beyond, normal, chance)?;
                                }
                                turned
                            }
                        };
                        if !turned {
                            room = beyond;
                        }
                        false
                    }
                }
            };
            if painted {
                if chance.number() >= matter.paint {
                    self.ledger.paint += particle.weight;
                    return None;
                }
                particle.direction = scattered(normal, chance.number(), chance.number());
                particle.scattered += 1;
            }
        }
        self.ledger.not_traced += particle.weight;
        None
    }

    /// Lets the layers on a surface, in a medium of index `n`, stop or scatter the particle. Returns `None` if no light is left.
    fn diffuse(
        &mut self,
        particle: &mut Particle,
        at: usize,
        n: f64,
        normal: DVec3,
        chance: &mut WalkNumbers,
    ) -> Option<()> {
        let skin = &self.interior.skins[at];
        let place = skin.place(particle.position);
        let Shares { open, straight } = Shares::at(&skin.layers, place, skin.semi_diameter_mm);
        self.ledger.coatings += particle.weight * (1.0 - open);
        particle.weight *= open;
        if !(open > 0.0) {
            return None;
        }
        if chance.number() * open < straight {
            return Some(());
        }
        let layer = which(&skin.layers, place, skin.semi_diameter_mm, chance.number());
        let (one, other) = ([chance.number(), chance.number()], [chance.number(), chance.number()]);
        let [x, y] = layer?.lobe.step(one, other, self.wavelength_nm, place);
        let normal = if normal.dot(particle.direction) < 0.0 { -normal } else { normal };
        let [axis_x, axis_y] = skin.axes();
        let across_x = (axis_x - axis_x.dot(normal) * normal).normalize();
        let across_y = axis_y - axis_y.dot(normal) * normal;
        let across_y = (across_y - across_y.dot(across_x) * across_x).normalize();
        let d = particle.direction;
        let along = d - d.dot(normal) * normal + (x * across_x + y * across_y) / n;
        let square = along.length_squared();
        if !(square < 1.0) {
            self.ledger.coatings += particle.weight;
            return None;
        }
        particle.direction = (along + normal * (1.0 - square).sqrt()).normalize();
        particle.diffused += 1;
        Some(())
    }

    /// Reflects or transmits the particle by chance; returns whether it was reflected. Returns `None` if no light is left.
    fn bend(
        &mut self,
        particle: &mut Particle,
        at: usize,
        n: f64,
        n_beyond: f64,
        normal: DVec3,
        chance: &mut WalkNumbers,
    ) -> Option<bool> {
        let skin = &self.interior.skins[at];
        let d = particle.direction;
        let cosine = -d.dot(normal);
        let sends = |coating: &Coating| {
            let back = coating.reflectance(n, n_beyond, cosine, self.wavelength_nm).mean();
            [back, coating.transmittance(n, n_beyond, cosine, self.wavelength_nm).mean()]
        };
        let [mut reflects, mut passes] = sends(&skin.coating);
        let place = || skin.place(particle.position);
        if let Some((part, gap)) = skin.separation.as_ref().and_then(|s| s.at(place(), skin.semi_diameter_mm)) {
            let [back, on] = sends(&gap);
            reflects += part * (back - reflects);
            passes += part * (on - passes);
        }
        let left = reflects + passes;
        if left < 1.0 {
            let taken = particle.weight * (1.0 - left).max(0.0);
            self.ledger.coatings += taken;
            particle.weight -= taken;
            if !(left > 0.0) {
                return None;
            }
        }
        if passes <= 0.0 || chance.number() * left < reflects {
            particle.direction = d + 2.0 * cosine * normal;
            particle.mirrored += 1;
            return Some(true);
        }
        let ratio = n / n_beyond;
        let inner = (1.0 - ratio * ratio * (1.0 - cosine * cosine)).max(0.0).sqrt();
        particle.direction = (ratio * d + (ratio * cosine - inner) * normal).normalize();
        Some(false)
    }
}

/// Draws a direction by Lambert's law off a wall with this normal.
fn scattered(normal: DVec3, u: f64, v: f64) -> DVec3 {
    let (a, b) = math::concentric_disk(u, v);
    let up = (1.0 - a * a - b * b).max(0.0).sqrt();
    let aside = if normal.x.abs() < 0.5 { DVec3::X } else { DVec3::Y };
    let first = normal.cross(aside).normalize();
    (a * first + b * normal.cross(first) + up * normal).normalize()
}
