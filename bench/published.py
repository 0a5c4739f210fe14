"""What a page of docs/results says of where its figures are from, and its tables."""
import pathlib
import re
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent


def gpus():
    """Of each GPU: its name and the driver's version."""
    query = ["nvidia-smi", "--query-gpu=name,driver_version", "--format=csv,noheader"]
    lines = subprocess.run(query, check=True, capture_output=True, text=True).stdout.splitlines()
    return [tuple(line.split(", ")) for line in lines]


def commit():
    """That of the sources; `unknown` where they are no repository, `-dirty` where they are not as they were committed."""
    query = ["git", "-C", str(ROOT), "describe", "--always", "--dirty"]
    return subprocess.run(query, capture_output=True, text=True).stdout.strip() or "unknown"


def version_of(nvcc):
    text = subprocess.run([nvcc, "--version"], check=True, capture_output=True, text=True).stdout
    return re.search(r"V([\d.]+)", text)[1]


def table(head, lines):
    out = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(out + ["| " + " | ".join(map(str, line)) + " |" for line in lines]) + "\n"
