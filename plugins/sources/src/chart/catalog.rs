//! List of the charts, by name.

use std::collections::VecDeque;
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use super::designs;
use super::drawing::Drawing;
use super::test_chart::Chart;

/// A chart that a scene can name.
#[derive(Clone, Copy, Debug)]
pub struct ChartEntry {
    /// Name of the chart in a scene.
    pub name: &'static str,
    /// Description of the chart in one line.
    pub summary: &'static str,
    draw: fn(seed: u64) -> Drawing,
}

impl ChartEntry {
    /// Draws the chart `width_mm` wide, or in the size of its design if `width_mm` is `None`. `seed` matters only for charts with
    /// random parts.
    ///
    /// # Errors
    /// [`ChartError::Width`] if the width is not positive and finite.
    pub fn build(&self, width_mm: Option<f64>, seed: u64) -> Result<Chart, ChartError> {
        if let Some(width_mm) = width_mm
            && !(width_mm.is_finite() && width_mm > 0.0)
        {
            return Err(ChartError::Width { width_mm });
        }
        let design = cached((self.name, seed), || (self.draw)(seed).finish(self.name));
        Ok(design.scaled(width_mm.unwrap_or(design.width_mm())))
    }
}

/// All charts, in order of their names.
pub const CHARTS: &[ChartEntry] = &[
    ChartEntry {
        name: "color-checker",
        summary: "The 24 patches of a ColorChecker, 6 x 4, on a black frame",
        draw: designs::color_checker,
    },
    ChartEntry {
        name: "gray-card",
        summary: "Uniform gray of 18 % reflectance, for exposure and vignetting",
        draw: designs::gray_card,
    },
    ChartEntry {
        name: "grid",
        summary: "White lines on black, 28 x 18 squares, for distortion and lateral color",
        draw: designs::grid,
    },
    ChartEntry {
        name: "resolution",
        summary: "Photographic test chart: stars, slanted edges, wedges, line groups, circles, grays, color patches",
        draw: designs::resolution,
    },
    ChartEntry {
        name: "siemens",
        summary: "One Siemens star of 72 cycles with tone patches in the corners",
        draw: designs::siemens,
    },
    ChartEntry {
        name: "slanted-edge",
        summary: "7 x 5 squares of 4:1 contrast, turned by 5 degrees, for MTF over the field",
        draw: designs::slanted_edge,
    },
    ChartEntry {
        name: "star-field",
        summary: "Stars as tiny disks on black, by seed, for aberrations and lateral color",
        draw: designs::star_field,
    },
    ChartEntry {
        name: "step-wedge",
        summary: "21 gray steps of density 0.15, in both directions, for tone and flare",
        draw: designs::step_wedge,
    },
    ChartEntry {
        name: "text",
        summary: "Lines of text in decreasing sizes, black on white and white on black",
        draw: designs::text,
    },
    ChartEntry {
        name: "white",
        summary: "Uniform white of reflectance 1, for vignetting and flat fields",
        draw: designs::white,
    },
];

/// Name of the chart that shows the user's reflectances as patches.
pub const OWN_PATCHES: &str = "patches";

/// Draws a chart of `count` patches ([`Ink::Own`](super::Ink::Own)) in a block on a black frame, `width_mm` wide.
#[must_use]
pub fn own_patches(count: u16, width_mm: f64) -> Chart {
    let key = (OWN_PATCHES, u64::from(count));
    cached(key, || designs::patches(count).finish(OWN_PATCHES)).scaled(width_mm)
}

/// Number of designs in the cache, which keeps the latest ones. Drawing a design takes tens of milliseconds, scaling it less than
/// one.
const KEPT: usize = 4;

