#!/usr/bin/env bash
# Sets up, builds the Python module and runs a step loop with it, or a program of yours: scripts/python.sh FILE ARGUMENTS...
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
cd "$root"

build=$build_root/python
(($#)) || set -- examples/11_step_loop.py

step "set-up" scripts/setup.sh python --no-cuda
python=$(python_of_module)
step "configure" cmake --preset release -B "$build" -DMPMPBD_PYTHON=ON "-DPython_EXECUTABLE=$python" \
  -DMPMPBD_CUDA=OFF -DMPMPBD_TESTS=OFF -DMPMPBD_BENCH=OFF -DMPMPBD_EXAMPLES=OFF
step "build" cmake --build "$build" -j "$jobs" --target mpmpbd_python
export OMP_WAIT_POLICY=${OMP_WAIT_POLICY:-passive}

say "PYTHONPATH=$build/python $python $*"
PYTHONPATH=$build/python exec "$python" "$@"
