//! The quantities used in scene, lens and stock files.

use super::quantity_format::{Bound, Quantity};
use super::units::{Dimension, Unit};

impl Quantity for f64 {
    const DIMENSION: Dimension = Dimension::Number;
    const BARE_UNIT: &'static str = "";
    const EXAMPLE: &'static str = "1.5";

    fn from_bare(value: f64) -> Self {
        value
    }

    fn bare(self) -> f64 {
        self
    }
}

/// Defines the type, its constructor and its accessor in the unit in which it is stored.
macro_rules! newtype {
    ($(#[$doc:meta])* $name:ident, $from:ident, $get:ident, $unit:literal) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
        pub struct $name(f64);

        impl $name {
            #[doc = concat!("Creates the quantity from a number in ", $unit, "; not checked.")]
            #[must_use]
            pub const fn $from(value: f64) -> Self {
                Self(value)
            }

            #[doc = concat!("Returns the number in ", $unit, ".")]
            #[must_use]
            pub const fn $get(self) -> f64 {
                self.0
            }
        }

        impl From<$name> for f64 {
            #[doc = concat!("Returns the number in ", $unit, ".")]
            fn from(quantity: $name) -> f64 {
                quantity.0
            }
        }

    };
}

/// Defines a quantity that is stored in the unit of its bare number.
macro_rules! quantity {
    ($(#[$doc:meta])* $name:ident { $noun:literal, $dimension:ident, $bare:literal, $example:literal, $bound:ident } $from:ident, $get:ident, $unit:literal) => {
        newtype!($(#[$doc])* $name, $from, $get, $unit);

        impl Quantity for $name {
            const DIMENSION: Dimension = Dimension::$dimension;
            const NOUN: &'static str = $noun;
            const BARE_UNIT: &'static str = $bare;
            const EXAMPLE: &'static str = $example;
            const BOUND: Bound = Bound::$bound;

            fn from_bare(value: f64) -> Self {
                Self(value)
            }

            fn bare(self) -> f64 {
                self.0
            }
        }
    };
}

quantity! {
    /// A length, any sign: `50 mm`, `2 m`, `5 um`, `1 in`; a bare number is in mm.
    Length { "length", Length, "mm", "50 mm", Any } from_mm, mm, "mm"
}
quantity! {
    /// A wavelength, positive: `550 nm`, `0.55 um`; a bare number is in nm.
    Wavelength { "wavelength", Length, "nm", "550 nm", Positive } from_nm, nm, "nm"
}
quantity! {
    /// A time, any sign: `1/125 s`, `20 ms`, `2 min`; a bare number is in s.
    Time { "time", Time, "s", "1/125 s", Any } from_s, s, "s"
}
quantity! {
    /// A thermodynamic or color temperature, positive: `5500 K`; a bare number is in K.
    Temperature { "temperature", Temperature, "K", "5500 K", Positive } from_kelvin, kelvin, "K"
}
quantity! {
    /// A luminance, not negative: `300 cd/m2`, `300 nit`; a bare number is in cd/m2.
    Luminance { "luminance", Luminance, "cd/m2", "300 cd/m2", NonNegative } from_cd_per_m2, cd_per_m2, "cd/m2"
}
quantity! {
    /// An illuminance, not negative: `500 lx`, `10 klx`; a bare number is in lx.
    Illuminance { "illuminance", Illuminance, "lx", "500 lx", NonNegative } from_lx, lx, "lx"
}
quantity! {
    /// A photometric exposure, not negative: `0.02 lx s`; a bare number is in lx s.
    Exposure { "exposure", Exposure, "lx s", "0.02 lx s", NonNegative } from_lx_s, lx_s, "lx s"
}
quantity! {
    /// A radiant flux, not negative: `100 W`, `5 mW`; a bare number is in W.
    Power { "power", Power, "W", "100 W", NonNegative } from_w, w, "W"
}
quantity! {
    /// A radiant intensity, not negative: `0.5 W/sr`; a bare number is in W/sr.
    RadiantIntensity { "radiant intensity", RadiantIntensity, "W/sr", "0.5 W/sr", NonNegative } from_w_per_sr, w_per_sr, "W/sr"
}
quantity! {
    /// A part of a whole, any sign and size: `50 %` or `0.5`.
    Ratio { "ratio", Ratio, "", "50 %", Any } from_number, number, "parts of 1"
}
quantity! {
    /// A spatial frequency, any sign: `600 lines/mm`, `40 lp/mm`; a bare number is in 1/mm.
    SpatialFrequency { "spatial frequency", SpatialFrequency, "1/mm", "40 lp/mm", Any } from_per_mm, per_mm, "1/mm"
}
quantity! {
    /// An f-number, positive: `f/2.8` or `2.8`.
    FNumber { "f-number", FNumber, "f/", "f/2.8", Positive } from_number, number, "units of 1"
}

newtype! {
    /// An angle, any sign: `12 deg`, `0.2 rad`, `30 arcmin`; a bare number is in degrees. It is stored in radians.
    Angle, from_rad, rad, "rad"
}

impl Quantity for Angle {
    const DIMENSION: Dimension = Dimension::Angle;
    const BARE_UNIT: &'static str = "deg";
    const EXAMPLE: &'static str = "12 deg";

    fn from_bare(value: f64) -> Self {
        Self(value.to_radians())
    }

    fn bare(self) -> f64 {
        self.0.to_degrees()
    }

    fn from_unit(value: f64, unit: &Unit) -> Self {
        match unit.symbols[0] {
            "rad" => Self(value),
            "mrad" => Self(value / 1000.0),
            // The size of a degree in arc seconds is exact, that of a radian is not.
            _ => Self::from_bare(Unit::find(Self::BARE_UNIT).map_or(value, |bare| unit.convert(value, bare))),
        }
    }
}

/// A quantity that must be more than zero.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Positive<Q>(Q);

/// A quantity that must be zero or more.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct NonNegative<Q>(Q);

macro_rules! bounded {
    ($name:ident) => {
        impl<Q: Quantity> $name<Q> {
            /// Returns the quantity in this wrapper, or `None` if it violates the bound.
            #[must_use]
            pub fn new(quantity: Q) -> Option<Self> {
                Bound::$name.limits().allow(quantity.bare()).then_some(Self(quantity))
            }

            /// Returns the quantity without its bound.
            #[must_use]
            pub fn get(self) -> Q {
                self.0
            }
        }

        impl<Q> std::ops::Deref for $name<Q> {
            type Target = Q;

            fn deref(&self) -> &Q {
                &self.0
            }
        }

        impl<Q: Quantity + Into<f64>> From<$name<Q>> for f64 {
            fn from(quantity: $name<Q>) -> f64 {
                quantity.0.into()
            }
        }

        impl<Q: Quantity> Quantity for $name<Q> {
            const DIMENSION: Dimension = Q::DIMENSION;
            const NOUN: &'static str = Q::NOUN;
            const BARE_UNIT: &'static str = Q::BARE_UNIT;
            const EXAMPLE: &'static str = Q::EXAMPLE;
            const BOUND: Bound = Q::BOUND.and(Bound::$name);
            const INFINITY: bool = Q::INFINITY;

            fn from_bare(value: f64) -> Self {
                Self(Q::from_bare(value))
            }

            fn bare(self) -> f64 {
                self.0.bare()
            }

            fn from_unit(value: f64, unit: &Unit) -> Self {
                Self(Q::from_unit(value, unit))
            }
        }
    };
}

bounded!(Positive);
bounded!(NonNegative);

/// A quantity, or infinity, which is written `inf` (or `.inf`, `infinity`).
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub enum OrInfinity<Q> {
    /// A finite quantity.
    Finite(Q),
    /// Positive infinity.
    Infinite,
}

/// A length that may be infinite: the radius of a plane, the distance of a star.
pub type LengthOrInfinity = OrInfinity<Length>;

impl<Q> OrInfinity<Q> {
    /// Returns the quantity, or `None` if it is infinite.
    #[must_use]
    pub fn finite(self) -> Option<Q> {
        match self {
            Self::Finite(quantity) => Some(quantity),
            Self::Infinite => None,
        }
    }
}

impl<Q: Quantity + Into<f64>> From<OrInfinity<Q>> for f64 {
    /// Returns the number in the quantity's own unit, or infinity.
    fn from(quantity: OrInfinity<Q>) -> f64 {
        quantity.finite().map_or(f64::INFINITY, Into::into)
    }
}

impl OrInfinity<Length> {
    /// Returns the length in mm, or infinity.
    #[must_use]
    pub fn mm(self) -> f64 {
        self.into()
    }
}

impl OrInfinity<Positive<Length>> {
    /// Returns the length in mm, or infinity.
    #[must_use]
    pub fn mm(self) -> f64 {
        self.into()
    }
}

impl<Q: Quantity> Quantity for OrInfinity<Q> {
    const DIMENSION: Dimension = Q::DIMENSION;
    const NOUN: &'static str = Q::NOUN;
    const BARE_UNIT: &'static str = Q::BARE_UNIT;
    const EXAMPLE: &'static str = Q::EXAMPLE;
    const BOUND: Bound = Q::BOUND;
    const INFINITY: bool = true;

    fn from_bare(value: f64) -> Self {
        if value == f64::INFINITY { Self::Infinite } else { Self::Finite(Q::from_bare(value)) }
    }

    fn bare(self) -> f64 {
        self.finite().map_or(f64::INFINITY, Q::bare)
    }

    fn from_unit(value: f64, unit: &Unit) -> Self {
        Self::Finite(Q::from_unit(value, unit))
    }
}
