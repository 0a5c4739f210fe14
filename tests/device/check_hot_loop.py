#!/usr/bin/env python3
"""Checks the machine code of the loops in which a resident step moves particles, without a GPU.

Usage: check_hot_loop.py CUOBJDUMP LIBRARY NODES

LIBRARY: an object or archive with one `step` kernel per architecture; NODES: those of a stencil, 27 for quadratic
splines. A loop that gathers loads a node's velocity from shared memory, one that scatters adds four integers to it.
The loops are the smallest that do so; it is one loop where the grid holds velocities beside the sums. Fails when
  - a kernel has no such loop
  - a loop spills: it stores to local memory, or loads more than a few words that were stored there before it
  - they take more instructions together than they should, which is how most mistakes show first
"""
import re
import subprocess
import sys
from collections import Counter

INSTRUCTION = re.compile(r"/\*([0-9a-f]{4,6})\*/\s+(?:@!?U?P\w+\s+)?([A-Z][A-Z0-9_.]*)([^;]*);")
STEP = "4cuda4stepI"  # cuda::step<...>, mangled
MOST_KEPT_WORDS = 8
INSTRUCTIONS_PER_NODE = 60


def kernels(listing):
    """The instructions (address, name, operands) of every resident step."""
    for part in listing.split("Function : ")[1:]:
        name, _, body = part.partition("\n")
        if STEP in name:
            yield name, [(int(at, 16), what, of) for at, what, of in INSTRUCTION.findall(body)]


def loops(code):
    """What is between a branch back and where it leads, the shortest first."""
    place = {at: i for i, (at, _, _) in enumerate(code)}
    found = []
    for i, (at, what, of) in enumerate(code):
        to = re.search(r"0x([0-9a-f]+)", of) if what.startswith("BRA") else None
        if to and int(to[1], 16) <= at and int(to[1], 16) in place:
            found.append((place[int(to[1], 16)], i + 1))
    return sorted(found, key=lambda loop: loop[1] - loop[0])


def names(code):
    return Counter(what.split(".")[0] for _, what, _ in code)


def particle_loops(code, nodes):
    """Where the loops that gather and that scatter begin and end, once each; fewer if there is none."""
    def smallest(does):
        return next(([loop] for loop in loops(code) if does(names(code[loop[0]:loop[1]]))), [])

    scatters = smallest(lambda count: count["ATOMS"] >= 4 * nodes)
    gathers = smallest(lambda count: count["LDS"] >= nodes and count["STG"] >= 12)
    return sorted({*gathers, *scatters}) if gathers and scatters else []


def complaints(name, code, nodes):
    found = particle_loops(code, nodes)
    if not found:
        yield f"{name} has no loops that gather from {nodes} nodes and scatter to as many"
        return
    for first, end in found:
        count = names(code[first:end])
        print(f"{end - first} instructions, {count['STL']} stores to and {count['LDL']} loads from local memory: {name}")
        if count["STL"] > 0 or count["LDL"] > MOST_KEPT_WORDS:
            yield f"{name} spills in a loop over particles"
    taken = sum(end - first for first, end in found)
    if taken > INSTRUCTIONS_PER_NODE * nodes:
        yield f"{name} takes {taken} instructions; {INSTRUCTIONS_PER_NODE * nodes} at most"


def main():
    cuobjdump, library, nodes = sys.argv[1], sys.argv[2], int(sys.argv[3])
    listing = subprocess.run([cuobjdump, "-sass", library], check=True, capture_output=True, text=True).stdout
    found = list(kernels(listing))
    wrong = [sentence for name, code in found for sentence in complaints(name, code, nodes)]
    if not found:
        wrong = [f"{library} has no resident step"]
    for sentence in wrong:
        print(f"FAIL: {sentence}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
