#!/usr/bin/env python3
"""What float and double cost on a device, and how far float ends from double. A GPU is needed.

Usage: bench/precision.py [--arch 90] [--nvcc nvcc] [--out docs/results]

Compiles two scenes that rest on a floor in both precisions (step_of_scene.hpp), runs them and writes precision.md and .csv.
"""
import argparse
import csv
import pathlib
import tempfile

from published import ROOT, commit, gpus, table, version_of
from scene_programs import (
    OF_THREAD,
    OF_TISSUE,
    SET_GRAVITY,
    SET_THREAD,
    SET_TISSUE,
    THREAD,
    TISSUE,
    add_compiler,
    program,
    run,
)

FLOOR = "Wall<Sticky, 2, Side::low>"
OTHERS = ["effects/gravity.hpp", "effects/walls.hpp"]
SET_OTHERS = SET_GRAVITY | {FLOOR: "{0.3}"}
# name, declarations, parts of the scene, headers, parameters
SCENES = [
    ("tissue", TISSUE, f"Tissue, Gravity, {FLOOR}", OF_TISSUE + OTHERS, SET_TISSUE | SET_OTHERS),
    (
        "tissue, thread",
        THREAD,
        f"Tissue, Thread, Coupling<Embedded, Friction>, Gravity, {FLOOR}",
        OF_THREAD + OTHERS,
        SET_THREAD | {"Friction": "{0.2, 100.0}"} | SET_OTHERS,
    ),
]
COLUMNS = [
    "scene",
    "precision",
    "form",
    "132 environments [ns]",
    "1,056 environments [ns]",
    "farthest from start [m]",
    "farthest from double [m]",
]


def rows_of(name, text):
    for line in text.splitlines():
        precision, form, few, few_deviation, many, many_deviation, *distances = line.split(",")
        times = [f"{float(few):.3f} +- {float(few_deviation):.3f}", f"{float(many):.3f} +- {float(many_deviation):.3f}"]
        yield [name, precision, form, *times, *distances]


def measure(options, folder):
    for number, (name, *scene) in enumerate(SCENES):
        place = folder / str(number)
        place.mkdir()
        path = program(options, place, *scene, prints="print_precisions")
        yield from rows_of(name, run(path))


def write(options, rows):
    out = pathlib.Path(options.out)
    with open(out / "precision.csv", "w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows([COLUMNS] + rows)
    gpu, driver = gpus()[0]
    head = (ROOT / "bench" / "precision_head.md").read_text(encoding="utf-8")
    head = head.format(arch=options.arch, compiler=version_of(options.nvcc), commit=commit(), gpu=gpu, driver=driver)
    (out / "precision.md").write_text(head + table(COLUMNS, rows), encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    add_compiler(parser)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        rows = list(measure(options, pathlib.Path(folder)))
    write(options, rows)


if __name__ == "__main__":
    main()
