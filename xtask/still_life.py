#!/usr/bin/env python3
"""Draws a still life by a window, for the page of films: light and shade, bright and dull things, a gray card.

    VENV/bin/python xtask/still_life.py FILE.exr [WIDTH]

Needs numpy. The picture is ray traced: the window is an area light of four panes, walls and table reflect diffusely, brass and glaze are
specular. R, G, B, linear, Rec. 709, in units in which white paper in the window's light is about 1. The seed is fixed, so the picture is
always the same.
"""

import pathlib
import sys

import numpy as np

import half_exr

FAR = 1e9
# The window in the left wall: center, half height, half width (along z), and light of the panes relative to white paper.
WINDOW, HALF_UP, HALF_ALONG, PANES = np.array([-1.1, 0.62, 0.42]), 0.36, 0.4, 14.0
SKY = np.array([0.93, 0.99, 1.08])
EYE, AIM, LENS = np.array([0.08, 0.33, 1.45]), np.array([0.03, 0.105, 0.0]), 3.7  # LENS: focal length over half the frame's width

# Spheroids: name, center, semi-axes.
ROUND = [
    ("orange", (-0.155, 0.042, 0.165), (0.042, 0.042, 0.042)),
    ("lemon", (-0.055, 0.031, 0.235), (0.043, 0.031, 0.031)),
    ("plum", (0.03, 0.025, 0.19), (0.026, 0.025, 0.026)),
    ("plum", (0.088, 0.025, 0.215), (0.025, 0.025, 0.025)),
    ("apple", (-0.085, 0.041, 0.09), (0.045, 0.041, 0.045)),
    ("brass", (0.17, 0.036, 0.17), (0.036, 0.036, 0.036)),
    ("jug", (0.045, 0.085, 0.0), (0.078, 0.085, 0.078)),
    ("flame", (-0.26, 0.243, 0.0), (0.0065, 0.019, 0.0065)),
]
# Upright cylinders: name, x and z, radius, lower and upper end.
UPRIGHT = [
    ("jug", (0.045, 0.0), 0.036, 0.15, 0.235),
    ("jug", (0.045, 0.0), 0.045, 0.228, 0.242),
    ("wax", (-0.26, 0.0), 0.021, 0.02, 0.215),
    ("brass", (-0.26, 0.0), 0.05, 0.0, 0.02),
]
# Boxes, rotated about the vertical: name, center, half sides, rotation in radians.
BOXES = [
    ("book", (0.20, 0.0175, 0.02), (0.105, 0.0175, 0.075), 0.22),
    ("slate", (0.19, 0.05, 0.02), (0.09, 0.015, 0.065), -0.12),
    ("card", (0.315, 0.06, 0.13), (0.045, 0.06, 0.001), 0.55),
]
COLORS = {
    "orange": (0.72, 0.24, 0.025), "lemon": (0.78, 0.56, 0.05), "plum": (0.055, 0.018, 0.045), "apple": (0.30, 0.36, 0.05),
    "brass": (0.82, 0.58, 0.22), "jug": (0.66, 0.67, 0.65), "wax": (0.78, 0.72, 0.58), "book": (0.30, 0.035, 0.03),
    "slate": (0.05, 0.085, 0.15), "card": (0.18, 0.18, 0.18), "flame": (0.0, 0.0, 0.0), "table": (0.24, 0.125, 0.06),
    "wall": (0.22, 0.25, 0.255), "side": (0.4, 0.38, 0.35),
}
GLOSS = {"orange": 0.03, "lemon": 0.03, "plum": 0.04, "apple": 0.045, "jug": 0.05, "wax": 0.01, "brass": 1.0, "table": 0.012, "slate": 0.02}
NAMES = list(COLORS)
BACK, FLOOR = -0.75, 0.0


