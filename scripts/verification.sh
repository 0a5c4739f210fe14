#!/usr/bin/env bash
# Sets up, builds, runs the verification suites and writes docs/results/verification.md (half an hour on 2 cores).
#
#   --long          the tier `long` too (hours)
#   --cost          instead: error against wall time of every policy, docs/results/work_precision.*
#   --independent   instead: rows again by other computations, docs/results/independent.md
#
# Other arguments go to bench/verification.py.
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
cd "$root"

build=$build_root/release
results=docs/results
origin="$(git rev-parse --short HEAD 2>/dev/null || echo 'no commit'), $(date +%F), $(uname -m), $jobs cores"

set_up() { # PURPOSE TARGET...
  step "set-up" scripts/setup.sh "$1" --no-cuda
  step "configure" cmake --preset release -B "$build" -DMPMPBD_CUDA=OFF
  step "build" cmake --build "$build" -j "$jobs" --target "${@:2}"
}

case ${1:-} in
  -h | --help) sed -n '2,8s/^# \{0,1\}//p' "$0" ;;
  --cost)
    set_up demo bench_work_precision
    step "measure" "$build/bench/bench_work_precision" "$results/work_precision.csv"
    step "draw" "$(python_with_matplotlib)" bench/plot_work_precision.py \
      "$results/work_precision.csv" docs/images/work_precision.png "$results/work_precision.md" "$origin"
    ;;
  --independent)
    set_up test bench_independent
    {
      printf '# Independent computations\n\n'
      printf 'Rows of the verification again, by computations that share no line with library and tests: matrices by\n'
      printf 'Eigen, threads and pendulums as ordinary differential equations, a bar by finite elements.\n'
      printf 'Written by `scripts/verification.sh --independent` at %s.\n\n' "$origin"
      "$build/bench/bench_independent"
    } | tee "$results/independent.md"
    ;;
  *)
    targets=(mpmpbd_unit mpmpbd_physics)
    [[ " $* " != *" --long "* ]] || targets+=(mpmpbd_long)
    set_up test "${targets[@]}"
    step "verify" python3 bench/verification.py "$build" "$results" "$@"
    ;;
esac
