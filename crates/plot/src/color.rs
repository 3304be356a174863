//! Colors of a figure.

/// An sRGB color of 8 bits a channel, with its opacity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Color {
    /// Code values of red, green and blue.
    pub rgb: [u8; 3],
    /// 0 is clear, 1 covers what is below.
    pub opacity: f64,
}

impl Color {
    /// Black.
    pub const BLACK: Self = Self::new(0, 0, 0);
    /// White: paper.
    pub const WHITE: Self = Self::new(255, 255, 255);
    /// Nearly black: text and frames.
    pub const INK: Self = Self::new(0x1f, 0x23, 0x28);
    /// Grey of things beside the point.
    pub const GREY: Self = Self::new(0x6b, 0x72, 0x7b);
    /// Grid lines.
    pub const PALE: Self = Self::new(0xdf, 0xe2, 0xe6);
    /// Blue of the palette.
    pub const BLUE: Self = Self::new(0x00, 0x72, 0xb2);
    /// Colors that people of any color vision tell apart, for curves in their order. Okabe and Ito (2008), "Color
    /// Universal Design", without their yellow, which is too light for a line on paper.
    pub const PALETTE: [Self; 7] = [
        Self::BLUE,
        Self::new(0xd5, 0x5e, 0x00),
        Self::new(0x00, 0x9e, 0x73),
        Self::new(0xcc, 0x79, 0xa7),
        Self::new(0x1f, 0x23, 0x28),
        Self::new(0xe6, 0x9f, 0x00),
        Self::new(0x56, 0xb4, 0xe9),
    ];

    /// An opaque color.
    #[must_use]
    pub const fn new(red: u8, green: u8, blue: u8) -> Self {
        Self { rgb: [red, green, blue], opacity: 1.0 }
    }

    /// The same color, `opacity` of 0 to 1.
    #[must_use]
    pub const fn with_opacity(self, opacity: f64) -> Self {
        Self { opacity: opacity.clamp(0.0, 1.0), ..self }
    }

    /// The color between this (0) and `other` (1), on code values.
    #[must_use]
    pub fn toward(self, other: Self, share: f64) -> Self {
        let mix = |a: f64, b: f64| a + share * (b - a);
        let rgb = [0, 1, 2].map(|i| mix(f64::from(self.rgb[i]), f64::from(other.rgb[i])).round_ties_even() as u8);
        Self { rgb, opacity: mix(self.opacity, other.opacity) }
    }

    /// `#1f2328`; opacity is not in it.
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
