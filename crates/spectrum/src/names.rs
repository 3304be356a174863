//! Search for similar names when a typed name is unknown.

pub(crate) use spectra_core::names::normalized;

/// Returns the number of characters to insert, delete, replace or swap with a neighbor to turn `a` into `b`.
fn distance(a: &[char], b: &[char]) -> usize {
    let mut before: Vec<usize> = Vec::new();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut next = vec![i; b.len() + 1];
        for j in 1..=b.len() {
            let replace = row[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            next[j] = replace.min(row[j] + 1).min(next[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                next[j] = next[j].min(before[j - 2] + 1);
            }
        }
        before = std::mem::replace(&mut row, next);
    }
    row[b.len()]
}

/// Returns up to six of `names` that resemble `wanted`, nearest first: they differ by few letters, or one contains the other.
pub(crate) fn candidates<'a>(wanted: &str, names: impl Iterator<Item = &'a str>) -> Vec<String> {
    // A name as long as a file is no misspelling of anything; comparing it would only cost time.
    const LONGEST: usize = 80;
    let key = normalized(wanted);
    let letters: Vec<char> = key.chars().take(LONGEST).collect();
    let mut near: Vec<(usize, &str)> = Vec::new();
    for name in names {
        let other = normalized(name);
        let apart = distance(&letters, &other.chars().collect::<Vec<_>>());
        let part = letters.len() >= 3 && other.contains(&key);
        let whole = other.len() >= 3 && key.contains(&other);
        if part {
            near.push((0, name));
        } else if whole || apart <= (letters.len() / 3).max(1) {
            near.push((apart, name));
        }
    }
    near.sort();
    near.dedup();
    near.into_iter().take(6).map(|(_, n)| n.to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_of_the_pen_are_one_apart() {
        let d = |a: &str, b: &str| distance(&a.chars().collect::<Vec<_>>(), &b.chars().collect::<Vec<_>>());
        assert_eq!([d("d65", "d56"), d("d65", "d6"), d("d65", "d655"), d("d65", "d60"), d("", "ab")], [1, 1, 1, 1, 2]);
    }

    #[test]
    fn nearest_come_first() {
        let names = ["mercury", "neon", "argon", "hydrogen", "iso-7589-photographic-daylight"];
        assert_eq!(candidates("mercuri", names.into_iter()), ["mercury"]);
        assert_eq!(candidates("Photographic Daylight", names.into_iter()), ["iso-7589-photographic-daylight"]);
        assert!(candidates("zzzz", names.into_iter()).is_empty());
        // A typing error in a long name is nearer than a short name that it contains.
        let lights = ["daylight", "iso-7589-photographic-daylight"];
        let near = candidates("iso-7589-fotographic-daylight", lights.into_iter());
        assert_eq!(near, ["iso-7589-photographic-daylight", "daylight"]);
    }
}
