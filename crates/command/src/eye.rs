//! `--seen-by`: a figure as an eye without one kind of cones has it.

use clap::ValueEnum;
use spectra_color::Deficiency;
use spectra_plot::Canvas;

/// An eye without one kind of cones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum EyeName {
    /// Without the long ones: red is dark.
    Protan,
    /// Without the medium ones: red and green look alike.
    Deutan,
    /// Without the short ones: blue and green look alike.
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

    /// As it is written.
    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Protan => "protan",
            Self::Deutan => "deutan",
            Self::Tritan => "tritan",
        }
    }

    /// The eye, with its article.
    pub(crate) fn eye(self) -> String {
        format!("a {} eye", self.word())
    }

    /// A figure with all its colors as the eye has them.
    pub(crate) fn sees(self, canvas: Canvas) -> Canvas {
        canvas.with_colors(|code| self.deficiency().seen_srgb8(code))
    }
}
