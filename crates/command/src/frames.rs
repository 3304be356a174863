//! `--frames`: which frames of an animation are rendered.

use crate::outcome::Failure;
use spectra_core::params::Fault;
use spectra_scene::{Series, SeriesKind};
use std::ops::RangeInclusive;
use std::str::FromStr;

/// Frame numbers and ranges: `17`, `10-20`, `10-`, or several of these separated by commas.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Frames(Vec<(u32, Option<u32>)>);

impl FromStr for Frames {
    type Err = Fault;

    fn from_str(text: &str) -> Result<Self, Fault> {
        let number = |text: &str| {
            let text = text.trim();
            text.parse::<u32>().map_err(|_| Fault::new(format!("`{text}` is not a frame number")))
        };
        let part = |part: &str| match part.split_once('-') {
            None => number(part).map(|n| (n, Some(n))),
            Some((first, "")) => Ok((number(first)?, None)),
            Some((first, last)) => {
                let (first, last) = (number(first)?, number(last)?);
                if first <= last {
                    Ok((first, Some(last)))
                } else {
                    Err(format!("the range {first}-{last} runs backward").into())
                }
            }
        };
        text.split(',').map(part).collect::<Result<_, _>>().map(Self)
    }
}

impl Frames {
    /// Whether a frame is selected.
    pub(crate) fn contains(&self, frame: u32) -> bool {
        self.0.iter().any(|(first, last)| *first <= frame && last.is_none_or(|last| frame <= last))
    }

    /// Fails if a selected frame is not among those of the animation, `all`.
    pub(crate) fn check(&self, all: &RangeInclusive<u32>) -> Result<(), Failure> {
        let beyond =
            |&(first, last): &(u32, Option<u32>)| [Some(first), last].into_iter().flatten().find(|f| !all.contains(f));
        match self.0.iter().find_map(beyond) {
            Some(frame) => Err(Failure::Input(format!(
                "--frames: there is no frame {frame}; the animation has the frames {} to {}",
                all.start(),
                all.end()
            ))),
            None => Ok(()),
        }
    }
}

/// Returns the indices, in the series, of the requested pictures. `skips` says whether `--skip-existing` was given; it and `frames`
/// are errors for a single picture.
pub(crate) fn chosen(series: &Series, frames: Option<&Frames>, skips: bool) -> Result<Vec<usize>, Failure> {
    let all = 0..series.count();
    if series.kind() == SeriesKind::Single {
        let named = [("--frames", frames.is_some()), ("--skip-existing", skips)];
        return match named.into_iter().find(|(_, given)| *given) {
            Some((name, _)) => Err(Failure::Input(format!(
                "{name}: this scene is one picture; it has neither `animation` nor `sweep`"
            ))),
            None => Ok(all.collect()),
        };
    }
    let Some(frames) = frames else { return Ok(all.collect()) };
    let SeriesKind::Animation { first, .. } = series.kind() else {
        return Err(Failure::Input("--frames: this scene has a `sweep`, not an `animation`".to_owned()));
    };
    let last = first + series.count() as u32 - 1;
    frames.check(&(first..=last))?;
    Ok(all.filter(|index| frames.contains(first + *index as u32)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_chosen_by_number_and_range() {
        let chosen = |text: &str| {
            let frames: Frames = text.parse().expect(text);
            (0..=25).filter(|f| frames.contains(*f)).collect::<Vec<u32>>()
        };
        assert_eq!(chosen("17"), [17]);
        assert_eq!(chosen("10-12, 3"), [3, 10, 11, 12]);
        assert_eq!(chosen("24-"), [24, 25]);
        for bad in ["", "x", "3-1", "-3", "1,,2", "1-2-3", "1.5"] {
            assert!(bad.parse::<Frames>().is_err(), "{bad}");
        }
        let frames: Frames = "10-30".parse().expect("good");
        assert!(frames.check(&(1..=30)).is_ok());
        assert!(frames.check(&(1..=29)).is_err() && frames.check(&(11..=30)).is_err());
    }
}