def nearest(o, d):
    """Returns the distance, the name as a number, and the normal of the first hit of each ray."""
    n = len(o)
    t, what, normal = np.full(n, FAR), np.full(n, NAMES.index("wall")), np.zeros((n, 3))

    def take(at, name, of_normal):
        nearer = at < t
        if nearer.any():
            t[nearer] = at[nearer]
            what[nearer] = NAMES.index(name)
            normal[nearer] = of_normal(nearer, o[nearer] + d[nearer] * at[nearer, None])

    with np.errstate(divide="ignore", invalid="ignore"):
        for name, axis, place, sign in (("table", 1, FLOOR, 1), ("wall", 2, BACK, 1), ("side", 0, 1.5, -1), ("side", 0, -1.101, 1)):
            at = (place - o[:, axis]) / d[:, axis]
            up = np.eye(3)[axis] * sign
            take(np.where(at > 1e-5, at, FAR), name, lambda m, p, up=up: up)
        for name, center, axes in ROUND:
            c, s = np.array(center), np.array(axes)
            oo, dd = (o - c) / s, d / s
            a, b, e = (dd * dd).sum(1), (oo * dd).sum(1), (oo * oo).sum(1) - 1
            root = np.sqrt(b * b - a * e)
            at = np.where(-b - root > 1e-5 * a, (-b - root) / a, FAR)
            take(np.where(np.isnan(at), FAR, at), name, lambda m, p, c=c, s=s: (p - c) / (s * s))
        for name, (x, z), radius, low, high in UPRIGHT:
            ox, oz = o[:, 0] - x, o[:, 2] - z
            a, b, e = d[:, 0] ** 2 + d[:, 2] ** 2, ox * d[:, 0] + oz * d[:, 2], ox * ox + oz * oz - radius * radius
            at = (-b - np.sqrt(b * b - a * e)) / a
            y = o[:, 1] + at * d[:, 1]
            at = np.where((at > 1e-5) & (y > low) & (y < high), at, FAR)
            take(at, name, lambda m, p, x=x, z=z: np.stack([p[:, 0] - x, 0 * p[:, 0], p[:, 2] - z], 1))
            top = (high - o[:, 1]) / d[:, 1]
            inside = (ox + top * d[:, 0]) ** 2 + (oz + top * d[:, 2]) ** 2 < radius * radius
            take(np.where((top > 1e-5) & inside, top, FAR), name, lambda m, p: np.array([0.0, 1.0, 0.0]))
        for name, center, half, turn in BOXES:
            turned = np.array([[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]])
            oo, dd, h = (o - np.array(center)) @ turned.T, d @ turned.T, np.array(half)
            near, far = np.sort(np.stack([(-h - oo) / dd, (h - oo) / dd]), 0)
            enters = near.max(1)
            at = np.where((enters > 1e-5) & (enters < far.min(1)), enters, FAR)

            def side(m, p, near=near, dd=dd, turned=turned):
                axis = near[m].argmax(1)
                return (np.eye(3)[axis] * -np.sign(dd[m])) @ turned

            take(at, name, side)
    length = np.sqrt((normal * normal).sum(1, keepdims=True))
    return t, what, normal / np.where(length > 0, length, 1)


def blotches(x, y, chance, size):
    """Value noise: smooth random values, 0 to 1, on a lattice."""
    table = np.random.default_rng(chance).random((256, 256))
    x, y = x / size, y / size
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)
    u, v = x - i, y - j
    u, v = u * u * (3 - 2 * u), v * v * (3 - 2 * v)
    at = lambda a, b: table[b % 256, a % 256]
    return (at(i, j) * (1 - u) + at(i + 1, j) * u) * (1 - v) + (at(i, j + 1) * (1 - u) + at(i + 1, j + 1) * u) * v


