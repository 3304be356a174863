#!/usr/bin/env python3
"""Writes spread.json next to this file: light on the pixels around a point, for tests/it/scatter.rs.

    python3 crates/film/tests/reference/spread.py target/debug/spectra

Reads the light spread of each stock's emulsion from `spectra film info --json` (standard deviations and weights of Gaussians) and
integrates this function of the distance over pixels in polar coordinates around the point: over the angle in closed form
(the arc of each circle that lies in the pixel), over the radius by the trapezoidal rule on the share of light within it. The
method of the program (products of error functions, a Fourier transform) is not used. Needs numpy.
"""

import json
import pathlib
import subprocess
import sys

import numpy as np

STOCKS = ["kodak-tri-x-400", "kodak-double-x-5222", "kodak-vision3-250d-5207", "kodak-ektachrome-100d"]
PITCHES_UM = [2, 6, 12, 37.5, 75]


def arc_in_first_quadrant(r, x, y):
    """Angle of the circle of radius r that lies in [0, x] x [0, y]."""
    with np.errstate(divide="ignore", invalid="ignore"):
        begin = np.where(r > x, np.arccos(np.minimum(x / r, 1)), 0)
        end = np.where(r > y, np.arcsin(np.minimum(y / r, 1)), np.pi / 2)
    return np.maximum(end - begin, 0)


def arc(r, x0, x1, y0, y1):
    """Angle of the circle that lies in a rectangle with non-negative coordinates."""
    a = arc_in_first_quadrant
    return a(r, x1, y1) - a(r, x0, y1) - a(r, x1, y0) + a(r, x0, y0)


def on_pixel(gaussians, pitch, i, j):
    """Share of the light on pixel i across and j down from a point in the middle of pixel 0."""
    def side(k):
        return [(0, 0.5 * pitch, 2)] if k == 0 else [((k - 0.5) * pitch, (k + 0.5) * pitch, 1)]

    total = 0.0
    for x0, x1, nx in side(i):
        for y0, y1, ny in side(j):
            near, far = np.hypot(x0, y0), np.hypot(x1, y1)
            r = np.linspace(near, far, 200001)
            angle = arc(np.maximum(r, 1e-12), x0, x1, y0, y1)
            # The share of light within r, whose steps are weighted by the angle over a full turn.
            beyond = sum(w * np.exp(-r * r / (2 * s * s)) for s, w in gaussians)
            steps = beyond[:-1] - beyond[1:]
            total += nx * ny * np.sum(steps * (angle[1:] + angle[:-1]) / 2) / (2 * np.pi)
    return total


def main():
    program = sys.argv[1]
    out = []
    for stock in STOCKS:
        info = json.loads(subprocess.run([program, "film", "info", stock, "--json"], check=True, capture_output=True, text=True).stdout)
        for layer in info["layers"]:
            gaussians = layer["modulation"]["spread_mm_and_weight"]
            for pitch_um in PITCHES_UM:
                pitch = pitch_um / 1000
                peak = on_pixel(gaussians, pitch, 0, 0)
                points = []
                for a, b in [(1, 0), (1, 1), (2, 1)]:
                    n = 1 if (a, b) != (1, 0) else 0
                    while n < 60:
                        value = on_pixel(gaussians, pitch, a * n, b * n)
                        if value < 1e-6 * peak:
                            break
                        points.append([a * n, b * n, float(f"{value:.7g}")])
                        n += 1 if n < 6 else n // 3
                out.append({"stock": stock, "layer": layer["name"], "pitch_um": pitch_um, "points": points})
    lines = ",\n".join(json.dumps(entry) for entry in out)
    pathlib.Path(__file__).with_name("spread.json").write_text(f"[\n{lines}\n]\n", encoding="utf-8")


main()
