//! Lens mounts of cameras, and the test which of them a lens fits.
//!
//! Flange focal distances (mounting flange to image plane) are the nominal values of the makers. For screw mounts the diameter of the
//! thread is given, for bayonets that of the throat. C-mount has a flange focal distance of 0.69 inch, CS-mount 5 mm less; both have a
//! thread of 1 inch.
//! Sources: ARRI PL and LPL: ARRI's mount drawings; Canon, Nikon Z, Sony E, L-Mount, Fujifilm X and G: the makers' system pages; the others
//! as the makers' manuals give them, collected in the camera-wiki's and Wikipedia's lists of mounts and, for throats, in N. Mansurov, "What
//! is a lens mount" (photographylife.com) and "Lens mounts: a reference for using adapters" (photobuilds.com). Minolta SR: 43.50 mm by most
//! lists; the 43.72 mm that some give is within the play of its adapters and changes no answer here.
//!
//! Glass may reach behind the flange of a reflex camera, as far as the mirror allows. No maker publishes where the mirror sweeps. What is
//! known is how close to the film the glass of the makers' own lenses comes. Canon FD: 32.7 mm (JP 1988-081312, 50 mm f/1.8), M42: 38.0 mm
//! (Helios-44), Minolta SR: 37.3 mm (US 4256373 at 16 mm), rounded down to half millimeters. Other mounts for 24 x 36 mm with a mirror are
//! assumed to clear 37.5 mm, as M42 does. In mounts without a mirror, and of other formats, glass must stay in front of the flange, because
//! nothing is known here of their shutters and baffles.

use serde::Serialize;

/// A lens mount of a camera system.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mount {
    /// Name of the mount.
    pub name: &'static str,
    /// Flange focal distance: mounting flange to image plane, mm.
    pub flange_mm: f64,
    /// Diameter of the throat or thread, mm; `None` if none is published.
    pub throat_mm: Option<f64>,
    /// Distance from the image plane at which the swinging mirror lets glass stand, mm; `None` if glass must stay in front of the flange.
    pub mirror_mm: Option<f64>,
}

const fn mount(name: &'static str, flange_mm: f64, throat_mm: f64) -> Mount {
    Mount { name, flange_mm, throat_mm: Some(throat_mm), mirror_mm: None }
}

const fn flange(name: &'static str, flange_mm: f64) -> Mount {
    Mount { name, flange_mm, throat_mm: None, mirror_mm: None }
}

const fn reflex(name: &'static str, flange_mm: f64, throat_mm: f64, mirror_mm: f64) -> Mount {
    Mount { name, flange_mm, throat_mm: Some(throat_mm), mirror_mm: Some(mirror_mm) }
}

/// Least distance of glass from the film in a 24 x 36 mm reflex camera for which no lens of its maker is known here, mm.
const MIRROR_MM: f64 = 37.5;
/// Thickness of the lens barrel within the throat, mm.
const BARREL_MM: f64 = 1.5;

/// All known camera mounts, in descending order of flange focal distance.
pub const MOUNTS: [Mount; 36] = [
    flange("Pentax 67", 84.95),
    flange("Hasselblad V", 74.90),
    flange("Pentacon Six", 74.10),
    flange("Pentax 645", 70.87),
    flange("Mamiya 645", 63.30),
    flange("Hasselblad H", 61.63),
    mount("T2", 55.00, 42.0),
    mount("ARRI PL", 52.00, 54.0),
    flange("B4", 48.00),
    flange("Leica R", 47.00),
    reflex("Nikon F", 46.50, 44.0, MIRROR_MM),
    flange("Olympus OM", 46.00),
    reflex("Contax/Yashica", 45.50, 48.0, MIRROR_MM),
    reflex("M42", 45.46, 42.0, MIRROR_MM),
    reflex("Pentax K", 45.46, 44.0, MIRROR_MM),
    flange("Exakta", 44.70),
    reflex("Minolta/Sony A", 44.50, 49.7, MIRROR_MM),
    reflex("Canon EF", 44.00, 54.0, MIRROR_MM),
    mount("ARRI LPL", 44.00, 62.0),
    reflex("Sigma SA", 44.00, 44.0, MIRROR_MM),
    reflex("Minolta SR", 43.50, 44.7, 37.0),
    reflex("Canon FD", 42.00, 48.0, 32.5),
    flange("Four Thirds", 38.67),
    flange("Contax G", 29.00),
    mount("Leica L39", 28.80, 39.0),
    mount("Leica M", 27.80, 44.0),
    mount("Fujifilm G", 26.70, 65.0),
    mount("Samsung NX", 25.50, 42.0),
    mount("Canon RF", 20.00, 54.0),
    mount("L-Mount", 20.00, 51.6),
    flange("Micro Four Thirds", 19.25),
    mount("Sony E", 18.00, 46.1),
    mount("Fujifilm X", 17.70, 43.5),
    mount("C-mount", 17.526, 25.4),
    mount("Nikon Z", 16.00, 55.0),
    mount("CS-mount", 12.526, 25.4),
];

