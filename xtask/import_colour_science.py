#!/usr/bin/env python3
"""Writes the CIE, ISO and ColorChecker tables under spectra/, and the values that tests compare with.

Run from the root of the repository:

    python3 -m venv VENV
    VENV/bin/pip install colour-science==0.4.7
    VENV/bin/python xtask/import_colour_science.py

The source of all tables is the Python package colour-science 0.4.7 (BSD-3-Clause, Copyright 2013 Colour Developers). It names the
publication of each table, which `source` states. Numbers are written as the package holds them (the shortest decimal that reads back to
the same double, which is what was typed there). Nothing is interpolated, extended, normalized or cut: `outside` states what a reader
does beyond the range, `interpolation` what it does between points if that is not linear.

`crates/film/tests/data/unseen.csv` holds spectra to which nothing was fitted: skins and leaves among the 190 training spectra of the
Academy's rawtoaces, which the package includes. The skins are those with the two bands of blood near 545 and 575 nm, the leaves those
with the band of chlorophyll near 675 nm and the edge behind it.

The expected values (`crates/spectrum/tests/data/`) are computed here, by that package and numpy alone:
  illuminants.csv  x, y of each illuminant: aligned to 360-830 nm by 1 nm (linear, constant ends), summed with the
                   1 nm CIE 1931 functions; CCT and Duv by Ohno (2013) from that chromaticity, if it has one
  checker-d50.csv  XYZ and Lab of the ColorChecker patches under D50; reflectances by Sprague's interpolation (CIE 167:2005)
"""

import pathlib
import re

import colour
import numpy as np
from colour.colorimetry import SDS_BASIS_FUNCTIONS_CIE_ILLUMINANT_D_SERIES as DAYLIGHT

LICENCE = "BSD-3-Clause (colour-science 0.4.7, Copyright 2013 Colour Developers)"
SPECTRA = pathlib.Path("spectra")
EXPECTED = pathlib.Path("crates/spectrum/tests/data")
CIE15 = "CIE 15:2004, Colorimetry, 3rd edition, tables"
CIE15_2018 = "CIE 015:2018, Colorimetry, 4th edition, doi:10.25039/TR.015.2018"


def number(value):
    """Returns the shortest decimal that reads back to the same double, without a trailing `.0`."""
    text = repr(float(value))
    return text[:-2] if text.endswith(".0") else text


def write(path, front_matter, wavelengths, columns):
    """Writes one file: front matter, a header row, rows."""
    low, high = number(wavelengths[0]), number(wavelengths[-1])
    lines = ["# spectra: 1"]
    lines += [f"# {key}: {value}" for key, value in front_matter.items()]
    lines.append(f"# range: {low}-{high} nm")
    lines.append(",".join(["wavelength_nm", *columns]))
    for i, wavelength in enumerate(wavelengths):
        lines.append(",".join([number(wavelength), *(number(values[i]) for values in columns.values())]))
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def slug(name):
    """Returns a file name: lower case, with hyphens."""
    return re.sub(r"[^a-z0-9.]+", "-", name.lower()).strip("-")


