"""Writes the pictures of the scenes scenes/bench/noise-*.yaml, which measure how long a clean frame takes.

- noise-portrait.exr: head and shoulders at 1.5 m by ray casting from a pinhole, with a card of 18 % gray, and leaves and sky
  on a wall at 8 m. Channel Z is the depth in m.
- noise-lights.exr: the portrait at dusk, with 70 lamps on the wall, disks of 1 to 6 pixels and 30 to 150 times white.
- noise-street.exr: a street at night: road, houses with lit windows, lamps up to 400 and headlamps up to 3000 times white.

In the two pictures with depth, the color of a pixel is the mean of nine samples; its depth is that of the sample in the middle, as in
other renderers. The street has one sample per pixel. R, G, B (linear, Rec. 709) and Z as 16-bit floats with 8 significant bits, ZIP
compressed. The script needs only Python 3 and takes some minutes.

    python3 xtask/noise_scenes.py
"""

import math
import pathlib
import random

import half_exr

WIDTH, HEIGHT = 600, 400
SAMPLES = 3  # samples of a pixel across, and as many down
PLANE, ACROSS, WALL = 1.5, 0.52, 8.0  # m: the picture is ACROSS wide on the plane at PLANE
LIGHT = (-0.55, 0.62, 0.56)  # toward the key light; +z toward the camera


def unit(v):
    n = math.sqrt(sum(c * c for c in v))
    return tuple(c / n for c in v)


LIGHT = unit(LIGHT)


def scaled(color, by):
    return tuple(c * by for c in color)


def mixed(a, b, part):
    return tuple(x + (y - x) * part for x, y in zip(a, b))


def smooth(a, b, x):
    t = min(1.0, max(0.0, (x - a) / (b - a)))
    return t * t * (3 - 2 * t)


def lattice(seed, size=256):
    dice = random.Random(seed)
    return [[dice.random() for _ in range(size)] for _ in range(size)]


LATTICE = lattice(3)


def noise(x, y):
    """Value noise: random values on an integer lattice, smooth between them, 0 to 1."""
    i, j = math.floor(x), math.floor(y)
    u, v = smooth(0, 1, x - i), smooth(0, 1, y - j)
    a, b = LATTICE[j % 256], LATTICE[(j + 1) % 256]
    above = a[i % 256] + (a[(i + 1) % 256] - a[i % 256]) * u
    below = b[i % 256] + (b[(i + 1) % 256] - b[i % 256]) * u
    return above + (below - above) * v


def cloudy(x, y, octaves):
    total, weight = 0.0, 0.0
    for k in range(octaves):
        total += noise(x * 2**k + 17 * k, y * 2**k + 31 * k) / 2**k
        weight += 1 / 2**k
    return total / weight


def eight_bits(value):
    """Rounds a number to 8 significant bits, which compresses well and is finer than the eye sees."""
    if value == 0:
        return 0.0
    scale = 2.0 ** (7 - math.floor(math.log2(abs(value))))
    return round(value * scale) / scale


# Ellipsoids: name, center and semi-axes in m.
SKIN, HAIR, SHIRT = (0.56, 0.34, 0.25), (0.055, 0.035, 0.022), (0.16, 0.19, 0.24)
BODY = [
    ("head", (0.0, 0.035, -1.5), (0.072, 0.098, 0.09)),
    ("hair", (0.0, 0.062, -1.535), (0.088, 0.1, 0.098)),
    ("hair", (-0.058, 0.0, -1.535), (0.034, 0.1, 0.06)),
    ("hair", (0.058, 0.0, -1.535), (0.034, 0.1, 0.06)),
    ("nose", (0.0, 0.022, -1.416), (0.011, 0.022, 0.016)),
    ("neck", (0.0, -0.08, -1.52), (0.043, 0.07, 0.045)),
    ("shirt", (0.0, -0.24, -1.54), (0.205, 0.125, 0.1)),
]


