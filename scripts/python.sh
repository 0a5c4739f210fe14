#!/usr/bin/env bash
# Sets up, builds the Python module and runs a step loop with it, or a program of yours: scripts/python.sh [--cuda] FILE ARGUMENTS...
# With --cuda the module has step loops on CUDA devices too. PYTHON=/path/to/python names another Python than Debian's.
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
cd "$root"

build=$build_root/python
cuda=(-DMPMPBD_CUDA=OFF)
if [[ ${1:-} == --cuda ]]; then
  shift
  step "set-up" scripts/setup.sh python
  CUDACXX=$(find_nvcc)
  [[ -n $CUDACXX ]] || die "--cuda needs nvcc >= $cuda_minimum, and there is none"
  export CUDACXX
  cuda=(-DMPMPBD_CUDA=ON "-DCMAKE_CUDA_ARCHITECTURES=$(gpu_architecture)")
else
  step "set-up" scripts/setup.sh python --no-cuda
fi
(($#)) || set -- examples/11_step_loop.py

python=$(python_of_module)
step "configure" cmake --preset release -B "$build" -DMPMPBD_PYTHON=ON "-DPython_EXECUTABLE=$python" \
  "${cuda[@]}" -DMPMPBD_TESTS=OFF -DMPMPBD_BENCH=OFF -DMPMPBD_EXAMPLES=OFF
step "build" cmake --build "$build" -j "$jobs" --target mpmpbd_python
export OMP_WAIT_POLICY=${OMP_WAIT_POLICY:-passive}

say "PYTHONPATH=$build/python $python $*"
PYTHONPATH=$build/python exec "$python" "$@"
