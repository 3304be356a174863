//! Kinds of coatings that a program knows.

use super::Coating;

spectra_core::declare!(CoatingEntry, Coating, "coating", "A registered kind of coating.");
