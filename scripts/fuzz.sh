#!/usr/bin/env bash
# Feeds the readers of files with what libFuzzer makes of valid and broken ones.
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

usage() {
  cat <<'TEXT'
Usage: scripts/fuzz.sh SECONDS [NAME...]

Builds the fuzzers of tests/fuzz (clang, address and undefined-behaviour sanitizers) and runs each, or
those named (scene_file), for so many seconds. A finding ends its run with exit status 1; the input is
kept in build/fuzz-findings. What is worth keeping joins tests/fuzz/corpus and gets a test.
TEXT
}

[[ ${1:-} =~ ^[0-9]+$ ]] || { usage >&2 && die "give the seconds per fuzzer"; }
seconds=$1
shift
cd "$root"
names=("$@")
((${#names[@]})) || mapfile -t names < <(basename -s .cpp tests/fuzz/*.cpp)

build=$build_root/fuzz
findings=$build_root/fuzz-findings
mkdir -p "$findings"
cmake --preset fuzz -B "$build" >"$findings/configure.log" || die "see $findings/configure.log"
step "build" cmake --build "$build" -j "$jobs" --target "${names[@]/#/fuzz_}"

# The readers read files: in memory that goes ten times as fast.
[[ ! -w /dev/shm ]] || export TMPDIR=/dev/shm

# Words of the seeds: no mutation finds a key.
words() { grep -ahoE '[[:alnum:]_]{4,40}' "$@" | sort -u | sed 's/.*/"&"/'; }

for name in "${names[@]}"; do
  seeds=("tests/fuzz/corpus/$name")
  [[ $name != scene_file ]] || seeds+=(examples/scenes)
  grown=$build/corpus/$name
  mkdir -p "$grown"
  words -r "${seeds[@]}" >"$build/$name.dict"
  step "$name" "$build/tests/fuzz/fuzz_$name" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=2048 \
    -max_len=8192 -print_final_stats=1 -verbosity=0 -dict="$build/$name.dict" \
    -artifact_prefix="$findings/$name-" "$grown" "${seeds[@]}"
done
