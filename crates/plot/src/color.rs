//! Colors used in figures.

/// An sRGB color with 8 bits per channel and an opacity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Color {
    /// Code values of red, green and blue.
    pub rgb: [u8; 3],
    /// Opacity: 0 is clear, 1 covers what is below.
    pub opacity: f64,
}

impl Color {
    /// Black: background of dark figures.
    pub const BLACK: Self = Self::new(0, 0, 0);
    /// White: paper.
    pub const WHITE: Self = Self::new(255, 255, 255);
    /// Nearly black: text and frames.
    pub const INK: Self = Self::new(0x1f, 0x23, 0x28);
    /// Gray for secondary text and marks.
    pub const GREY: Self = Self::new(0x6b, 0x72, 0x7b);
    /// Pale gray for grid lines.
    pub const PALE: Self = Self::new(0xdf, 0xe2, 0xe6);
    /// Blue of the palette.
    pub const BLUE: Self = Self::new(0x00, 0x72, 0xb2);
    /// Colors for curves in their order, which people with any color vision can tell apart. Okabe and Ito (2008), "Color Universal Design",
    /// without their yellow, which is too light for a line on paper.
    pub const PALETTE: [Self; 7] = [
        Self::BLUE,
        Self::new(0xd5, 0x5e, 0x00),
        Self::new(0x00, 0x9e, 0x73),
        Self::new(0xcc, 0x79, 0xa7),
        Self::new(0x1f, 0x23, 0x28),
        Self::new(0xe6, 0x9f, 0x00),
        Self::new(0x56, 0xb4, 0xe9),
    ];

    /// Creates an opaque color from code values.
    #[must_use]
    pub const fn new(red: u8, green: u8, blue: u8) -> Self {
        Self { rgb: [red, green, blue], opacity: 1.0 }
    }

    /// Returns this color with another opacity, clamped to 0 to 1.
    #[must_use]
    pub const fn with_opacity(self, opacity: f64) -> Self {
        Self { opacity: opacity.clamp(0.0, 1.0), ..self }
    }

    /// Returns the color between this one (`share` 0) and `other` (1), interpolated on code values.
    #[must_use]
    pub fn toward(self, other: Self, share: f64) -> Self {
        let mix = |a: f64, b: f64| a + share * (b - a);
        let rgb = [0, 1, 2].map(|i| mix(f64::from(self.rgb[i]), f64::from(other.rgb[i])).round_ties_even() as u8);
        Self { rgb, opacity: mix(self.opacity, other.opacity) }
    }

    /// Returns the color as in `#1f2328`, without its opacity.
    #[must_use]
    pub fn hex(self) -> String {
        let [r, g, b] = self.rgb;
        format!("#{r:02x}{g:02x}{b:02x}")
    }
}

impl From<[u8; 3]> for Color {
    fn from([r, g, b]: [u8; 3]) -> Self {
        Self::new(r, g, b)
    }
}
