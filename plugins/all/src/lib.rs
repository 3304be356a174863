//! Every built-in plugin, linked into the program: a crate that nobody names registers nothing.

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
