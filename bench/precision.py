#!/usr/bin/env python3
"""What float and double cost on a device, and how far float ends from double. A GPU is needed.

Usage: bench/precision.py [--arch 90] [--nvcc nvcc] [--out docs/results]

Compiles two scenes that rest on a floor in both precisions (step_of_scene.hpp), runs them and writes precision.md and .csv.
"""
import argparse
import csv
import pathlib
import tempfile

import effects_off
from effects_off import OF_THREAD, OF_TISSUE, SET_GRAVITY, SET_THREAD, SET_TISSUE, THREAD, TISSUE

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
        path = effects_off.program(options, place, *scene, prints="print_precisions")
        yield from rows_of(name, effects_off.run(path))


def write(options, rows):
    out = pathlib.Path(options.out)
    with open(out / "precision.csv", "w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows([COLUMNS] + rows)
    head = (pathlib.Path(__file__).parent / "precision_head.md").read_text(encoding="utf-8")
    head = head.format(arch=options.arch, compiler=effects_off.compiler(options), commit=effects_off.commit(), device=effects_off.device())
    (out / "precision.md").write_text(head + effects_off.table(COLUMNS, rows), encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    effects_off.add_compiler(parser)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        rows = list(measure(options, pathlib.Path(folder)))
    write(options, rows)


if __name__ == "__main__":
    main()
