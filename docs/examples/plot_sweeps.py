#!/usr/bin/env python3
"""Plots what the samples of sweeps.csv are off by, joint by joint, into a PNG or PDF.

    python3 plot_sweeps.py SWEEPS.csv PICTURE.png

Needs matplotlib (Debian: python3-matplotlib).
"""
import collections
import csv
import sys

import matplotlib

matplotlib.use("Agg")  # a file, no window
import matplotlib.pyplot as plt

COLUMNS = (("radial_residual_mm", "from the circle, um", 1000),
           ("chain_radial_residual_mm", "from the chain, um", 1000),
           ("angle_error_arcsec", "angle error, arcsec", 1))


def main(sweeps, picture):
    joints = collections.defaultdict(list)
    with open(sweeps, encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            joints[int(row["joint"])].append(row)
    if not joints:
        sys.exit(f"{sweeps} has no samples")
    figure, axes = plt.subplots(len(joints), len(COLUMNS), squeeze=False,
                                figsize=(11, 1.8 * len(joints)), layout="constrained")
    for line, (joint, rows) in zip(axes, sorted(joints.items())):
        for axis, (column, label, factor) in zip(line, COLUMNS):
            seen = [(float(row.get("t_s", k)), factor * float(row[column]))
                    for k, row in enumerate(rows) if row[column]]
            if seen:
                axis.plot(*zip(*seen), ".", markersize=1)
            axis.set_ylabel(f"joint {joint}\n{label}", fontsize=7)
            axis.tick_params(labelsize=7)
    for axis in axes[-1]:
        axis.set_xlabel("time, s" if "t_s" in rows[0] else "samples in order", fontsize=7)
    figure.savefig(picture, dpi=150)
    print(f"{picture}: {sum(map(len, joints.values()))} samples of {len(joints)} joints")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2])