def colors(what, p):
    """Returns reflectances with texture: grain of wood, pores, pages, the white rim of the card."""
    color = np.array([COLORS[n] for n in NAMES])[what]
    x, y, z = p.T
    wood = 0.55 + 0.5 * blotches(x * 0.12, z, 3, 0.004) * blotches(x * 0.2, z, 4, 0.02) + 0.35 * blotches(x, z, 5, 0.15)
    planks = np.where(np.abs((z + 0.03) % 0.14 - 0.07) > 0.0692, 0.35, 1.0)
    plaster = 0.86 + 0.2 * blotches(x, y, 6, 0.09) + 0.06 * blotches(x, y, 7, 0.01)
    pores = 0.9 + 0.2 * blotches(x + z, y, 8, 0.0022)
    stripes = np.where((y > 0.098) & (y < 0.104) | (y > 0.062) & (y < 0.066), 1.0, 0.0)[:, None]
    for name, by in (("table", wood * planks), ("wall", plaster), ("orange", pores), ("lemon", pores)):
        color = np.where((what == NAMES.index(name))[:, None], color * by[:, None], color)
    color = np.where((what == NAMES.index("jug"))[:, None], color * (1 - stripes) + stripes * np.array([0.05, 0.09, 0.22]), color)
    red = 0.5 + 0.5 * blotches(x * 3, y, 9, 0.03)[:, None]
    color = np.where((what == NAMES.index("apple"))[:, None], color * (1 - 0.75 * red) + 0.75 * red * np.array([0.42, 0.05, 0.03]), color)
    name, center, half, turn = BOXES[0]
    across, along = (x - center[0]) * np.cos(turn) + (z - center[2]) * np.sin(turn), -(x - center[0]) * np.sin(turn) + (z - center[2]) * np.cos(turn)
    pages = (what == NAMES.index("book")) & (np.abs(y - 0.0175) < 0.0135) & (along > 0.0745)
    leaves = (0.6 + 0.15 * np.sin(y * 6000))[:, None] * np.array([0.95, 0.88, 0.72])
    color = np.where(pages[:, None], leaves, color)
    name, center, half, turn = BOXES[2]
    across = ((x - center[0]) * np.cos(turn) + (z - center[2]) * np.sin(turn)) / half[0]
    up = (y - center[1]) / half[1]
    rim = (what == NAMES.index("card")) & ((np.abs(across) > 0.93) | (np.abs(up) > 0.95))
    return np.where(rim[:, None], 0.85, color)


def light_of(o, d):
    """Returns which rays hit the window or the flame, or leave the room, and their light."""
    with np.errstate(divide="ignore", invalid="ignore"):
        at = (WINDOW[0] - o[:, 0]) / d[:, 0]
        p = o + d * at[:, None]
    up, along = (p[:, 1] - WINDOW[1]) / HALF_UP, (p[:, 2] - WINDOW[2]) / HALF_ALONG
    is_pane = (at > 0) & (np.abs(up) < 1) & (np.abs(along) < 1) & (np.abs(up) > 0.05) & (np.abs(along) > 0.05)
    return is_pane, PANES * SKY * (0.75 + 0.25 * np.clip(up, -1, 1))[:, None]


