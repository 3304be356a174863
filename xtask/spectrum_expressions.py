#!/usr/bin/env python3
"""Writes 200 random expressions of spectra with their values: crates/spectrum/tests/data/expressions.csv.

Run from the root of the repository, with numpy and scipy:

    python3 xtask/spectrum_expressions.py

Each expression is a random tree, printed with as few parentheses as the usual operator precedence allows (and sometimes more).
numpy evaluates it from the tree and not from the text, with scipy's constants for Planck's law. Tables are read from spectra/
and evaluated at their own rows. The script discards trees that are negative or not finite anywhere on 350-830 nm, since spectrum
would refuse them, and filters above 1.

Columns: the quantity, values at the wavelengths of the header, and the magnitude of each value. The magnitude is the sum of
everything that is added on the way, without signs; rounding errors are relative to it. The expression comes last, in quotes.
"""

import csv
import math
import pathlib

import numpy as np
from scipy import constants
from scipy.special import erf

ROOT = pathlib.Path(__file__).resolve().parent.parent
AT_NM = [400.0, 470.0, 550.0, 630.0, 700.0]
GRID = np.arange(350.0, 831.0)
WAVELENGTHS = np.concatenate([AT_NM, GRID])
RANDOM = np.random.default_rng(17)

SUM, PRODUCT, SIGN, POWER, ATOM = range(5)


class Tree:
    """An expression: text, precedence of its outermost operator, values, and magnitudes."""

    def __init__(self, text, rank, values, sizes=None):
        self.text, self.rank, self.values = text, rank, values
        self.sizes = np.abs(values) if sizes is None else sizes

    def inside(self, least):
        """Returns the text as an operand of an operator with precedence `least`, in parentheses if needed."""
        loose = self.rank < least or RANDOM.random() < 0.08
        return f"({self.text})" if loose else self.text


def number(low=0.05, high=4.0):
    text = f"{RANDOM.uniform(low, high):.4g}"
    return Tree(text, ATOM, np.full(WAVELENGTHS.shape, float(text)))


def table(path, column):
    rows = [r for r in csv.reader(open(ROOT / path)) if r and not r[0].startswith("#")]
    index = rows[0].index(column) if column else 1
    data = np.array([[float(r[0]), float(r[index])] for r in rows[1:]])
    # Exact at the rows of the table. Between them, on the grid, the values only decide which trees are discarded.
    return np.interp(WAVELENGTHS, data[:, 0], data[:, 1])


def function_leaf():
    kind = RANDOM.integers(0, 6)
    w = WAVELENGTHS
    if kind == 0:
        center, sigma = round(RANDOM.uniform(380, 750), 1), round(RANDOM.uniform(15, 90), 1)
        return Tree(f"gaussian:{center},{sigma}", ATOM, np.exp(-0.5 * ((w - center) / sigma) ** 2))
    if kind == 1:
        low, width = round(RANDOM.uniform(360, 600), 1) + 0.05, round(RANDOM.uniform(30, 200), 1)
        high = round(low + width, 2)
        low = round(low, 2)
        return Tree(f"rectangle:{low},{high}", ATOM, np.where((w >= low) & (w <= high), 1.0, 0.0))
    if kind == 2:
        value = round(RANDOM.uniform(0.05, 2), 3)
        return Tree(f"constant:{value}", ATOM, np.full(w.shape, value))
    if kind == 3:
        center, width, power = round(RANDOM.uniform(400, 700)), round(RANDOM.uniform(20, 80)), RANDOM.choice([2, 4, 6])
        return Tree(
            f"function:exp(-((w - {center}) / {width})^{power})", ATOM, np.exp(-(((w - center) / width) ** int(power)))
        )
    if kind == 4:
        edge, width = round(RANDOM.uniform(430, 700)), round(RANDOM.uniform(5, 40))
        return Tree(f"function:(0.5 + 0.5*erf((w-{edge})/{width}))", ATOM, 0.5 + 0.5 * erf((w - edge) / width), np.ones(w.shape))
    return number()


def planck(kelvin):
    h, c, k = constants.h, constants.c, constants.k
    m = WAVELENGTHS * 1e-9
    return 2 * h * c * c / m**5 / np.expm1(h * c / (m * k * kelvin)) * 1e-9


def light_leaf():
    kind = RANDOM.integers(0, 4)
    if kind == 0:
        kelvin = round(RANDOM.uniform(1500, 12000))
        return Tree(f"blackbody:{kelvin}", ATOM, planck(kelvin))
    name = ["A", "D65", "FL2"][kind - 1]
    return Tree(name, ATOM, table(f"spectra/illuminants/{name}.csv", None))


def filter_leaf():
    if RANDOM.random() < 0.5:
        name = RANDOM.choice(["wratten-8", "wratten-12", "wratten-25", "wratten-58"])
        return Tree(str(name), ATOM, table(f"spectra/transmittances/{name}.csv", None))
    return Tree(f"{(v := round(RANDOM.uniform(0.1, 0.9), 2))} * wratten-47", PRODUCT, v * table("spectra/transmittances/wratten-47.csv", None))


