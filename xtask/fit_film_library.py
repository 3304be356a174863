#!/usr/bin/env python3
"""Fits the few numbers by which xtask/film_library.py makes the grays of its stocks gray, and writes xtask/film_library.json.

Run from the root of the repository, with the wheel that import_film.py names, and numpy:

    VENV/bin/python xtask/fit_film_library.py WHEEL [STOCK ...]

The model is that of xtask/fit_film_color.py. What is fitted, for each stock separately:
  negative       curves of blue and red against green:
                 p (u + 1) + q (u^2 - 1) + r (u + 1) u (u - 1.2), density, u = decades from mid gray, -1 to 1.2
  slide          three terms q (t exp(1 - t))^2 for blue and red, t = density above the minimum over 0.4, 1.0 and 2.2,
                 and a shift along log10 exposure
  paper, print   the terms of a slide without a shift (paper: 0.3, 0.9 and 1.9; film: 0.3, 1.0 and 2.4), so that the negatives made for
                 this stock, as digitized, print gray on it; Vision3 250D if there are none
Targets: a neutral subject in the film's own light is gray, as in fit_film_color.py, and every number is as near to 0 as that allows.
The influence of the layers on each other does not change a gray scale: xtask/fit_film_families.py fits it afterwards.
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
# Stray light of the room, as in crates/film/src/viewing_options.rs.
FLARE = 0.005
# If the gray scale is gray within this CIELAB a*, b*, the curves stay as digitized.
NEUTRAL = 1.95


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
        # The dyes matter only where the status products are above 0.
        self.seen = self.status.max(0) > 1e-7

    def take_apart(self, curves):
        """Computes amounts of dye over all log10 exposures at once."""
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
    """Converts the light from film, or from paper with FLARE of the room's light added, to CIELAB."""

    def __init__(self, clear, paper):
        super().__init__(clear)
        self.flare = FLARE if paper else 0.0

    def lab(self, passes):
        return model.cielab((self.weights @ passes / self.white + self.flare) / (1 + self.flare))

    def gray(self):
        """Returns the luminance that shows as mid gray."""
        return (0.18 * (1 + self.flare) - self.flare) * self.white[1]


class Print:
    """A print stock, and the light that prints a negative on it."""

    def __init__(self, film, paper):
        self.film, self.paper = film, paper

    def take_apart(self, curves):
        self.film.take_apart(curves)
        self.eye = Eye(self.film.passes(np.zeros(3)), self.paper)

    def balance(self, negative, gray):
        film, eye = self.film, self.eye
        third = np.digitize(model.BAND, (500, 590))
        lamp = model.blackbody(3200)
        parts = np.array([[np.where(third == p, s * lamp, 0) for p in range(3)] for s in film.sees])
        amounts = film.amounts_for(-np.log10(eye.white / eye.white[1] * eye.gray()), eye.weights, [1, 1, 1])
        needed = 10 ** np.array([film.exposure_for(i, amounts[i]) for i in range(3)])
        lights = np.linalg.solve(parts @ negative.passes(negative.neutral(gray)), needed)
        self.weights = np.einsum("lpw,p->lw", parts, lights)

    def printed(self, passes):
        h = np.log10(self.weights @ passes)
        return self.film.passes(np.array([self.film.amount(i, h[i]) for i in range(3)]))

    def lab(self, passes):
        return self.eye.lab(self.printed(passes))


def mended(film, kind, numbers):
    """Returns the film's curves, with blue and red corrected by `numbers`."""
    gray = np.log10(10 / film.iso) if film.iso else None
    out = list(film.curves)
    for i, layer in ((0, "blue"), (2, "red")):
        points, _, _ = library.moved(kind, numbers[layer], film.points[i], gray)
        out[i] = model.Curve(base.monotone(points, kind != "slide")[0])
    return out


