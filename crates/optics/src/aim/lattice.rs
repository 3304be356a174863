//! The lattice of the nodes of all zones.

use super::measure::turns;
use super::nodes::Node;
use super::outline::Colors;
use super::probe::Stages;
use super::shaped_opening::{OpeningMap, ShapedOpening};
use super::task::{Cancelled, Task};
use spectra_core::workers::map_pieces;

/// The maps by which an opening is seen from the ends of a zone, by wavelength.
pub(super) type Views = Vec<Vec<Option<OpeningMap>>>;

/// The indices of a zone among all zones.
pub(super) struct ZonePlace {
    pub depth: usize,
    pub azimuth: usize,
    pub zone: usize,
    pub azimuths: usize,
    /// Number of zones per unit of the angle's measure.
    pub scale: f64,
}

/// All nodes, by depth, azimuth, and half-zone of the angle.
pub(super) struct Lattice {
    rows: Vec<Vec<Option<Node>>>,
    azimuths: usize,
    depths: usize,
}

impl Lattice {
    pub fn new(
        task: &Task<'_>,
        stages: &Stages<'_>,
        azimuths: usize,
        steps: usize,
        most: f64,
        colors_nm: &[f64],
    ) -> Result<Self, Cancelled> {
        let grid = task.effort.fineness().grid[usize::from(azimuths > 1)];
        let a_row = steps + 1;
        let pieces = task.depth_nodes.len() * azimuths * a_row;
        let nodes = map_pieces(
            task.workers,
            pieces,
            || stages.prober(),
            |prober, piece| {
                let (row, k) = (piece / a_row, piece % a_row);
                let turns = turns((row % azimuths) as f64 / azimuths as f64);
                let measure = most * k as f64 / steps as f64;
                // Outlines need the edges only at the ends of zones.
                let colors_nm = if k.is_multiple_of(2) { colors_nm } else { &[] };
                let depth = task.depth_nodes[row / azimuths];
                task.check_cancelled()?;
                Ok(task.geometry.node(prober, measure, depth, turns, grid, colors_nm))
            },
        );
        let mut nodes = nodes?.into_iter();
        let rows = (0..task.depth_nodes.len() * azimuths).map(|_| nodes.by_ref().take(a_row).collect()).collect();
        Ok(Self { rows, azimuths, depths: task.depth_nodes.len() })
    }

    /// Number of nodes of a zone if all of them see light.
    pub fn nodes_a_zone(&self) -> usize {
        3 * if self.azimuths > 1 { 2 } else { 1 } * if self.depths > 1 { 2 } else { 1 }
    }

    fn rows_of(&self, at: &ZonePlace) -> Vec<&Vec<Option<Node>>> {
        let depths = if self.depths > 1 { vec![at.depth, at.depth + 1] } else { vec![0] };
        let looks = if self.azimuths > 1 { vec![at.azimuth, (at.azimuth + 1) % self.azimuths] } else { vec![0] };
        depths.iter().flat_map(|d| looks.iter().map(move |a| &self.rows[d * self.azimuths + a])).collect()
    }

    /// Returns the nodes at the edges and in the middle of a zone from which light passes.
    pub fn of(&self, at: &ZonePlace) -> Vec<&Node> {
        let from = 2 * at.zone;
        self.rows_of(at).into_iter().flat_map(|row| row[from..=from + 2].iter().flatten()).collect()
    }

    /// Returns the nodes at the ends of a zone with their azimuths, turns; `None` if one of them sees nothing.
    pub fn ends(&self, at: &ZonePlace) -> Option<Vec<(f64, &Node)>> {
        let depths = if self.depths > 1 { vec![at.depth, at.depth + 1] } else { vec![0] };
        let looks = if self.azimuths > 1 { vec![at.azimuth, at.azimuth + 1] } else { vec![0] };
        let mut ends = Vec::new();
        for depth in depths {
            for look in &looks {
                let row = &self.rows[depth * self.azimuths + look % self.azimuths];
                let turns = if *look == self.azimuths { 1.0 } else { turns(*look as f64 / self.azimuths as f64) };
                for k in [2 * at.zone, 2 * at.zone + 2] {
                    ends.push((turns, row[k].as_ref()?));
                }
            }
        }
        Some(ends)
    }

    /// Number of ends of a zone at one depth.
    pub fn ends_a_depth(&self) -> usize {
        if self.azimuths > 1 { 4 } else { 2 }
    }

    /// Fits the maps by which an opening is seen from the ends of a zone; `None` if there is no opening or an end sees nothing.
    pub fn views(&self, at: &ZonePlace, opening: Option<&ShapedOpening>, colors: &Colors) -> Option<Views> {
        let opening = opening?;
        let nodes_nm = colors.nodes_nm();
        let of_end = |node: &Node| {
            let lines = node.edges.iter().zip(&nodes_nm);
            lines.map(|(line, nm)| (!line.is_empty()).then(|| opening.opening_map(node, line, *nm)).flatten()).collect()
        };
        Some(self.ends(at)?.iter().map(|(_, node)| of_end(node)).collect())
    }

    /// Returns the row of nodes over the angle that runs through the zone and sees the most light in it.
    pub fn row(&self, at: &ZonePlace) -> &[Option<Node>] {
        let from = 2 * at.zone;
        let mut rows = self.rows_of(at);
        rows.sort_by_key(|row| row[from..=from + 2].iter().flatten().count());
        rows.pop().map_or(&[], |row| row)
    }
}
