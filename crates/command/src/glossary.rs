//! Words of photographers and of other programs that are no keys here, and the pages that tell of what they mean.

use spectra_core::names::normalized;

/// Words, what they are here, and the page or command.
const WORDS: [(&[&str], &str, &str); 26] = [
    (&["bokeh", "blur", "defocus"], "the form of the stop, and what its edge does", "spectra doc lens.aperture"),
    (&["depth-of-field", "dof"], "a matter of f-number, focus and frame", "spectra doc lens.f-number"),
    (
        &["fov", "field-of-view", "angle-of-view", "camera"],
        "what the lens sees on the frame",
        "spectra doc imager.format",
    ),
    (
        &["focal-length", "zoom"],
        "the lens file's; `spectra lens scale LENS --to 85mm` writes it at another",
        "spectra list lens",
    ),
    (&["sequence", "frames", "keyframes", "movie", "video"], "an animation: values by frame", "spectra doc animation"),
    (
        &["overscan", "data-window"],
        "part of an EXR picture beyond its display window, which is used as it is",
        "spectra doc source/picture",
    ),
    (&["alpha", "cover", "matte"], "what a picture covers of what lies behind it", "spectra doc source/layers"),
    (&["z", "zdepth", "depth-map"], "a channel of the picture", "spectra doc source.depth"),
    (
        &["flare", "ghost", "lens-flare"],
        "light that is reflected twice between surfaces",
        "spectra doc render.reflections",
    ),
    (&["star", "starburst", "sunstar", "glare", "spikes"], "diffraction at the stop", "spectra doc render"),
    (&["haze", "veil", "fog", "bloom"], "light that dust and scratches scatter", "spectra doc lens.haze"),
    (
        &["vignetting", "falloff"],
        "what the rims of the lens cut off: `spectra lens info LENS` has the light by field",
        "spectra lens info helios-44-58-f2",
    ),
    (
        &["distortion", "chromatic-aberration", "fringing", "aberration", "mtf"],
        "the lens's: `spectra lens info LENS` has the figures",
        "spectra lens info helios-44-58-f2",
    ),
    (&["iso", "sensitivity", "asa", "speed"], "the film's own", "spectra list stock"),
    (&["shutter", "shutter-speed", "exposure-time"], "how long the film is exposed", "spectra doc film.exposure"),
    (
        &["white-balance", "color-temperature", "temperature"],
        "the light's, and filters on the lens",
        "spectra doc lens.filters",
    ),
    (&["negative", "scan", "print-film"], "how the film is looked at", "spectra doc film.view"),
    (&["paper", "darkroom"], "what a negative is printed on", "spectra doc film.print"),
    (&["lut", "cube"], "a film as a table for grading programs", "spectra film cube --help"),
    (&["hdr", "aces", "acescg"], "EXR pictures, in the space that is asked for", "spectra doc output/exr"),
    (&["raw", "dng"], "what a sensor's converter gives", "spectra doc output/dng"),
    (&["squeeze", "anamorphic"], "lenses that squeeze the picture", "spectra doc lens.squeeze"),
    (&["tilt-shift", "scheimpflug"], "how the frame stands behind the lens", "spectra doc imager.tilt"),
    (&["denoise", "noise"], "how many rays a pixel gets", "spectra doc render.noise"),
    (&["st-map", "stmap", "cryptomatte"], "not written by this program; what it writes", "spectra doc output"),
    (&["filter", "wratten", "gel", "nd"], "a spectrum before the lens", "spectra doc lens.filters"),
];

/// What such a word is here, and the command that tells more.
pub(crate) fn meant(word: &str) -> Option<(&'static str, &'static str)> {
    let key = normalized(word.trim());
    let one = key.strip_suffix('s').unwrap_or(&key);
    let is = |known: &&str| {
        let known = normalized(known);
        known == key || known == one
    };
    WORDS.iter().find(|(words, ..)| words.iter().any(&is)).map(|(_, what, command)| (*what, *command))
}
