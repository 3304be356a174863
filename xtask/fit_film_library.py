#!/usr/bin/env python3
"""Finds the few numbers by which xtask/film_library.py mends the color of its stocks, and writes xtask/film_library.json.

Run from the root of the repository, with the wheel that import_film.py names, and numpy:

    VENV/bin/python xtask/fit_film_library.py WHEEL [STOCK ...]

The model is that of xtask/fit_film_color.py. What is fitted, of each stock by itself:
  negative       six inhibitions, log10 of exposure a unit of dye; of blue and red against green
                 p (u + 1) + q (u^2 - 1) + r (u + 1) u (u - 1.2), density, u = decades from mid gray, -1 to 1.2
  slide          six inhibitions; of blue and red three times q (t exp(1 - t))^2, t = density over the minimum over 0.4, 1.0 and 2.2,
                 and a shift along log10 exposure
  paper, print   the same without a shift (paper: 0.3, 0.9 and 1.9; film: 0.3, 1.0 and 2.4): so that the negatives that are made
                 for it, as digitized, print gray on it; Vision3 250D where there are none
To what: hue and chroma of the 18 chromatic patches of the ColorChecker in the light that the film is made for, and a neutral
subject in its own light, as fit_film_color.py does; every number as near to 0 as that allows.
"""

import json
import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import film_library as library  # noqa: E402
import fit_film_color as model  # noqa: E402
import import_film as base  # noqa: E402

ORDER = (2, 1, 0)
HINGE, SPREAD, PAPER = 1.7, 0.01, 0.05
# Where a gray scale is gray within this, the curves stay as digitized.
NEUTRAL = 1.95
INHIBITION = 0.3


class Film(model.Film):
    """A color film as film_library.py writes it: sensitivities, dyes, base and curves, blue first."""

    def __init__(self, data, densities, iso, minimum, rising, reference):
        self.points = [base.monotone(library.points_of(data, i, iso), rising)[0] for i in ORDER]
        self.curves = [model.Curve(p) for p in self.points]
        self.status, self.iso = model.status(densities), iso
        self.dyes = np.array([self.read(base.pairs(data.spectral_density[i])) for i in ORDER])
        self.sees = np.array([self.sensitivity(base.pairs(data.log_sensitivity[i])) for i in ORDER])
        lows = [c.y.min() for c in self.curves]
        self.base = self.read(minimum) if minimum else np.interp(model.BAND, (440, 530, 620), lows)
        self.clear = -np.log10(self.status @ 10**-self.base)
        self.x = np.linspace(min(c.x[0] for c in self.curves) - 0.1, max(c.x[-1] for c in self.curves) + 0.1, 241)
        self.reference = reference
        if reference is not None:
            self.per_lux = (model.V * reference).sum() / (self.sees * reference).sum(1)
        # Of the dyes, only where the status products see.
        self.seen = self.status.max(0) > 1e-7

    def take_apart(self, curves):
        """Amounts of dye over log10 exposure, all at once."""
        wanted = self.clear[:, None] + np.array([c(self.x) - c(self.x).min() for c in curves])
        status, dyes, minimum = self.status[:, self.seen], self.dyes[:, self.seen], self.base[self.seen]
        amounts = np.maximum(wanted - self.clear[:, None], 0)
        for _ in range(60):
            passed = 10 ** -(minimum + amounts.T @ dyes)
            total = passed @ status.T
            slopes = np.einsum("kl,il,jl->kij", passed, status, dyes) / total[:, :, None]
            step = np.linalg.solve(slopes, (wanted.T + np.log10(total))[:, :, None])[:, :, 0]
            step *= np.minimum(1, 0.5 / np.maximum(np.abs(step).max(1), 1e-12))[:, None]
            amounts += step.T
            if np.abs(step).max() < 1e-9:
                self.amounts = amounts
                return
        raise ArithmeticError("no such amounts")

    def exposures(self, light, reflectance):
        del light
        return super().exposures(self.reference, reflectance)


class Eye(model.Seen):
    """What is seen of paper in a lit room, or of film in the dark."""

    def __init__(self, clear, paper):
        super().__init__(clear)
        self.paper = paper

    def lab(self, passes):
        if not self.paper:
            return super().lab(passes)
        veil = self.black / self.white[1]
        return model.cielab((self.weights @ passes / self.white - veil) / (1 - veil))

    def gray(self):
        """Luminance that is shown as mid gray."""
        share = 0.18 if self.paper else 0.18 ** (1 / model.SURROUND)
        return self.black + share * (self.white[1] - self.black)