class Negative:
    """Model of a negative on a print stock that is already fitted."""

    kind, hold = "negative", False

    def __init__(self, film, onto):
        self.film, self.onto, self.gray = film, onto, np.log10(10 / film.iso)
        self.start = np.zeros(6)

    def numbers(self, p):
        return {"blue": [], "red": []} if self.hold else {"blue": p[:3].round(4).tolist(), "red": p[3:].round(4).tolist()}

    def set(self, p):
        self.film.take_apart(mended(self.film, "negative", {"blue": p[:3], "red": p[3:]}))
        self.onto.balance(self.film, self.gray)

    def ramp(self, stops):
        return self.onto.lab(self.film.passes(self.film.neutral(self.gray + stops * np.log10(2))))

    def seen(self, amounts):
        return self.onto.lab(self.film.passes(amounts))

    def spread(self):
        return np.array([SPREAD] * 6)


class Slide:
    kind = "slide"

    def __init__(self, film):
        self.film, self.gray = film, np.log10(10 / film.iso)
        self.start = np.zeros(8)

    def numbers(self, p):
        return {"blue": p[:4].round(4).tolist(), "red": p[4:].round(4).tolist()}

    def set(self, p):
        self.film.take_apart(mended(self.film, "slide", {"blue": p[:4], "red": p[4:]}))
        self.eye = Eye(self.film.passes(np.zeros(3)), False)

    def ramp(self, stops):
        return self.eye.lab(self.film.passes(self.film.neutral(self.gray + stops * np.log10(2))))

    def seen(self, amounts):
        return self.eye.lab(self.film.passes(amounts))

    def spread(self):
        return np.array([SPREAD, SPREAD, SPREAD, 0.2] * 2)


class Onto:
    """Model of a print stock under the negatives that are made for it."""

    def __init__(self, onto, negatives, kind):
        self.onto, self.negatives, self.kind = onto, negatives, kind
        self.start = np.zeros(6)

    def numbers(self, p):
        return {"blue": p[:3].round(4).tolist(), "red": p[3:].round(4).tolist()}

    def set(self, p):
        self.onto.take_apart(mended(self.onto.film, self.kind, {"blue": p[:3], "red": p[3:]}))

    def ramps(self):
        """Yields CIELAB at every half stop, for each negative."""
        for film in self.negatives:
            gray = np.log10(10 / film.iso)
            self.onto.balance(film, gray)
            yield [self.onto.lab(film.passes(film.neutral(gray + s / 2 * np.log10(2)))) for s in range(-6, 9)]

    def spread(self):
        return np.array([PAPER] * 6)


def residuals(m, p):
    m.set(p)
    out = []
    if isinstance(m, Onto):
        for ramp in m.ramps():
            out.extend(np.array(ramp)[1:-1, 1:].ravel())
        return np.array([*out, *(p / m.spread())])
    for half in range(-6, 9):
        ab, stops = m.ramp(half / 2)[1:], half / 2
        inside = -2.5 <= stops <= 3.5
        if inside:
            out.extend(20 * np.sign(ab) * np.maximum(np.abs(ab) - HINGE, 0))
        out.extend((0.3 if inside else 0.1) * ab)
    return np.array([*out, *(p / m.spread())])


def fit(m, steps=14, h=1e-3):
    """Minimizes the squares by Levenberg-Marquardt."""
    p, damping = m.start.copy(), 1e-3
    r = residuals(m, p)
    for _ in range(steps):
        slopes = np.array([(residuals(m, p + h * e) - r) / h for e in np.eye(len(p))]).T
        normal = slopes.T @ slopes
        while damping < 1e6:
            step = np.linalg.solve(normal + damping * np.diag(np.maximum(np.diag(normal), 1e-9)), -slopes.T @ r)
            try:
                trial = residuals(m, p + step)
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


def report(name, m):
    ramps = np.array([r[2:13] for r in m.ramps()] if isinstance(m, Onto) else [[m.ramp(s / 2) for s in range(-4, 7)]])
    low, high = ramps.min((0, 1)), ramps.max((0, 1))
    line = f"{name}: gray a* {low[1]:+.1f}..{high[1]:+.1f}, b* {low[2]:+.1f}..{high[2]:+.1f}"
    if not isinstance(m, Onto):
        line += f", L* of -3 to +2: {', '.join(f'{m.ramp(s)[0]:.0f}' for s in range(-3, 3))}"
    print(line, flush=True)
    return max(np.abs(low[1:]).max(), np.abs(high[1:]).max())


