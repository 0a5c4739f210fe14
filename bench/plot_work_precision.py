#!/usr/bin/env python3
"""Draws error against wall time from the table of bench_work_precision, and writes what an error costs.

Usage: bench/plot_work_precision.py TABLE.csv PICTURE.png PAGE.md ORIGIN
"""
import csv
import math
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


def good(points):
    return [(time, error) for time, error, good in points if good and error > 0]


def time_to(points, level):
    """Wall time to an error [s], between two points on a straight line of logarithms; None if it is not reached."""
    points = good(points)
    for i, (time, error) in enumerate(points):
        if error <= level:
            if i == 0:
                return time
            before, larger = points[i - 1]
            part = math.log(larger / level) / math.log(larger / error)
            return before * (time / before) ** part
    return None


def common_level(lines):
    """The smallest error that every line with good points reaches."""
    return max(min(error for _, error in good(points)) for points in lines.values() if good(points))


def table(lines, title, label):
    """A row per policy: what the common error costs, and the least error that it reaches."""
    level = common_level(lines)
    times = {policy: time_to(points, level) for policy, points in lines.items()}
    cheapest = min(time for time in times.values() if time is not None)
    yield f"## {title[0].upper()}{title[1:]}\n"
    yield f"{label[0].upper()}{label[1:]}. Every policy without a fault reaches {level:.2g}; the cheapest in {cheapest:.2g} s.\n"
    yield f"| policy | time to {level:.2g} | least error | in s |"
    yield "|---|---|---|---|"
    for policy in sorted(lines, key=lambda p: times[p] if times[p] is not None else math.inf):
        points = good(lines[policy])
        if not points:
            yield f"| {policy} | a fault, or energy gained, at every point | | |"
            continue
        time, error = min(points, key=lambda point: point[1])
        ratio = f"{times[policy] / cheapest:.2f}"
        yield f"| {policy} | {ratio} | {error:.2g} | {time:.2g} |"
    yield ""


def page(rows, origin):
    yield "# What accuracy costs\n"
    yield "Error against wall time, the same physics for every policy. Written by `scripts/verification.sh --cost` at"
    yield f"{origin}, double, one thread, the fastest of three runs. All points: [work_precision.csv](work_precision.csv).\n"
    yield "![error against wall time](../images/work_precision.png)\n"
    yield "Grey: points that no other one beats in both. Crosses: a fault on the way, or energy gained. Times are relative to the"
    yield "cheapest policy of a table; between two points they are interpolated.\n"
    for problem, step, title, label in PANELS:
        yield from table(lines_of(rows, problem, step), title, label)


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
    measured, picture, written = map(pathlib.Path, sys.argv[1:4])
    with measured.open(newline="") as file:
        rows = list(csv.DictReader(file))
    figure, grid = plt.subplots(2, 2, figsize=(13, 10), dpi=110)
    for axes, (problem, step, title, label) in zip(grid.flat, PANELS):
        draw(axes, lines_of(rows, problem, step), title, label)
    figure.tight_layout()
    figure.savefig(picture)
    written.write_text("\n".join(page(rows, sys.argv[4])))


if __name__ == "__main__":
    main()
