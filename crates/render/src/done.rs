//! Keeps track of the samples that are in the sums.

use std::collections::BTreeMap;
use std::ops::Range;

/// The samples of one estimator that are in the sums: all samples below a number, and beyond it an open span of which some units are done.
/// Tiles that became clean earlier ended with fewer samples.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Done {
    complete: u64,
    open: Option<(Range<u64>, Units)>,
    /// Tiles that get no more samples, with the number of samples they have.
    ended: BTreeMap<u32, u64>,
}

impl Done {
    /// Number of complete samples of a tile.
    #[must_use]
    pub fn samples_of(&self, tile: u32) -> u64 {
        self.ended.get(&tile).copied().unwrap_or(self.complete)
    }

    /// Returns the tiles, out of `count`, that still get samples.
    #[must_use]
    pub fn active(&self, count: usize) -> Vec<u32> {
        (0..count as u32).filter(|tile| !self.ended.contains_key(tile)).collect()
    }

    /// Tiles that get no more samples, each with the number of samples it has.
    pub(crate) fn ended(&self) -> &BTreeMap<u32, u64> {
        &self.ended
    }

    /// Ends a tile: from now on it gets no more samples than are complete.
    pub(crate) fn end_tile(&mut self, tile: u32) {
        self.ended.entry(tile).or_insert(self.complete);
    }

    /// Number of complete samples: all samples below it are in the sums.
    #[must_use]
    pub fn complete(&self) -> u64 {
        self.complete
    }

    /// End of the samples that are in the sums or in the open span.
    #[must_use]
    pub fn end(&self) -> u64 {
        self.open.as_ref().map_or(self.complete, |(samples, _)| samples.end)
    }

    /// The open span and the units of it that are done, if there is one.
    #[must_use]
    pub fn open(&self) -> Option<(&Range<u64>, &Units)> {
        self.open.as_ref().map(|(samples, units)| (samples, units))
    }

    /// Returns the span to work on next to complete all samples below `upto`; `None` if they are complete. An open span is finished first.
    pub(crate) fn next(&mut self, upto: u64) -> Option<Range<u64>> {
        if self.open.is_none() && self.complete < upto {
            self.open = Some((self.complete..upto, Units::default()));
        }
        self.open.as_ref().map(|(samples, _)| samples.clone())
    }

    /// Records more finished units of the open span, which has `of` units in all. Closes the span once all are finished.
    pub(crate) fn note(&mut self, units: &Units, of: u64) {
        let Some((samples, known)) = &mut self.open else { return };
        units.0.iter().for_each(|(begin, end)| known.insert(*begin..*end));
        if known.covers(of) {
            self.complete = samples.end;
            self.open = None;
        }
    }

    /// Creates a record with these complete samples, open span and ended tiles.
    pub(crate) fn of(complete: u64, open: Option<(Range<u64>, Units)>, ended: BTreeMap<u32, u64>) -> Self {
        Self { complete, open, ended }
    }
}

/// A set of units of work, stored as ranges from begin to end that neither touch nor overlap.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Units(BTreeMap<u64, u64>);

impl Units {
    /// Iterates over the ranges of units in ascending order.
    pub fn ranges(&self) -> impl Iterator<Item = Range<u64>> + '_ {
        self.0.iter().map(|(begin, end)| *begin..*end)
    }

    /// Whether the set contains a unit.
    #[must_use]
    pub fn contains(&self, unit: u64) -> bool {
        self.0.range(..=unit).next_back().is_some_and(|(_, end)| unit < *end)
    }

    /// Whether the set contains all units below `of`.
    pub(crate) fn covers(&self, of: u64) -> bool {
        of == 0 || self.0.first_key_value().is_some_and(|(begin, end)| *begin == 0 && *end >= of)
    }

    /// Adds a range of units to the set.
    pub(crate) fn insert(&mut self, Range { mut start, mut end }: Range<u64>) {
        // Ranges that touch the new one are merged into it.
        while let Some((begin, upto)) = self.0.range(..=end).next_back().map(|(b, e)| (*b, *e)) {
            if upto < start {
                break;
            }
            self.0.remove(&begin);
            (start, end) = (start.min(begin), end.max(upto));
        }
        self.0.insert(start, end);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_grow_together() {
        let mut units = Units::default();
        for unit in [7, 3, 5, 4, 0, 6] {
            units.insert(unit..unit + 1);
        }
        assert_eq!(units.ranges().collect::<Vec<_>>(), [0..1, 3..8]);
        units.insert(1..3);
        assert!(units.covers(8) && !units.covers(9));
        assert!(units.contains(7) && !units.contains(8));
        units.insert(10..12);
        units.insert(2..20);
        assert!(units.ranges().eq(std::iter::once(0..20)));
    }

    #[test]
    fn a_span_is_complete_with_its_last_unit() {
        let mut done = Done::default();
        assert_eq!(done.next(64), Some(0..64));
        let mut some = Units::default();
        some.insert(1..3);
        done.note(&some, 3);
        // A request for more samples finishes the open span first.
        assert_eq!((done.complete(), done.end(), done.next(100)), (0, 64, Some(0..64)));
        some.insert(0..1);
        done.note(&some, 3);
        assert_eq!((done.complete(), done.next(64), done.next(100)), (64, None, Some(64..100)));
    }
}
