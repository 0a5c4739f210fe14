#!/usr/bin/env python3
"""compute-sanitizer on the device tests: a row of a table for each program, a column for each tool.

    tests/device/sanitize.py build/release/tests/device [program ...] [--tool synccheck] [--jobs 2] [--limit 600]

Programs run in their brief forms, `jobs` at a time on each GPU that is visible. A run is clean when the tool counts no
error and the program's own checks pass. The exit status is 1 when one is not.
"""

import argparse
import concurrent.futures
import os
import pathlib
import queue
import re
import subprocess
import sys
import tempfile
import time

TOOLS = ("memcheck", "racecheck", "initcheck")  # synccheck has to be asked for
SCENES = pathlib.Path(__file__).resolve().parents[2] / "examples" / "scenes"
PREFIX = "test_device_"
# Of a run on the host, which has others beside it.
FEW_THREADS = {"OMP_NUM_THREADS": "2"}
# The programs that take longest, the longest first, with the arguments of their brief forms where they have one.
LONGEST = {"step_loop": (SCENES, "x"), "physics": ("x",), "batch": ("x",), "resident": (), "suture": ("x",), "stitch": ("x",)}


def names_in(programs):
    """Of all device tests in a folder, those that take longest first."""
    found = {path.name.removeprefix(PREFIX) for path in programs.glob(PREFIX + "*") if os.access(path, os.X_OK)}
    return [name for name in LONGEST if name in found] + sorted(found - LONGEST.keys())


def verdict(status, output):
    """`clean`, or what is wrong. A program closes with `N passed, N failed`, the tool with its summary."""
    checks = re.findall(r"^[1-9]\d* passed, (\d+) failed$", output, re.MULTILINE)
    summary = re.findall(r"SUMMARY: (.*)", output)
    if status == 124:
        return "did not end"
    if not summary or not checks:
        return f"ended early or checked nothing, exit status {status}"
    if not re.match("0 (errors|hazards)", summary[-1]):
        return summary[-1]
    return "clean" if status == 0 else f"{checks[-1]} checks failed, exit status {status}"


def visible():
    """Numbers of the GPUs that may be used: those of CUDA_VISIBLE_DEVICES, or all."""
    if chosen := os.environ.get("CUDA_VISIBLE_DEVICES"):
        return chosen.split(",")
    listed = subprocess.run(["nvidia-smi", "-L"], check=True, capture_output=True, text=True).stdout
    return [str(gpu) for gpu in range(len(listed.splitlines()))]


class Runs:
    """Runs side by side, each on a GPU that has room; their output is kept in a folder."""

    def __init__(self, programs, kept, limit, jobs):
        self.programs, self.kept, self.limit = programs, kept, limit
        self.room = queue.Queue()
        for gpu in visible() * jobs:
            self.room.put(gpu)
        self.at_once = self.room.qsize()

    def __call__(self, name, tool):
        command = ["timeout", str(self.limit), "compute-sanitizer", "--tool", tool, "--error-exitcode", "9",
                   self.programs / (PREFIX + name), *LONGEST.get(name, ())]
        output = self.kept / f"{name}.{tool}.txt"
        gpu = self.room.get()
        begun = time.monotonic()
        with output.open("w") as out:
            status = subprocess.run(command, stdout=out, stderr=subprocess.STDOUT,
                                    env={**os.environ, "CUDA_VISIBLE_DEVICES": gpu, **FEW_THREADS}).returncode
        self.room.put(gpu)
        found = f"{verdict(status, output.read_text(errors='replace'))}, {time.monotonic() - begun:.0f} s"
        print(f"{name}, {tool}: {found}", flush=True)
        return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", type=pathlib.Path, help="folder of the device tests")
    parser.add_argument("names", nargs="*", help="without test_device_; all where none is named")
    parser.add_argument("--tool", dest="tools", action="append", choices=(*TOOLS, "synccheck"),
                        help=f"in place of {', '.join(TOOLS)}; may be given again")
    parser.add_argument("--jobs", type=int, default=2, help="runs at a time on a GPU")
    parser.add_argument("--limit", type=int, default=600, help="of a run [s]")
    parser.add_argument("--out", type=pathlib.Path, help="a folder for what the runs print")
    args = parser.parse_args()
    names = args.names or names_in(args.programs)
    if not names:
        parser.error(f"{args.programs}: no {PREFIX}* there; give the folder where they were built")
    tools = args.tools or TOOLS
    kept = args.out or pathlib.Path(tempfile.mkdtemp(prefix="mpmpbd_sanitize_"))
    kept.mkdir(parents=True, exist_ok=True)

    runs = Runs(args.programs, kept, args.limit, args.jobs)
    with concurrent.futures.ThreadPoolExecutor(runs.at_once) as pool:
        found = {(name, tool): pool.submit(runs, name, tool) for name in names for tool in tools}
    print("\n| program | " + " | ".join(tools) + " |\n|---|" + "---|" * len(tools))
    for name in names:
        print(f"| `{name}` | " + " | ".join(found[name, tool].result() for tool in tools) + " |")
    print(f"\nwhat the runs printed: {kept}")
    return 0 if all(f.result().startswith("clean") for f in found.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
