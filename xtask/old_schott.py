"""Improves the dispersion of old SCHOTT glasses for which Robb and Mercado's table has only a two-term fit over 400 to 700 nm.

- Glasses without lead (BK7, SK16, ...) get the dispersion of SCHOTT's glass of the same type with N- before its name, if nd agrees to
  0.0005 and Vd to 0.5, scaled to the nd of the table and to the Vd of that glass. SCHOTT gave both the same six digits; the table's Vd
  differs by up to 0.4.
- Glasses with lead and also barium, lanthanum or boron (BAF4, SSK2, KZFS8, ...) get the dispersion of that glass too, but scaled to nd and
  Vd of the table. The lead-free successor has a Vd that differs by up to 0.25, and the table is nearer to the six digits of the old one.
- Flints whose dispersion comes from lead (F, LF, LLF, SF) get nd and Vd of the table, and the relative partial dispersions that the
  flints of SCHOTT's catalog have at these, by least squares. This predicts each of those, left out in turn, within 1e-4 from h to C,
  except SF57 and SF11, the ends of the family (1.1e-4). A glass is not changed if it lies beyond the Vd of these, or if the table's
  own index at g differs by more than 1e-4.

All are written as a constant and three Sellmeier terms with the poles of the N- glass, or of the flint with the nearest Vd. These formulas
match the dispersion to 2e-5 from 400 to 800 nm. The stated range stays that of the table: 400 to 700 nm.
"""

import re

import numpy as np

H, G, F, D, C = 0.4046561, 0.4358343, 0.4861327, 0.5875618, 0.6562725
# Glasses whose dispersion comes from lead, with some titanium in SF10, SF11, SF14 and SF15.
FLINTS = "SF1 SF2 SF4 SF5 SF6 SF10 SF11 SF14 SF15 SF56A SF57 F2 F5 LF5 LF7 LLF1".split()
# Types that had lead; their successors (N-) have another Vd.
LEAD = r"(KF|BALF|SSK|BAF|BASF|KZFS)\d+|BAK4|LAK10|SK10|SK15"
WAVELENGTHS = 1.0 / np.linspace(1.0 / 0.4, 1.0 / 0.8, 200)
LARGEST_RESIDUAL = 2e-5


def index(fields):
    """Returns the index of a glass as a function of the wavelength in um, or None if its formula is not one of SCHOTT's."""
    c = [float(v) for v in fields["coefficients"].split()]
    match fields["type"]:
        case "2":
            return lambda um: np.sqrt(1 + c[0] + sum(a * um**2 / (um**2 - b) for a, b in zip(c[1::2], c[2::2])))
        case "3":
            return lambda um: np.sqrt(c[0] + sum(a * um**p for a, p in zip(c[1::2], c[2::2])))
        case "B":
            return lambda um: c[1] + c[2] * (w := (um - c[0]) / (1 + 2.5 * (um - c[0]))) + c[3] * w**2
    return None


def abbe(n):
    return (n(D) - 1) / (n(F) - n(C))


def features(nd, vd):
    return np.array([1, 1 / vd, 1 / vd**2, nd, nd / vd])


def partials(n, um):
    return (n(um) - n(D)) / (n(F) - n(C))


def flint(nd, vd, known):
    """Returns the index function of a flint with nd and Vd, using the partial dispersions of the other flints."""
    rows = np.array([features(n(D), abbe(n)) for n in known])
    at = features(nd, vd)

    def n(um):
        um = np.atleast_1d(um)
        fit = np.linalg.lstsq(rows, np.array([partials(n, um) for n in known]), rcond=None)[0]
        # The fit gives exactly that Vd; the partial dispersions between F and C follow.
        return np.squeeze(nd + (at @ fit) * (nd - 1) / vd)

    return n


def left_out(known):
    """Returns the largest error from h to C of each flint of the catalog if it is left out of the fit."""
    um = np.linspace(H, C, 50)
    errors = {}
    for name, n in known.items():
        others = [other for key, other in known.items() if key != name]
        errors[name] = float(np.max(np.abs(flint(n(D), abbe(n), others)(um) - n(um))))
    return errors


def sellmeier(n, like, number):
    """Returns coefficients of Sellmeier's formula with the poles of another glass."""
    poles = [float(v) for v in like["coefficients"].split()][2::2]
    squared = WAVELENGTHS**2
    basis = np.array([np.ones_like(squared)] + [squared / (squared - pole) for pole in poles]).T
    fit = np.linalg.lstsq(basis, n(WAVELENGTHS) ** 2 - 1, rcond=None)[0]
    residual = np.max(np.abs(np.sqrt(1 + basis @ fit) - n(WAVELENGTHS)))
    if residual > LARGEST_RESIDUAL:
        raise SystemExit(f"Sellmeier's formula leaves {residual} with the poles {poles}")
    return " ".join([number(fit[0])] + [f"{number(b)} {number(c)}" for b, c in zip(fit[1:], poles)])


def improve(catalogue, number):
    """Replaces the dispersion of old glasses, and prints which glass got which."""
    of = {}
    for (maker, _, source), glasses in catalogue.blocks.items():
        if maker == "SCHOTT":
            of.update({name: (source, fields) for name, fields in glasses.items()})
    known = {name: index(of[name][1]) for name in FLINTS}
    print("flints left out:", {name: f"{error:.1e}" for name, error in left_out(known).items()})
    done = {"namesake": 0, "shape": 0, "flint": 0}
    by_sellmeier = [name for name in known if of[name][1]["type"] == "2"]
    family = [float(abbe(n)) for n in known.values()]
    table = next(glasses for (maker, _, source), glasses in catalogue.blocks.items() if (maker, source) == ("SCHOTT", "robb"))
    for name in list(table):
        fields = table[name]
        old = index(fields)
        nd, vd = float(old(D)), float(abbe(old))
        source = None
        if re.fullmatch(r"(F|LF|LLF|SF)\d+", name):
            n = flint(nd, vd, list(known.values()))
            if min(family) <= vd <= max(family) and abs(n(G) - old(G)) <= 1e-4:
                source, listed = "flint", ""
                like = of[min(by_sellmeier, key=lambda key: abs(abbe(known[key]) - vd))][1]
        elif f"N-{name}" in of:
            listed_vd = float(of[f"N-{name}"][1]["listed"].split()[1])
            like = of[f"N-{name}"][1]
            new = index(like)
            if abs(nd - new(D)) <= 5e-4 and abs(vd - listed_vd) <= 0.5:
                had_lead = re.fullmatch(LEAD, name)
                scale = ((nd - 1) / (vd if had_lead else listed_vd)) / (new(F) - new(C))
                n = lambda um, new=new, scale=scale: nd + scale * (new(um) - new(D))
                source, listed = ("shape", "") if had_lead else ("namesake", f"{nd:.5f} {number(listed_vd)}")
        if source:
            fields = dict(table.pop(name), type="2", coefficients=sellmeier(n, like, number), listed=listed)
            catalogue.blocks.setdefault(("SCHOTT", "optical glass", source), {})[name] = fields
            done[source] += 1
    return done
