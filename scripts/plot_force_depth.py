#!/usr/bin/env python3
"""Plots the force on the needle against its depth, from the stitch.csv and summary.json of a run.

Usage: scripts/plot_force_depth.py FOLDER [PICTURE]     (default: FOLDER/force_depth.png)
"""
import csv
import json
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt


def read_columns(path):
    with path.open(newline="") as file:
        rows = list(csv.reader(file))
    return {name: [float(row[i]) for row in rows[1:]] for i, name in enumerate(rows[0])}


def prefix(largest):
    """The unit prefix in which `largest` is a number between 1 and 1000, and its factor."""
    for sign, factor in (("k", 1e3), ("", 1.0), ("m", 1e-3), ("u", 1e-6)):
        if largest >= factor:
            return sign, factor
    return "", 1.0


def plot(folder, picture):
    run = read_columns(folder / "stitch.csv")
    summary = json.loads((folder / "summary.json").read_text())
    depth = run["depth [m]"]
    length_sign, length = prefix(max(abs(x) for x in depth))
    curves = {"tissue on needle": "force [N]", "tip, axial": "tip force [N]", "pull of the thread": "thread pull [N]"}
    force_sign, force = prefix(max(max(run[name]) for name in curves.values()))

    figure, axes = plt.subplots(figsize=(9, 5), dpi=120)
    for (label, name), colour in zip(curves.items(), ("#b03a2e", "#888888", "#3b2a9a")):
        axes.plot([x / length for x in depth], [y / force for y in run[name]], label=label, color=colour, linewidth=1.3)
    for event in ("entry", "exit"):
        found = summary.get("miss at " + event)
        if found is None:
            continue
        at = min(range(len(depth)), key=lambda i: abs(run["time [s]"][i] - found["time"]))
        axes.axvline(depth[at] / length, color="black", linewidth=0.8, linestyle=":")
        axes.annotate(event, (depth[at] / length, 1.0), xycoords=("data", "axes fraction"), xytext=(3, -12),
                      textcoords="offset points")
    axes.set_xlabel(f"way of the tip past the entry marker, along the arc [{length_sign}m]")
    axes.set_ylabel(f"force [{force_sign}N]")
    axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
    axes.legend(loc="upper right", frameon=False)
    axes.grid(alpha=0.25)
    axes.set_title(f"The stitch, preset {summary['preset']}: {summary['verdict']}")
    figure.tight_layout()
    figure.savefig(picture)


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    folder = pathlib.Path(sys.argv[1])
    plot(folder, pathlib.Path(sys.argv[2]) if len(sys.argv) == 3 else folder / "force_depth.png")


if __name__ == "__main__":
    main()
