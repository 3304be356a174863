#!/usr/bin/env python3
"""Writes tests/data/surfaces/*.csv: rays refracted at aspheric surfaces, computed with 40 digits.

Run from the root of the repository:

    python3 -m venv VENV
    VENV/bin/pip install mpmath==1.4.1
    VENV/bin/python xtask/reference_surfaces.py

The computation is independent of the tracer: sags are written as in textbooks, the intersection nearest to the vertex plane is
found by bisection and refined by the secant method, normals are numerical derivatives of the sag, and Snell's law is applied to
the angle: sin i' = (n / n') sin i in the plane of incidence. Surfaces and rays are made up here; nothing comes from elsewhere.

A file holds sets of parameters, as comments, and rows: number of the set, direction of travel (1: toward +z), refractive index
before and after, start (mm) and direction of the ray, point on the surface (mm), direction behind it. The frame is that of
the surface. The start and its direction are exact doubles; the direction is normalized before use.
"""

import pathlib
import random

from mpmath import asin, atan2, cos, diff, inf, mp, mpf, sin, sqrt

mp.dps = 40
OUTPUT = pathlib.Path("tests/data/surfaces")
INDEX = 1.5168
RAYS = 16


def curvature(radius):
    return mpf(0) if radius == inf else 1 / mpf(radius)


def conic(radius, k, r2):
    c = curvature(radius)
    return c * r2 / (1 + sqrt(1 - (1 + mpf(k)) * c * c * r2))


def even_asphere(p, x, y):
    r2 = x * x + y * y
    return conic(p[0], p[1], r2) + sum(mpf(a) * r2 ** (i + 1) for i, a in enumerate(p[2:]))


def odd_asphere(p, x, y):
    r2 = x * x + y * y
    r = sqrt(r2)
    return conic(p[0], p[1], r2) + sum(mpf(a) * r ** (i + 1) for i, a in enumerate(p[2:]))


def toroid(p, x, y):
    """Parameters: radius, conic, rotation radius, a2, a4, ..."""
    g = conic(p[0], p[1], y * y) + sum(mpf(a) * y ** (2 * i + 2) for i, a in enumerate(p[3:]))
    if p[2] == inf:
        return g
    rotation = mpf(p[2])
    root = sqrt((rotation - g) ** 2 - x * x)
    return rotation - root if rotation > 0 else rotation + root


def biconic(p, x, y):
    """Parameters: radius-x, radius-y, conic-x, conic-y."""
    cx, cy = curvature(p[0]), curvature(p[1])
    below = 1 + sqrt(1 - (1 + mpf(p[2])) * cx**2 * x**2 - (1 + mpf(p[3])) * cy**2 * y**2)
    return (cx * x * x + cy * y * y) / below


def cylinder(p, x, y):
    """Parameters: radius, 1 for straight lines along x or 0 for y."""
    return conic(p[0], 0, y * y if p[1] else x * x)


FACTORIAL = [mp.factorial(i) for i in range(40)]


