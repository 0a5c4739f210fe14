#!/usr/bin/env python3
"""11. A step loop in Python: needles that go straight for their marker, in many environments at once.

scripts/python.sh builds the module and runs this. With --device cuda environments and policy are on a GPU, and the arrays
are PyTorch's (scripts/python.sh --cuda).
"""

import argparse
import pathlib
import sys
import time

import numpy as np

import mpmpbd

SCENES = pathlib.Path(__file__).resolve().parent / "scenes"


def way_to_entry(observations):
    tip_and_markers = observations["tip_and_markers"][:, -1]
    return tip_and_markers[:, 3:6] - tip_and_markers[:, 0:3]


def towards_entry(observations, xp):
    """Actions (num_envs, 3): the arc centre moves as its tip should, along x and z; the needle does not turn."""
    way = way_to_entry(observations)
    return xp.clip(20.0 * xp.stack([way[:, 0], way[:, 2], 0.0 * way[:, 0]], axis=1), -1.0, 1.0)


def distance(observations):
    return float(((way_to_entry(observations) ** 2).sum(axis=1) ** 0.5).mean())


def library(device):
    """Of arrays that lie there, and what it makes them from."""
    if device == "cpu":
        return np, np.asarray
    import torch

    return torch, torch.from_dlpack


def check(holds, what):
    print("ok    " if holds else "FAILED", what)
    return holds


def main():
    options = argparse.ArgumentParser(description="Needles that go straight for their marker.")
    options.add_argument("--num-envs", type=int, default=8)
    options.add_argument("--decisions", type=int, default=20)
    options.add_argument("--seed", type=int, help="without it: that of the settings")
    options.add_argument("--threads", type=int, default=0, help="0: as many as there are cores")
    options.add_argument("--device", default="cpu", help="cpu, cuda, cuda:1 and so on")
    run = options.parse_args()
    xp, as_array = library(run.device)

    env = mpmpbd.SuturingVectorEnv(
        run.num_envs,
        config=[SCENES / "coarse.toml", SCENES / "suturing_task.toml"],
        seed=run.seed,
        threads=run.threads,
        device=run.device,
        as_array=as_array,
    )
    observations, info = env.reset()
    seen = observations["tip_and_markers"]
    first, paid = distance(observations), 0.0
    began = time.monotonic()
    for _ in range(run.decisions):
        observations, reward, terminated, truncated, info = env.step(towards_entry(observations, xp))
        paid = paid + reward
        if terminated.any() or truncated.any():
            break
    decisions = int(info["episode_length"].sum())  # waits for a device
    seconds = time.monotonic() - began

    print(f"{decisions} decisions, {decisions / seconds:.1f} a second, {float(paid.mean()):.2f} paid on average")
    near = check(distance(observations) < first, f"the tips came closer than {first:.3f} m")
    kept = check(observations["tip_and_markers"] is seen, "no array was copied")
    return 0 if near and kept else 1


if __name__ == "__main__":
    sys.exit(main())
