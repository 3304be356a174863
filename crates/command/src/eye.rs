//! `--seen-by`: draws a figure as an eye without one kind of cones sees it.

use clap::ValueEnum;
use spectra_color::Deficiency;
use spectra_plot::Canvas;

/// An eye that lacks one kind of cones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum EyeName {
    /// No long-wavelength (L) cones: red looks dark.
    Protan,
    /// No medium-wavelength (M) cones: red and green look alike.
    Deutan,
    /// No short-wavelength (S) cones: blue and green look alike.
    Tritan,
}

impl EyeName {
    fn deficiency(self) -> Deficiency {
        match self {
            Self::Protan => Deficiency::Protan,
            Self::Deutan => Deficiency::Deutan,
            Self::Tritan => Deficiency::Tritan,
        }
    }

    /// Returns the word for this eye as written on the command line.
    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Protan => "protan",
            Self::Deutan => "deutan",
            Self::Tritan => "tritan",
        }
    }

    /// Returns the eye with its article, for a sentence: `a protan eye`.
    pub(crate) fn eye(self) -> String {
        format!("a {} eye", self.word())
    }

    /// Returns a figure with all its colors converted to what this eye sees.
    pub(crate) fn simulate(self, canvas: Canvas) -> Canvas {
        canvas.with_colors(|code| self.deficiency().simulate_srgb8(code))
    }
}
