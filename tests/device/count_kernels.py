#!/usr/bin/env python3
"""Counts the kernels that a build has compiled: every one takes CI the better part of a minute, for each architecture.

Usage: count_kernels.py CUOBJDUMP MOST BINARY...

Fails when the binaries hold more than MOST kernels of different names. A name that several of them hold (from the catalogue that
they link) counts once.
"""
import re
import subprocess
import sys


def kernels(cuobjdump, binary):
    text = subprocess.run([cuobjdump, "-res-usage", binary], check=True, capture_output=True, text=True).stdout
    return set(re.findall(r"Function (\S+):", text))


def main():
    cuobjdump, most, *binaries = sys.argv[1:]
    found = set().union(*(kernels(cuobjdump, binary) for binary in binaries))
    for name in sorted(found):
        print(name[:120])
    print(f"{len(found)} kernels, {most} allowed")
    return 0 if 0 < len(found) <= int(most) else 1


if __name__ == "__main__":
    sys.exit(main())
