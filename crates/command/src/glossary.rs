//! Terms of photography and of other programs that are not keys of `spectra`, and the pages that explain them.

use spectra_core::names::normalized;

/// Entries of the glossary: the words, what they mean here, and the page or command that tells more.
const WORDS: [(&[&str], &str, &str); 26] = [
    (
        &["bokeh", "blur", "defocus"],
        "the shape of the aperture stop, and what happens at its edge",
        "spectra doc lens.aperture",
    ),
    (
        &["depth-of-field", "dof"],
        "set by the f-number, the focus and the size of the frame",
        "spectra doc lens.f-number",
    ),
    (
        &["fov", "field-of-view", "angle-of-view", "camera"],
        "set by the lens and the size of the frame",
        "spectra doc imager.format",
    ),
    (
        &["focal-length", "zoom"],
        "set by the lens file; `spectra lens scale LENS --to 85mm` writes a scaled copy",
        "spectra list lens",
    ),
    (
        &["sequence", "frames", "keyframes", "movie", "video"],
        "an animation, with values by frame",
        "spectra doc animation",
    ),
    (
        &["overscan", "data-window"],
        "the part of an EXR picture outside its display window, which is used as it is",
        "spectra doc source/picture",
    ),
    (&["alpha", "cover", "matte"], "how much a picture hides of what lies behind it", "spectra doc source/layers"),
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
        "light that the rims of the lens cut off; `spectra lens info LENS` shows the light over the field",
        "spectra lens info helios-44-58-f2",
    ),
    (
        &["distortion", "chromatic-aberration", "fringing", "aberration", "mtf"],
        "a property of the lens; `spectra lens info LENS` shows the figures",
        "spectra lens info helios-44-58-f2",
    ),
    (&["iso", "sensitivity", "asa", "speed"], "a property of the film stock", "spectra list stock"),
    (&["shutter", "shutter-speed", "exposure-time"], "the time that the film is exposed", "spectra doc film.exposure"),
    (
        &["white-balance", "color-temperature", "temperature"],
        "set by the light source and by filters on the lens",
        "spectra doc lens.filters",
    ),
    (&["negative", "scan", "print-film"], "how the developed film is viewed", "spectra doc film.view"),
    (&["paper", "darkroom"], "the material that a negative is printed on", "spectra doc film.print"),
    (&["lut", "cube"], "a lookup table of a film for color grading programs", "spectra film cube --help"),
    (&["hdr", "aces", "acescg"], "EXR pictures, in the color space that you choose", "spectra doc output/exr"),
    (&["raw", "dng"], "the numbers from a sensor's A/D converter", "spectra doc output/dng"),
    (&["squeeze", "anamorphic"], "lenses that squeeze the picture", "spectra doc lens.squeeze"),
    (&["tilt-shift", "scheimpflug"], "the tilt of the frame behind the lens", "spectra doc imager.tilt"),
    (&["denoise", "noise"], "set by the number of rays that a pixel gets", "spectra doc render.noise"),
    (&["st-map", "stmap", "cryptomatte"], "not written by this program; see what it does write", "spectra doc output"),
    (&["filter", "wratten", "gel", "nd"], "a spectrum in front of the lens", "spectra doc lens.filters"),
];

/// Looks up a word of the glossary: returns what it means here and the command that tells more.
pub(crate) fn lookup(word: &str) -> Option<(&'static str, &'static str)> {
    let key = normalized(word.trim());
    let one = key.strip_suffix('s').unwrap_or(&key);
    let is = |known: &&str| {
        let known = normalized(known);
        known == key || known == one
    };
    WORDS.iter().find(|(words, ..)| words.iter().any(&is)).map(|(_, what, command)| (*what, *command))
}
