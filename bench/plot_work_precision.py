#!/usr/bin/env python3
"""Draws error against wall time from the table of bench_work_precision.

Usage: bench/plot_work_precision.py TABLE.csv PICTURE.png
"""
import csv
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

PANELS = [
    ("vortex", "0.8 of the limit", "vortex, each at its own best step", "error [amplitude]"),
    ("vortex", "0.1 dx/c", "vortex, one step for all", "error [amplitude]"),
    ("discs", "1 ms", "colliding discs", "kinetic energy lost [1]"),
    ("chain", "1/60 s / substeps", "chain of 50 links", "largest stretch [1]"),
]


def lines_of(rows, problem, step):
    """Points of each policy, in order of time: (time, error, good)."""
    lines = {}
    for row in rows:
        if row["problem"] == problem and row["step"] == step:
            point = float(row["time [s]"]), float(row["error [1]"]), row["good"] == "1"
            lines.setdefault(row["policy"], []).append(point)
    return {policy: sorted(points) for policy, points in lines.items()}


def front(points):
    """Those that no other point beats in both."""
    best, kept = float("inf"), []
    for time, error, good in sorted(points):
        if good and 0 < error < best:
            best = error
            kept.append((time, error))
    return kept


def draw(axes, lines, title, label):
    for policy, points in lines.items():
        solid = [p for p in points if p[2] and p[1] > 0]
        line, = axes.plot([p[0] for p in solid], [p[1] for p in solid], marker="o", markersize=3, linewidth=1,
                          label=policy)
        failed = [p for p in points if not p[2] and 0 < p[1] < float("inf")]
        axes.plot([p[0] for p in failed], [p[1] for p in failed], "x", color=line.get_color())
    best = front([p for points in lines.values() for p in points])
    axes.plot([p[0] for p in best], [p[1] for p in best], color="black", linewidth=4, alpha=0.15, zorder=0)
    axes.set(xscale="log", yscale="log", xlabel="wall time [s]", ylabel=label, title=title)
    axes.grid(alpha=0.25, which="both")
    axes.legend(frameon=False, fontsize=6)


def main():
    table, picture = map(pathlib.Path, sys.argv[1:3])
    with table.open(newline="") as file:
        rows = list(csv.DictReader(file))
    figure, grid = plt.subplots(2, 2, figsize=(13, 10), dpi=110)
    for axes, (problem, step, title, label) in zip(grid.flat, PANELS):
        draw(axes, lines_of(rows, problem, step), title, label)
    figure.tight_layout()
    figure.savefig(picture)


if __name__ == "__main__":
    main()
