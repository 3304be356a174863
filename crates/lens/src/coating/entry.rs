//! The registry of the kinds of coatings.

use super::Coating;

spectra_core::declare!(CoatingEntry, Coating, "coating", "A registered kind of coating.");
