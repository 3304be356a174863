#!/usr/bin/env python3
"""Compares how much two programs pay for a clean frame: user CPU seconds times squared noise, in turns, in one run.

    xtask/clean_frame.py BEFORE AFTER

The noise of a frame is told from two seeds by `picture compare` of AFTER, in the first channel. The scenes are the bench scenes at
2 % noise, 480 x 270 pixels, and the first pictures of two sweeps at their own samples. The last line is the geometric mean of the ratios.
"""

import json
import math
import os
import resource
import subprocess
import sys
import tempfile

SMALL = ["--set", "imager.resolution=[480, 270]"]
SCENES = {
    "noise-portrait": ["bench/noise-portrait", "--noise", "2%", *SMALL],
    "noise-lights": ["bench/noise-lights", "--noise", "2%", *SMALL],
    "noise-night": ["bench/noise-night", "--noise", "2%", *SMALL],
    "hazy-street": ["hazy-street", "--set", "sweep=null", "--set", "lens.haze={share: 0}"],
    "sun-biotar": ["sun-biotar", "--set", "sweep=null", "--set", "lens.coating=bare"],
}


def timed(command):
    """Runs a command and returns its user CPU seconds and its output."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(command)}:\n{done.stdout}")
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before, done.stdout


def main(before, after):
    ratios = []
    with tempfile.TemporaryDirectory() as folder:
        for name, arguments in SCENES.items():
            spent = {before: 0.0, after: 0.0}
            for seed in (1, 2):
                for number, program in enumerate((before, after)):
                    out = os.path.join(folder, f"{number}-{seed}.exr")
                    seconds, _ = timed([program, "run", *arguments, "--seed", str(seed), "-o", out])
                    spent[program] += 0.5 * seconds
            cost = []
            for number, program in enumerate((before, after)):
                files = [os.path.join(folder, f"{number}-{seed}.exr") for seed in (1, 2)]
                compared = json.loads(timed([after, "picture", "compare", *files, "--json"])[1])
                noise = compared["channels"][0]["relative_noise"]
                cost.append(spent[program] * noise * noise)
                print(f"{name}: {program}: {spent[program]:.2f} s, noise {100 * noise:.3f} %", flush=True)
            ratios.append(cost[1] / cost[0])
            print(f"{name}: ratio {ratios[-1]:.3f}", flush=True)
    print(f"geometric mean {math.exp(sum(map(math.log, ratios)) / len(ratios)):.3f}, worst {max(ratios):.3f}")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
