#!/usr/bin/env python3
"""What each effect adds to a step on a device, and that what is not named adds nothing. No GPU is needed.

Usage: bench/effects_off.py [--arch 90] [--nvcc nvcc] [--cuobjdump cuobjdump] [--out docs/results]

Compiles the resident step of scenes that differ by one effect and reads its machine code: registers, words on the stack,
and of the fused loop (one particle, one substep) instructions, bytes of global memory and additions in shared memory.
Every scene is compiled twice, with its own headers and with every header of the library: the machine code has to be
the same, so that an effect that is not named is one that the scene has never known. Writes effects_off.md and .csv;
ends with 1 where the two differ.
"""
import argparse
import csv
import pathlib
import re
import subprocess
import sys
import tempfile
from collections import Counter

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests" / "device"))
from check_hot_loop import STEP, kernels, particle_loop  # noqa: E402

TISSUE = "struct Tissue : Mpm<NeoHookean> {};"
THREAD = TISSUE + " struct Thread : Pbd<Constraints<Distance, Bend>> {};"
SUTURE = TISSUE + " struct Thread : Pbd<Constraints<Distance, Bend, Swage>> {};"
FULL = "Tissue, Thread, ArcNeedle, Surface, Coupling<Embedded, Friction, Drag>, Gravity, {}Air, Wall<Sticky, 2, Side::low>"
OF_TISSUE = ["mpm/materials/neo_hookean.hpp", "scene/scene.hpp"]
OF_THREAD = OF_TISSUE + ["pbd/body.hpp", "coupling/embedded.hpp"]
OF_SUTURE = OF_THREAD + ["effects/gravity.hpp", "effects/air.hpp", "effects/walls.hpp"]
# name, declarations, parts of the scene, headers
SCENES = [
    ("tissue", TISSUE, "Tissue", OF_TISSUE),
    ("tissue, Gravity", TISSUE, "Tissue, Gravity", OF_TISSUE + ["effects/gravity.hpp"]),
    ("tissue, Damping", TISSUE, "Tissue, Damping", OF_TISSUE + ["effects/damping.hpp"]),
    ("tissue, Viscosity", TISSUE, "Tissue, Viscosity", OF_TISSUE + ["effects/viscosity.hpp"]),
    ("tissue, Prony<2>", TISSUE, "Tissue, Prony<2>", OF_TISSUE + ["effects/prony.hpp"]),
    ("tissue, Walls<Slip>", TISSUE, "Tissue, Walls<Slip>", OF_TISSUE + ["effects/walls.hpp"]),
    ("tissue, StretchLimit", TISSUE, "Tissue, StretchLimit", OF_TISSUE + ["effects/stretch_limit.hpp"]),
    ("tissue, thread", THREAD, "Tissue, Thread, Coupling<Embedded>", OF_THREAD),
    ("tissue, thread, Friction, Drag", THREAD, "Tissue, Thread, Coupling<Embedded, Friction, Drag>", OF_THREAD),
    ("suturing without Viscosity", SUTURE, FULL.format(""), OF_SUTURE),
    ("suturing", SUTURE, FULL.format("Viscosity, "), OF_SUTURE + ["effects/viscosity.hpp"]),
]
COLUMNS = ["scene", "registers", "stack [B]", "instructions", "read [B]", "written [B]", "additions", "same with all headers"]


def every_header():
    """Those of policies; what a back end or a file format needs is none of a scene's business."""
    folders = ("effects", "mpm", "pbd", "coupling", "scene", "surface")
    include = ROOT / "include" / "mpmpbd"
    return sorted(str(path.relative_to(include)) for folder in folders for path in (include / folder).rglob("*.hpp"))


def listing(options, folder, declarations, parts, headers):
    """The machine code and the use of resources of the scene's step."""
    source, binary = folder / "scene.cu", folder / "scene.cubin"
    includes = ["backend/cuda/simulation.cuh"] + headers
    source.write_text(
        "".join(f"#include <mpmpbd/{header}>\n" for header in includes)
        + f"namespace mpmpbd::measured {{ {declarations} struct Measured : Scene<{parts}> {{}}; }}\n"
        + "template class mpmpbd::Simulation<mpmpbd::measured::Measured, mpmpbd::Cuda, float>;\n"
    )
    subprocess.run(
        [options.nvcc, "-std=c++20", "-O3", f"-arch=sm_{options.arch}", "-cubin", f"-I{ROOT / 'include'}"]
        + [f"-I{folder}" for folder in options.include]
        + [str(source), "-o", str(binary)],
        check=True,
    )
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


def measure(options, folder, name, declarations, parts, headers):
    code, use = listing(options, folder, declarations, parts, headers)
    with_all, _ = listing(options, folder, declarations, parts, every_header())
    (_, step), = kernels(code)
    (_, again), = kernels(with_all)
    first, end = particle_loop(step, 27)
    loop = [what for _, what, _ in step[first:end]]
    moved = lambda prefix: sum(width(what) for what in loop if what.startswith(prefix))
    registers, stack = resources(use)
    additions = Counter(what.split(".")[0] for what in loop)["ATOMS"]
    return [name, registers, stack, end - first, moved("LDG"), moved("STG"), additions, "yes" if step == again else "NO"]


def write(options, rows):
    out = pathlib.Path(options.out)
    with open(out / "effects_off.csv", "w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows([COLUMNS] + rows)
    commit = subprocess.run(
        ["git", "-C", str(ROOT), "describe", "--always", "--dirty"], check=True, capture_output=True, text=True
    ).stdout.strip()
    compiler = re.search(r"V([\d.]+)", subprocess.run([options.nvcc, "--version"], capture_output=True, text=True).stdout)
    table = ["| " + " | ".join(map(str, row)) + " |" for row in [COLUMNS, ["---"] * len(COLUMNS)] + rows]
    text = (ROOT / "bench" / "effects_off_head.md").read_text(encoding="utf-8")
    text = text.format(arch=options.arch, compiler=compiler[1], commit=commit)
    (out / "effects_off.md").write_text(text + "\n".join(table) + "\n", encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--arch", default="90")
    parser.add_argument("--nvcc", default="nvcc")
    parser.add_argument("--cuobjdump", default="cuobjdump")
    parser.add_argument("--include", action="append", default=["/usr/include/eigen3"])
    parser.add_argument("--out", default=str(ROOT / "docs" / "results"))
    parser.add_argument("--only", help="scenes whose name begins so")
    options = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for scene in SCENES:
            if options.only and not scene[0].startswith(options.only):
                continue
            rows.append(measure(options, pathlib.Path(folder), *scene))
            print(*rows[-1], sep="\t", flush=True)
    if not options.only:
        write(options, rows)
    return 1 if any(row[-1] != "yes" for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
