#!/usr/bin/env python3
"""What a step costs on a CUDA device, beside what is published: tables, rows and pictures in docs/results.

Usage: bench/device_throughput.py [--program build/release/bench/bench_device_throughput] [--rows FILE] [--out docs/results]

Runs every table of bench/device_throughput.cpp, resident and tiled, and writes device_throughput.csv; then, from those rows,
device_throughput.md and device_throughput.png. --rows writes the latter two from rows that were measured elsewhere. A GPU is needed
for measuring alone, matplotlib for the picture alone. A run takes some eight minutes on an H200.
"""
import argparse
import csv
import pathlib
import subprocess
import sys

from published import ROOT, commit, gpus, table

RUNS = (
    ("environments", "resident"),
    ("environments", "tiled", "1", "10", "132", "264", "528", "1056"),
    ("bodies", "tiled"),
    ("small", "resident"),
    ("small", "tiled"),
    ("moved", "resident"),
    ("moved", "tiled", "10", "132", "1056"),
    ("moved_body", "tiled"),
    ("streams", "resident"),
    ("streams", "tiled"),
    ("devices",),
    ("decisions",),
    ("threads",),
)
# Milliseconds of the paper's scene by streams: 10 environments of 20,000 particles, 0.004 s, 2 substeps, no pictures.
PUBLISHED = (
    ("the paper (RTX 4090)", {"1": 5.85, "2": 2.10, "4": 1.70}),
    ("CRESSim-MPM 2.2.0 (H200)", {"1": 4.11, "2": 2.52, "4": 1.97, "10": 1.56}),
)
# Copies [B/s], by kind of GPU; for the fused loop bytes and, in ns, its additions and loads in shared memory and its instructions.
COPIES = {"H200": 4.24e12, "H100": 3.0e12}
BYTES, SHARED_PIPE, ISSUE = 152, 0.042, 0.046