def observers():
    """Writes color-matching functions and luminous efficiency functions."""
    table = [
        ("cie-1931-2deg", "CIE 1931 2 Degree Standard Observer", "CIE 1931 2 deg", CIE15 + " (CIE 018:2019)", "geometric"),
        ("cie-1964-10deg", "CIE 1964 10 Degree Standard Observer", "CIE 1964 10 deg", CIE15, "geometric"),
        ("cie-2015-2deg", "CIE 2015 2 Degree Standard Observer", "CIE 2015 2 deg",
         "CIE 170-2:2015, Fundamental chromaticity diagram with physiological axes, part 2 (CVRL)", "geometric"),
        ("cie-2015-10deg", "CIE 2015 10 Degree Standard Observer", "CIE 2015 10 deg",
         "CIE 170-2:2015, Fundamental chromaticity diagram with physiological axes, part 2 (CVRL)", "geometric"),
        ("cie-rgb-1931", "Wright & Guild 1931 2 Degree RGB CMFs", "CIE RGB 1931",
         "CIE 1931 RGB functions of Wright and Guild, primaries 700, 546.1 and 435.8 nm; A. D. Broadbent (2009)", "zero"),
    ]
    for file, key, name, source, outside in table:
        cmfs = colour.MSDS_CMFS[key]
        labels = ["r", "g", "b"] if "rgb" in file else ["x", "y", "z"]
        columns = {label: cmfs.values[:, i] for i, label in enumerate(labels)}
        write(SPECTRA / "cie" / f"{file}.csv", {
            "name": name, "kind": "color-matching", "quantity": "color-matching functions", "unit": "1",
            "source": source, "license": LICENCE,
            "conditions": f"{'2' if '10' not in name else '10'} degree field", "outside": outside,
        }, cmfs.wavelengths, columns)
    table = [
        ("v-lambda-1924", "CIE 1924 Photopic Standard Observer", "V(lambda)", "V",
         "CIE 1924 photopic luminous efficiency; " + CIE15, "photopic, 2 degree field"),
        ("v-prime-1951", "CIE 1951 Scotopic Standard Observer", "V'(lambda)", "V'",
         "CIE 1951 scotopic luminous efficiency; CIE 018:2019", "scotopic"),
    ]
    for file, key, name, column, source, conditions in table:
        lef = colour.SDS_LEFS[key]
        write(SPECTRA / "cie" / f"{file}.csv", {
            "name": name, "kind": "sensitivity", "quantity": "spectral luminous efficiency", "unit": "1",
            "source": source, "license": LICENCE, "conditions": conditions, "outside": "geometric",
        }, lef.wavelengths, {column: lef.values})
    wavelengths = DAYLIGHT["S0"].wavelengths
    write(SPECTRA / "cie" / "daylight-components.csv", {
        "name": "daylight components", "kind": "components", "quantity": "relative spectral power", "unit": "1",
        "source": CIE15 + "; D. B. Judd, D. L. MacAdam, G. Wyszecki, J. Opt. Soc. Am. 54, 1031 (1964)",
        "license": LICENCE, "conditions": "mean and first two characteristic vectors of daylight", "outside": "constant",
    }, wavelengths, {key: DAYLIGHT[key].values for key in ("S0", "S1", "S2")})


def illuminant_front_matter(name):
    """Returns source and conditions of an illuminant."""
    source, conditions = CIE15, "CIE illuminant"
    if name == "D60":
        conditions = "CIE daylight of 6000 K nominal (6003.5 K), computed from the daylight components"
    elif name == "E":
        conditions = "equal power at all wavelengths"
    elif name.startswith("FL3."):
        conditions = "CIE fluorescent lamps, second series; 5 nm bands hold the mercury lines"
    elif name.startswith("FL"):
        conditions = "CIE fluorescent lamp; 5 nm bands hold the mercury lines"
    elif name.startswith("HP"):
        conditions = "CIE high-pressure discharge lamp"
    elif name.startswith("LED"):
        source, conditions = CIE15_2018, "CIE typical LED lamp"
    elif name.startswith("ID"):
        source, conditions = CIE15_2018, "CIE indoor daylight, behind window glass"
    elif name.startswith("ISO"):
        source = "ISO 7589:2002, Photography - Illuminants for sensitometry"
        conditions = "defined in the range below only"
        if "Sensitometric" in name:
            conditions += "; through the ISO standard lens" + (" and diffuser" if "Printer" in name else "")
    return {
        "name": name, "kind": "emission", "quantity": "relative spectral power", "unit": "1/nm",
        "source": source, "license": LICENCE, "conditions": conditions, "outside": "constant",
    }


