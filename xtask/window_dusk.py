"""Writes scenes/window-dusk.exr: a dim room with a vase in front and a window behind it, by ray casting from a pinhole.

A vase stands at 0.7 m on a table that reaches to 1.6 m. Behind it, at 5 m, is a wall with a lit picture at the right and a window of six
panes, through which the evening sky shines at three times white. The color of a pixel is the mean of nine samples; its depth is that of
the sample in the middle, as in other renderers. R, G, B (linear, Rec. 709) and Z (m, along the axis) as 16-bit floats, ZIP compressed, as
OpenEXR's "File Layout" describes. Needs only Python 3.

    python3 xtask/window_dusk.py
"""

import math
import pathlib

import half_exr

WIDTH, HEIGHT = 960, 640
SAMPLES = 3  # samples of a pixel across, and as many down
PLANE, ACROSS = 1.0, 0.84  # m: the picture is this wide on a plane at this distance
WALL, TABLE_END, TABLE = 5.0, 1.6, -0.14  # m
VASE, VASE_Z = -0.07, 0.7  # position of its axis, m
# Radius of the vase by height above the table, m.
OUTLINE = [(0.0, 0.026), (0.01, 0.03), (0.05, 0.048), (0.09, 0.05), (0.13, 0.034), (0.17, 0.016), (0.21, 0.014), (0.235, 0.02)]


def radius(height):
    """Returns the radius of the vase, m, and its slope at a height, or `None` above and below it."""
    for (low, a), (high, b) in zip(OUTLINE, OUTLINE[1:]):
        if low <= height <= high:
            t = (height - low) / (high - low)
            smooth = t * t * (3 - 2 * t)
            return a + (b - a) * smooth, (b - a) / (high - low) * 6 * t * (1 - t)
    return None


def sky(up):
    """Returns the color of the evening sky by height in the window, 0 to 1: about three times white."""
    low, high = (3.7, 2.7, 1.9), (1.9, 2.6, 3.9)
    return tuple(a + (b - a) * up for a, b in zip(low, high))


def wall(x, y):
    left, right, low, high, bar = -1.05, 0.55, -0.25, 1.1, 0.035
    if left <= x <= right and low <= y <= high:
        u, v = (x - left) / (right - left) * 3 % 1, (y - low) / (high - low) * 2 % 1
        across, up = (right - left) / 3, (high - low) / 2
        is_glass = bar < u * across < across - bar and bar < v * up < up - bar
        return sky((y - low) / (high - low)) if is_glass else (0.11, 0.1, 0.09)
    if 1.05 <= x <= 1.5 and 0.0 <= y <= 0.6:
        return (0.5, 0.3, 0.12) if 1.1 <= x <= 1.45 and 0.05 <= y <= 0.55 else (0.03, 0.02, 0.015)
    glow = 0.035 + 0.05 / (1 + (x + 0.25) ** 2 + (y - 0.4) ** 2)
    return (glow, 0.86 * glow, 0.74 * glow)


def vase(x, y):
    """Returns color and depth of the vase along a ray through (x, y, 1), or `None` if the ray misses it."""
    if abs(x * VASE_Z - VASE) > 0.056 or not TABLE - 0.02 < y * VASE_Z < TABLE + 0.26:
        return None

    def outside(depth):
        found = radius(y * depth - TABLE)
        return found is None or (x * depth - VASE) ** 2 + (depth - VASE_Z) ** 2 > found[0] ** 2

    steps = [VASE_Z - 0.056 + 0.002 * k for k in range(40)]
    far = next((depth for depth in steps if not outside(depth)), None)
    if far is None:
        return None
    near = far - 0.002
    for _ in range(10):
        middle = 0.5 * (near + far)
        near, far = (middle, far) if outside(middle) else (near, middle)
    size, slope = radius(y * far - TABLE)
    long = math.sqrt(1 + slope * slope)
    nx, ny, nz = (x * far - VASE) / size / long, -slope / long, (far - VASE_Z) / size / long
    # Shading: a soft lamp at the front left, its reflection in the glaze, and the window as rim light.
    lamp = max(0.0, -0.72 * nx + 0.35 * ny - 0.6 * nz)
    gloss = max(0.0, -0.45 * nx + 0.2 * ny - 0.87 * nz) ** 60
    rim = max(0.0, 0.5 * nz + 0.62) ** 4
    glaze = (0.1, 0.2, 0.26)
    return tuple(g * (0.06 + 0.55 * lamp) + 0.35 * gloss + 0.4 * rim * s for g, s in zip(glaze, (0.8, 1.0, 1.2))), far


def table(x, y):
    """Returns color and depth of the table along a ray through (x, y, 1), or `None` above and beyond it."""
    if y >= 0:
        return None
    depth = TABLE / y
    if depth > TABLE_END:
        return None
    x *= depth
    boards = 0.9 + 0.1 * math.sin(40 * x + 3 * math.sin(7 * depth))
    seam = 0.35 if (x + 0.03) % 0.14 < 0.003 else 1.0
    shade = 1 - 0.7 * math.exp(-((x - VASE) ** 2 / 0.004 + (depth - VASE_Z + 0.03) ** 2 / 0.006))
    light = boards * seam * shade * (0.05 + 0.1 * (depth / TABLE_END) ** 2)
    return (1.15 * light, 0.8 * light, 0.55 * light), depth


def sample(column, row):
    """Returns color and depth at a point of the picture, given in pixels."""
    x = (column / WIDTH - 0.5) * ACROSS / PLANE
    y = (0.5 - row / HEIGHT) * ACROSS * HEIGHT / WIDTH / PLANE
    return vase(x, y) or table(x, y) or (wall(x * WALL, y * WALL), WALL)


def pixel(column, row):
    steps = [(k + 0.5) / SAMPLES for k in range(SAMPLES)]
    all_of_it = [sample(column + across, row + down) for down in steps for across in steps]
    red, green, blue = (sum(color[k] for color, _ in all_of_it) / len(all_of_it) for k in range(3))
    return (blue, green, red, all_of_it[len(all_of_it) // 2][1])


def main():
    path = pathlib.Path(__file__).resolve().parent.parent / "scenes/window-dusk.exr"
    rows = [[pixel(column, row) for column in range(WIDTH)] for row in range(HEIGHT)]
    half_exr.write(path, "xtask/window_dusk.py", "BGRZ", rows)


main()