def measure(program, out):
    rows = []
    for words in RUNS:
        print("==", *words, file=sys.stderr, flush=True)
        text = subprocess.run([program, *words], capture_output=True, text=True, check=True).stdout
        rows += list(csv.DictReader(text.splitlines()))
    (gpu, driver), source = gpus()[0], commit()
    for row in rows:
        row |= {"gpu": gpu, "driver": driver, "commit": source}
    with open(out, "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def time_of(row):
    return f"{float(row['ms']):.3f} +- {float(row['deviation']):.3f}"


class Rows:
    def __init__(self, rows):
        self.rows = rows

    def all(self, **words):
        return [r for r in self.rows if all(r[k] == v for k, v in words.items())]

    def one(self, **words):
        found = self.all(**words)
        return found[0] if found else None


def streams(rows):
    counts = ("1", "2", "4", "10")
    lines = [(name, *(f"{ms[n]:.2f}" if n in ms else "" for n in counts)) for name, ms in PUBLISHED]
    for form in ("resident", "tiled"):
        found = [rows.one(table="streams", form=form, contents="contact", runs=n) for n in counts]
        lines.append((f"mpmpbd, {form}", *(time_of(r) if r else "" for r in found)))
    return table(("", *(f"{n} streams" if n != "1" else "1 stream" for n in counts)), lines)


def components(rows):
    lines = [("the paper (RTX 4090, 2 streams, soft body drawn)", "4.96", "0.63")]
    for substeps in ("2", "4"):
        for n, form in (("10", "tiled"), ("10", "resident"), ("1056", "resident"), ("1056", "tiled")):
            parts = [
                rows.one(table="environments", form=form, environments=n, substeps=substeps, contents=c)
                for c in ("tissue", "contact")
            ]
            if None in parts:
                continue
            tissue, contact = (float(p["ms"]) for p in parts)
            lines.append((f"{n} environments, {substeps} substeps, {form}", f"{tissue:.3f}", f"{contact - tissue:.3f}"))
    return table(("", "MPM [ms]", "needle, thread, contact, surface [ms]"), lines)


def copy_of(gpu):
    """How fast such a GPU copies [B/s]; None where that was not measured."""
    return next((speed for name, speed in COPIES.items() if name in gpu), None)


def environments(rows):
    lines = []
    for row in rows.all(table="environments"):
        ns, copy = float(row["ns"]), copy_of(row["gpu"])
        of = [BYTES / copy * 1e9, SHARED_PIPE, ISSUE] if copy and ns < 1 and row["form"] == "resident" else []
        shares = [f"{100 * least / ns:.0f}" for least in of] or [""] * 3
        known = [row[name] for name in ("environments", "substeps", "density", "contents", "form")]
        lines.append((*known, time_of(row), f"{ns:.4f}", *shares))
    head = ("environments", "substeps", "density [kg/m^3]", "contents", "form", "ms per step", "ns per particle and substep")
    return table(head + ("of memory [%]", "of shared memory [%]", "of instructions [%]"), lines)


def moved(rows):
    found = rows.all(table="moved") + rows.all(table="moved_body")
    known = ("environments", "particles", "substeps", "density", "form")
    lines = [(*(r[k] for k in known), time_of(r), f"{float(r['ns']):.4f}", r["faults"].replace("+", ", ")) for r in found]
    return table((*known, "ms per step", "ns per particle and substep", "faults of any environment"), lines)


def bodies(rows):
    lines = [(r["particles"], r["form"], time_of(r), f"{float(r['ns']):.4f}") for r in rows.all(table="bodies")]
    return table(("particles", "form", "ms per step", "ns per particle and substep"), lines)


def small(rows):
    lines = []
    for r in rows.all(table="small", form="resident"):
        tiled = rows.one(table="small", form="tiled", environments=r["environments"], particles=r["particles"])
        if tiled:
            lines.append((r["particles"], r["environments"], time_of(r), time_of(tiled)))
    if not lines:
        return ()
    return (
        "## Smaller bodies\n",
        "Tissue alone, 4 substeps: where the [automatic form](../decisions/0034-few-environments-are-tiled.md) has its border.\n",
        table(("particles", "environments", "resident, ms per step", "tiled"), lines),
    )


def devices(rows):
    found = rows.all(table="devices")
    lines = []
    for r in found:
        alone = rows.one(table="devices", devices="1", gpu=r["gpu"])
        times = float(alone["ns"]) / float(r["ns"])
        lines.append((r["devices"], r["gpu"], r["environments"], time_of(r), f"{float(r['ns']):.4f}", f"{times:.2f}"))
    return table(("devices", "of kind", "environments", "ms per step", "ns per particle and substep", "times one"), lines)


def decisions(rows):
    lines = []
    for r in rows.all(table="decisions"):
        lines.append((r["environments"], time_of(r), f"{1e3 * float(r['environments']) / float(r['ms']):.0f}"))
    return table(("environments", "ms per decision of all", "decisions/s"), lines)


def threads(rows):
    lines = []
    for r in rows.all(table="threads"):
        beads = int(r["environments"]) * int(r["particles"]) * int(r["substeps"])
        lines.append((r["environments"], time_of(r), f"{1e-3 * beads / float(r['ms']):.1f}"))
    return table(("environments", "ms per step", "million bead substeps per second"), lines)


def note(axes, text, y):
    axes.axhline(y, color="black", linewidth=0.8, linestyle=":")
    where = {"xycoords": ("axes fraction", "data"), "textcoords": "offset points", "ha": "right"}
    axes.annotate(text, (0.98, y), xytext=(0, 3), **where)


def plot(rows, path):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.5), dpi=120)
    colours = {"tissue": "#888888", "apart": "#3b2a9a", "contact": "#b03a2e"}
    for form, style in (("resident", "-"), ("tiled", "--")):
        for contents, colour in colours.items():
            found = rows.all(table="environments", form=form, substeps="4", contents=contents)
            xs, ys = ([float(r[k]) for r in found] for k in ("environments", "ns"))
            left.loglog(xs, ys, style, color=colour, marker="o", markersize=3, label=f"{contents}, {form}")
    note(left, "best published", 1.7)
    left.set_xlabel("environments of 20,000 particles")
    left.set_ylabel("ns per particle and substep")
    left.legend(frameon=False, fontsize=8)
    found = rows.all(table="bodies")
    xs, ys = ([float(r[k]) for r in found] for k in ("particles", "ns"))
    right.loglog(xs, ys, "--", color=colours["apart"], marker="o", markersize=3, label="mpmpbd, tiled")
    note(right, "CRESSim-MPM, 4 million", 1.71)
    right.set_xlabel("particles of one body")
    right.legend(frameon=False, fontsize=8)
    for axes in (left, right):
        axes.grid(alpha=0.25, which="both")
    figure.suptitle(f"A substep on one {rows.rows[0]['gpu']}, float")
    figure.tight_layout()
    figure.savefig(path)