def surface_leaf():
    name = RANDOM.choice(["red", "cyan", "neutral-5", "foliage"])
    return Tree(f"colorchecker#{name}", ATOM, table("spectra/reflectances/colorchecker.csv", name))


def plus(a, b):
    return Tree(f"{a.inside(SUM)} + {b.inside(PRODUCT)}", SUM, a.values + b.values, a.sizes + b.sizes)


def minus(a, b):
    return Tree(f"{a.inside(SUM)} - {b.inside(PRODUCT)}", SUM, a.values - b.values, a.sizes + b.sizes)


def times(a, b):
    star = "*" if RANDOM.random() < 0.2 and a.rank == ATOM and b.rank == ATOM else " * "
    return Tree(f"{a.inside(PRODUCT)}{star}{b.inside(SIGN)}", PRODUCT, a.values * b.values, a.sizes * b.sizes)


def over(a, b):
    with np.errstate(all="ignore"):
        sizes = a.sizes / np.abs(b.values) * (b.sizes / np.abs(b.values))
        return Tree(f"{a.inside(PRODUCT)} / {b.inside(SIGN)}", PRODUCT, a.values / b.values, sizes)


def power(a, b):
    with np.errstate(all="ignore"):
        values = np.power(a.values, b.values)
        relative = a.sizes / np.abs(a.values) * np.abs(b.values) + np.abs(np.log(np.abs(a.values))) * b.sizes + 1
        sizes = np.where(values == 0, 0, np.abs(values) * relative)
    return Tree(f"{a.inside(ATOM)}^{b.inside(POWER)}", POWER, values, sizes)


def negative(a):
    return Tree(f"-{a.inside(SIGN)}", SIGN, -a.values, a.sizes)


def function(depth):
    if depth == 0:
        return function_leaf()
    a, b = function(depth - 1), function(depth - 1)
    kind = RANDOM.integers(0, 7)
    if kind == 0:
        return plus(a, b)
    if kind == 1:
        return minus(a, b)
    if kind == 2:
        return times(a, b)
    if kind == 3:
        return over(a, plus(b, number(0.5, 2)))
    if kind == 4:
        return power(a, number(0.3, 3))
    if kind == 5:
        return power(number(0.2, 10), negative(a))
    return plus(number(), negative(a))


def filtered(depth):
    if depth == 0:
        return filter_leaf()
    kind = RANDOM.integers(0, 5)
    a = filtered(depth - 1)
    if kind == 0:
        return times(a, filtered(depth - 1))
    if kind == 1:
        return minus(Tree("1", ATOM, np.ones(WAVELENGTHS.shape)), a)
    if kind == 2:
        return power(a, number(0.5, 3))
    if kind == 3:
        return over(plus(a, filtered(depth - 1)), Tree("2", ATOM, np.full(WAVELENGTHS.shape, 2.0)))
    return times(function_leaf(), a)


def light(depth):
    if depth == 0:
        return light_leaf()
    kind = RANDOM.integers(0, 7)
    a = light(depth - 1)
    if kind == 0:
        return plus(a, light(depth - 1))
    if kind == 1:
        return minus(a, times(number(0.01, 0.3), light(depth - 1)))
    if kind == 2:
        return times(a, filtered(depth - 1))
    if kind == 3:
        return times(surface_leaf(), a)
    if kind == 4:
        return times(number(), a)
    if kind == 5:
        return over(a, plus(filtered(depth - 1), number(0.5, 1)))
    return times(a, function(depth - 1))


def is_good(tree, wanted):
    v = tree.values
    if not np.all(np.isfinite(v)) or not np.all(np.isfinite(tree.sizes)) or np.max(v) <= 0:
        return False
    if np.min(v) < 0 or (wanted == "transmittance" and np.max(v) > 1):
        return False
    # Discards expressions that are only the name of a spectrum.
    return any(sign in tree.text for sign in "+-*/^ ") and len(tree.text) < 400


rows = []
while len(rows) < 200:
    wanted = ["emission", "transmittance", "sensitivity"][len(rows) % 3]
    depth = int(RANDOM.integers(1, 5))
    tree = {"emission": light, "transmittance": filtered, "sensitivity": function}[wanted](depth)
    if is_good(tree, wanted) and all(row[-1] != tree.text for row in rows):
        n = len(AT_NM)
        rows.append([wanted, *map(repr, map(float, tree.values[:n])), *map(repr, map(float, tree.sizes[:n])), tree.text])

path = ROOT / "crates/spectrum/tests/data/expressions.csv"
with open(path, "w", newline="") as file:
    file.write("# Random expressions and their values, by numpy and scipy; see xtask/spectrum_expressions.py.\n")
    header = ["wanted", *[f"at_{nm:g}" for nm in AT_NM], *[f"size_{nm:g}" for nm in AT_NM], "expression"]
    file.write(",".join(header) + "\n")
    for row in rows:
        file.write(",".join(row[:-1]) + ',"' + row[-1] + '"\n')
print(f"wrote {path.relative_to(ROOT)}: {len(rows)}; longest {max(len(r[-1]) for r in rows)} characters")
