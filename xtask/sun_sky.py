"""Writes scenes/sun-sky.exr: a clear sky in late afternoon over hills and a meadow, for suns at the edge of the frame.

The sky is bluest far from the sun and pale near the horizon and around the sun. The sun itself is not in the picture; its place is at the
right edge, 18.5 degrees across and 11 degrees up from the middle. Four ranges of hills grow paler with distance; there are thin clouds.
The picture has the field of a 50 mm lens on 36 x 24 mm. Every pixel is the mean of nine samples. R, G, B (linear, Rec. 709, 1 is white) as
16-bit floats with 8 significant bits, ZIP compressed. The script needs only Python 3 and takes some minutes.

    python3 xtask/sun_sky.py
"""

import functools
import math
import pathlib

import half_exr
from noise_scenes import eight_bits, mixed, noise, scaled, smooth

WIDTH, HEIGHT = 1080, 720
SAMPLES = 3  # samples of a pixel across, and as many down
# Tangent of the field per pixel, and tangents of the sun's direction.
PITCH = 36.0 / 50.0 / WIDTH
SUN = (0.335, 0.195)
HORIZON = -0.06


def cloudy(x, y):
    """Fractal noise of five octaves: 0 to 1."""
    return sum(noise(x * 2**k, y * 2**k) / 2 ** (k + 1) for k in range(5))


def sky(x, y):
    up = max(0.0, y - HORIZON)
    color = mixed((0.62, 0.72, 0.84), (0.16, 0.32, 0.66), smooth(0.0, 0.34, up))
    around = math.hypot(x - SUN[0], y - SUN[1])
    glow = 0.9 * math.exp(-around / 0.05) + 0.45 * math.exp(-around / 0.2)
    color = tuple(c + glow * g for c, g in zip(color, (1.0, 0.9, 0.74)))
    cover = smooth(0.5, 0.8, cloudy(3.1 * x / (0.25 + up), 9.0 / (0.25 + up))) * smooth(0.0, 0.08, up)
    return mixed(color, scaled((1.0, 0.98, 0.95), 0.95 + 0.5 * glow), 0.55 * cover)


@functools.lru_cache(4 * WIDTH)
def ridges(x):
    """Returns the heights of the ranges in a direction, from far to near."""
    found = []
    for k, (base, height, per) in enumerate([(-0.035, 0.05, 9), (-0.055, 0.05, 13), (-0.085, 0.045, 21), (-0.13, 0.03, 8)]):
        ridge = base + height * (cloudy(per * x + 31 * k, 7.3 * k) - 0.35)
        if k in (1, 2):
            # Trees.
            ridge += 0.006 * noise(420 * x, 5.0 + k)
        found.append(ridge)
    return found


def hills(x, y):
    """Returns the nearest range in a direction, 0 to 3 from far to near, or `None` for free sky."""
    return max((k for k, ridge in enumerate(ridges(x)) if y < ridge), default=None)


def color(x, y):
    near = hills(x, y)
    if near is None:
        return sky(x, y)
    haze = (0.5, 0.6, 0.72)
    grain = 0.7 + 0.6 * cloudy(60 * x, 90 * y)
    if near == 3:
        below = -0.1 - y
        grass = mixed((0.09, 0.13, 0.035), (0.16, 0.15, 0.05), cloudy(14 * x / (0.1 + below), 3.0 / (0.1 + below)))
        return scaled(grass, 0.75 + 0.5 * cloudy(90 * x / (0.1 + below), 40.0 / (0.1 + below)))
    woods = scaled((0.045, 0.065, 0.035), grain)
    return mixed(woods, haze, (0.62, 0.3, 0.1)[near])


def pixel(column, row):
    steps = [(k + 0.5) / SAMPLES for k in range(SAMPLES)]
    all_of_it = [
        color((column + across - WIDTH / 2) * PITCH, (HEIGHT / 2 - row - down) * PITCH) for down in steps for across in steps
    ]
    # Channels in alphabetical order.
    return tuple(eight_bits(sum(c[k] for c in all_of_it) / len(all_of_it)) for k in (2, 1, 0))


def main():
    rows = [[pixel(column, row) for column in range(WIDTH)] for row in range(HEIGHT)]
    path = pathlib.Path(__file__).parent.parent / "scenes/sun-sky.exr"
    half_exr.write(path, "a clear sky over hills, by xtask/sun_sky.py", "BGR", rows)


if __name__ == "__main__":
    main()