/// Mounts that most lenses are made for or adapted to today, still and cinema.
const COMMON: [&str; 14] = [
    "ARRI PL",
    "Nikon F",
    "M42",
    "Pentax K",
    "Canon EF",
    "Minolta SR",
    "Canon FD",
    "Leica M",
    "Canon RF",
    "L-Mount",
    "Micro Four Thirds",
    "Sony E",
    "Fujifilm X",
    "Nikon Z",
];

/// A mount that a lens fits, with its clearance.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MountReport {
    /// Name of the mount.
    pub name: &'static str,
    /// Flange focal distance: mounting flange to image plane, mm.
    pub flange_mm: f64,
    /// Diameter of the throat or thread, mm; `None` if none is published.
    pub throat_mm: Option<f64>,
    /// Distance from the rearmost glass to the flange, mm; negative if glass stands behind it, in the mirror box.
    pub clearance_mm: f64,
}

impl MountReport {
    /// Whether this mount is among those that most lenses are made for or adapted to today.
    #[must_use]
    pub fn is_common(&self) -> bool {
        COMMON.contains(&self.name)
    }
}

/// Position and size of one glass surface, for the test of which mounts a lens fits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glass {
    /// Distance from the rearmost point of the surface, vertex or rim, to the image plane, mm.
    pub nearest_mm: f64,
    /// Semi-diameter, mm; 0 if it is not known.
    pub semi_diameter_mm: f64,
}

/// Returns the mounts that a lens with the surfaces `glass` fits. No glass may be closer to the image than the mirror (or the
/// flange) allows, and glass behind the flange must pass the throat with its barrel.
#[must_use]
pub fn cleared(glass: &[Glass]) -> Vec<MountReport> {
    let nearest_mm = glass.iter().map(|g| g.nearest_mm).fold(f64::INFINITY, f64::min);
    let fits = |m: &&Mount| {
        let behind = glass.iter().filter(|g| g.nearest_mm < m.flange_mm);
        let widest_mm = behind.map(|g| 2.0 * (g.semi_diameter_mm + BARREL_MM)).fold(0.0, f64::max);
        nearest_mm >= m.mirror_mm.unwrap_or(m.flange_mm) && m.throat_mm.is_none_or(|throat| widest_mm <= throat)
    };
    let report = |m: &Mount| MountReport {
        name: m.name,
        flange_mm: m.flange_mm,
        throat_mm: m.throat_mm,
        clearance_mm: nearest_mm - m.flange_mm,
    };
    if glass.is_empty() { Vec::new() } else { MOUNTS.iter().filter(fits).map(report).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(glass: &[Glass]) -> Vec<&'static str> {
        cleared(glass).iter().map(|m| m.name).collect()
    }

    #[test]
    fn the_table_is_in_order_and_names_are_unique() {
        assert!(MOUNTS.windows(2).all(|w| w[0].flange_mm >= w[1].flange_mm));
        let mut names: Vec<_> = MOUNTS.iter().map(|m| m.name).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), MOUNTS.len());
        assert!(COMMON.iter().all(|common| names.contains(common)));
        // Catch typing errors in the table: throats are between 10 and 100 mm.
        assert!(MOUNTS.iter().all(|m| m.throat_mm.is_none_or(|t| t > 10.0 && t < 100.0)));
        // A mirror stands behind the flange, and glass that passes it goes through a throat of known size.
        assert!(MOUNTS.iter().all(|m| m.mirror_mm.is_none_or(|mirror| mirror < m.flange_mm && m.throat_mm.is_some())));
    }

    #[test]
    fn what_stands_in_front_of_a_flange_clears_all_shallower_mounts() {
        let at = |nearest_mm: f64| [Glass { nearest_mm, semi_diameter_mm: 10.0 }];
        let slr = cleared(&at(46.5));
        let shown = |name: &str| slr.iter().find(|m| m.name == name).map(|m| m.clearance_mm);
        assert_eq!((shown("Nikon F"), shown("Leica R")), (Some(0.0), None));
        assert!(MOUNTS.iter().filter(|m| m.flange_mm <= 46.5).all(|m| shown(m.name).is_some()));
        assert!(cleared(&at(10.0)).is_empty() && cleared(&[]).is_empty());
    }

    /// Glass may reach into the mirror box as far as the mirror, and only through the throat.
    #[test]
    fn glass_dips_as_far_as_the_mirror_and_through_the_throat() {
        let rear = |nearest_mm: f64, semi_diameter_mm: f64| [Glass { nearest_mm, semi_diameter_mm }];
        assert!(names(&rear(38.0, 13.0)).contains(&"M42") && !names(&rear(37.4, 13.0)).contains(&"M42"));
        assert!(names(&rear(32.6, 14.0)).contains(&"Canon FD") && !names(&rear(32.4, 14.0)).contains(&"Canon FD"));
        // Glass of 46 mm with a barrel around it does not pass a throat of 48 mm, nor one of 42 mm that of M42.
        assert!(!names(&rear(40.0, 23.0)).contains(&"Canon FD") && !names(&rear(40.0, 21.0)).contains(&"M42"));
        // A wide front does not matter, since it stands in front of the flange.
        let both = [rear(60.0, 40.0)[0], rear(38.5, 12.0)[0]];
        assert!(names(&both).contains(&"M42") && names(&both).contains(&"Canon EF"));
    }
}
