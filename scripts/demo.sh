#!/usr/bin/env bash
# Sets up, builds and runs the stitch: a needle drives a thread through soft tissue.
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
cd "$root"

compgen -G 'examples/[0-9][0-9]_stitch.cpp' >/dev/null ||
  die "the demo is not built yet: there is no examples/NN_stitch.cpp in this version"

build=$build_root/demo
step "set-up" scripts/setup.sh demo --no-cuda
step "configure" cmake --preset release -B "$build" \
  -DMPMPBD_CUDA=OFF -DMPMPBD_TESTS=OFF -DMPMPBD_BENCH=OFF
step "build" cmake --build "$build" -j "$jobs" --target stitch
exec "$build/examples/stitch" --preset "${1:-paper}" --out "$root/out/${1:-paper}"
