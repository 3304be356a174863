#!/usr/bin/env python3
"""Tests that each strategy draws wavelengths with the density of its documented formula.

Run from the root of the repository, with numpy and scipy:

    cargo build && python3 xtask/drawn_wavelengths.py target/debug/spectra

Each strategy draws 100 000 wavelengths of D65 (`lines` draws from FdC) with independent numbers for each of five seeds. The p-value of
the Kolmogorov-Smirnov test (for `lines` of the chi-square test) must exceed 0.001. With Sobol numbers, the largest difference of the
distributions must stay below 0.005. The mean of weight times light times response must equal the integral within 4 standard errors.
Each strategy draws a share of its samples from the response, which is flat here: 1/16 of them, 5 % for `source-times-response`.
`gaussian-terms` draws from the terms that `spectrum fit` prints, without their signs, each with its integral over the band as weight.
"""

import csv
import io
import json
import subprocess
import sys

import numpy as np
from scipy import stats

MANY = 100_000
SEEDS = [11, 12, 13, 14, 15]
BAND = (350.0, 830.0)


def draw(program, light, strategy, seed, numbers="random", many=MANY):
    command = [program, "spectrum", "draw", light, "--strategy", strategy, "-n", str(many), "--seed", str(seed), "--numbers", numbers]
    rows = list(csv.DictReader(io.StringIO(subprocess.run(command, check=True, capture_output=True, text=True).stdout)))
    column = lambda name: np.array([float(row[name] or "nan") for row in rows])
    return column("wavelength_nm"), column("line"), column("density"), column("weight") * column("light") * column("response"), column("light")


def of_terms(program):
    """Returns the distribution function of the sum of the fitted terms without their signs, within the band."""
    told = subprocess.run([program, "spectrum", "fit", "D65", "--json"], check=True, capture_output=True, text=True).stdout
    terms = [(term["center_nm"], term["sigma_nm"], abs(term["amplitude"])) for term in json.loads(told)["terms"]]
    within = lambda to, center, sigma: stats.norm.cdf((to - center) / sigma) - stats.norm.cdf((BAND[0] - center) / sigma)
    shares = np.array([size * sigma * within(BAND[1], center, sigma) for center, sigma, size in terms])
    parts = [lambda w, c=c, s=s: within(w, c, s) / within(BAND[1], c, s) for c, s, _ in terms]
    return lambda w: sum(share * part(w) for share, part in zip(shares / shares.sum(), parts))


def main():
    program = sys.argv[1]
    nm, _, _, _, light = draw(program, "D65", "uniform", 1, "stratified", 2 * MANY)
    order = np.argsort(nm)
    nm, light = nm[order], light[order]
    steps = 0.5 * (light[1:] + light[:-1]) * np.diff(nm)
    integral = steps.sum()
    source = np.concatenate([[0.0], np.cumsum(steps) / integral])
    flat = lambda w: (w - BAND[0]) / (BAND[1] - BAND[0])
    of_source = lambda w: np.interp(w, nm, source)
    ends = [(end - 540.0) / 60.0 for end in BAND]
    gaussian = stats.truncnorm(*ends, 540.0, 60.0).cdf
    mixed = lambda share, of: lambda w: (1.0 - share) * of(w) + share * flat(w)
    cases = [
        ("uniform", flat),
        ("truncated-gaussian{center: 540, sigma: 60}", mixed(1 / 16, gaussian)),
        ("inverse-transform", mixed(1 / 16, of_source)),
        ("source-times-response", mixed(0.05, of_source)),
        ("gaussian-terms", mixed(1 / 16, of_terms(program))),
    ]
    failed = 0
    for strategy, distribution in cases:
        all_p, all_z = [], []
        for seed in SEEDS:
            drawn, _, _, estimates, _ = draw(program, "D65", strategy, seed)
            all_p.append(stats.kstest(drawn, distribution).pvalue)
            all_z.append((estimates.mean() - integral) / (estimates.std() / np.sqrt(MANY)))
        even = stats.kstest(draw(program, "D65", strategy, 3, "sobol")[0], distribution).statistic
        good = min(all_p) > 1e-3 and even < 0.005 and max(map(abs, all_z)) < 4.0
        failed |= not good
        print(f"{strategy:45} p {min(all_p):.3f} .. {max(all_p):.3f}  Sobol {even:.5f}  mean {max(map(abs, all_z)):.1f} standard errors  {'holds' if good else 'FAILED'}")
    for seed in SEEDS:
        _, line, probability, _, _ = draw(program, "FdC", "lines", seed)
        kinds, first, counts = np.unique(line, return_index=True, return_counts=True)
        p = stats.chisquare(counts, MANY * probability[first]).pvalue
        failed |= p <= 1e-3
        print(f"lines, FdC, seed {seed}: chi-square p {p:.3f}, {len(kinds)} lines  {'holds' if p > 1e-3 else 'FAILED'}")
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