class Print:
    """A print stock, and the light that prints a negative on it."""

    def __init__(self, film, paper, aim):
        self.film, self.paper, self.aim = film, paper, aim

    def take_apart(self, curves):
        self.film.take_apart(curves)
        self.eye = Eye(self.film.passes(np.zeros(3)), self.paper)

    def balance(self, negative, gray):
        film, eye, black = self.film, self.eye, 0.0
        third = np.digitize(model.BAND, (500, 590))
        lamp = model.blackbody(3200)
        parts = np.array([[np.where(third == p, s * lamp, 0) for p in range(3)] for s in film.sees])
        clear, unexposed = negative.passes(negative.neutral(gray)), negative.passes(negative.neutral(-9))
        for _ in range(4):
            eye.black = black
            shown = eye.gray()
            if self.aim:
                aim = film.passes(film.amounts_for(np.array(self.aim[::-1]), film.status, [1, 1, 1]))
                shown = (eye.weights @ aim)[1]
            amounts = film.amounts_for(-np.log10(eye.white / eye.white[1] * shown), eye.weights, [1, 1, 1])
            needed = 10 ** np.array([film.exposure_for(i, amounts[i]) for i in range(3)])
            lights = np.linalg.solve(parts @ clear, needed)
            self.weights = np.einsum("lpw,p->lw", parts, lights)
            black = (eye.weights @ self.printed(unexposed))[1]
            if self.aim:
                break
        eye.black = black

    def printed(self, passes):
        h = np.log10(self.weights @ passes)
        return self.film.passes(np.array([self.film.amount(i, h[i]) for i in range(3)]))

    def lab(self, passes):
        return self.eye.lab(self.printed(passes))


def mended(film, kind, numbers):
    """The film's curves, blue and red moved by `numbers`."""
    gray = np.log10(10 / film.iso) if film.iso else None
    out = list(film.curves)
    for i, layer in ((0, "blue"), (2, "red")):
        points, _, _ = library.moved(kind, numbers[layer], film.points[i], gray)
        out[i] = model.Curve(base.monotone(points, kind != "slide")[0])
    return out


class Negative:
    """A negative on a print stock that is done."""

    kind, hold = "negative", False

    def __init__(self, film, onto):
        self.film, self.onto, self.gray = film, onto, np.log10(10 / film.iso)
        self.start = np.array([0.1] * 6 + [0.0] * 6)

    def numbers(self, p):
        return {"inhibition": np.abs(model.inhibition(p)).round(2).tolist(), "blue": p[6:9].round(4).tolist(),
                "red": p[9:12].round(4).tolist()} | ({"blue": [], "red": []} if self.hold else {})

    def set(self, p):
        self.film.take_apart(mended(self.film, "negative", {"blue": p[6:9], "red": p[9:12]}))
        self.k = model.inhibition(p)
        self.onto.balance(self.film, self.gray)

    def ramp(self, stops):
        return self.onto.lab(self.film.passes(self.film.neutral(self.gray + stops * np.log10(2))))

    def patch(self, reflectance):
        x = self.film.exposures(None, reflectance)
        return self.onto.lab(self.film.passes(self.film.developed(x, self.k)))

    def spread(self):
        return np.array([INHIBITION] * 6 + [1e-7 if self.hold else SPREAD] * 6)


class Slide:
    kind = "slide"

    def __init__(self, film):
        self.film, self.gray = film, np.log10(10 / film.iso)
        self.start = np.array([0.02] * 6 + [0.0] * 8)

    def numbers(self, p):
        return {"inhibition": np.abs(model.inhibition(p)).round(2).tolist(),
                "blue": p[6:10].round(4).tolist(), "red": p[10:14].round(4).tolist()}

    def set(self, p):
        n = {"blue": p[6:10], "red": p[10:14]}
        self.film.take_apart(mended(self.film, "slide", n))
        self.k = -model.inhibition(p)
        self.eye = Eye(self.film.passes(np.zeros(3)), False)

    def ramp(self, stops):
        return self.eye.lab(self.film.passes(self.film.neutral(self.gray + stops * np.log10(2))))

    def patch(self, reflectance):
        x = self.film.exposures(None, reflectance)
        return self.eye.lab(self.film.passes(self.film.developed(x, self.k)))

    def spread(self):
        return np.array([0.1] * 6 + [SPREAD, SPREAD, SPREAD, 0.2] * 2)


