//! Links every built-in plugin into the program; a crate that is not named anywhere would register nothing.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

use spectra_plugin_colors as _;
use spectra_plugin_films as _;
use spectra_plugin_imagers as _;
#[cfg(feature = "oiio")]
use spectra_plugin_oiio as _;
use spectra_plugin_outputs as _;
use spectra_plugin_responses as _;
use spectra_plugin_samplers as _;
use spectra_plugin_sources as _;
use spectra_plugin_surfaces as _;
