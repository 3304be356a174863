//! What each surface of a lens does to the weight of light.

use crate::coating::{Coating, Films, Swift};
use crate::separation::Separation;
use crate::{Element, Lens, LensMedium};
use spectra_core::loss::ALIVE;
use spectra_core::surface::Action;
use spectra_glass::Lender;

/// How a coating is worked out for a batch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Kernel {
    /// Fresnel's equations.
    Bare,
    /// Clear layers, with the number of times that [`Films`] halves the angle; and in single precision, where that is enough.
    One(Films<1>, u32, Option<Swift<1>>),
    Two(Films<2>, u32, Option<Swift<2>>),
    Three(Films<3>, u32, Option<Swift<3>>),
    /// Any coating: [`Coating::transmittance`].
    RayByRay,
}

impl Kernel {
    /// Of a coating between media of which the lower index is `low`, for light of this wavelength, nm, or longer.
    fn of(coating: &Coating, low: f64, shortest_nm: f64) -> Self {
        match coating {
            Coating::Bare => return Self::Bare,
            Coating::Layer { index, thickness_nm } => {
                let films = Films::new(&[[*index, *thickness_nm]]);
                return films
                    .halvings(shortest_nm, low)
                    .map_or(Self::RayByRay, |h| Self::One(films, h, Swift::of(&films, shortest_nm, low)));
            }
            Coating::Stack(stack) => {
                let one = || {
                    let films = Films::new(&stack.clear_layers::<1>()?);
                    Some(Self::One(films, films.halvings(shortest_nm, low)?, Swift::of(&films, shortest_nm, low)))
                };
                let two = || {
                    let films = Films::new(&stack.clear_layers::<2>()?);
                    Some(Self::Two(films, films.halvings(shortest_nm, low)?, Swift::of(&films, shortest_nm, low)))
                };
                let three = || {
                    let films = Films::new(&stack.clear_layers::<3>()?);
                    Some(Self::Three(films, films.halvings(shortest_nm, low)?, Swift::of(&films, shortest_nm, low)))
                };
                one().or_else(two).or_else(three)
            }
            Coating::Ideal | Coating::Measured(_) => None,
        }
        .unwrap_or(Self::RayByRay)
    }
}

/// What a surface does to the weight of light.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Passage {
    /// Nothing.
    All,
    /// Fresnel, under a coating or bare.
    Coated(Coating, Kernel),
    /// This part is reflected by a mirror.
    Mirror(f64),
    /// What it does where the cement holds, beside a gap of air.
    Apart(Box<Passage>, Gap),
}

/// Where the cement of a surface has come apart.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Gap {
    pub(super) separation: Separation,
    pub(super) semi_diameter_mm: Option<f64>,
}

impl Gap {
    /// Of living rays that met it: which, the part of their light that did, and the gap as a coating.
    pub(super) fn met<'a>(
        &'a self,
        [x, y, _]: [&'a [f64]; 3],
        state: &'a [u64],
    ) -> impl Iterator<Item = (usize, f64, Coating)> + 'a {
        (0..state.len()).filter(|i| state[*i] == ALIVE).filter_map(move |i| {
            let (part, coating) = self.separation.at([x[i], y[i]], self.semi_diameter_mm)?;
            Some((i, part, coating))
        })
    }
}

impl Passage {
    /// Of an element of a lens, for light of this wavelength, nm, or longer.
    pub(crate) fn of(lens: &Lens, element: &Element, shortest_nm: f64) -> Self {
        match element.action {
            Action::Pass => Self::All,
            Action::Reflect if element.reflectance == 1.0 => Self::All,
            Action::Reflect => Self::Mirror(element.reflectance),
            Action::Refract if element.medium_before == element.medium_after => Self::All,
            // What a grating sends into its order, or a surface scatters, is not a matter of Fresnel's equations.
            Action::Refract if element.surface.is_directional() || element.surface.draws() => Self::All,
            Action::Refract => {
                let intact = match lens.coating_of(element) {
                    Coating::Ideal => Self::All,
                    coating => {
                        let sides = [element.medium_before, element.medium_after].map(|m| lens.index(m, shortest_nm));
                        let kernel = Kernel::of(&coating, sides[0].min(sides[1]), shortest_nm);
                        Self::Coated(coating, kernel)
                    }
                };
                match element.separation.clone() {
                    Some(separation) => {
                        let gap = Gap { separation, semi_diameter_mm: element.semi_diameter_mm };
                        Self::Apart(Box::new(intact), gap)
                    }
                    None => intact,
                }
            }
        }
    }

    /// Whether it sends back light that should pass.
    pub(crate) fn reflects(&self) -> bool {
        matches!(self, Self::Coated(..) | Self::Apart(..))
    }

    /// The coating where it has one, and where cement holds.
    pub(crate) fn coating(&self) -> Option<&Coating> {
        match self {
            Self::Coated(coating, _) => Some(coating),
            Self::Apart(intact, _) => intact.coating(),
            Self::All | Self::Mirror(_) => None,
        }
    }
}

impl Lens {
    /// The coating of an element: its own, else the lens's; of the latter a surface between two glasses has none, it is
    /// cemented.
    #[must_use]
    pub fn coating_of(&self, element: &Element) -> Coating {
        match (&element.coating, &self.coating) {
            (Some(own), _) => own.clone(),
            (None, all @ (Coating::Ideal | Coating::Bare)) => all.clone(),
            (None, _) if !self.is_gas(element.medium_before) && !self.is_gas(element.medium_after) => Coating::Bare,
            (None, all) => all.clone(),
        }
    }

    /// The coating of the faces of a prism: its own, else the lens's.
    pub(crate) fn solid_coating_of(&self, element: &Element) -> Coating {
        element.coating.as_ref().unwrap_or(&self.coating).clone()
    }

    /// The media whose absorption is borrowed, each with its label and the glass that lends; whether or not glass absorbs
    /// now.
    #[must_use]
    pub fn borrowed_absorption(&self) -> Vec<(&str, Lender)> {
        let lender = |m: &LensMedium| m.medium.absorption(self.year)?.lender;
        self.media.iter().filter_map(|m| Some((m.label.as_str(), lender(m)?))).collect()
    }

    /// The same lens with this coating everywhere, whatever its surfaces state.
    #[must_use]
    pub fn with_coating(mut self, coating: Coating) -> Self {
        self.coating = coating;
        self.coating_assumed = false;
        for e in &mut self.elements {
            e.coating = None;
        }
        self
    }
}