def commits(rows):
    """The commit of the first row, and those of tables that were measured at others."""
    first = rows.rows[0]["commit"]
    others = {}
    for row in rows.rows:
        if row["commit"] != first:
            others.setdefault(row["table"], set()).add(row["commit"])
    return first + "".join(f", `{table}` at {' and '.join(sorted(at))}" for table, at in sorted(others.items()))


def write(rows, out):
    one = rows.rows[0]
    parts = (
        "# Throughput on a CUDA device\n",
        f"{one['gpu']}, driver {one['driver']}, `-arch=sm_90 -O3 -fmad=false`, float with 32-bit fixed-point sums, commit {commits(rows)}. "
        "The suturing scene: 20,000 particles\non 26 x 16 x 16 nodes, arc needle, thread of 20 beads, surface, after 400 steps of the "
        "scripted stitch (the needle is in tissue). A step is 0.004 s.\nWall time from the host; mean and deviation of five blocks of 4 to "
        "20 steps. What moves: `tissue` alone; `apart`, needle and thread as well, which do\nnot meet it; `contact`, all of it.\n",
        "Again: `bench/device_throughput.py`, which writes this page, its [rows](device_throughput.csv) and its picture. What was tried "
        "and where time goes:\n[CUDA on an H200](device.md).\n",
        "![ns per particle and substep, by environments and by particles](device_throughput.png)\n",
        "## Ten environments on several streams\n",
        "Milliseconds per step of 2 substeps, in contact. Ten environments in one run are one launch (resident), or one row of launches: "
        "streams gain nothing.\n",
        streams(rows),
        "## Components\n",
        components(rows),
        "## Environments\n",
        f"Percentages, of resident rows: of the time that {BYTES} B per particle and substep take to be copied ("
        + ", ".join(f"{speed / 1e12:g} TB/s on an {name}" for name, speed in COPIES.items())
        + f"); that the fused loop's 108 additions\nand 27 loads take in shared memory ({SHARED_PIPE} ns at best); that its instructions take to be "
        f"issued ({ISSUE} ns).\n",
        environments(rows),
        "## Moved at random\n",
        "In contact: every 20 steps needles move otherwise, as fast as the hand of the step loop may, and in every step a hundredth of "
        "the environments,\ndrawn by lot, begins anew. Substeps are fixed, so that some needles are too fast for them.\n",
        moved(rows),
        "## One larger body\n",
        "4 substeps; needle and thread beside it.\n",
        bodies(rows),
        *small(rows),
        "## Several devices\n",
        "As many environments on each, 4 substeps, in contact, one thread of the host.\n",
        devices(rows),
        "## Decisions\n",
        "The step loop of the suturing task with 20,000 particles, 20 steps of 4 substeps a decision, observations of numbers; random "
        "actions.\n",
        decisions(rows),
        "## Threads without tissue\n",
        "Threads of 100 beads that stretch and bend (`Distance`, `Bend`, solved directly, 4 iterations), hung up at one end; steps of 0.002 s, 2 "
        "substeps.\n",
        threads(rows),
    )
    (out / "device_throughput.md").write_text("\n".join(parts))


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--program", default=ROOT / "build/release/bench/bench_device_throughput")
    arguments.add_argument("--rows", type=pathlib.Path)
    arguments.add_argument("--out", type=pathlib.Path, default=ROOT / "docs/results")
    words = arguments.parse_args()
    path = words.out / "device_throughput.csv"
    if words.rows is None:
        measure(words.program, path)
    elif words.rows.resolve() != path.resolve():
        path.write_text(words.rows.read_text())
    with path.open(newline="") as file:
        rows = Rows(list(csv.DictReader(file)))
    write(rows, words.out)
    try:
        plot(rows, words.out / "device_throughput.png")
    except ImportError:
        print("no matplotlib: no picture", file=sys.stderr)


if __name__ == "__main__":
    main()