class Onto:
    """A print stock under the negatives that are made for it."""

    def __init__(self, onto, negatives, kind):
        self.onto, self.negatives, self.kind = onto, negatives, kind
        self.start = np.zeros(6)

    def numbers(self, p):
        return {"blue": p[:3].round(4).tolist(), "red": p[3:].round(4).tolist()}

    def set(self, p):
        self.onto.take_apart(mended(self.onto.film, self.kind, {"blue": p[:3], "red": p[3:]}))

    def ramps(self):
        """CIELAB of every half stop, of each negative."""
        for film in self.negatives:
            gray = np.log10(10 / film.iso)
            self.onto.balance(film, gray)
            yield [self.onto.lab(film.passes(film.neutral(gray + s / 2 * np.log10(2)))) for s in range(-6, 9)]

    def spread(self):
        return np.array([PAPER] * 6)


def residuals(m, p, patches, chroma_wanted):
    m.set(p)
    out = []
    if isinstance(m, Onto):
        for ramp in m.ramps():
            out.extend(np.array(ramp)[1:-1, 1:].ravel())
        return np.array([*out, *(p / m.spread())])
    for reflectance, eye in patches.values():
        chroma = np.hypot(*eye[1:])
        u, d = eye[1:] / chroma, m.patch(reflectance)[1:]
        out.append((d @ u - chroma_wanted * chroma) / (1 + 0.045 * chroma))
        out.append(model.HUE * (d[1] * u[0] - d[0] * u[1]) / (1 + 0.015 * chroma))
    for half in range(-6, 9):
        ab, stops = m.ramp(half / 2)[1:], half / 2
        inside = -2.5 <= stops <= 3.5
        if inside:
            out.extend(20 * np.sign(ab) * np.maximum(np.abs(ab) - HINGE, 0))
        out.extend((0.3 if inside else 0.1) * ab)
    return np.array([*out, *(p / m.spread())])


def fit(m, patches, chroma_wanted, steps=14, h=1e-3):
    """Levenberg and Marquardt's least squares."""
    p, damping = m.start.copy(), 1e-3
    r = residuals(m, p, patches, chroma_wanted)
    for _ in range(steps):
        slopes = np.array([(residuals(m, p + h * e, patches, chroma_wanted) - r) / h for e in np.eye(len(p))]).T
        normal = slopes.T @ slopes
        while damping < 1e6:
            step = np.linalg.solve(normal + damping * np.diag(np.maximum(np.diag(normal), 1e-9)), -slopes.T @ r)
            try:
                trial = residuals(m, p + step, patches, chroma_wanted)
            except (ArithmeticError, np.linalg.LinAlgError):
                damping *= 5
                continue
            if np.isfinite(trial).all() and trial @ trial < r @ r:
                break
            damping *= 5
        else:
            break
        gain = 1 - (trial @ trial) / (r @ r)
        p, r, damping = p + step, trial, damping / 5
        if gain < 2e-3:
            break
    m.set(p)
    return p


def report(name, m, patches):
    ramps = np.array([r[2:13] for r in m.ramps()] if isinstance(m, Onto) else [[m.ramp(s / 2) for s in range(-4, 7)]])
    low, high = ramps.min((0, 1)), ramps.max((0, 1))
    line = f"{name}: gray a* {low[1]:+.1f}..{high[1]:+.1f}, b* {low[2]:+.1f}..{high[2]:+.1f}"
    if not isinstance(m, Onto):
        ratios, turns = [], {}
        for patch, (reflectance, eye) in patches.items():
            lab = m.patch(reflectance)
            turn = np.degrees(np.arctan2(lab[2], lab[1]) - np.arctan2(eye[2], eye[1]))
            turns[patch] = (turn + 180) % 360 - 180
            ratios.append(np.hypot(*lab[1:]) / np.hypot(*eye[1:]))
        worst = sorted(turns, key=lambda k: -abs(turns[k]))[:4]
        line += f", chroma x {np.mean(ratios):.2f}, hue rms {np.sqrt(np.mean(np.square(list(turns.values())))):.1f}, worst "
        line += ", ".join(f"{w} {turns[w]:+.0f}" for w in worst)
        line += f", L* of -2, 0, +2: {', '.join(f'{m.ramp(s)[0]:.0f}' for s in (-2, 0, 2))}"
    print(line, flush=True)
    return max(np.abs(low[1:]).max(), np.abs(high[1:]).max())


