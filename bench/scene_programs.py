"""Programs of scenes, written as text and compiled by nvcc: what bench/effects_off.py and bench/precision.py measure."""
import subprocess

from published import ROOT

# Declarations of parts, and the headers of theirs.
TISSUE = "struct Tissue : Mpm<NeoHookean> {};"
THREAD = TISSUE + " struct Thread : Pbd<Constraints<Distance, Bend>> {};"
OF_TISSUE = ["mpm/materials/neo_hookean.hpp", "scene/scene.hpp"]
OF_THREAD = OF_TISSUE + ["pbd/body.hpp", "coupling/embedded.hpp"]
# What is set for a time to be taken.
SET_TISSUE = {"NeoHookean": "lame(5e5, 0.4)"}
SET_THREAD = SET_TISSUE | {"Embedded": "{0.006}"}
SET_GRAVITY = {"Gravity": "{{0.0, 0.0, -9.81}}"}


# declarations, parts of the scene, headers, parameters: as in the tables of scenes of those who call.
def source_of(declarations, parts, headers):
    return (
        "".join(f"#include <mpmpbd/{header}>\n" for header in ["backend/cuda/simulation.cuh"] + headers)
        + f"namespace mpmpbd::measured {{ {declarations} struct Measured : Scene<{parts}> {{}}; }}\n"
    )


def compile_scene(options, source, text, *how):
    source.write_text(text, encoding="utf-8")
    subprocess.run(
        [options.nvcc, "-std=c++20", "-O3", "-fmad=false", f"-arch=sm_{options.arch}", f"-I{ROOT / 'include'}", f"-I{ROOT / 'bench'}"]
        + [f"-I{folder}" for folder in options.include]
        + [*how, str(source)],
        check=True,
    )


def program(options, folder, declarations, parts, headers, parameters, prints="print_step_time"):
    """A program that prints what a step of the scene takes, or what else step_of_scene.hpp can print."""
    path = folder / "time"
    text = "#include \"step_of_scene.hpp\"\n" + source_of(declarations, parts, headers)
    text += "int main(int argc, char** argv) {\n  using namespace mpmpbd;\n"
    text += f"  return measured::{prints}<measured::Measured>(argc, argv, [](auto& run) {{\n"
    text += "".join(f"    run.template set<{name}>(0, {value});\n" for name, value in parameters.items())
    compile_scene(options, folder / "time.cu", text + "  });\n}\n", "-o", str(path))
    return path


def run(path):
    return subprocess.run([str(path)], check=True, capture_output=True, text=True).stdout


def add_compiler(parser):
    """The options that compile_scene reads, and where results go."""
    parser.add_argument("--arch", default="90")
    parser.add_argument("--nvcc", default="nvcc")
    parser.add_argument("--include", action="append", default=["/usr/include/eigen3"])
    parser.add_argument("--out", default=str(ROOT / "docs" / "results"))
