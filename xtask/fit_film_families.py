#!/usr/bin/env python3
"""Fits the influence of color film layers on each other, for all films at once, and writes xtask/film_families.json.

Run from the root of the repository, after xtask/fit_film_library.py, with the unpacked wheel that import_film.py names, numpy and scipy:

    VENV/bin/python xtask/fit_film_families.py WHEEL

What is fitted: six inhibitions for each family of film_families.py, and a strength for each class in it.
Targets for each film, printed or projected as usual, in the light that it is made for:
  the hues that the eye sees of the 18 chromatic patches of the ColorChecker. Those of sky, leaf, skins and the two oranges (wood, brick
  and hair in photographs) count COUNT times. Beyond WITHIN degrees (6 more for oranges) they count additionally: twice as much for the
  films that people compare most (COMPARED), and eight times for 5207, whose limit is 3 degrees less;
  the mean saturation that film_families.py states for the class;
  every number as near to 0 as these targets allow.
"""

import copy
import json
import pathlib
import sys

import numpy as np
from scipy.optimize import least_squares

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import film_families as families  # noqa: E402
import film_library as library  # noqa: E402
import fit_film_color as model  # noqa: E402
import fit_film_library as grays  # noqa: E402
import import_film as base  # noqa: E402

PLACES = ((0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1))
FAMILIAR = ("dark-skin", "light-skin", "blue-sky", "foliage", "orange", "orange-yellow")
COMPARED = ("fuji-velvia-50", "kodak-ektar-100", "kodak-ektachrome-100d", "kodak-gold-200", "kodak-vision3-250d-5207", "kodak-portra-400",
            "fuji-pro-400h", "kodachrome-64")
# Weights: of a hue difference of DEGREES, of familiar colors (count), of a degree beyond WITHIN, of saturation, of a number's size.
DEGREES, TURNED, COUNT, WITHIN, BEYOND, SATURATED, SPREAD = 8, 0.7, 2, 9, 1, 120, 1
# Classes with strength 1.
UNIT = ("portrait", "Kodachrome")


def uv(xyz):
    """Returns the CIE 1976 coordinates u', v'."""
    return np.array([4 * xyz[0], 9 * xyz[1]]) / (xyz[0] + 15 * xyz[1] + 3 * xyz[2])


def relative(lab):
    """Returns XYZ of a CIELAB color, relative to white."""
    fy = (lab[0] + 16) / 116
    f = np.array([fy + lab[1] / 500, fy, fy - lab[2] / 200])
    return np.where(f > 6 / 29, f**3, 3 * (6 / 29) ** 2 * (f - 4 / 29))


def saturation(lab, white):
    return 13 * np.hypot(*(uv(relative(lab) * white) - uv(white)))


def turn(lab, eye):
    degrees = np.degrees(np.arctan2(lab[2], lab[1]) - np.arctan2(eye[2], eye[1]))
    return (degrees + 180) % 360 - 180


def moved(film, data, kind):
    """Returns the film with the shifts of the sensitivities that import_film.py applies."""
    nm = base.MOVED[kind]
    table = [[(x + nm[base.LAYERS[i]], y) for x, y in base.pairs(data.log_sensitivity[i])] for i in grays.ORDER]
    film.sees = np.array([film.sensitivity(t) for t in table])
    film.per_lux = (model.V * film.reference).sum() / (film.sees * film.reference).sum(1)
    return film


def films(folder, lights):
    """Returns all color films for cameras, each with its print or projection."""
    numbers = json.loads(library.NUMBERS.read_text(encoding="utf-8"))
    paper = grays.Print(grays.Film(library.prepared(folder, "print", library.ENDURA), "status-a", None, None, True, None), True)
    paper.take_apart(grays.mended(paper.film, "paper", numbers[library.ENDURA]))
    prints = {library.ENDURA: paper, library.CINE: grays.fitted_2383(folder)}

    def printed(film, on):
        m = grays.Negative(film, copy.copy(prints[on]))
        m.onto.balance(film, m.gray)
        return m

    out = {}
    for slug, row in library.NEGATIVES.items():
        data = library.prepared(folder, "negative", slug)
        film = grays.Film(data, "status-m", row[6], base.pairs(data.d_min_sd), True, lights[row[7]])
        film.take_apart(grays.mended(film, "negative", {k: numbers[slug][k] or [0, 0, 0] for k in ("blue", "red")}))
        out[slug] = printed(film, row[8])
    data = base.load(folder, "negative_film.kodak_5207", "KODAK_5207")
    out["kodak-vision3-250d-5207"] = printed(
        moved(grays.fitted_5207(folder, lights[library.DAYLIGHT]), data, "negative"), library.CINE)
    for slug, row in library.SLIDES.items():
        film = grays.Film(library.prepared(folder, "slide", slug), "status-a", row[6], None, False, lights[library.DAYLIGHT])
        out[slug] = grays.Slide(film)
        out[slug].set(np.array([*numbers[slug]["blue"], *numbers[slug]["red"]]))
    data = base.load(folder, "reversal_film.kodak_ektachrome_100d", "KODAK_EKTACHROME_100D")
    film = moved(grays.Film(data, "status-a", 100, None, False, lights[library.DAYLIGHT]), data, "reversal")
    layers = [base.LAYERS[i] for i in grays.ORDER]
    film.take_apart([model.Curve(base.mended("reversal", layer, p, None)[0]) for layer, p in zip(layers, film.points)])
    out["kodak-ektachrome-100d"] = slide = grays.Slide(film)
    slide.eye = grays.Eye(film.passes(np.zeros(3)), False)
    return out


