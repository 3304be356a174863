#!/usr/bin/env python3
"""Computes the effect of a wavefront's aberrations on contrast, from rays of `spectra lens trace` with their optical paths.

    xtask/wave_contrast.py SPECTRA > crates/diffraction/tests/data/wave-contrast.csv

The object is a point at infinity. The wavefront over the direction cosines at the film is a polynomial through the paths to the foot
of the perpendicular from the middle of the spot. The contrast of light is the modulus of the autocorrelation of the pupil with that
phase (H. H. Hopkins, "The frequency response of a defocused optical system", Proc. R. Soc. A 231, 1955). The contrast of rays is the
modulus of the mean of exp(-2 pi i f x), that of the edge the overlap of the pupil with itself. Needs numpy and scipy.
"""

import subprocess
import sys
import tempfile

import numpy as np
from scipy.spatial import ConvexHull, Delaunay

NM, DEGREE, CELLS = 550.0, 12, 512
LENSES = ["zeiss-biotar-50-f1.4", "canon-35-f1.8"]
STOPS = [2.8, 4, 5.6, 8, 16]
FIELDS = [0, 8, 15]
PER_MM = [10, 20, 40, 60]


def traced(program, lens, stop, points, direction):
    """Returns which rays hit, and their hit points, directions and optical paths."""
    with tempfile.NamedTemporaryFile("w", suffix=".csv") as rays:
        rays.write("x_mm,y_mm,z_mm,l,m,n\n")
        rays.writelines("%.12g,%.12g,%.12g,%.17g,%.17g,%.17g\n" % (*p, *direction) for p in points)
        rays.flush()
        call = [program, "lens", "trace", lens, "--rays", rays.name, "--focus", "inf", "--f-number", f"f/{stop}"]
        call += ["--coating", "ideal", "--absorption", "false", "--wavelength-nm", str(NM)]
        lines = subprocess.run(call, capture_output=True, text=True, check=True).stdout.strip().split("\n")[1:]
    fields = [line.split(",") for line in lines]
    hit = np.array([f[0] == "hit" for f in fields])
    return hit, np.array([[float(v or "nan") for v in [*f[2:8], f[10]]] for f in fields])


def grid(center, reach, count):
    line = np.linspace(-1, 1, count) * reach
    x, y = np.meshgrid(line + center[0], line + center[1])
    return np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], 1)


def contrasts(program, lens, stop, field_deg):
    angle = np.radians(field_deg)
    way = np.array([0, np.sin(angle), np.cos(angle)])
    before = way * (80 / way[2])
    look = grid((0, 0), 26, 141)
    hit, _ = traced(program, lens, stop, look - before, way)
    low, high = look[hit].min(0), look[hit].max(0)
    points = grid((low + high) / 2, (high - low)[:2].max() / 2 + 0.4, 161) - before
    hit, rows = traced(program, lens, stop, points, way)
    points, rows = points[hit], rows[hit]
    land, k, path = rows[:, :3], rows[:, 3:6], rows[:, 6] + points @ way
    middle = land.mean(0)
    wave = path - np.sum(k * (land - middle), 1)
    u, v = k[:, 0], k[:, 1]
    center = u.mean(), (v.max() + v.min()) / 2
    scale = max(abs(u - center[0]).max(), abs(v - center[1]).max())
    x, y = (u - center[0]) / scale, (v - center[1]) / scale
    powers = [(i, j) for i in range(DEGREE + 1) for j in range(DEGREE + 1 - i)]
    fit = np.linalg.lstsq(np.stack([x**i * y**j for i, j in powers], 1), wave, rcond=None)[0]
    corners = np.stack([x, y], 1)
    inside = Delaunay(corners[ConvexHull(corners).vertices])
    line = (np.arange(CELLS) + 0.5) / CELLS * 2.1 - 1.05
    gx, gy = np.meshgrid(line, line)
    mask = (inside.find_simplex(np.stack([gx.ravel(), gy.ravel()], 1)) >= 0).reshape(CELLS, CELLS)
    mm = NM * 1e-6
    phase = sum(c * gx**i * gy**j for c, (i, j) in zip(fit, powers)) / mm
    light = mask * np.exp(2j * np.pi * phase)
    cell = 2.1 / CELLS * scale
    for per_mm in PER_MM:
        for axis in (0, 1):
            shift = round(per_mm * mm / cell)
            own = shift * cell / mm
            first = (slice(None), slice(shift, None)) if axis == 0 else slice(shift, None)
            second = (slice(None), slice(None, CELLS - shift)) if axis == 0 else slice(None, CELLS - shift)
            yield (
                middle[1],
                "xy"[axis],
                own,
                abs(np.mean(np.exp(-2j * np.pi * own * land[:, axis]))),
                (mask[first] & mask[second]).sum() / mask.sum(),
                abs(np.vdot(light[first], light[second])) / mask.sum(),
            )


print("# Contrast of light, of rays and of the edge, line 550 nm, focused at infinity by contrast; by xtask/wave_contrast.py.")
print("lens,f-number,field_deg,film_y_mm,axis,per_mm,rays,edge,light")
for lens in LENSES:
    for stop in STOPS:
        for field in FIELDS:
            for y, axis, per_mm, rays, edge, light in contrasts(sys.argv[1], lens, stop, field):
                print(f"{lens},{stop},{field},{y:.5f},{axis},{per_mm:.4f},{rays:.4f},{edge:.4f},{light:.4f}", flush=True)