def traced(o, d, chance, depth):
    """Returns the light along rays."""
    t, what, normal = nearest(o, d)
    p = o + d * t[:, None]
    is_pane, pane = light_of(o, d)
    is_flame = what == NAMES.index("flame")
    shows_pane = is_pane & (t > (WINDOW[0] - o[:, 0]) / np.where(d[:, 0] == 0, 1, d[:, 0]) - 1e-3) & (d[:, 0] < 0)
    albedo = colors(what, p)
    normal = np.where(((normal * d).sum(1) > 0)[:, None], -normal, normal)
    start = p + 1e-4 * normal
    # Direct light from a random point of the window.
    n = len(o)
    place = WINDOW + np.stack([np.zeros(n), (2 * chance.random(n) - 1) * HALF_UP, (2 * chance.random(n) - 1) * HALF_ALONG], 1)
    way = place - start
    far2 = (way * way).sum(1)
    way = way / np.sqrt(far2)[:, None]
    cosines = np.clip((way * normal).sum(1), 0, None) * np.clip(-way[:, 0], 0, None)
    is_seen, from_pane = light_of(start, way)
    blocked = nearest(start, way)[0] < np.sqrt(far2) - 2e-3
    direct = from_pane * (cosines / (np.pi * far2) * 4 * HALF_UP * HALF_ALONG * (is_seen & ~blocked))[:, None]
    # Direct light from the flame, a small lamp.
    way = np.array(ROUND[-1][1]) - start
    far2 = (way * way).sum(1)
    way = way / np.sqrt(far2)[:, None]
    open_ = nearest(start, way)[0] > np.sqrt(far2) - 0.02
    direct += np.array([1.0, 0.55, 0.2]) * (0.0022 * np.clip((way * normal).sum(1), 0, None) / far2 * open_)[:, None]
    # Light that the room reflects.
    around = np.full((n, 3), 0.03)
    if depth > 0:
        u, v = chance.random(n), 2 * np.pi * chance.random(n)
        side = np.where(np.abs(normal[:, :1]) > 0.9, np.array([0.0, 1, 0]), np.array([1.0, 0, 0]))
        a = np.cross(normal, side)
        a /= np.sqrt((a * a).sum(1, keepdims=True))
        b = np.cross(normal, a)
        way = np.sqrt(u)[:, None] * (a * np.cos(v)[:, None] + b * np.sin(v)[:, None]) + normal * np.sqrt(1 - u)[:, None]
        # Direct light from the window has already been counted.
        around = np.minimum(traced(start, way, chance, depth - 1) * ~light_of(start, way)[0][:, None], 2.0)
    light = albedo * (direct + around)
    gloss = np.array([GLOSS.get(name, 0.0) for name in NAMES])[what]
    if depth > 0 and (gloss > 0).any():
        m = gloss > 0
        cosine = -(d[m] * normal[m]).sum(1)
        mirrored = d[m] + 2 * cosine[:, None] * normal[m]
        is_metal = (what[m] == NAMES.index("brass"))[:, None]
        share = np.where(is_metal, albedo[m], (gloss[m] + (1 - gloss[m]) * 0.6 * (1 - cosine) ** 5)[:, None])
        seen = traced(start[m], mirrored, chance, 0)
        light[m] = np.where(is_metal, 0.0, light[m]) + share * seen
    light = np.where(is_flame[:, None], np.array([30.0, 17.0, 6.5]), light)
    return np.where(shows_pane[:, None], pane, light)


def drawn(width, samples=36):
    height = width * 2 // 3
    chance = np.random.default_rng(7)
    forward = (AIM - EYE) / np.linalg.norm(AIM - EYE)
    right = np.cross(forward, [0, 1, 0])
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    picture = np.zeros((height, width, 3))
    rows = max(1, 40_000 // width)
    for first in range(0, height, rows):
        y, x = np.mgrid[first:min(first + rows, height), 0:width].reshape(2, -1).astype(float)
        total = np.zeros((len(x), 3))
        for _ in range(samples):
            px = (x + chance.random(len(x)) - width / 2) / (width / 2)
            py = (height / 2 - y - chance.random(len(x))) / (width / 2)
            way = LENS * forward + px[:, None] * right + py[:, None] * up
            way /= np.sqrt((way * way).sum(1, keepdims=True))
            total += traced(np.broadcast_to(EYE, way.shape), way, chance, 1)
        picture[first:first + rows] = (total / samples).reshape(-1, width, 3)
    return picture


def write(path, width=600):
    picture = drawn(width)
    rows = [[(b, g, r) for r, g, b in row] for row in picture.astype(np.float16).tolist()]
    half_exr.write(pathlib.Path(path), "a still life by a window, by xtask/still_life.py", "BGR", rows)
    return picture


if __name__ == "__main__":
    write(sys.argv[1], *(int(v) for v in sys.argv[2:]))
