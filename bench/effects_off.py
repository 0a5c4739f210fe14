#!/usr/bin/env python3
"""What each effect adds to a step on a device, and that what is not named adds nothing. A GPU is needed for times alone.

Usage: bench/effects_off.py [--time] [--arch 90] [--nvcc nvcc] [--cuobjdump cuobjdump] [--out docs/results]

Compiles the resident step of scenes that differ by one effect and reads its machine code: registers, words on the stack,
and of the fused loop (one particle, one substep) instructions, bytes of global memory and additions in shared memory.
Every scene is compiled twice, with its own headers and with every header of the library: the machine code has to be
the same, so that an effect that is not named is one that the scene has never known. With --time, it is run as well
(step_of_scene.hpp). Writes effects_off.md and .csv; ends with 1 where the two differ.
"""
import argparse
import concurrent.futures
import csv
import os
import pathlib
import re
import subprocess
import sys
import tempfile
from collections import Counter

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
    compile_scene,
    program,
    run,
    source_of,
)

sys.path.insert(0, str(ROOT / "tests" / "device"))
from check_hot_loop import STEP, kernels, particle_loop  # noqa: E402

SUTURE = TISSUE + " struct Thread : Pbd<Constraints<Distance, Bend, Swage>> {};"
FULL = "Tissue, Thread, ArcNeedle, Surface, Coupling<Embedded, Friction, Drag>, Gravity, {}Air, Wall<Sticky, 2, Side::low>"
OF_SUTURE = OF_THREAD + ["effects/gravity.hpp", "effects/air.hpp", "effects/walls.hpp"]
SET_FRICTION = SET_THREAD | {"Friction": "{0.2, 100.0}", "Drag": "{5.0}"}
SET_VISCOSITY = {"Viscosity": "{500.0}"}
SET_FULL = SET_FRICTION | SET_GRAVITY | {
    "Air": "{5.0}",
    "Wall<Sticky, 2, Side::low>": "{0.3}",
    "ArcNeedle": "{0.32, 3.14, 0.02, 0.06, 6250.0, 2080.0}",
}
# name, declarations, parts of the scene, headers, parameters
SCENES = [
    ("tissue", TISSUE, "Tissue", OF_TISSUE, SET_TISSUE),
    ("tissue, Gravity", TISSUE, "Tissue, Gravity", OF_TISSUE + ["effects/gravity.hpp"], SET_TISSUE | SET_GRAVITY),
    ("tissue, Damping", TISSUE, "Tissue, Damping", OF_TISSUE + ["effects/damping.hpp"], SET_TISSUE | {"Damping": "{2.0}"}),
    ("tissue, Viscosity", TISSUE, "Tissue, Viscosity", OF_TISSUE + ["effects/viscosity.hpp"], SET_TISSUE | SET_VISCOSITY),
    (
        "tissue, Prony<2>",
        TISSUE,
        "Tissue, Prony<2>",
        OF_TISSUE + ["effects/prony.hpp"],
        SET_TISSUE | {"Prony<2>": "{{0.2, 0.1}, {0.01, 0.1}}"},
    ),
    (
        "tissue, Walls<Slip>",
        TISSUE,
        "Tissue, Walls<Slip>",
        OF_TISSUE + ["effects/walls.hpp"],
        SET_TISSUE | {"Walls<Slip>": "{{0.2, 0.2, 0.2}, {2.4, 1.4, 1.4}}"},
    ),
    (
        "tissue, StretchLimit",
        TISSUE,
        "Tissue, StretchLimit",
        OF_TISSUE + ["effects/stretch_limit.hpp"],
        SET_TISSUE | {"StretchLimit": "{1.9}"},
    ),
    ("tissue, thread", THREAD, "Tissue, Thread, Coupling<Embedded>", OF_THREAD, SET_THREAD),
    (
        "tissue, thread, Friction, Drag",
        THREAD,
        "Tissue, Thread, Coupling<Embedded, Friction, Drag>",
        OF_THREAD,
        SET_FRICTION,
    ),
    ("suturing without Viscosity", SUTURE, FULL.format(""), OF_SUTURE, SET_FULL),
    (
        "suturing",
        SUTURE,
        FULL.format("Viscosity, "),
        OF_SUTURE + ["effects/viscosity.hpp"],
        SET_FULL | SET_VISCOSITY,
    ),
]
COLUMNS = ["scene", "registers", "stack [B]", "instructions", "read [B]", "written [B]", "additions", "same with all headers"]
TIME = ["time [ns]"]