def illuminants():
    """Writes all illuminants, and the chromaticities that a test compares with."""
    cmfs = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    rows = ["name,x,y,cct_k,duv"]
    for name in colour.SDS_ILLUMINANTS:
        if name != name.strip():
            continue
        sd = colour.SDS_ILLUMINANTS[name]
        label = slug(name) if name.startswith("ISO") else name
        write(SPECTRA / "illuminants" / f"{label}.csv", illuminant_front_matter(name), sd.wavelengths, {"power": sd.values})
        aligned = sd.copy().align(colour.SpectralShape(360, 830, 1))
        xyz = aligned.values @ cmfs.values
        x, y = xyz[0] / xyz.sum(), xyz[1] / xyz.sum()
        cct, duv = colour.temperature.uv_to_CCT_Ohno2013(colour.UCS_to_uv(colour.XYZ_to_UCS(xyz / xyz[1])))
        temperature = f"{cct:.2f},{duv:.6f}" if abs(duv) < 0.05 and 1000 < cct < 25000 else ","
        rows.append(f"{name},{x:.7f},{y:.7f},{temperature}")
    EXPECTED.mkdir(parents=True, exist_ok=True)
    (EXPECTED / "illuminants.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")


PATCH_NAMES = {
    "white 9.5 (.05 D)": "white", "neutral 8 (.23 D)": "neutral-8", "neutral 6.5 (.44 D)": "neutral-6.5",
    "neutral 5 (.70 D)": "neutral-5", "neutral 3.5 (1.05 D)": "neutral-3.5", "black 2 (1.5 D)": "black",
}


def checkers():
    """Writes ColorChecker reflectances, and their colors under D50."""
    table = [
        ("colorchecker", "ISO 17321-1", "ColorChecker", "ISO 17321-1:2012, annex C", "24 patches, 0/45 geometry"),
        ("colorchecker-babelcolor", "BabelColor Average", "ColorChecker BabelColor average",
         "D. Pascale, The ColorChecker (since 1976!), BabelColor (2012)", "24 patches, average of 30 charts"),
    ]
    for file, key, name, source, conditions in table:
        patches = colour.SDS_COLOURCHECKERS[key]
        columns = {PATCH_NAMES.get(p, slug(p)): sd.values for p, sd in patches.items()}
        wavelengths = next(iter(patches.values())).wavelengths
        write(SPECTRA / "reflectances" / f"{file}.csv", {
            "name": name, "kind": "reflectance", "quantity": "reflectance factor", "unit": "1",
            "source": source, "license": LICENCE, "conditions": conditions,
            "interpolation": "sprague", "outside": "constant",
        }, wavelengths, columns)
    shape = colour.SpectralShape(360, 830, 1)
    cmfs = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].values
    light = colour.SDS_ILLUMINANTS["D50"].copy().align(shape).values
    white = light @ cmfs
    rows = ["patch,X,Y,Z,L,a,b"]
    for patch, sd in colour.SDS_COLOURCHECKERS["ISO 17321-1"].items():
        xyz = 100 * (sd.copy().align(shape).values * light) @ cmfs / white[1]
        lab = colour.XYZ_to_Lab(xyz / 100, colour.XYZ_to_xy(white))
        rows.append(",".join([PATCH_NAMES.get(patch, slug(patch)), *(f"{v:.5f}" for v in (*xyz, *lab))]))
    (EXPECTED / "checker-d50.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")


UNSEEN = pathlib.Path("crates/film/tests/data/unseen.csv")


def unseen():
    """Writes skins and leaves to which film was not fitted: patches of the rawtoaces training data, by number."""
    training = colour.characterisation.read_training_data_rawtoaces_v1()
    values = np.maximum(training.values, 0)  # at 380 nm the data have +-1e-17 instead of 0
    columns = {f"skin-{i}": values[:, i - 1] for i in range(12, 19)}
    columns |= {f"leaf-{i}": values[:, i - 1] for i in (80, 81, *range(85, 91))}
    write(UNSEEN, {
        "name": "Skins and leaves", "kind": "reflectance", "quantity": "reflectance factor", "unit": "1",
        "source": "Academy of Motion Picture Arts and Sciences, rawtoaces, training data: 190 patches", "license": LICENCE,
        "conditions": "patches 12-18, 80, 81 and 85-90", "outside": "constant",
    }, training.wavelengths, columns)


