#!/usr/bin/env python3
"""Writes covering_array_rows.hpp: at most 24 scenes in which each pair of policies that composes meets.

Run it again after adding a policy to one of the lists; the same lists give the same file.
"""
import itertools
import pathlib
import random

DIMENSIONS = {
    "material": ["NeoHookean", "StableNeoHookean", "FixedCorotated", "StVenantKirchhoff",
                 "FibreReinforced<>", "WeaklyCompressibleFluid"],
    "effects": ["Free", "Falls", "Hangs", "Relaxes"],
    "transfer": ["Apic", "Tpic", "Flip", "Pic"],
    "shape": ["QuadraticBSpline", "CubicBSpline", "LinearBSpline"],
    "form": ["Mls", "WeightGradient"],
    "scalar": ["double", "float"],
    "back_end": ["Serial", "Threads"],
}
# Pairs that the library refuses or that mean nothing.
EXCLUDED = [
    {"shape": "LinearBSpline", "form": "Mls"},
    {"shape": "LinearBSpline", "transfer": "Tpic"},
    {"effects": "Falls", "transfer": "Flip"},  # Falls has viscosity, which needs an affine transfer
    {"effects": "Falls", "transfer": "Pic"},
]
MOST = 24
NAMES = list(DIMENSIONS)


def composes(row):
    return not any(all(row[k] == v for k, v in bad.items()) for bad in EXCLUDED)


def pairs_of(row):
    return {((a, row[a]), (b, row[b])) for a, b in itertools.combinations(NAMES, 2)}


def wanted_pairs(rows):
    return set().union(*(pairs_of(r) for r in rows))


def search():
    every = [dict(zip(NAMES, v)) for v in itertools.product(*DIMENSIONS.values())]
    every = [r for r in every if composes(r)]
    wanted = wanted_pairs(every)
    by_head = {}
    for r in every:
        by_head.setdefault((r["material"], r["effects"]), []).append(r)
    rng = random.Random(1)
    best = None
    for _ in range(200):
        rows = [rng.choice(c) for c in by_head.values()]  # each material with each effect set
        for _ in range(40):
            changed = False
            for n in rng.sample(range(len(rows)), len(rows)):
                others = wanted_pairs(rows[:n] + rows[n + 1:])
                options = by_head[(rows[n]["material"], rows[n]["effects"])]
                gain = lambda r: len(pairs_of(r) - others)
                most = max(map(gain, options))
                choice = rng.choice([r for r in options if gain(r) == most])
                changed |= choice != rows[n]
                rows[n] = choice
            if wanted_pairs(rows) == wanted:
                return rows, wanted
        if best is None or len(wanted_pairs(rows)) > best:
            best = len(wanted_pairs(rows))
    raise SystemExit(f"{best} of {len(wanted)} pairs: {MOST} scenes are not enough")


def main():
    rows, wanted = search()
    assert len(rows) <= MOST
    text = ["// Written by covering_array.py: %d scenes, %d pairs of policies, each at least once."
            % (len(rows), len(wanted)), "#pragma once", "",
            "inline constexpr int covered_pairs = %d;" % len(wanted), ""]
    for part in range(4):
        mine = rows[part::4]
        text.append("using Rows%d = TypeList<" % part)
        text.append(",\n".join("    Row<" + ", ".join(r[n] for n in NAMES) + ">" for r in mine) + ">;")
    path = pathlib.Path(__file__).with_name("covering_array_rows.hpp")
    path.write_text("\n".join(text) + "\n")
    print(f"{path.name}: {len(rows)} scenes, {len(wanted)} pairs")


if __name__ == "__main__":
    main()
