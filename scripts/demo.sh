#!/usr/bin/env bash
# Sets up, builds and runs the stitch: a needle drives a thread through soft tissue.
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
cd "$root"

preset=${1:-paper}
case $preset in
  paper | phantom) ;;
  *)
    echo "Usage: scripts/demo.sh [paper|phantom]" >&2
    die "unknown preset '$preset'"
    ;;
esac
build=$build_root/demo
out=$root/out/$preset

step "set-up" scripts/setup.sh demo --no-cuda
step "configure" cmake --preset release -B "$build" \
  -DMPMPBD_CUDA=OFF -DMPMPBD_TESTS=OFF -DMPMPBD_BENCH=OFF
step "build" cmake --build "$build" -j "$jobs" --target stitch
stitch=$build/examples/stitch
# Threads that wait sleep: where the cores are shared, spinning took three times as long.
export OMP_WAIT_POLICY=${OMP_WAIT_POLICY:-passive}

# The first steps of a run tell how long all of it takes: 2500 steps, and 200 frames at half a second.
if [[ $preset == phantom ]]; then
  begin=$(date +%s%N)
  "$stitch" --preset phantom --steps 40 --no-video --unfinished --out "$build/estimate" >/dev/null 2>&1
  seconds=$((2500 * ($(date +%s%N) - begin) / 40 / 1000000000 + 200 / 2))
  say "preset phantom takes about $((seconds / 60 + 1)) minutes on this machine"
fi

status=0
rm -f "$out/summary.json"  # what is plotted is of this run
step "stitch" "$stitch" --preset "$preset" --out "$out" || status=$?
if [[ -f $out/summary.json ]]; then
  step "plot" "$(python_with_matplotlib)" scripts/plot_force_depth.py "$out" || status=1
fi
say "picture  $out/stitch.png"
say "video    $out/stitch.mp4 and $out/stitch_small.mp4"
say "plot     $out/force_depth.png"
say "summary  $out/summary.json"
say "ParaView $out/stitch.pvd"
exit "$status"
