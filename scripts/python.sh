#!/usr/bin/env bash
# Sets up, builds the Python module and runs a step loop with it, or a program of yours.
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

usage() {
  cat <<'TEXT'
Usage: [PYTHON=/path/to/python] scripts/python.sh [--cuda] [FILE ARGUMENT...]

  --cuda   a module that has step loops on CUDA devices, too; without FILE the step loop is on a GPU, and needs PyTorch
  PYTHON   for this Python instead of Debian's: one that has NumPy and what FILE imports
  FILE     the program to run, in the folder you are in (examples/11_step_loop.py)
TEXT
}

cuda=no
case ${1:-} in
  --cuda) cuda=yes && shift ;;
  -h | --help) usage && exit ;;
  -*) usage >&2 && die "unknown option '$1'" ;;
esac
python=
if [[ -n ${PYTHON:-} ]]; then
  python=$(command -v "$PYTHON") || die "PYTHON = '$PYTHON': there is no such program"
  python=$(cd "$(dirname "$python")" && pwd)/$(basename "$python")
  "$python" -c 'import numpy' || die "PYTHON = '$PYTHON' has no NumPy; install it there"
fi
here=$PWD
cd "$root"

if [[ $cuda == yes ]]; then
  build=$build_root/python-cuda
  (($#)) || set -- "$root/examples/11_step_loop.py" --device cuda
  step "set-up" scripts/setup.sh python
  CUDACXX=$(find_nvcc)
  [[ -n $CUDACXX ]] || die "--cuda needs nvcc >= $cuda_minimum, and there is none"
  export CUDACXX
  options=(-DMPMPBD_CUDA=ON -DMPMPBD_CATALOG_CUDA_ALL=OFF "-DCMAKE_CUDA_ARCHITECTURES=$(gpu_architectures)")
else
  build=$build_root/python
  (($#)) || set -- "$root/examples/11_step_loop.py"
  step "set-up" scripts/setup.sh python --no-cuda
  options=(-DMPMPBD_CUDA=OFF)
fi
[[ -n $python ]] || python=$(python_of_module)
step "configure" cmake --preset release -B "$build" -DMPMPBD_PYTHON=ON "-DPython_EXECUTABLE=$python" \
  "${options[@]}" -DMPMPBD_TESTS=OFF -DMPMPBD_BENCH=OFF -DMPMPBD_EXAMPLES=OFF
step "build" cmake --build "$build" -j "$jobs" --target mpmpbd_python
export OMP_WAIT_POLICY=${OMP_WAIT_POLICY:-passive}

say "PYTHONPATH=$build/python $python $*"
cd "$here"
PYTHONPATH=$build/python exec "$python" "$@"
