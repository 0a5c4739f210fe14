#!/usr/bin/env python3
"""Checks what a compiler made of the kernels of a library, without a GPU.

Usage: check_kernels.py CUOBJDUMP LIBRARY NODES

LIBRARY: an object or archive that holds PTX; NODES: those of a stencil, 27 for quadratic splines. Fails when
  - a kernel is empty, or it or a function it calls traps: nvcc has made both of code it did not like, with exit status 0
  - a kernel is no more than a call, or a tiled environment's that couples has no more than 128 registers: it then spills
  - anything adds floating-point numbers atomically: its order would show in the bits
  - a sum or a product of floating-point numbers may be joined with another (it does not say how it rounds): a compiler
    without -fmad=false does that by what is around, and so differently from kernel to kernel
  - in the kernel of a form of execution, the fused pass and the last gather do not load a node's velocity and mass at
    once, or the passes that scatter do not add four integers per node: then grid or loop has lost its place in shared
    memory (resident), in the memory of the device (tiled, whose sums go there by way of shared memory or straight), or in
    registers
"""
import re
import subprocess
import sys

FLOAT_ATOMIC = re.compile(r"^\s*(?:@!?%p\d+\s+)?((?:atom|red)\.\S*\.(?:f16|f32|f64|bf16)\S*)", re.M)
JOINABLE = re.compile(r"^\s*(?:@!?%p\d+\s+)?((?:add|sub|mul|mad)(?:\.ftz)?(?:\.sat)?\.(?:f32|f64))\b", re.M)
# Kernels that move particles: where the grid lies, and where its sums are added up.
FORMS = {"step": ("shared", ["shared"]), "tiled_particles": ("global", ["shared", "global"])}
ADD = r"\b(?:atom|red)\.{}\.add\.(?:u32|s32)"
QUAD = r"\bld\.{}\.v4\.(?:f32|b32|u32)"
DEFINITION = re.compile(
    r"^(?:\.(?:visible|weak) )?\.(entry|func) (?:\(.*?\) )?(\w+)(.*?)(?=^\.(?:visible|weak|func|entry|version)|\Z)", re.M | re.S)
CALL = re.compile(r"\bcall(?:\.uni)?\s+(?:\([^)]*\),\s*)?(\w+)")
INSTRUCTION = re.compile(r"^\s*(?:@!?%p\d+\s+)?[a-z][a-z0-9_.:]*\s*.*;", re.M)


def with_what_it_calls(body, functions):
    """The text of a kernel and of all functions that it reaches, each once."""
    called, texts = set(), [body]
    for text in texts:  # grows
        for name in set(CALL.findall(text)) - called:
            called.add(name)
            texts.append(functions.get(name, ""))
    return "".join(texts)


def complaints(text, nodes):
    kernels = []  # of every architecture, and of every source that has them, with the functions beside them
    for module in re.split(r"^\.version ", text, flags=re.M):
        defined = [found for found in DEFINITION.findall(module) if "{" in found[2]]
        functions = {name: body for kind, name, body in defined if kind == "func"}
        kernels += [(name, body, functions) for kind, name, body in defined if kind == "entry"]
    if not kernels:
        yield "there is no kernel"
    for name, body, functions in kernels:
        whole = with_what_it_calls(body, functions)
        own, count = len(INSTRUCTION.findall(body)), len(INSTRUCTION.findall(whole))
        print(f"{name}: {count} instructions, {own} of them its own")
        if count < 20:
            yield f"{name} is empty: {count} instructions"
        elif own < 20:
            yield f"{name} is no more than a call"
        if re.search(r"\btrap;", whole):
            yield f"{name} traps"
    for atomic in FLOAT_ATOMIC.findall(text):
        yield f"an atomic floating-point operation: {atomic}"
    joinable = JOINABLE.findall(text)
    if joinable:
        yield f"{len(joinable)} operations that may be joined with others, {joinable[0]} for one"
    passes = 2
    for kernel, (grid, sums) in FORMS.items():
        bodies = [body for name, body, _ in kernels if f"{len(kernel)}{kernel}I" in name]
        if not bodies:
            yield f"there is no kernel {kernel}"
        wanted = [(f"additions of integers in {memory} memory", ADD.format(memory), passes * 4 * nodes) for memory in sums]
        wanted.append((f"loads of four numbers from {grid} memory", QUAD.format(grid), passes * nodes))
        for body in bodies:
            for what, pattern, least in wanted:
                found = len(re.findall(pattern, body))
                print(f"{kernel}: {what}: {found}, at least {least}")
                if found < least:
                    yield f"{kernel}: {found} {what}; {least} expected"


def too_few_registers(usage):
    used = re.findall(r"Function (\S*17tiled_environment\S*Coupling\S*):\s+REG:(\d+)", usage)
    if not used:
        yield "there is no kernel of a tiled environment that couples"
    for name, registers in used:
        if int(registers) <= 128:
            yield f"{name} has {registers} registers; more than 128 expected"


def main():
    cuobjdump, library, nodes = sys.argv[1], sys.argv[2], int(sys.argv[3])

    def read(what):
        return subprocess.run([cuobjdump, what, library], check=True, capture_output=True, text=True).stdout

    wrong = [*complaints(read("-ptx"), nodes), *too_few_registers(read("-res-usage"))]
    for sentence in wrong:
        print(f"FAIL: {sentence}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
