"""Writes scenes/depth-still-life.exr: a small synthetic picture with depth, by ray casting from a pinhole.

A checkered table runs from 0.6 m to 3.5 m. A red cone stands at 0.95 m on the left, a gray ball at 2 m in the middle and a green post
at 3 m on the right. Behind them, at 12 m, is a dark wall with small lamps. The color of a pixel is the mean of nine samples; its depth
is that of the sample in the middle, as in other renderers. The file holds R, G, B (linear, Rec. 709) and Z (m, along the axis) as
16-bit floats, the colors rounded to 8 significant bits, ZIP compressed, as OpenEXR's "File Layout" describes. The script needs only
Python 3 and takes some minutes.

    python3 xtask/depth_still_life.py
"""

import math
import pathlib
import random

import half_exr
from noise_scenes import eight_bits

WIDTH, HEIGHT = 1440, 960
SAMPLES = 3  # samples of a pixel across, and as many down
PLANE, ACROSS = 2.0, 1.7  # m: the picture is this wide on a plane at this distance
TABLE = -0.32  # m below the eye
LIGHT = (0.45, 0.75, 0.48)  # toward the light; +z toward the camera


def unit(v):
    n = math.sqrt(sum(c * c for c in v))
    return tuple(c / n for c in v)


LIGHT = unit(LIGHT)


def lit(color, normal):
    shade = 0.25 + 0.75 * max(0.0, sum(a * b for a, b in zip(normal, LIGHT)))
    return tuple(c * shade for c in color)


def lamps():
    numbers = random.Random(5)
    tints = [(1.0, 0.75, 0.45), (1.0, 0.9, 0.8), (0.55, 0.75, 1.0), (1.0, 0.35, 0.25), (0.5, 1.0, 0.6)]
    for _ in range(46):
        x, y = numbers.uniform(-4.6, 4.6), numbers.uniform(-0.4, 3.0)
        power = numbers.choice([6.0, 12.0, 25.0])
        yield x, y, tuple(power * c for c in numbers.choice(tints))


LAMPS = list(lamps())


def cone(d):
    """Intersects a ray with an upright cone: radius 0.11 m at the table, 0.42 m high, at (-0.22, -0.95)."""
    ax, az, high, radius = -0.22, -0.95, 0.42, 0.11
    k = (radius / high) ** 2
    top = TABLE + high
    a = d[0] ** 2 + d[2] ** 2 - k * d[1] ** 2
    b = -d[0] * ax - d[2] * az + k * d[1] * top
    c = ax * ax + az * az - k * top * top
    under = b * b - a * c
    if under < 0:
        return None
    for t in sorted(((-b - math.sqrt(under)) / a, (-b + math.sqrt(under)) / a)):
        y = t * d[1]
        if t > 0 and TABLE <= y <= top:
            n = unit((t * d[0] - ax, k * (top - y), t * d[2] - az))
            return t, lit((0.75, 0.08, 0.05), n)
    return None


def ball(d):
    center, radius = (0.05, TABLE + 0.2, -2.0), 0.2
    b = sum(p * q for p, q in zip(d, center))
    a = sum(p * p for p in d)
    under = b * b - a * (sum(p * p for p in center) - radius * radius)
    if under < 0:
        return None
    t = (b - math.sqrt(under)) / a
    n = unit(tuple(t * p - q for p, q in zip(d, center)))
    band = math.floor(12 * math.atan2(n[0], n[2]) / math.pi) + math.floor(8 * math.asin(max(-1, min(1, n[1]))) / math.pi)
    return t, lit((0.6, 0.6, 0.6) if band % 2 else (0.16, 0.18, 0.22), n)


def post(d):
    ax, az, radius, top = 0.62, -3.0, 0.09, 0.62
    a = d[0] ** 2 + d[2] ** 2
    b = d[0] * ax + d[2] * az
    under = b * b - a * (ax * ax + az * az - radius * radius)
    if under < 0:
        return None
    t = (b - math.sqrt(under)) / a
    y = t * d[1]
    if not TABLE <= y <= top:
        return None
    stripe = math.floor((y - TABLE) / 0.12) % 2
    return t, lit((0.08, 0.4, 0.12) if stripe else (0.7, 0.7, 0.55), unit((t * d[0] - ax, 0, t * d[2] - az)))


def table(d):
    if d[1] >= 0:
        return None
    t = TABLE / d[1]
    if t > 3.5:
        return None
    square = (math.floor(t * d[0] / 0.12) + math.floor(t / 0.12)) % 2
    return t, lit((0.42, 0.3, 0.2) if square else (0.13, 0.09, 0.06), (0, 1, 0))


def wall(d):
    t = 12.0
    x, y = t * d[0], t * d[1]
    color = (0.01, 0.013, 0.02)
    for lx, ly, lamp in LAMPS:
        if (x - lx) ** 2 + (y - ly) ** 2 < 0.028**2:
            color = lamp
    return t, color


def sample(column, row):
    """Returns the depth and the color at a point of the picture, given in pixels."""
    x = (column / WIDTH - 0.5) * ACROSS / PLANE
    y = (0.5 * HEIGHT - row) / WIDTH * ACROSS / PLANE
    d = (x, y, -1.0)  # with -1 along the axis, the ray parameter t is the depth
    near = [hit for hit in (cone(d), ball(d), post(d), table(d)) if hit]
    return min(near, key=lambda hit: hit[0]) if near else wall(d)


def pixel(column, row):
    steps = [(k + 0.5) / SAMPLES for k in range(SAMPLES)]
    all_of_it = [sample(column + across, row + down) for down in steps for across in steps]
    red, green, blue = (eight_bits(sum(color[k] for _, color in all_of_it) / len(all_of_it)) for k in range(3))
    return (blue, green, red, all_of_it[len(all_of_it) // 2][0])


def main():
    rows = [[pixel(c, r) for c in range(WIDTH)] for r in range(HEIGHT)]
    out = pathlib.Path(__file__).resolve().parent.parent / "scenes" / "depth-still-life.exr"
    half_exr.write(out, "Synthetic, by xtask/depth_still_life.py; CC0-1.0", "BGRZ", rows)


if __name__ == "__main__":
    main()