class Colors:
    """A film and how it reproduces the patches."""

    def __init__(self, slug, m, patches, white):
        self.slug, self.m, self.patches, self.white = slug, m, patches, white
        self.exposures = [m.film.exposures(None, reflectance) for reflectance, _ in patches.values()]
        self.wanted = families.CLASSES[families.class_of(slug)][0]
        self.eye = [saturation(eye, white) for _, eye in patches.values()]

    def labs(self, numbers):
        k = np.zeros((3, 3))
        for value, place in zip(numbers, PLACES):
            k[place] = value
        # The dye of a slide forms where the first developer left silver halide, so the sign changes.
        k = k if self.m.kind == "negative" else -k
        return [self.m.seen(self.m.film.developed(x, k)) for x in self.exposures]

    def saturation(self, labs):
        return np.mean([saturation(lab, self.white) / eye for lab, eye in zip(labs, self.eye)])

    def turns(self, labs):
        return {name: turn(lab, eye) for (name, (_, eye)), lab in zip(self.patches.items(), labs)}

    def residuals(self, numbers):
        labs = self.labs(numbers)
        out = []
        for (name, (_, eye)), lab in zip(self.patches.items(), labs):
            u, d = eye[1:] / np.hypot(*eye[1:]), lab[1:]
            sine = np.degrees((d[1] * u[0] - d[0] * u[1]) / max(np.hypot(*d), 1e-3))
            out.append(TURNED * (COUNT if name in FAMILIAR else 1) * sine / DEGREES)
            if name in FAMILIAR:
                within = WITHIN + 6 if name.startswith("orange") else WITHIN
                over = max(abs(turn(lab, eye)) - (within - 3 if "5207" in self.slug else within), 0)
                out.append(BEYOND * (8 if "5207" in self.slug else 2 if self.slug in COMPARED else 1) * np.sign(sine) * over)
        out.append(SATURATED * (self.saturation(labs) - self.wanted))
        return np.array(out)


def main():
    folder = pathlib.Path(sys.argv[1])
    base.prepare(folder)
    lights = grays.lights()
    eye = (model.CMF * model.D55).sum(1)
    checker = list(model.table("reflectances/colorchecker.csv").items())[:18]
    patches = {n: (r, model.cielab((model.CMF * model.D55 * r).sum(1) / eye)) for n, r in checker}
    all_films = [Colors(slug, m, patches, eye / eye[1]) for slug, m in films(folder, lights).items()]
    names, free = list(families.FAMILIES), [c for c in families.CLASSES if c not in UNIT]
    count = len(PLACES) * len(names)

    def parts(p):
        matrices = {name: p[6 * i : 6 * i + 6] for i, name in enumerate(names)}
        return matrices, dict.fromkeys(UNIT, 1.0) | dict(zip(free, p[count:]))

    def residuals(p):
        matrices, strengths = parts(p)
        of = [c.residuals(matrices[families.family_of(c.slug)] * strengths[families.class_of(c.slug)]) for c in all_films]
        return np.concatenate([*of, p[:count] / SPREAD])

    def slopes(p):
        matrices, strengths = parts(p)
        rows = []
        for c in all_films:
            family, name = families.family_of(c.slug), families.class_of(c.slug)
            numbers, strength = matrices[family], strengths[name]
            here = c.residuals(numbers * strength)
            by = np.array([(c.residuals(numbers * strength + 1e-3 * e) - here) / 1e-3 for e in np.eye(6)]).T
            row, at = np.zeros((len(here), len(p))), 6 * names.index(family)
            row[:, at : at + 6] = by * strength
            if name in free:
                row[:, count + free.index(name)] = by @ numbers
            rows.append(row)
        prior = np.zeros((count, len(p)))
        prior[:, :count] = np.eye(count) / SPREAD
        return np.vstack([*rows, prior])

    start = np.concatenate([np.full(count, 0.12), np.ones(len(free))])
    low, high = np.zeros(len(start)), np.concatenate([np.full(count, 1.5), np.full(len(free), 4.0)])
    low[count:] = 0.2
    found = least_squares(residuals, start, jac=slopes, bounds=(low, high), max_nfev=60, x_scale=np.where(high > 2, 1.0, 0.2))
    matrices, strengths = parts(found.x)
    whole = {}
    for name, numbers in matrices.items():
        whole[name] = [[0.0] * 3 for _ in range(3)]
        for value, (i, j) in zip(numbers, PLACES):
            whole[name][i][j] = round(float(value), 3)
    numbers = {"matrices": whole, "strengths": {name: round(float(s), 3) for name, s in strengths.items()}}
    text = ",\n".join(
        f'  "{part}": {{\n' + ",\n".join(f"    {json.dumps(k)}: {json.dumps(v)}" for k, v in values.items()) + "\n  }"
        for part, values in numbers.items())
    families.NUMBERS.write_text("{\n" + text + "\n}\n", encoding="utf-8")
    for c in all_films:
        matrix = families.inhibition(c.slug)
        labs = c.labs([matrix[i][j] for i, j in PLACES])
        turns = c.turns(labs)
        worst = max(turns, key=lambda n: abs(turns[n]))
        said = ", ".join(f"{n} {turns[n]:+.0f}" for n in (*FAMILIAR, worst))
        print(f"{c.slug}: {families.class_of(c.slug)}, saturation {c.saturation(labs):.3f}, dark skin L* {labs[0][0]:.0f}, hue {said}")


if __name__ == "__main__":
    main()
