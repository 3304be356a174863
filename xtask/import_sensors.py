#!/usr/bin/env python3
"""Writes the tables under spectra/sensors/: spectral sensitivities of sensors, by color.

Run from the root of the repository:

    python3 -m venv VENV
    VENV/bin/pip install colour-science==0.4.7
    VENV/bin/python xtask/import_sensors.py

Source: the Python package colour-science 0.4.7 (BSD-3-Clause, Copyright 2013 Colour Developers), which holds the
measurement of the National Physical Laboratory: M. M. Darrodi, G. Finlayson, T. Goodman, M. Mackiewicz, "Reference data
set for camera spectral sensitivity estimation", J. Opt. Soc. Am. A 32, 381 (2015), doi:10.1364/JOSAA.32.000381.

There each color is scaled to a peak of 1, and the ratio of the colors is not stated. It is derived from the camera's response
to white: the matrix for D65 that Adobe's DNG Converter writes for this camera, (0.8198 -0.2239 -0.0724; -0.4871 1.2389 0.2798;
-0.1043 0.2050 0.7181) from XYZ, as LibRaw 0.21 lists it, gives red, green and blue of D65 as 0.441 : 1 : 0.822. Red and blue
are scaled to that; green keeps its peak of 1. The number of electrons per photon remains unknown.
"""

import pathlib

from colour import SDS_ILLUMINANTS
from colour.characterisation import MSDS_CAMERA_SENSITIVITIES

# Matrix from XYZ to the camera's colors, for D65.
MATRIX = [[0.8198, -0.2239, -0.0724], [-0.4871, 1.2389, 0.2798], [-0.1043, 0.2050, 0.7181]]
D65_XYZ = [0.95047, 1.0, 1.08883]

FRONT = """# spectra: 1
# name: Nikon D5100
# kind: sensitivity
# quantity: relative spectral sensitivity per power
# unit: 1
# source: M. M. Darrodi, G. Finlayson, T. Goodman, M. Mackiewicz, J. Opt. Soc. Am. A 32, 381 (2015), doi:10.1364/JOSAA.32.000381
# license: BSD-3-Clause (colour-science 0.4.7, Copyright 2013 Colour Developers)
# conditions: measured with a monochromator at the National Physical Laboratory; camera with its filters, without lens
# outside: zero
# range: 380-780 nm
# note: measured color by color, each relative to its peak; red and blue over green scaled to the camera's answer to D65, 0.441 : 1 : 0.822 by the color matrix in Adobe's DNG Converter, as listed by LibRaw
# note: absolute quantum efficiency not known
"""


def number(value):
    """Returns the shortest decimal that reads back to the same double, without a trailing `.0`."""
    text = repr(float(value))
    return text[:-2] if text.endswith(".0") else text


def main():
    camera = MSDS_CAMERA_SENSITIVITIES["Nikon 5100 (NPL)"]
    rows = ["wavelength_nm,red,green,blue"]
    # Negative values are noise of the measurement about zero.
    table = [[max(float(x), 0.0) for x in values] for values in camera.values]
    daylight = [float(SDS_ILLUMINANTS["D65"][w]) for w in camera.domain]
    seen = [sum(p * row[i] for p, row in zip(daylight, table)) for i in range(3)]
    wanted = [sum(m * v for m, v in zip(row, D65_XYZ)) for row in MATRIX]
    scale = [wanted[i] / wanted[1] / (seen[i] / seen[1]) for i in range(3)]
    print("red, green and blue of D65:", [round(v / wanted[1], 4) for v in wanted], "scaled by", scale)
    for wavelength, values in zip(camera.domain, table):
        rows.append(",".join([number(wavelength), *(number(round(v * k, 6)) for v, k in zip(values, scale))]))
    folder = pathlib.Path("spectra/sensors")
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "nikon-d5100.csv").write_text(FRONT + "\n".join(rows) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
