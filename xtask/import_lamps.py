#!/usr/bin/env python3
"""Writes spectra/lamps/: the principal lines of gas-discharge lamps.

Run from the root of the repository:

    python3 -m venv VENV
    VENV/bin/pip install rascal==0.3.11 colour-science==0.4.7
    VENV/bin/python xtask/import_lamps.py

Mercury, neon, helium, argon, krypton, xenon, cadmium: lines of the neutral atom in the NIST Atomic Spectra Database, as
distributed by the Python package rascal 0.3.11 (BSD-3-Clause, Copyright 2020 Josh Veitch-Michaelis, Marco Lam), file
arc_lines/all_nist.csv. It holds wavelengths in vacuum. They are written in air (E. R. Peck and K. Reeder, J. Opt. Soc.
Am. 62, 958 (1972), as the database itself does), with four decimals of a nanometer. Intensities are the relative ones of
the database: observers' estimates, comparable between neighbors, less so across the band and between sources. The letters
with them (wide, blended) are dropped. The script keeps lines in 350-830 nm with at least 1 % of the strongest line there,
at most 40. A wavelength that is listed several times (unresolved fine structure) counts once.

Neon is an exception. The estimates for its blue lines (470-484 nm) come from another observer than those of the red ones
and are as large, so the lamp would be purple. Its intensities are computed: g A / lambda from the database's transition
probabilities A, with the statistical weight g = 2 J + 1 of the upper level, assuming equally populated upper levels. These
lie within 0.7 eV of each other for the visually important red and orange lines.

Mercury's strengths are measured where a measurement is available: the relative spectral power of a clear high-pressure lamp
(H38HT-100, 100 W) from 380 to 780 nm in steps of 5 nm, in Y. Ohno, W. Davis, "NIST CQS simulation" 7.4 (National Institute
of Standards and Technology, 2008), as distributed by the Python package colour-science 0.4.7 (BSD-3-Clause, Copyright 2013
Colour Developers). The power of each group of lines is the measured power above a straight line between the values on both
sides of the group. Lines within a group are closer together than the steps; the estimates, which do compare neighbors,
divide the power among them. The lamp's continuum is left out. The lines near 365 nm lie below the measured range: their
strength relative to the violet lines is that of the observers' estimates.

Hydrogen and sodium are not in that package. Their few lines are written out below with their sources. A helium-neon
laser has one line.
"""

import csv
import fractions
import pathlib
import re

import rascal
from colour.colorimetry import SDS_LIGHT_SOURCES

TABLE = pathlib.Path(rascal.__file__).parent / "arc_lines" / "all_nist.csv"
OUTPUT = pathlib.Path("spectra/lamps")
LOW, HIGH = 350.0, 830.0
SHARE, MOST = 0.01, 40

RASCAL = "BSD-3-Clause (rascal 0.3.11, Copyright 2020 Josh Veitch-Michaelis, Marco Lam)"
FACTS = "facts, no license needed"
GASES = {
    "Hg": "mercury", "Ne": "neon", "He": "helium", "Ar": "argon", "Kr": "krypton", "Xe": "xenon", "Cd": "cadmium",
}


def air(vacuum_nm):
    """Converts a wavelength in vacuum to air at 15 C, 101 325 Pa (Peck and Reeder 1972, eq. 2)."""
    s2 = (1000.0 / vacuum_nm) ** 2
    index = 1 + 1e-8 * (8060.51 + 2480990 / (132.274 - s2) + 17455.7 / (39.32957 - s2))
    return vacuum_nm / index


def intensity_of(row):
    """Returns the relative intensity of a row of the table, or None if it states none."""
    if row[0] == "Ne":
        if not row[5] or not row[8]:
            return None
        weight = 2 * float(fractions.Fraction(row[8])) + 1
        return weight * float(row[5]) / float(row[2])
    stated = re.match(r"\d+(\.\d+)?", row[4])
    return float(stated.group()) if stated else None


def nist_lines():
    """Returns the lines of neutral atoms: element -> {wavelength in air: intensity}."""
    lines = {element: {} for element in GASES}
    with TABLE.open(encoding="utf-8") as file:
        for row in csv.reader(file):
            if row[0] not in lines or row[1] != "1":
                continue
            intensity = intensity_of(row)
            if intensity is None:
                continue
            wavelength = f"{air(float(row[2]) / 10):.4f}"
            known = lines[row[0]].get(wavelength, 0.0)
            lines[row[0]][wavelength] = max(known, intensity)
    return lines


def principal(lines):
    """Returns the lines in the band that are bright enough, by wavelength."""
    band = {w: i for w, i in lines.items() if LOW <= float(w) <= HIGH}
    strongest = max(band.values())
    kept = sorted(band.items(), key=lambda l: (-l[1], float(l[0])))[:MOST]
    return sorted(((w, i) for w, i in kept if i >= SHARE * strongest), key=lambda l: float(l[0]))


