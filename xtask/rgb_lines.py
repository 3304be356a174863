"""Computes three spectral lines with the hues of sRGB's primaries that together are white: wavelengths and powers, mean power 1.

An independent computation for the test `rgb_lines_make_white` (plugins/colors/src/named.rs). Needs colour-science (BSD-3-Clause) only
for the CIE 1931 color-matching functions.
"""
import colour
import numpy as np

PRIMARIES = np.array([[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]])  # IEC 61966-2-1
WHITE = np.array([0.3127, 0.3290])

functions = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]


def xyz(nm):
    return np.stack([np.interp(nm, functions.wavelengths, functions.values[:, k]) for k in range(3)], -1)


fine = np.arange(440.0, 640.0, 0.001)
locus = xyz(fine)[:, :2] / xyz(fine).sum(1)[:, None]
lines = []
for primary in PRIMARIES:
    out, to = locus - WHITE, primary - WHITE
    across = np.abs(out[:, 0] * to[1] - out[:, 1] * to[0])
    lines.append(fine[np.argmin(np.where(out @ to > 0, across, np.inf))])
white = np.array([WHITE[0] / WHITE[1], 1.0, (1 - WHITE.sum()) / WHITE[1]])
powers = np.linalg.solve(xyz(np.array(lines)).T, white)
for nm, power in zip(lines, 3 * powers / powers.sum()):
    print(f"{nm:.3f} nm  {power:.6f}")