def zernike(p, x, y):
    """Parameters: radius, conic, normalization radius, 0 for noll or 1 for fringe, coefficients; tables as published."""
    noll = [(0, 0), (1, 1), (1, -1), (2, 0), (2, -2), (2, 2), (3, -1), (3, 1), (3, -3), (3, 3), (4, 0), (4, 2), (4, -2), (4, 4), (4, -4)]
    fringe = [(0, 0), (1, 1), (1, -1), (2, 0), (2, 2), (2, -2), (3, 1), (3, -1), (4, 0), (3, 3), (3, -3), (4, 2), (4, -2), (5, 1), (5, -1), (6, 0)]
    r, angle = sqrt(x * x + y * y) / p[2], atan2(y, x)
    total = conic(p[0], p[1], x * x + y * y)
    for (n, signed), c in zip(fringe if p[3] else noll, p[4:]):
        m = abs(signed)
        radial = sum(
            (-1) ** s * FACTORIAL[n - s] / (FACTORIAL[s] * FACTORIAL[(n + m) // 2 - s] * FACTORIAL[(n - m) // 2 - s]) * r ** (n - 2 * s)
            for s in range((n - m) // 2 + 1)
        )
        size = 1 if p[3] else sqrt(mpf(n + 1) * (1 if m == 0 else 2))
        total += mpf(c) * size * radial * (sin(m * angle) if signed < 0 else cos(m * angle))
    return total


# Kind: sag, sets of (parameters, largest radius of the rays on the vertex plane, mm).
KINDS = {
    "even_asphere": (
        even_asphere,
        [
            ([25.0, -0.5, 0.0, 2e-6, -3e-9, 1e-12], 10),
            ([-30.0, 1.5, 1e-4, -1e-5, 2e-8], 9),
            ([6.0, -1.2, 0.0, 1e-4, -2e-6, 3e-8, -1e-10, 2e-13, -1e-16, 1e-19], 4.5),  # steep
            ([1.6, -0.6, 0.02, -0.01, 0.004, -0.001], 1.1),  # from a telephone camera
            ([inf, 0.0, 0.01, -2e-5, 1e-7, -1e-10, 2e-13, -3e-16, 1e-19, 2e-23, -1e-26, 3e-30, -1e-33], 8),
            ([40.0, 0.0] + [1e-3 / 15.0 ** (2 * i + 1) * (-1) ** i for i in range(20)], 12),
        ],
    ),
    "odd_asphere": (
        odd_asphere,
        [
            ([25.0, -0.5, 0.0, 1e-4, 2e-5, -3e-7], 9),
            ([-30.0, 0.3, 0.002, 1e-4, -2e-5, 1e-6, -2e-8], 8),
            ([inf, 0.0, 0.1], 8),  # an axicon
            ([15.0, -1.0, 0.0, 0.0, 3e-4, -2e-5, 1e-6, -1e-8, 2e-10], 7),
        ],
    ),
    "toroid": (
        toroid,
        [
            ([40.0, 0.0, 55.0], 12),
            ([-30.0, -0.7, 45.0, 1e-4, -2e-6, 1e-9], 10),
            ([12.0, 0.5, -20.0, 0.0, 1e-5], 7),
            ([25.0, -1.0, inf, 0.0, -1e-6], 9),
        ],
    ),
    "biconic": (
        biconic,
        [([50.0, 60.0, -0.5, 0.0], 15), ([-20.0, 35.0, 0.4, -2.0], 10), ([9.0, 11.0, -0.9, 0.2], 6), ([inf, -15.0, 0.0, -1.0], 8)],
    ),
    "cylinder": (cylinder, [([30.0, 1], 12), ([-12.0, 0], 8), ([7.0, 0], 5)]),
    "zernike": (
        zernike,
        [
            ([60.0, 0.0, 12.0, 0, 0.0, 1e-3, -2e-3, 3e-2, 1e-2, -2e-2, 5e-3, 4e-3, -3e-3, 2e-3, 1e-3, -1e-3, 2e-3, 1e-3, -5e-4], 11),
            ([-80.0, -0.4, 10.0, 1, 0.0, 2e-3, 1e-3, 5e-2, -3e-2, 2e-2, 1e-2, -8e-3, 6e-3, 5e-3, -4e-3, 3e-3, 2e-3, -1e-3, 1e-3, 2e-3], 9),
            ([inf, 0.0, 5.0, 1, 0.0, 0.0, 0.0, 0.4, 0.05, 0.0, 0.03], 4.5),
        ],
    ),
}


def crossing(sag, p, start, d):
    """Returns the distance along the ray to the intersection nearest to the vertex plane."""
    origin = -start[2] / d[2]

    def height(t):
        return start[2] + t * d[2] - sag(p, start[0] + t * d[0], start[1] + t * d[1])

    def real(value):
        return value if mp.im(value) == 0 else None

    step = mpf("0.02")
    low = high = origin
    f_low = f_high = real(height(origin))
    for _ in range(2000):
        for side in (1, -1):
            at = high + step if side > 0 else low - step
            f = real(height(at))
            was = f_high if side > 0 else f_low
            if f is not None and was is not None and f * was <= 0:
                a, b = (high, at) if side > 0 else (at, low)
                return mp.findroot(height, (a, b), solver="anderson", tol=mpf(10) ** -70, maxsteps=200)
            if side > 0:
                high, f_high = at, f
            else:
                low, f_low = at, f
    return None


def refract(d, normal, ratio):
    """Refracts a direction by Snell's law for the angle. Returns None at total reflection."""
    length = sqrt(sum(v * v for v in normal))
    normal = [v / length for v in normal]
    along = sum(a * b for a, b in zip(d, normal))
    if along < 0:
        normal, along = [-v for v in normal], -along
    across = [a - along * b for a, b in zip(d, normal)]
    sine = sqrt(sum(v * v for v in across))
    if ratio * sine >= 1:
        return None
    after = asin(ratio * sine)
    unit = [v / sine for v in across] if sine != 0 else across
    return [cos(after) * b + sin(after) * a for a, b in zip(unit, normal)]


def rays(sag, p, largest, numbers):
    """Yields the rows of one set: half in each direction of travel, and in each direction from air into glass and back."""
    for i in range(RAYS):
        sense = 1 if i % 2 == 0 else -1
        before, after = (1.0, INDEX) if i % 4 < 2 else (INDEX, 1.0)
        while True:
            angle, radius = numbers.uniform(0, 6.28), largest * numbers.uniform(0, 1) ** 0.5
            target = [float(radius * cos(angle)), float(radius * sin(angle))]
            slope = [numbers.uniform(-0.35, 0.35), numbers.uniform(-0.35, 0.35)]
            away = numbers.uniform(3, 40) * sense
            start = [target[0] - slope[0] * away, target[1] - slope[1] * away, -away]
            size = (1 + slope[0] ** 2 + slope[1] ** 2) ** 0.5
            direction = [slope[0] / size * sense, slope[1] / size * sense, sense / size]
            exact = [mpf(v) for v in direction]
            norm = sqrt(sum(v * v for v in exact))
            d = [v / norm for v in exact]
            t = crossing(sag, p, [mpf(v) for v in start], d)
            if t is None:
                continue
            q = [mpf(v) + t * w for v, w in zip(start, d)]
            normal = [-diff(lambda x: sag(p, x, q[1]), q[0]), -diff(lambda y: sag(p, q[0], y), q[1]), mpf(1)]
            # Keeps only rays that hit the surface from the correct side and not at grazing incidence.
            if sense * sum(a * b for a, b in zip(d, normal)) < 0.1:
                continue
            bent = refract(d, normal, mpf(before) / mpf(after))
            if bent is not None:
                break
        row = [*start, *direction]
        yield ",".join([f"{sense},{before!r},{after!r}", *map(repr, row), *(mp.nstr(v, 20) for v in (*q, *bent))])


def main():
    OUTPUT.mkdir(parents=True, exist_ok=True)
    for kind, (sag, sets) in KINDS.items():
        numbers = random.Random(kind)
        lines = ["# Written by xtask/reference_surfaces.py (mpmath, 40 digits); lengths in mm."]
        lines += [f"# set {i}: " + ",".join("inf" if v == inf else repr(float(v)) for v in p) for i, (p, _) in enumerate(sets)]
        lines.append("set,travel,n_before,n_after,x,y,z,l,m,n,point_x,point_y,point_z,after_l,after_m,after_n")
        for i, (p, largest) in enumerate(sets):
            lines += [f"{i},{row}" for row in rays(sag, p, largest, numbers)]
        (OUTPUT / f"{kind}.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
        print(kind, len(lines) - len(sets) - 2, "rays")


if __name__ == "__main__":
    main()
