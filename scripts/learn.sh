#!/usr/bin/env bash
# Sets up, builds, and learns to bring the needle in: policies are searched without derivatives (10 to 15 minutes on 2 cores).
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
here=$PWD  # what paths among the arguments begin at
cd "$root"

build=$build_root/demo
out=$root/out/learn_insertion

rm -f "$out/learning.csv"  # what is plotted is of this run
step "set-up" scripts/setup.sh demo --no-cuda
step "configure" cmake --preset release -B "$build" \
  -DMPMPBD_CUDA=OFF -DMPMPBD_TESTS=OFF -DMPMPBD_BENCH=OFF
step "build" cmake --build "$build" -j "$jobs" --target learn_insertion
export OMP_WAIT_POLICY=${OMP_WAIT_POLICY:-passive}

status=0
step "learn" env -C "$here" "$build/examples/learn_insertion" --out "$out" "$@" || status=$?
if [[ -f $out/learning.csv ]]; then
  step "plot" "$(python_with_matplotlib)" scripts/plot_learning.py "$out" || status=1
fi
say "curve    $out/learning.png and $out/learning.csv"
exit "$status"