def fitted_5207(folder, light):
    """Returns Vision3 250D with the numbers of import_film.py."""
    data = base.load(folder, "negative_film.kodak_5207", "KODAK_5207")
    film = Film(data, "status-m", 250, base.pairs(data.d_min_sd), True, light)
    curves = list(film.curves)
    for i, layer in ((0, "blue"), (2, "red")):
        curves[i] = model.Curve(base.mended("negative", layer, film.points[i], np.log10(10 / 250))[0])
    film.take_apart(curves)
    return film


def fitted_2383(folder):
    """Returns print film 2383 with the numbers of import_film.py."""
    data = base.load(folder, "print_film.kodak_2383", "KODAK_2383")
    onto = Print(Film(data, "status-a", None, None, True, None), False)
    onto.take_apart([model.Curve(base.mended("print", l, p, None)[0]) for l, p in zip(("blue", "green", "red"), onto.film.points)])
    return onto


def keep(numbers):
    text = ",\n".join(f"  {json.dumps(k)}: {json.dumps(numbers[k])}" for k in sorted(numbers))
    library.NUMBERS.write_text("{\n" + text + "\n}\n", encoding="utf-8")


def lights():
    """Returns the illuminants by name, after setting the model's D55 and standard observer."""
    functions = model.table("cie/cie-1931-2deg.csv")
    model.CMF = np.array([functions[k] for k in "xyz"])
    model.V, model.D55 = model.CMF[1], model.illuminant("D55")
    return {name: model.illuminant(name) for name in (library.DAYLIGHT, library.TUNGSTEN)}


def main():
    folder, only = pathlib.Path(sys.argv[1]), sys.argv[2:]
    base.prepare(folder)
    known_lights = lights()
    known = json.loads(library.NUMBERS.read_text(encoding="utf-8")) if library.NUMBERS.exists() else {}
    numbers = dict(known)
    cine = fitted_5207(folder, known_lights[library.DAYLIGHT])
    films = {}
    for slug, row in library.NEGATIVES.items():
        data = library.prepared(folder, "negative", slug)
        films[slug] = Film(data, "status-m", row[6], base.pairs(data.d_min_sd), True, known_lights[row[7]])
        films[slug].take_apart(films[slug].curves)
    prints = {}
    for slug, row in library.PRINTS.items():
        is_paper = row[6] == "paper"
        onto = Print(Film(library.prepared(folder, "print", slug), "status-a", None, None, True, None), is_paper)
        m = Onto(onto, [f for s, f in films.items() if library.NEGATIVES[s][8] == slug] or [cine], "paper" if is_paper else "print")
        m.set(m.start)
        report(f"{slug} as digitized", m)
        if only and slug not in only and slug in known:
            m.set(np.array([*known[slug]["blue"], *known[slug]["red"]]))
        else:
            numbers[slug] = m.numbers(fit(m))
            keep(numbers)
        report(slug, m)
        prints[slug] = onto
    prints[library.CINE] = fitted_2383(folder)
    for slug, row in library.NEGATIVES.items():
        if only and slug not in only:
            continue
        m = Negative(films[slug], prints[row[8]])
        m.set(np.zeros(len(m.start)))
        if report(f"{slug} as digitized", m) <= NEUTRAL:
            m.hold = True
            numbers[slug] = m.numbers(m.start)
        else:
            numbers[slug] = m.numbers(fit(m))
        keep(numbers)
        report(slug, m)
    for slug, row in library.SLIDES.items():
        if only and slug not in only:
            continue
        m = Slide(Film(library.prepared(folder, "slide", slug), "status-a", row[6], None, False, known_lights[library.DAYLIGHT]))
        m.set(np.zeros(len(m.start)))
        report(f"{slug} as digitized", m)
        numbers[slug] = m.numbers(fit(m))
        keep(numbers)
        report(slug, m)


if __name__ == "__main__":
    main()
