#!/usr/bin/env python3
"""Checks the machine code of the loop in which a resident step spends its time, without a GPU.

Usage: check_hot_loop.py CUOBJDUMP LIBRARY NODES

LIBRARY: an object or archive with one `step` kernel per architecture; NODES: those of a stencil, 27 for quadratic
splines. The loop is the smallest that gathers from a stencil and scatters to one: a load of four numbers and four
additions of integers per node, in shared memory. Fails when
  - a kernel has no such loop
  - the loop spills: it stores to local memory, or loads more than a few words that were stored there before it
  - it takes more instructions than it should, which is how most mistakes show first
"""
import re
import subprocess
import sys
from collections import Counter

INSTRUCTION = re.compile(r"/\*([0-9a-f]{4,6})\*/\s+(?:@!?U?P\w+\s+)?([A-Z][A-Z0-9_.]*)([^;]*);")
MOST_KEPT_WORDS = 2
INSTRUCTIONS_PER_NODE = 57
STEP = "4cuda4stepI"  # cuda::step<...>, mangled


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


def particle_loop(code, nodes):
    """Where the loop over particles begins and ends; None if there is none."""
    for first, end in loops(code):
        count = names(code[first:end])
        if count["ATOMS"] >= 4 * nodes and count["LDS"] >= nodes:
            return first, end
    return None


def complaints(name, code, nodes):
    loop = particle_loop(code, nodes)
    if loop is None:
        yield f"{name} has no loop that gathers from {nodes} nodes and scatters to as many"
        return
    first, end = loop
    count = names(code[first:end])
    print(f"{end - first} instructions, {count['STL']} stores to and {count['LDL']} loads from local memory: {name}")
    if count["STL"] > 0 or count["LDL"] > MOST_KEPT_WORDS:
        yield f"{name} spills in its loop"
    if end - first > INSTRUCTIONS_PER_NODE * nodes:
        yield f"{name} takes {end - first} instructions; {INSTRUCTIONS_PER_NODE * nodes} at most"


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
