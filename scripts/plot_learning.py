#!/usr/bin/env python3
"""Plots how a policy search learns, from the learning.csv of a run of examples/09_learn_insertion.cpp.

Usage: scripts/plot_learning.py FOLDER [PICTURE]     (default: FOLDER/learning.png)
"""
import csv
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt


def read_columns(path):
    with path.open(newline="") as file:
        rows = list(csv.reader(file))
    return {name: [float(row[i]) for row in rows[1:]] for i, name in enumerate(rows[0])}


def plot(folder, picture):
    run = read_columns(folder / "learning.csv")
    minutes = [t / 60 for t in run["time [s]"]]
    figure, (share, returns) = plt.subplots(1, 2, figsize=(10, 4), dpi=120)
    share.plot(minutes, [100 * x for x in run["best entered [1]"]], label="best six policies", color="#b03a2e")
    share.plot(minutes, [100 * x for x in run["entered [1]"]], label="all policies", color="#888888")
    share.axhline(80, color="black", linewidth=0.8, linestyle=":")
    share.set_ylabel("went in at the entry marker [% of episodes]")
    share.set_ylim(-3, 103)
    returns.plot(minutes, run["best return [1]"], label="best policy", color="#b03a2e")
    returns.plot(minutes, run["mean return [1]"], label="all policies", color="#888888")
    returns.set_ylabel("return")
    for axes in (share, returns):
        axes.set_xlabel("time [min]")
        axes.legend(frameon=False)
        axes.grid(alpha=0.25)
    figure.tight_layout()
    figure.savefig(picture)


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    folder = pathlib.Path(sys.argv[1])
    plot(folder, pathlib.Path(sys.argv[2]) if len(sys.argv) == 3 else folder / "learning.png")


if __name__ == "__main__":
    main()
