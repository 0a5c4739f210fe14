#!/usr/bin/env python3
"""11. A step loop in Python: needles that go straight for their marker, in many environments at once.

scripts/python.sh builds the module and runs this.
"""

import argparse
import pathlib
import sys
import time

import numpy as np

import mpmpbd

SCENES = pathlib.Path(__file__).resolve().parent / "scenes"


def towards_entry(observations):
    """Actions (num_envs, 3): the arc centre moves as its tip should, along x and z; the needle does not turn."""
    tip_and_markers = observations["tip_and_markers"][:, -1]
    way = tip_and_markers[:, 3:6] - tip_and_markers[:, 0:3]
    return np.clip(20.0 * np.stack([way[:, 0], way[:, 2], 0.0 * way[:, 0]], axis=1), -1.0, 1.0)


def distance(observations):
    tip_and_markers = observations["tip_and_markers"][:, -1]
    return float(np.linalg.norm(tip_and_markers[:, 3:6] - tip_and_markers[:, 0:3], axis=1).mean())


def check(holds, what):
    print("ok    " if holds else "FAILED", what)
    return holds


def main():
    options = argparse.ArgumentParser(description="Needles that go straight for their marker.")
    options.add_argument("--num-envs", type=int, default=8)
    options.add_argument("--decisions", type=int, default=20)
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--threads", type=int, default=0, help="0: as many as there are cores")
    run = options.parse_args()

    env = mpmpbd.SuturingVectorEnv(
        run.num_envs,
        config=[SCENES / "coarse.toml", SCENES / "suturing_task.toml"],
        seed=run.seed,
        threads=run.threads,
    )
    observations, info = env.reset()
    seen = observations["tip_and_markers"]
    first, paid = distance(observations), np.zeros(run.num_envs)
    began = time.monotonic()
    for _ in range(run.decisions):
        observations, reward, terminated, truncated, info = env.step(towards_entry(observations))
        paid += reward
        if terminated.any() or truncated.any():
            break
    seconds = time.monotonic() - began

    decisions = int(info["episode_length"].sum())
    print(f"{decisions} decisions, {decisions / seconds:.1f} a second, {paid.mean():.2f} paid on average")
    near = check(distance(observations) < first, f"the tips came closer than {first:.3f} m")
    kept = check(observations["tip_and_markers"] is seen, "no array was copied")
    return 0 if near and kept else 1


if __name__ == "__main__":
    sys.exit(main())
