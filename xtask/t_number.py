#!/usr/bin/env python3
"""Computes T-numbers on the axis for a lens file of spheres, planes and a stop, with an independent tracer.

`spectra lens info` is compared with them (tests/it/cli_lens.rs, figures in tests/data/t-numbers.csv).

    python3 xtask/t_number.py lenses/zeiss-biotar-50-f1.4.yaml target/release/spectra

The rays come from an object at infinity on the axis, in rings of equal area over the pupil. At each surface the script applies Snell's
law to the angle to the normal and Fresnel's equations for both polarizations (of an uncoated lens, including cemented surfaces). The
marginal ray is the highest one that passes all semi-diameters. N = 1 / (2 sin theta'), T = N / sqrt(mean transmitted fraction). Indices
at the line d are those of the program's own `glass info`. With a third argument, `absorbing`, glass absorbs too: by the internal
transmittance of 10 mm that `glass info` gives for it. If it has none, that of the glass counts from which `lens info` says it is borrowed.
"""

import json
import math
import re
import subprocess
import sys

RINGS = 2000
LINE_D_NM = 587.5618


def surfaces(path):
    """Returns (curvature, thickness, glass or None or 'same', semi-diameter or inf) of each row of a file in flow style."""
    found = []
    with open(path, encoding="utf-8") as file:
        for line in file:
            row = re.match(r"\s*- \{(.*)\}\s*$", line)
            if not row:
                continue
            keys = dict(part.split(": ", 1) for part in row.group(1).split(", "))
            kind = keys["kind"]
            if kind not in ("sphere", "plane", "stop"):
                sys.exit(f"{path}: no tracer for a {kind} here")
            found.append((
                1.0 / float(keys["radius"]) if kind == "sphere" else 0.0,
                float(keys.get("thickness", 0)),
                "same" if kind == "stop" else (keys.get("glass") or (f"{keys['nd']},{keys['vd']}" if "nd" in keys else None)),
                float(keys.get("semi-diameter", "inf")),
            ))  # fmt: skip
    return found


def index(program, glass):
    if re.match(r"[0-9.]+,", glass):
        return float(glass.split(",")[0])
    out = subprocess.run([program, "glass", "info", glass, "--json"], check=True, capture_output=True, text=True).stdout
    return json.loads(out)["nd"]


def per_mm(program, glass):
    command = [program, "glass", "info", glass, "--wavelength-nm", str(LINE_D_NM), "--json"]
    out = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    return -math.log(json.loads(out)["internal_transmittance_10mm_at"]) / 10.0


def fresnel(n, m, cos_i, cos_t):
    """Returns the power fraction of unpolarized light that passes from n to m."""
    rs = (n * cos_i - m * cos_t) / (n * cos_i + m * cos_t)
    rp = (m * cos_i - n * cos_t) / (m * cos_i + n * cos_t)
    return 1.0 - 0.5 * (rs * rs + rp * rp)


def trace(lens, height, clip=True):
    """Returns the transmitted fraction and the sine behind the lens, or None if the ray ends. The ray runs in the plane of the paper."""
    y, z, sin, cos, n = height, 0.0, 0.0, 1.0, 1.0
    weight = 1.0
    for curvature, thickness, m, per_mm, before_per_mm, rim in lens:
        start = (y, z)
        if curvature == 0.0:
            way = -z / cos
        else:
            radius = 1.0 / curvature
            # From (y, z) along (sin, cos) to the sphere about (0, radius); the intersection near the vertex counts.
            dy, dz = y, z - radius
            b = dy * sin + dz * cos
            disc = b * b - (dy * dy + dz * dz - radius * radius)
            if disc < 0.0:
                return None
            way = min((-b - math.sqrt(disc), -b + math.sqrt(disc)), key=lambda s: abs(z + s * cos))
        y, z = y + way * sin, z + way * cos
        if clip and abs(y) > rim:
            return None
        weight *= math.exp(-before_per_mm * math.hypot(y - start[0], z - start[1]))
        # Tilt is the angle of the outward normal to the axis; the others are ordinary angles.
        tilt = math.asin(y * curvature)
        incidence = math.atan2(sin, cos) + tilt
        ratio = n * math.sin(incidence) / m
        if abs(ratio) >= 1.0:
            return None
        refraction = math.asin(ratio)
        if m != n:
            weight *= fresnel(n, m, math.cos(incidence), math.cos(refraction))
        angle = refraction - tilt
        sin, cos, n = math.sin(angle), math.cos(angle), m
        z -= thickness
    return weight, abs(sin)


def numbers(rows, indices, absorption):
    """Returns the f-number, the transmitted fraction of the light, and the T-number."""
    lens, n, a = [], 1.0, 0.0
    for curvature, thickness, glass, rim in rows:
        before = a
        if glass != "same":
            n = indices[glass] if glass else 1.0
            a = absorption.get(glass, 0.0) if glass else 0.0
        lens.append((curvature, thickness, n, a, before, rim))
    low, high = 0.0, 2.0 * max(row[3] for row in rows if math.isfinite(row[3]))
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if trace(lens, middle) else (low, middle)
    f_number = 0.5 / trace(lens, low)[1]
    passed = sum(trace(lens, low * math.sqrt((k + 0.5) / RINGS))[0] for k in range(RINGS)) / RINGS
    return f_number, passed, f_number / math.sqrt(passed)


def main():
    rows = surfaces(sys.argv[1])
    program = sys.argv[2]
    names = {row[2] for row in rows if row[2] not in (None, "same")}
    indices = {name: index(program, name) for name in names}
    absorption = {}
    if len(sys.argv) > 3:
        out = subprocess.run([program, "lens", "info", sys.argv[1], "--json"], check=True, capture_output=True, text=True).stdout
        media = json.loads(out)["assumed_media"]
        lenders = {entry["medium"]: entry["absorption_of"] for entry in media if entry["absorption_of"]}
        absorption = {name: per_mm(program, lenders.get(name, name)) for name in names}
    f_number, passed, t_number = numbers(rows, indices, absorption)
    print(f"f/{f_number:.5f}, passes {passed:.5f}, T/{t_number:.5f}")


if __name__ == "__main__":
    main()