def fitted_5207(folder, light):
    """Vision3 250D with the numbers of import_film.py."""
    data = base.load(folder, "negative_film.kodak_5207", "KODAK_5207")
    film = Film(data, "status-m", 250, base.pairs(data.d_min_sd), True, light)
    curves = list(film.curves)
    for i, layer in ((0, "blue"), (2, "red")):
        curves[i] = model.Curve(base.mended("negative", layer, film.points[i], np.log10(10 / 250))[0])
    film.take_apart(curves)
    return film


def keep(numbers):
    text = ",\n".join(f"  {json.dumps(k)}: {json.dumps(numbers[k])}" for k in sorted(numbers))
    library.NUMBERS.write_text("{\n" + text + "\n}\n", encoding="utf-8")


def main():
    folder, only = pathlib.Path(sys.argv[1]), sys.argv[2:]
    base.prepare(folder)
    functions = model.table("cie/cie-1931-2deg.csv")
    model.CMF = np.array([functions[k] for k in "xyz"])
    model.V, model.D55 = model.CMF[1], model.illuminant("D55")
    lights = {name: model.illuminant(name) for name in (library.DAYLIGHT, library.TUNGSTEN)}
    eye = (model.CMF * model.D55).sum(1)
    checker = list(model.table("reflectances/colorchecker.csv").items())[:18]
    patches = {n: (r, model.cielab((model.CMF * model.D55 * r).sum(1) / eye)) for n, r in checker}
    known = json.loads(library.NUMBERS.read_text(encoding="utf-8")) if library.NUMBERS.exists() else {}
    numbers = dict(known)
    cine = fitted_5207(folder, lights[library.DAYLIGHT])
    films = {}
    for slug, row in library.NEGATIVES.items():
        data = library.prepared(folder, "negative", slug)
        films[slug] = Film(data, "status-m", row[6], base.pairs(data.d_min_sd), True, lights[row[7]])
        films[slug].take_apart(films[slug].curves)
    prints = {}
    papers = {s: (library.prepared(folder, "print", s), row[6], row[7]) for s, row in library.PRINTS.items()}
    for slug, (data, medium, aim) in papers.items():
        kind = "paper" if medium == "paper" else "print"
        onto = Print(Film(data, "status-a", None, None, True, None), medium == "paper", aim)
        m = Onto(onto, [f for s, f in films.items() if library.NEGATIVES[s][8] == slug] or [cine], kind)
        m.set(m.start)
        report(f"{slug} as digitized", m, patches)
        if only and slug not in only and slug in known:
            n = known[slug]
            m.set(np.array([*n["blue"], *n["red"]]))
        else:
            numbers[slug] = m.numbers(fit(m, patches, 1))
            keep(numbers)
        report(slug, m, patches)
        prints[slug] = onto
    data = base.load(folder, "print_film.kodak_2383", "KODAK_2383")
    onto = Print(Film(data, "status-a", None, None, True, None), False, (1.09, 1.06, 1.03))
    curves = [model.Curve(base.mended("print", l, p, None)[0]) for l, p in zip(("blue", "green", "red"), onto.film.points)]
    onto.take_apart(curves)
    prints[library.CINE] = onto
    for slug, row in library.NEGATIVES.items():
        if only and slug not in only:
            continue
        m = Negative(films[slug], prints[row[8]])
        m.set(np.zeros(len(m.start)))
        if report(f"{slug} as digitized", m, patches) <= NEUTRAL:
            m.hold = True
        numbers[slug] = m.numbers(fit(m, patches, 1.1))
        keep(numbers)
        report(slug, m, patches)
    for slug, row in library.SLIDES.items():
        if only and slug not in only:
            continue
        data = library.prepared(folder, "slide", slug)
        m = Slide(Film(data, "status-a", row[6], None, False, lights[library.DAYLIGHT]))
        m.set(np.zeros(len(m.start)))
        report(f"{slug} as digitized", m, patches)
        numbers[slug] = m.numbers(fit(m, patches, 1.05))
        keep(numbers)
        report(slug, m, patches)


if __name__ == "__main__":
    main()