def every_header():
    """Those of policies; what a back end or a file format needs is none of a scene's business."""
    folders = ("effects", "mpm", "pbd", "coupling", "scene", "surface")
    include = ROOT / "include" / "mpmpbd"
    return sorted(str(path.relative_to(include)) for folder in folders for path in (include / folder).rglob("*.hpp"))


def listing(options, folder, declarations, parts, headers):
    """The machine code and the use of resources of the scene's step."""
    binary = folder / "scene.cubin"
    text = source_of(declarations, parts, headers)
    text += "template class mpmpbd::Simulation<mpmpbd::measured::Measured, mpmpbd::Cuda, float>;\n"
    compile_scene(options, folder / "scene.cu", text, "-cubin", "-o", str(binary))
    read = lambda what: subprocess.run(
        [options.cuobjdump, what, str(binary)], check=True, capture_output=True, text=True
    ).stdout
    return read("-sass"), read("-res-usage")


def resources(text):
    for name, use in re.findall(r"Function (\S+):\s*\n\s*(.*)", text):
        if STEP in name:
            number = lambda key: int(re.search(rf"\b{key}:(\d+)", use)[1])
            return number("REG"), number("STACK")
    raise SystemExit("the listing has no resident step")


def width(instruction):
    bits = re.search(r"\.(8|16|64|128)\b|\.[US](8|16)\b", instruction)
    return int(next(filter(None, bits.groups()))) // 8 if bits else 4


def row_of(name, own, with_all):
    code, use = own
    (_, step), = kernels(code)
    (_, again), = kernels(with_all[0])
    first, end = particle_loop(step, 27)
    loop = [what for _, what, _ in step[first:end]]
    moved = lambda prefix: sum(width(what) for what in loop if what.startswith(prefix))
    registers, stack = resources(use)
    additions = Counter(what.split(".")[0] for what in loop)["ATOMS"]
    return [name, registers, stack, end - first, moved("LDG"), moved("STG"), additions, "yes" if step == again else "NO"]


def time_of(path):
    mean, deviation = run(path).split()
    return f"{float(mean):.3f} +- {float(deviation):.3f}"


def measure(options, scenes, folder):
    """A row per scene. Compiled side by side; times one after the other."""
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:

        def start(job, *arguments):
            place = pathlib.Path(tempfile.mkdtemp(dir=folder))
            return pool.submit(job, options, place, *arguments)

        started = []
        for name, declarations, parts, headers, parameters in scenes:
            listings = [start(listing, declarations, parts, which) for which in (headers, every_header())]
            timed = [start(program, declarations, parts, headers, parameters)] if options.time else []
            started.append((name, listings, timed))
        rows = [row_of(name, *(one.result() for one in listings)) for name, listings, _ in started]
        programs = [[one.result() for one in timed] for _, _, timed in started]
    for row, paths in zip(rows, programs):
        row += [time_of(path) for path in paths]
        print(*row, sep="\t", flush=True)
    return rows


def write(options, rows):
    out = pathlib.Path(options.out)
    columns = COLUMNS + (TIME if options.time else [])
    with open(out / "effects_off.csv", "w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows([columns] + rows)
    text = (ROOT / "bench" / "effects_off_head.md").read_text(encoding="utf-8")
    times = "Times: on an {}, driver {}.".format(*gpus()[0]) if options.time else "Times were not taken."
    text = text.format(arch=options.arch, compiler=version_of(options.nvcc), commit=commit(), times=times)
    (out / "effects_off.md").write_text(text + table(columns, rows), encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    add_compiler(parser)
    parser.add_argument("--cuobjdump", default="cuobjdump")
    parser.add_argument("--only", help="scenes whose name begins so")
    parser.add_argument("--time", action="store_true", help="take times too, on this machine's GPU")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="compilers at work at once")
    options = parser.parse_args()
    scenes = [scene for scene in SCENES if not options.only or scene[0].startswith(options.only)]
    with tempfile.TemporaryDirectory() as folder:
        rows = measure(options, scenes, folder)
    if not options.only:
        write(options, rows)
    return 1 if any(row[7] != "yes" for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
