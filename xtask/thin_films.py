"""Computes reflectance and transmittance of surfaces with and without films by another program: tests/data/thin-films.csv.

The program is the Python package `tmm` (MIT; S. J. Byrnes), version 0.2.0, `coh_tmm`, double precision: the transfer matrix of a coherent
stack between two half-spaces. Columns: a name; the indices of the medium that light comes from and of the one behind; the layers in the
order in which light meets them, each as thickness (nm), n and k, divided by `/`; wavelength (nm); angle of incidence (degrees);
reflectance and transmittance of s and of p light, as fractions of the power.

    pip install tmm==0.2.0
    python xtask/thin_films.py > tests/data/thin-films.csv
"""

import math

from tmm import coh_tmm

CROWN, FLINT = 1.5168, 1.7552
WAVELENGTHS_NM = [380, 486.1327, 587.5618, 750]
ANGLES_DEG = range(0, 81, 10)


def quarter(n, at_nm):
    return (at_nm / (4 * n), n, 0.0)


H, L = quarter(2.35, 550), quarter(1.46, 550)
# Name, index of the glass, layers from the air on.
SURFACES = [
    ("bare crown", CROWN, []),
    ("bare flint", FLINT, []),
    ("magnesium fluoride", CROWN, [quarter(1.38, 550)]),
    ("magnesium fluoride", FLINT, [quarter(1.38, 500)]),
    ("three layers", CROWN, [quarter(1.38, 530), (530 / (2 * 2.1), 2.1, 0.0), quarter(1.63, 530)]),
    ("quarter-wave stack", CROWN, [H, L] * 5 + [H]),
    ("V coat", CROWN, [(115.0, 1.38, 0.0), (14.0, 2.3, 0.0)]),
    ("absorbing film", CROWN, [(20.0, 2.0, 0.5)]),
    ("silver", CROWN, [(25.0, 0.135, 3.99)]),
    ("silver between oxides", FLINT, [(40.0, 2.1, 0.0), (12.0, 0.135, 3.99), (40.0, 2.1, 0.0)]),
]


def main():
    print("name,n_before,n_after,layers,wavelength_nm,angle_deg,s_reflected,p_reflected,s_passed,p_passed")
    for name, glass, layers in SURFACES:
        for before, after, order in [(1.0, glass, layers), (glass, 1.0, layers[::-1])]:
            written = "/".join(f"{d!r} {n!r} {k!r}" for d, n, k in order)
            indices = [before, *(complex(n, k) for _, n, k in order), after]
            thicknesses = [math.inf, *(d for d, _, _ in order), math.inf]
            for nm in WAVELENGTHS_NM:
                for angle in ANGLES_DEG:
                    if before * math.sin(math.radians(angle)) >= after:
                        # Total reflection transmits nothing; this table leaves it out.
                        continue
                    s, p = (coh_tmm(c, indices, thicknesses, math.radians(angle), nm) for c in "sp")
                    figures = [s["R"], p["R"], s["T"], p["T"]]
                    print(name, before, after, written, nm, angle, *(repr(float(v)) for v in figures), sep=",")


if __name__ == "__main__":
    main()
