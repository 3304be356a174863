//! A cache of kernels and tables that depend on a few numbers only, and take longer to compute than to use.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

/// Default number of cached values: the layers of a color film on planes of two sizes.
const KEPT: usize = 6;

/// A cache of the most recently used values with their keys. A value computed twice has the same bits, so the cache affects nothing but
/// time.
pub(crate) struct Cache<K, V> {
    all: Mutex<VecDeque<(K, Arc<V>)>>,
    kept: usize,
}

impl<K: PartialEq, V> Cache<K, V> {
    pub(crate) const fn new() -> Self {
        Self::keeping(KEPT)
    }

    /// Creates a cache of another size, smaller for large values.
    pub(crate) const fn keeping(kept: usize) -> Self {
        Self { all: Mutex::new(VecDeque::new()), kept }
    }

    /// Returns the cached value of `key`, or computes it with `make` and caches it.
    pub(crate) fn get_or_compute(&self, key: K, make: impl FnOnce() -> V) -> Arc<V> {
        let all = || self.all.lock().unwrap_or_else(PoisonError::into_inner);
        let known = {
            let mut all = all();
            let at = all.iter().position(|(other, _)| *other == key);
            // The most recently used value goes last.
            at.and_then(|at| all.remove(at)).map(|found| {
                let value = Arc::clone(&found.1);
                all.push_back(found);
                value
            })
        };
        known.unwrap_or_else(|| {
            // The lock is not held here, so that other threads can use the cache meanwhile.
            let made = Arc::new(make());
            let mut all = all();
            while all.len() >= self.kept {
                all.pop_front();
            }
            all.push_back((key, Arc::clone(&made)));
            made
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_known_is_not_made_again_and_the_oldest_is_forgotten() {
        let known = Cache::new();
        let mut made = Vec::new();
        for key in [1, 2, 1, 3, 4, 5, 6, 7, 1, 2] {
            assert_eq!(
                *known.get_or_compute(key, || {
                    made.push(key);
                    10 * key
                }),
                10 * key
            );
        }
        // 1 was used after 2, so 2 made room for the seventh.
        assert_eq!(made, [1, 2, 3, 4, 5, 6, 7, 2]);
    }
}
