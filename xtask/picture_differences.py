#!/usr/bin/env python3
"""Writes tests/data/picture-differences.csv: pixels of two pictures, and their color differences by another program.

Run from the root of the repository:

    python3 -m venv VENV
    VENV/bin/pip install colour-science==0.4.7
    VENV/bin/python xtask/picture_differences.py

Two pictures of 24 x 16 pixels as CIE 1931 XYZ in single precision, Y of white 1. The colors of the first lie within sRGB and beyond it,
from nearly black to twice as bright as white. Their counterparts in the second differ by noise, by hue, or altogether. CIEDE2000 of each
pair comes from the Python package colour-science 0.4.7 (BSD-3-Clause, Copyright 2013 Colour Developers), in CIE Lab against D65
(0.3127, 0.3290), from the values in single precision.
"""

import pathlib

import colour
import numpy as np

TARGET = pathlib.Path("tests/data/picture-differences.csv")
PIXELS = 24 * 16
WHITE_XY = np.array([0.3127, 0.3290])


def pictures():
    random = np.random.default_rng(2026)
    rgb = random.random((PIXELS, 3)) ** 2.2
    rgb[: PIXELS // 8] *= 1e-3
    rgb[PIXELS // 8 : PIXELS // 4] *= 2.0
    # About a third of the colors lies outside sRGB, as spectral lines do.
    outside = random.random((PIXELS, 3)) < 0.1
    rgb = np.where(outside, -0.05 * rgb, rgb)
    srgb = colour.models.RGB_COLOURSPACE_sRGB
    first = rgb @ srgb.matrix_RGB_to_XYZ.T
    first[first < 0] = 0.0
    second = first * (1.0 + 0.02 * random.standard_normal((PIXELS, 3)))
    second[::5] = first[::5][:, [2, 1, 0]]
    second[::7] = first[::-7][: len(second[::7])]
    second[::11] = first[::11]
    return first.astype(np.float32), np.abs(second).astype(np.float32)


def main():
    first, second = pictures()
    white = WHITE_XY

    def lab(xyz):
        return colour.XYZ_to_Lab(xyz.astype(np.float64), white)

    differences = colour.delta_E(lab(first), lab(second), method="CIE 2000")
    rows = ["x1,y1,z1,x2,y2,z2,ciede2000"]
    for a, b, difference in zip(first, second, differences):
        rows.append(",".join([*(repr(float(v)) for v in (*a, *b)), repr(float(difference))]))
    TARGET.write_text("\n".join(rows) + "\n")
    print(f"{PIXELS} pixels, mean {differences.mean():.9f}, largest {differences.max():.4f}")


main()
