#!/usr/bin/env python3
"""Shows what a file of recorded episodes holds (examples/10_record.cpp); needs python3-h5py."""

import sys

import h5py

with h5py.File(sys.argv[1]) as file:
    data = file["data"]
    print(f"{len(data)} episodes, {data.attrs['total']} decisions, made by {data.attrs['env_args']}")
    for name, demo in data.items():
        print(f"{name}: {demo.attrs['num_samples']} decisions, return {demo['rewards'][()].sum():.2f}")
    demo = data["demo_0"]
    print(f"arrays of demo_0: actions {demo['actions'].shape}, rewards {demo['rewards'].shape}")
    for group, array in demo["obs"].items():
        print(f"  obs/{group}: {array.shape} {array.dtype}")
