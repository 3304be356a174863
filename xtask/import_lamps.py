#!/usr/bin/env python3
"""Writes spectra/lamps/: the principal lines of gas-discharge lamps.

Run from the root of the repository:

    python3 -m venv VENV
    VENV/bin/pip install rascal==0.3.11
    VENV/bin/python xtask/import_lamps.py

Mercury, neon, helium, argon, krypton, xenon, cadmium: lines of the neutral atom in the NIST Atomic Spectra Database, as
carried by the Python package rascal 0.3.11 (BSD-3-Clause, Copyright 2020 Josh Veitch-Michaelis, Marco Lam), file
arc_lines/all_nist.csv. It holds wavelengths in vacuum; they are written in air (E. R. Peck and K. Reeder, J. Opt. Soc.
Am. 62, 958 (1972), which is what the database itself uses), with four decimals of a nanometre. Intensities are the
database's relative ones: observers' estimates, comparable between neighbors, less so across the band and between
sources; the letters beside them (wide, blended) are dropped. Kept: 350-830 nm, at least 1 % of the strongest line there,
at most 40. A wavelength that is listed several times (unresolved fine structure) counts once.

Neon is an exception: the estimates for its blue lines (470-484 nm) come from another observer than those of the red ones
and are as large, so that the lamp would be purple. Its intensities are computed: g A / lambda from the database's transition
probabilities A, with the statistical weight g = 2 J + 1 of the upper level, all upper levels taken as populated alike. They
lie within 0.7 eV for the red and orange lines, which are what one sees.

Hydrogen and sodium are not in that package; their few lines are written out below with their sources. A helium-neon
laser has one line.
"""

import csv
import fractions
import pathlib
import re

import rascal

TABLE = pathlib.Path(rascal.__file__).parent / "arc_lines" / "all_nist.csv"
OUTPUT = pathlib.Path("spectra/lamps")
LOW, HIGH = 350.0, 830.0
SHARE, MOST = 0.01, 40

RASCAL = "BSD-3-Clause (rascal 0.3.11, Copyright 2020 Josh Veitch-Michaelis, Marco Lam)"
FACTS = "facts, no licence needed"
GASES = {
    "Hg": "mercury", "Ne": "neon", "He": "helium", "Ar": "argon", "Kr": "krypton", "Xe": "xenon", "Cd": "cadmium",
}


def air(vacuum_nm):
    """Wavelength in air at 15 C, 101 325 Pa, from that in vacuum (Peck and Reeder 1972, eq. 2)."""
    s2 = (1000.0 / vacuum_nm) ** 2
    index = 1 + 1e-8 * (8060.51 + 2480990 / (132.274 - s2) + 17455.7 / (39.32957 - s2))
    return vacuum_nm / index


def intensity_of(row):
    """Relative intensity of a row of the table; None where it states none."""
    if row[0] == "Ne":
        if not row[5] or not row[8]:
            return None
        weight = 2 * float(fractions.Fraction(row[8])) + 1
        return weight * float(row[5]) / float(row[2])
    stated = re.match(r"\d+(\.\d+)?", row[4])
    return float(stated.group()) if stated else None


def nist_lines():
    """Lines of neutral atoms: element -> {wavelength in air: intensity}."""
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
    """Those in the band that are bright enough, by wavelength."""
    band = {w: i for w, i in lines.items() if LOW <= float(w) <= HIGH}
    strongest = max(band.values())
    kept = sorted(band.items(), key=lambda l: (-l[1], float(l[0])))[:MOST]
    return sorted(((w, i) for w, i in kept if i >= SHARE * strongest), key=lambda l: float(l[0]))


def write(name, title, source, licence, conditions, lines):
    """One lamp. `lines`: (wavelength as text, intensity as text or number)."""
    text = "\n".join([
        "# spectra: 1", f"# name: {title}", "# kind: lines", "# quantity: relative intensity", "# unit: 1",
        f"# source: {source}", f"# licence: {licence}", f"# conditions: {conditions}", "# outside: zero",
        f"# range: {lines[0][0]}-{lines[-1][0]} nm", "wavelength_nm,power",
        *(f"{w},{i:.6g}" for w, i in lines),
    ])
    OUTPUT.mkdir(parents=True, exist_ok=True)
    (OUTPUT / f"{name}.csv").write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    estimated = "relative intensities as estimated by the observers"
    computed = "relative intensities g A / lambda from transition probabilities, upper levels populated alike"
    for element, lines in nist_lines().items():
        write(
            GASES[element], f"{GASES[element]} lamp",
            "NIST Atomic Spectra Database, neutral atom; vacuum wavelengths converted to air by Peck and Reeder (1972)",
            RASCAL,
            f"{computed if element == 'Ne' else estimated}; lines of at least {SHARE:.0%} of the strongest, at most {MOST}",
            principal(lines),
        )
    write(
        "hydrogen", "hydrogen lamp, Balmer series",
        "J. Reader, C. H. Corliss, Line spectra of the elements, CRC Handbook of Chemistry and Physics; H alpha is the sum "
        "of its two components 120 + 180 at their mean",
        FACTS, "discharge in atomic hydrogen; wavelengths in air",
        [("383.5384", 5), ("388.9049", 6), ("397.0072", 8), ("410.174", 15), ("434.047", 30), ("486.133", 80), ("656.28", 300)],
    )
    write(
        "sodium", "sodium lamp, D lines",
        "NIST Atomic Spectra Database; intensities in the ratio 2 : 1 of the statistical weights of the upper levels",
        FACTS, "optically thin low-pressure discharge; wavelengths in air; all other lines left out",
        [("588.995", 2), ("589.5924", 1)],
    )
    write(
        "he-ne", "helium-neon laser",
        "632.991 21 nm in vacuum (BIPM, Mise en pratique of the metre); in air by Peck and Reeder (1972)",
        FACTS, "the red line of a helium-neon laser; wavelength in air", [("632.8163", 1)],
    )
