//! Lens mounts of cameras, and which of them a lens leaves room for.
//!
//! Flange focal distances (mounting flange to image plane) are the makers' nominal figures; screw mounts give the diameter of
//! their thread, bayonets the diameter of the throat where the maker states one. C and CS: 0.69 inch and 5 mm less, thread
//! 1 inch. ARRI PL and LPL: ARRI's mount drawings; Canon, Nikon Z, Sony E, L-Mount, Fujifilm X and G: the makers' system
//! pages; the others as the makers' manuals give them, collected in the camera-wiki's and Wikipedia's lists of mounts.

use serde::Serialize;

/// A lens mount.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mount {
    /// Its name.
    pub name: &'static str,
    /// Mounting flange to image plane, mm.
    pub flange_mm: f64,
    /// Diameter of throat or thread, mm; `None` where none is published.
    pub throat_mm: Option<f64>,
}

const fn mount(name: &'static str, flange_mm: f64, throat_mm: f64) -> Mount {
    Mount { name, flange_mm, throat_mm: Some(throat_mm) }
}

const fn flange(name: &'static str, flange_mm: f64) -> Mount {
    Mount { name, flange_mm, throat_mm: None }
}

/// Mounts, by falling flange distance.
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
    mount("Nikon F", 46.50, 44.0),
    flange("Olympus OM", 46.00),
    flange("Contax/Yashica", 45.50),
    mount("M42", 45.46, 42.0),
    flange("Pentax K", 45.46),
    flange("Exakta", 44.70),
    flange("Minolta/Sony A", 44.50),
    mount("Canon EF", 44.00, 54.0),
    mount("ARRI LPL", 44.00, 62.0),
    flange("Sigma SA", 44.00),
    flange("Minolta SR", 43.50),
    mount("Canon FD", 42.00, 48.0),
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

/// A mount that a lens leaves room for: its rearmost glass stands in front of the flange.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MountReport {
    /// The mount.
    pub name: &'static str,
    /// Mounting flange to image plane.
    pub flange_mm: f64,
    /// Diameter of throat or thread.
    pub throat_mm: Option<f64>,
    /// From the rearmost glass to the flange.
    pub clearance_mm: f64,
}

/// The mounts that a back focal distance (rearmost glass to image plane, mm) clears.
#[must_use]
pub fn cleared(back_focal_distance_mm: f64) -> Vec<MountReport> {
    let fits = MOUNTS.iter().filter(|m| m.flange_mm <= back_focal_distance_mm);
    fits.map(|m| MountReport {
        name: m.name,
        flange_mm: m.flange_mm,
        throat_mm: m.throat_mm,
        clearance_mm: back_focal_distance_mm - m.flange_mm,
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_order_and_names_are_unique() {
        assert!(MOUNTS.windows(2).all(|w| w[0].flange_mm >= w[1].flange_mm));
        let mut names: Vec<_> = MOUNTS.iter().map(|m| m.name).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), MOUNTS.len());
        // A screw of 42 mm does not go through a flange of 39.
        assert!(MOUNTS.iter().all(|m| m.throat_mm.is_none_or(|t| t > 10.0 && t < 100.0)));
    }

    #[test]
    fn what_clears_a_mirror_clears_all_shallower_mounts() {
        let slr = cleared(46.5);
        assert_eq!(slr.first().map(|m| (m.name, m.clearance_mm)), Some(("Nikon F", 0.0)));
        assert_eq!(slr.len(), MOUNTS.iter().filter(|m| m.flange_mm <= 46.5).count());
        assert!(cleared(10.0).is_empty());
    }
}
