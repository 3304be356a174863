//! Passages: the effect of each surface of a lens on the weight of light.

use spectra_core::loss::ALIVE;
use spectra_core::surface::Action;
use spectra_lens::Separation;
use spectra_lens::coating::{Coating, Films, FilmsF32};
use spectra_lens::{Element, Lens};

/// The way in which a coating is computed for a batch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Kernel {
    /// Fresnel's equations.
    Bare,
    /// Clear layers, with the number of times that [`Films`] halves the angle; and their single-precision form, if that is accurate enough.
    One(Films<1>, u32, Option<FilmsF32<1>>),
    Two(Films<2>, u32, Option<FilmsF32<2>>),
    Three(Films<3>, u32, Option<FilmsF32<3>>),
    /// Any coating, ray by ray: [`Coating::transmittance`].
    RayByRay,
}

impl Kernel {
    /// Chooses the kernel for a coating between media of which the lower index is `low`, for light of the wavelength
    /// `shortest_nm` or longer.
    fn of(coating: &Coating, low: f64, shortest_nm: f64) -> Self {
        match coating {
            Coating::Bare => return Self::Bare,
            Coating::Layer { index, thickness_nm } => {
                let films = Films::new(&[[*index, *thickness_nm]]);
                return films
                    .halvings(shortest_nm, low)
                    .map_or(Self::RayByRay, |h| Self::One(films, h, FilmsF32::of(&films, shortest_nm, low)));
            }
            Coating::Stack(stack) => {
                let one = || {
                    let films = Films::new(&stack.clear_layers::<1>()?);
                    Some(Self::One(films, films.halvings(shortest_nm, low)?, FilmsF32::of(&films, shortest_nm, low)))
                };
                let two = || {
                    let films = Films::new(&stack.clear_layers::<2>()?);
                    Some(Self::Two(films, films.halvings(shortest_nm, low)?, FilmsF32::of(&films, shortest_nm, low)))
                };
                let three = || {
                    let films = Films::new(&stack.clear_layers::<3>()?);
                    Some(Self::Three(films, films.halvings(shortest_nm, low)?, FilmsF32::of(&films, shortest_nm, low)))
                };
                one().or_else(two).or_else(three)
            }
            Coating::Ideal | Coating::Measured(_) => None,
        }
        .unwrap_or(Self::RayByRay)
    }
}

/// The effect of a surface on the weight of light.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Passage {
    /// The surface passes all light.
    All,
    /// A refracting surface, coated or bare.
    Coated(Coating, Kernel),
    /// A mirror that reflects this fraction.
    Mirror(f64),
    /// A cemented surface with a gap of air: the effect where the cement holds, and the gap.
    Apart(Box<Passage>, Gap),
}

/// A gap of air where the cement of a surface has separated.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Gap {
    pub(super) separation: Separation,
    pub(super) semi_diameter_mm: Option<f64>,
}

impl Gap {
    /// Lists the live rays that met the gap: index, fraction of the light that met it, and the gap as a coating.
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
    /// Returns the passage of an element of a lens, for light of the wavelength `shortest_nm` or longer.
    pub(crate) fn of(lens: &Lens, element: &Element, shortest_nm: f64) -> Self {
        match element.action {
            Action::Pass => Self::All,
            Action::Reflect if element.reflectance == 1.0 => Self::All,
            Action::Reflect => Self::Mirror(element.reflectance),
            Action::Refract if element.medium_before == element.medium_after => Self::All,
            // Light that a grating sends into its order, or that a surface scatters, does not follow Fresnel's equations.
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

    /// Whether its layers can be computed in single precision.
    pub(crate) fn has_single_precision(&self) -> bool {
        match self {
            Self::Coated(_, kernel) => {
                matches!(kernel, Kernel::One(.., Some(_)) | Kernel::Two(.., Some(_)) | Kernel::Three(.., Some(_)))
            }
            Self::Apart(intact, _) => intact.has_single_precision(),
            Self::All | Self::Mirror(_) => false,
        }
    }

    /// Whether the surface reflects light that should pass.
    pub(crate) fn reflects(&self) -> bool {
        matches!(self, Self::Coated(..) | Self::Apart(..))
    }

    /// Returns the coating of the surface, or of the part where the cement holds; `None` if there is none.
    pub(crate) fn coating(&self) -> Option<&Coating> {
        match self {
            Self::Coated(coating, _) => Some(coating),
            Self::Apart(intact, _) => intact.coating(),
            Self::All | Self::Mirror(_) => None,
        }
    }
}
