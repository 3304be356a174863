#!/usr/bin/env python3
"""Writes the tables under spectra/sensors/: what sensors see, by color.

Run from the root of the repository:

    python3 -m venv VENV
    VENV/bin/pip install colour-science==0.4.7
    VENV/bin/python xtask/import_sensors.py

Source: the Python package colour-science 0.4.7 (BSD-3-Clause, Copyright 2013 Colour Developers), which holds the
measurement of the National Physical Laboratory: M. M. Darrodi, G. Finlayson, T. Goodman, M. Mackiewicz, "Reference data
set for camera spectral sensitivity estimation", J. Opt. Soc. Am. A 32, 381 (2015), doi:10.1364/JOSAA.32.000381. Numbers are
written as the package holds them.
"""

import pathlib

from colour.characterisation import MSDS_CAMERA_SENSITIVITIES

FRONT = """# spectra: 1
# name: Nikon D5100
# kind: sensitivity
# quantity: relative spectral sensitivity per power, each color by itself
# unit: 1
# source: M. M. Darrodi, G. Finlayson, T. Goodman, M. Mackiewicz, J. Opt. Soc. Am. A 32, 381 (2015), doi:10.1364/JOSAA.32.000381
# licence: BSD-3-Clause (colour-science 0.4.7, Copyright 2013 Colour Developers)
# conditions: measured with a monochromator at the National Physical Laboratory; camera with its filters, without lens
# outside: zero
# range: 380-780 nm
# note: each color is scaled to a peak of 1: how the colors compare in absolute terms is not told
"""


def number(value):
    """The shortest decimal that reads back to the same double, without a trailing `.0`."""
    text = repr(float(value))
    return text[:-2] if text.endswith(".0") else text


def main():
    camera = MSDS_CAMERA_SENSITIVITIES["Nikon 5100 (NPL)"]
    rows = ["wavelength_nm,red,green,blue"]
    for wavelength, values in zip(camera.domain, camera.values):
        # Noise of the measurement about zero.
        rows.append(",".join(number(v) for v in (wavelength, *(max(float(x), 0.0) for x in values))))
    folder = pathlib.Path("spectra/sensors")
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "nikon-d5100.csv").write_text(FRONT + "\n".join(rows) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