def cones():
    """Writes cone fundamentals, and the 1931 observer's functions for the primaries of sRGB, with their negative lobes."""
    for degrees, key in ((2, "Stockman & Sharpe 2 Degree Cone Fundamentals"), (10, "Stockman & Sharpe 10 Degree Cone Fundamentals")):
        cones = colour.MSDS_CMFS[key]
        values = np.nan_to_num(cones.values)
        write(SPECTRA / "cie" / f"cone-fundamentals-{degrees}deg.csv", {
            "name": f"Cone fundamentals, {degrees} degrees", "kind": "color-matching", "quantity": "relative sensitivity, of energy",
            "unit": "1", "source": "CIE 170-1:2006; A. Stockman, L. T. Sharpe, Vision Research 40, 1711 (2000)",
            "license": LICENCE, "conditions": "long, medium and short cones, each with a peak of 1", "outside": "zero",
        }, cones.wavelengths, {name: values[:, i] for i, name in enumerate("lms")})
    xyz = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    matrix = np.linalg.inv(colour.normalised_primary_matrix(
        colour.RGB_COLOURSPACES["sRGB"].primaries, np.array([0.3127, 0.3290])))
    rgb = xyz.values @ matrix.T
    write(SPECTRA / "cie" / "srgb-1931-2deg.csv", {
        "name": "CIE 1931 color matching functions for the primaries of sRGB", "kind": "color-matching",
        "quantity": "color matching function", "unit": "1", "source": f"{CIE15}; IEC 61966-2-1:1999, primaries and white",
        "license": LICENCE, "conditions": "2 degrees; negative where a primary has to be added to the light instead", "outside": "zero",
    }, xyz.wavelengths, {name: np.round(rgb[:, i], 9) for i, name in enumerate("rgb")})


def rendering():
    """Writes samples by which lamps are judged, and the results of the package for F1 to F12 with them.

    The fourteen test colors of the CIE are taken from NIST's CQS simulation (a work of the United States government). The 99 color
    evaluation samples are published with CIE 224:2017 and ANSI/IES TM-30, and are here as the package distributes them, by 5 nm.
    """
    colors = colour.quality.datasets.tcs.SDS_TCS_CIE1995
    first = next(iter(colors.values()))
    write(SPECTRA / "reflectances" / "cie-test-colors.csv", {
        "name": "CIE test colors for color rendering", "kind": "reflectance", "quantity": "radiance factor", "unit": "1",
        "source": "CIE 13.3-1995, after Y. Ohno and W. Davis, NIST CQS simulation 7.4 (2008)", "license": LICENCE,
        "conditions": "test color samples 1 to 14", "outside": "constant",
    }, first.wavelengths, {slug(name): sd.values for name, sd in colors.items()})
    path = pathlib.Path(colour.quality.cfi2017.ROOT_RESOURCES_CIE2017) / "tcs_cfi2017_5_nm.csv.gz"
    data = np.genfromtxt(path, delimiter=",")
    write(SPECTRA / "reflectances" / "color-evaluation-samples.csv", {
        "name": "Color evaluation samples (TM-30)", "kind": "reflectance", "quantity": "reflectance factor", "unit": "1",
        "source": "CIE 224:2017, CIE 2017 color fidelity index; ANSI/IES TM-30-18", "license": LICENCE,
        "conditions": "99 samples", "outside": "constant",
        "note": "published by the CIE for free access at cie.co.at/data-tables under the terms stated there; this is the table that "
                "colour-science distributes under its own license",
    }, data[:, 0], {f"ces{i:02}": data[:, i] for i in range(1, 100)})
    rows = ["# By colour-science 0.4.7; see xtask/import_colour_science.py.", "lamp,Ra,Rf"]
    for i in range(1, 13):
        sd = colour.SDS_ILLUMINANTS[f"FL{i}"]
        indices = colour.colour_rendering_index(sd), colour.colour_fidelity_index(sd, method="CIE 2017")
        rows.append(",".join([f"FL{i}", *(f"{v:.6f}" for v in indices)]))
    pathlib.Path("crates/color/tests/data/rendering.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")


if __name__ == "__main__":
    observers()
    illuminants()
    checkers()
    unseen()
    cones()
    rendering()
