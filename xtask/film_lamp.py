#!/usr/bin/env python3
"""Computes how colors change from one light to another, for the eye and for the layers of a film, independently of the program.

Writes tests/data/film-lamp.csv for the test `film_lamp_is_that_of_another_program` (tests/it/cli_film.rs).

Needs numpy, pyyaml and colour-science (BSD-3-Clause), which has the matching functions, CAT16, CIE Lab and CIEDE2000. The spectra are
those under spectra/, interpolated here: lights linearly, surfaces by Sprague's formula, logarithmic sensitivities linearly in the
logarithm.
"""
import pathlib

import colour
import numpy as np
import yaml

ROOT = pathlib.Path(__file__).resolve().parent.parent
BAND = np.arange(350.0, 831.0)
D65 = np.array([0.3127 / 0.3290, 1.0, (1 - 0.3127 - 0.3290) / 0.3290])
CASES = [("kodak-portra-400", "FL2", "D50"), ("kodak-ektachrome-100d", "LED-B3", "D55"), ("fuji-provia-100f", "FL11", "D65")]

functions = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
EYE = np.stack([np.interp(BAND, functions.wavelengths, functions.values[:, k], 0, 0) for k in range(3)], 1)


def table(path):
    rows = [line for line in (ROOT / path).read_text().splitlines() if not line.startswith("#")]
    values = np.array([[float(v or "nan") for v in row.split(",")] for row in rows[1:]])
    return rows[0].split(","), values


def light(name):
    path = next(p for p in (ROOT / "spectra/illuminants").iterdir() if p.stem.lower() == name.lower())
    _, values = table(path)
    # The spectrum is constant beyond its ends, as the files say.
    assert "# outside: constant" in path.read_text()
    return np.interp(BAND, values[:, 0], values[:, 1])


def chart():
    names, values = table("spectra/reflectances/colorchecker.csv")
    # Sprague's formula within the data, constant beyond its ends, as the file says.
    within = np.clip(BAND, values[0, 0], values[-1, 0])
    return {
        name: colour.SpragueInterpolator(values[:, 0], values[:, k])(within) for k, name in enumerate(names) if k > 0
    }


def layers(stock):
    film = yaml.safe_load((ROOT / f"spectra/film/{stock}.yaml").read_text())
    out = []
    for layer in film["layers"]:
        seen = layer["sensitivity"]
        assert seen["reading"] == "log10" and seen["measured-under"] == "equal-energy" and "floor" not in seen, stock
        points = np.array(seen["table"], float)
        log = np.interp(BAND, points[:, 0], points[:, 1])
        within = (BAND >= points[0, 0]) & (BAND <= points[-1, 0])
        out.append(np.where(within, 10.0**log, 0.0))
    return np.stack(out, 1)


def seen(power, surfaces, film):
    """Returns for each surface what the eye sees, adapted to D65, and the exposures of the layers relative to white."""
    white = power @ EYE
    eye, exposed = [], []
    for surface in surfaces.values():
        xyz = (power * surface) @ EYE / white[1]
        eye.append(colour.adaptation.chromatic_adaptation_VonKries(xyz, white / white[1], D65, transform="CAT16"))
        exposed.append((power * surface) @ film / (power @ film))
    return np.array(eye), np.array(exposed)


def lab(xyz):
    return colour.XYZ_to_Lab(xyz, colour.XYZ_to_xy(D65))


def main():
    rows = ["stock,lamp,reference,patch,eye,layers"]
    for stock, lamp, reference in CASES:
        film, surfaces = layers(stock), chart()
        (eye, exposed), (eye_0, exposed_0) = (seen(light(name), surfaces, film) for name in (lamp, reference))
        # Weighted least squares, with by far the largest weight for white.
        weights = np.append(1 / np.maximum(exposed_0.sum(1), 1e-3), 1e4)
        a = np.vstack([exposed_0, np.ones(3)]) * np.sqrt(weights)[:, None]
        b = np.vstack([eye_0, D65]) * np.sqrt(weights)[:, None]
        matrix = np.linalg.lstsq(a, b, rcond=None)[0]
        to_eye = colour.delta_E(lab(eye_0), lab(eye), method="CIE 2000")
        to_film = colour.delta_E(lab(exposed_0 @ matrix), lab(exposed @ matrix), method="CIE 2000")
        for name, e, f in zip(surfaces, to_eye, to_film):
            rows.append(f"{stock},{lamp},{reference},{name},{e:.6f},{f:.6f}")
    (ROOT / "tests/data/film-lamp.csv").write_text("\n".join(rows) + "\n")


if __name__ == "__main__":
    main()