def met(way, center, axes):
    """Returns the distance along the ray from the origin to an ellipsoid, and its unit normal there."""
    d = [w / a for w, a in zip(way, axes)]
    o = [-c / a for c, a in zip(center, axes)]
    a, b, c = sum(x * x for x in d), sum(x * y for x, y in zip(d, o)), sum(x * x for x in o) - 1
    under = b * b - a * c
    if under < 0:
        return None
    t = (-b - math.sqrt(under)) / a
    point = scaled(way, t)
    return t, unit([(p - k) / (s * s) for p, k, s in zip(point, center, axes)])


def lit(color, normal, gloss):
    key = max(0.0, sum(a * b for a, b in zip(normal, LIGHT)))
    fill = 0.5 + 0.5 * normal[1]
    half = unit((LIGHT[0], LIGHT[1], LIGHT[2] + 1))
    shine = gloss * max(0.0, sum(a * b for a, b in zip(normal, half))) ** 30
    return tuple(c * (0.1 + 0.12 * fill + 0.85 * key) + shine for c in color)


def face(x, y):
    """Returns the color of the skin at a point of the face, given in m from the middle of the picture."""
    color = SKIN
    for eye in (-0.03, 0.03):
        dx, dy = (x - eye) / 0.0125, (y - 0.052) / 0.0055
        if dx * dx + dy * dy < 1:
            near = math.hypot(x - eye, y - 0.052)
            return (0.02, 0.02, 0.02) if near < 0.0026 else (0.1, 0.13, 0.11) if near < 0.0054 else (0.62, 0.6, 0.58)
        lid = (y - 0.0615 + 14 * (x - eye) ** 2) / 0.0016
        color = mixed(color, (0.12, 0.06, 0.04), math.exp(-lid * lid) * (abs(x - eye) < 0.0145))
        brow = (y - 0.078 + 10 * (x - eye) ** 2) / 0.0032
        color = mixed(color, HAIR, 0.8 * math.exp(-brow * brow) * smooth(0.021, 0.016, abs(x - eye)))
        color = mixed(color, (0.6, 0.27, 0.21), 0.35 * math.exp(-((x - 1.3 * eye) ** 2 + (y - 0.01) ** 2) / 0.0004))
    dx, dy = x / 0.022, (y + 0.024 - 2.0 * x * x) / 0.0075
    lips = smooth(1.15, 0.85, math.hypot(dx, dy))
    color = mixed(color, (0.45, 0.15, 0.14), lips)
    between = (y + 0.0235 - 1.5 * x * x) / 0.0009
    color = mixed(color, (0.16, 0.05, 0.05), 0.8 * math.exp(-between * between) * (abs(x) < 0.021))
    return color


def subject(x, y):
    """Returns color and depth of the foreground where a ray through (x, y) on the plane meets it."""
    way = (x / PLANE, y / PLANE, -1.0)
    best = None
    for what, center, axes in BODY:
        found = met(way, center, axes)
        if found and (best is None or found[0] < best[1]):
            best = what, *found
    if abs(x - 0.175) < 0.045 and abs(y + 0.06) < 0.06 and (best is None or best[1] > 1.5):
        inside = abs(x - 0.175) < 0.042 and abs(y + 0.06) < 0.057
        return ((0.18, 0.18, 0.18) if inside else (0.85, 0.85, 0.85)), 1.5
    if best is None:
        return None
    what, t, normal = best
    if what == "hair":
        strand = 0.6 + 0.8 * noise(900 * x + 40 * y, 35 * y)
        return scaled(lit(HAIR, normal, 0.05), strand), t
    if what == "shirt":
        weave = 0.88 + 0.12 * math.sin(1400 * x) * math.sin(1400 * y)
        return scaled(lit(SHIRT, normal, 0.0), weave), t
    pore = 0.97 + 0.06 * noise(700 * x, 700 * y)
    return scaled(lit(face(x, y) if what == "head" else SKIN, normal, 0.05), pore), t