# Groups of lines that the measured spectrum of a mercury lamp shows: first and last wavelength of each. Other lines (535.4, 567.6 nm)
# do not rise above its continuum.
MERCURY_GROUPS = [(400, 410), (430, 440), (540, 550), (575, 585)]
STEP = 5


def measured_mercury(estimates):
    """Returns the lines of mercury with their power relative to the strongest; `estimates`: [(wavelength as text, intensity)]."""
    spectrum = SDS_LIGHT_SOURCES["H38HT-100 (Mercury)"]
    values = {round(w): float(v) for w, v in zip(spectrum.wavelengths, spectrum.values)}
    powers, ratio = {}, None
    for first, last in MERCURY_GROUPS:
        left, right = values[first - STEP], values[last + STEP]
        steps = (last - first) // STEP + 2
        base = [left + (right - left) * i / steps for i in range(1, steps)]
        power = sum(values[w] - b for w, b in zip(range(first, last + 1, STEP), base))
        own = [(w, i) for w, i in estimates if first - STEP / 2 <= float(w) <= last + STEP / 2]
        powers.update({w: power * i / sum(i for _, i in own) for w, i in own})
        if ratio is None:
            ratio = power / sum(i for _, i in own)
    powers.update({w: ratio * i for w, i in estimates if float(w) < 380})
    strongest = max(powers.values())
    lines = [(w, p / strongest) for w, p in powers.items() if p >= SHARE * strongest]
    return sorted(lines, key=lambda line: float(line[0]))


def write(name, title, source, license, conditions, strengths, lines, notes=()):
    """Writes one lamp. `lines`: (wavelength as text, intensity as text or number)."""
    text = "\n".join([
        "# spectra: 1", f"# name: {title}", "# kind: lines",
        f"# quantity: relative {'power' if strengths == 'measured' else 'intensity'}", "# unit: 1",
        f"# source: {source}", f"# license: {license}", f"# conditions: {conditions}", f"# strengths: {strengths}",
        "# outside: zero", f"# range: {lines[0][0]}-{lines[-1][0]} nm", *(f"# note: {note}" for note in notes),
        "wavelength_nm,power", *(f"{w},{i:.6g}" for w, i in lines),
    ])
    OUTPUT.mkdir(parents=True, exist_ok=True)
    (OUTPUT / f"{name}.csv").write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    estimated = "relative intensities as estimated by the observers"
    computed = "relative intensities g A / lambda from transition probabilities, upper levels populated alike"
    for element, lines in nist_lines().items():
        if element == "Hg":
            write(
                "mercury", "mercury lamp",
                "relative spectral power of a clear lamp H38HT-100 in Y. Ohno, W. Davis, NIST CQS simulation 7.4, NIST (2008); "
                "wavelengths: NIST Atomic Spectra Database, converted to air by Peck and Reeder (1972)",
                "BSD-3-Clause (colour-science 0.4.7, Copyright 2013 Colour Developers; rascal 0.3.11, Copyright 2020 Josh "
                "Veitch-Michaelis, Marco Lam)",
                "clear high-pressure lamp of 100 W, measured from 380 to 780 nm in steps of 5 nm; its continuum left out",
                "measured", measured_mercury(principal(lines)),
                notes=["lines closer than 10 nm share their measured power by the observers' estimates",
                       "below 380 nm not measured: as strong relative to the violet lines as the observers estimate"],
            )
            continue
        write(
            GASES[element], f"{GASES[element]} lamp",
            "NIST Atomic Spectra Database, neutral atom; vacuum wavelengths converted to air by Peck and Reeder (1972)",
            RASCAL,
            f"{computed if element == 'Ne' else estimated}; lines of at least {SHARE:.0%} of the strongest, at most {MOST}",
            "computed" if element == "Ne" else "estimated", principal(lines),
        )
    write(
        "hydrogen", "hydrogen lamp, Balmer series",
        "J. Reader, C. H. Corliss, Line spectra of the elements, CRC Handbook of Chemistry and Physics; H alpha is the sum "
        "of its two components 120 + 180 at their mean",
        FACTS, "discharge in atomic hydrogen; wavelengths in air; relative intensities as estimated by the observers", "estimated",
        [("383.5384", 5), ("388.9049", 6), ("397.0072", 8), ("410.174", 15), ("434.047", 30), ("486.133", 80), ("656.28", 300)],
    )
    write(
        "sodium", "sodium lamp, D lines",
        "NIST Atomic Spectra Database; intensities in the ratio 2 : 1 of the statistical weights of the upper levels",
        FACTS, "optically thin low-pressure discharge; wavelengths in air; all other lines left out", "computed",
        [("588.995", 2), ("589.5924", 1)],
    )
    write(
        "he-ne", "helium-neon laser",
        "632.991 21 nm in vacuum (BIPM, Mise en pratique of the metre); in air by Peck and Reeder (1972)",
        FACTS, "the red line of a helium-neon laser; wavelength in air", "measured", [("632.8163", 1)],
    )