/// Cache key: the name of a chart, and its seed or its number of patches.
type Key = (&'static str, u64);

/// Returns the chart in the size of its design, from the cache if it is there. Drawing is deterministic, so the cache affects only
/// the time.
fn cached(key: Key, draw: impl FnOnce() -> Chart) -> Arc<Chart> {
    static KNOWN: Mutex<VecDeque<(Key, Arc<Chart>)>> = Mutex::new(VecDeque::new());
    let all = || KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    let found = all().iter().find(|(other, _)| *other == key).map(|(_, chart)| Arc::clone(chart));
    found.unwrap_or_else(|| {
        // Draw without holding the lock, so that other threads can use the cache meanwhile.
        let drawn = Arc::new(draw());
        let mut all = all();
        all.truncate(KEPT - 1);
        all.push_front((key, Arc::clone(&drawn)));
        drawn
    })
}

/// Draws the chart `name`, `width_mm` wide, or in the size of its design if `width_mm` is `None`. `seed` matters only for charts
/// with random parts.
///
/// ```
/// use spectra_plugin_sources::chart::{NO_INK, chart};
///
/// let chart = chart("resolution", Some(1500.0), 1)?;
/// assert_eq!(chart.height_mm(), 1000.0);
/// assert_ne!(chart.ink_at(0.0, 0.0), NO_INK);
/// assert_eq!(chart.ink_at(751.0, 0.0), NO_INK);
/// # Ok::<(), spectra_plugin_sources::chart::ChartError>(())
/// ```
///
/// # Errors
/// [`ChartError::Unknown`] if there is no such chart, with the name most similar to `name`; [`ChartError::Width`] if the width
/// is not positive and finite.
pub fn chart(name: &str, width_mm: Option<f64>, seed: u64) -> Result<Chart, ChartError> {
    match CHARTS.iter().find(|entry| entry.name == name) {
        Some(entry) => entry.build(width_mm, seed),
        None => Err(ChartError::Unknown { name: name.to_owned(), nearest: nearest(name) }),
    }
}

/// The reason why a chart cannot be drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum ChartError {
    /// No chart has that name.
    Unknown {
        /// The requested name.
        name: String,
        /// The known name that is most similar to it.
        nearest: &'static str,
    },
    /// The width is not a positive, finite length.
    Width {
        /// The requested width, mm.
        width_mm: f64,
    },
}

impl ChartError {
    /// Returns the error as a message and a hint.
    #[must_use]
    pub(crate) fn parts(&self) -> (String, String) {
        match self {
            Self::Unknown { name, .. } => {
                let own = std::iter::once(OWN_PATCHES);
                let known: Vec<&str> = CHARTS.iter().map(|entry| entry.name).chain(own).collect();
                let name: String = name.chars().take(48).collect();
                (format!("unknown chart `{name}`"), spectra_core::names::hint(&name, &known, ""))
            }
            Self::Width { .. } => (self.to_string(), "write a width such as `1.5 m`".to_owned()),
        }
    }
}

impl fmt::Display for ChartError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown { name, nearest } => {
                write!(f, "there is no chart `{name}`; did you mean `{nearest}`? Known charts: ")?;
                for (i, entry) in CHARTS.iter().enumerate() {
                    write!(f, "{}{}", if i == 0 { "" } else { ", " }, entry.name)?;
                }
                Ok(())
            }
            Self::Width { width_mm } => {
                write!(f, "a chart must have a positive width, found {width_mm} mm")
            }
        }
    }
}

impl std::error::Error for ChartError {}

/// Finds the chart whose name needs the fewest edits to reach from `name`. A name that contains `name`, or is contained in
/// it, is nearer than any other.
fn nearest(name: &str) -> &'static str {
    let asked = name.trim().to_lowercase().replace(['_', ' '], "-");
    let rank = |known: &str| {
        let kin = !asked.is_empty() && (known.contains(asked.as_str()) || asked.contains(known));
        (!kin, edits(&asked, known))
    };
    CHARTS.iter().map(|entry| entry.name).min_by_key(|known| rank(known)).expect("there are charts")
}

/// Computes the Levenshtein distance of two texts, in characters.
fn edits(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, &to) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(from != to);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}