def garden(x, y):
    """Returns the color of leaves with the sky between them."""
    leaves = cloudy(26 * x + 5, 26 * y + 9, 4)
    depth = cloudy(9 * x + 40, 9 * y, 3)
    green = mixed((0.02, 0.035, 0.012), (0.16, 0.23, 0.06), smooth(0.35, 0.7, leaves))
    green = mixed(green, (0.27, 0.23, 0.07), 0.6 * smooth(0.5, 0.7, depth))
    sky = smooth(0.55, 0.66, cloudy(14 * x, 14 * y + 77, 4) + 0.9 * (y - 0.05))
    return mixed(green, (0.62, 0.75, 0.95), sky)


def sample(behind, column, row):
    """Returns color and depth at a point of the picture, given in pixels."""
    x, y = (column - 0.5 * WIDTH) / WIDTH * ACROSS, (0.5 * HEIGHT - row) / WIDTH * ACROSS
    return subject(x, y) or (behind(x, y, column, row), WALL)


def pixel(behind, column, row):
    steps = [(k + 0.5) / SAMPLES for k in range(SAMPLES)]
    all_of_it = [sample(behind, column + across, row + down) for down in steps for across in steps]
    color = [sum(color[k] for color, _ in all_of_it) / len(all_of_it) for k in range(3)]
    return (*map(eight_bits, color), all_of_it[len(all_of_it) // 2][1])


def portrait(behind):
    return [[pixel(behind, column, row) for column in range(WIDTH)] for row in range(HEIGHT)]


def lamps():
    dice = random.Random(12)
    tints = [(1, 0.82, 0.55), (1, 0.9, 0.75), (1, 0.55, 0.25), (0.6, 0.8, 1), (1, 1, 1), (0.65, 1, 0.75)]
    for _ in range(70):
        place = dice.uniform(8, WIDTH - 8), dice.uniform(8, HEIGHT - 8)
        power = 30 * 5 ** dice.random()
        yield *place, dice.uniform(1, 6), scaled(dice.choice(tints), power)


def lights():
    """Draws the garden at dusk with lamps in it. The rim of a lamp is as smooth as its pixels allow."""
    strung = list(lamps())

    def behind(x, y, column, row):
        color = scaled(garden(x, y), 0.25)
        for at, down, radius, light in strung:
            away = math.hypot(column - at, row - down)
            if away < radius + 0.5:
                color = mixed(color, light, min(1.0, radius + 0.5 - away))
        return color

    return behind


STREET = (720, 480)


def street():
    """Draws a street to its vanishing point: houses on both sides, lamps along it, cars in both directions, strings of lights across."""
    width, height = STREET
    dice = random.Random(5)
    middle, horizon = 0.46 * width, 0.52 * height
    disks = []  # column, row, radius, light
    for k in range(1, 9):
        for side in (-1, 1):
            far = 1.0 / (0.55 + 0.55 * k)
            high = horizon - 400 * far
            disks.append((middle + side * 330 * far, high, 7.5 * far, scaled((1, 0.62, 0.28), 400)))
    for far, at in ((0.42, -70), (0.2, -42)):
        for lamp in (-34, 34):
            disks.append((middle + (at * 2.1 + lamp) * far, horizon + 88 * far, 7 * far, scaled((1, 0.93, 0.82), 3000)))
    for far, at in ((0.36, 120), (0.16, 90)):
        for lamp in (-32, 32):
            disks.append((middle + (at * 1.4 + lamp) * far, horizon + 80 * far, 7 * far, scaled((1, 0.05, 0.02), 60)))
    for k in range(60):
        along = (k + 0.5) / 60
        hang = 130 - 70 * (2 * along - 1) ** 2
        tint = dice.choice([(1, 0.8, 0.5), (1, 0.3, 0.2), (0.3, 0.6, 1), (0.5, 1, 0.6)])
        disks.append((width * along, 0.03 * height + hang * 0.55, 1.1, scaled(tint, 5 * 12 ** dice.random())))
    glow = [(c, r, light) for c, r, radius, light in disks if radius > 2.0]
    windows = {}

    def wall(side, far, row):
        """Returns the color of a house front at a distance from the eye (1 at the near end), with its windows."""
        along, up = 1.0 / far, (horizon - row) / far
        column, floor = math.floor(along * 3.2), math.floor(up / 62)
        if (side, column, floor) not in windows:
            on = dice.random() < 0.38
            windows[side, column, floor] = scaled((1, 0.72, 0.4), 0.15 * 8 ** dice.random()) if on else None
        u, v = along * 3.2 - column, up / 62 - floor
        if up > 6 and 0.28 < u < 0.72 and 0.25 < v < 0.8:
            lit = windows[side, column, floor]
            bars = abs(u - 0.5) < 0.02 or abs(v - 0.55) < 0.02
            if lit and not bars:
                return lit
            return (0.012, 0.013, 0.016)
        brick = 0.75 + 0.5 * noise(along * 60, up * 0.5)
        return scaled((0.05, 0.032, 0.02), brick * (0.35 + far))

    def scene(column, row):
        dx, dy = column + 0.5 - middle, row + 0.5 - horizon
        side = 1 if dx > 0 else -1
        far_wall = max(abs(dx) / 360, 0.045)
        far_road = dy / 220
        if dy > 0 and far_road > far_wall * 0.55:
            far = max(far_road, 0.03)
            across = dx / far
            texture = 0.8 + 0.4 * cloudy(across * 0.05, 40 / far, 3)
            base = scaled((0.05, 0.042, 0.034), texture * (0.6 + 0.5 / (1 + 3 * far)))
            if abs(across) > 290:
                base = scaled(base, 1.5)
            elif abs(across) < 5 and (10 / far) % 2 < 1:
                base = scaled((0.32, 0.28, 0.22), texture)
            for c, r, light in glow:
                if r < horizon:
                    wet = math.exp(-(((column - c) / 9.0) ** 2)) / (1 + 0.02 * dy)
                    base = tuple(b + 0.0003 * l * wet for b, l in zip(base, light))
            return base
        top = horizon - far_wall * 430 * (1 + 0.25 * math.sin(3.1 / far_wall + side))
        if row > top:
            if 0.13 < far_wall < 0.19 and side > 0 and 60 < (horizon - row) / far_wall < 200:
                return scaled((1, 0.1, 0.35), 12) if (row // 3) % 2 else (0.02, 0.01, 0.015)
            return wall(side, far_wall, row)
        return (0.003, 0.004, 0.0065)

    rows = []
    for row in range(height):
        line = []
        for column in range(width):
            color = scene(column, row)
            for c, r, radius, light in disks:
                away = math.hypot(column + 0.5 - c, row + 0.5 - r)
                if away < radius + 0.5:
                    color = mixed(color, light, min(1.0, radius + 0.5 - away))
            line.append(tuple(map(eight_bits, color)))
        rows.append(line)
    return rows


def main():
    folder = pathlib.Path(__file__).resolve().parent.parent / "scenes"
    comment = "Synthetic, by xtask/noise_scenes.py; CC0-1.0"
    deep = {"noise-portrait": lambda x, y, *_: garden(x, y), "noise-lights": lights()}
    for name, behind in deep.items():
        rows = [[(b, g, r, z) for r, g, b, z in row] for row in portrait(behind)]
        half_exr.write(folder / f"{name}.exr", comment, "BGRZ", rows)
    rows = [[pixel[::-1] for pixel in row] for row in street()]
    half_exr.write(folder / "noise-street.exr", comment, "BGR", rows)


if __name__ == "__main__":
    main()
