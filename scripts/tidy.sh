#!/usr/bin/env bash
# clang-tidy over every header and the programs that use them; --tests adds the tests (ten minutes).
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
cd "$root"

folders=(src examples bench)
case ${1:-} in
  '') ;;
  --tests) folders+=(tests) ;;
  *) die "usage: scripts/tidy.sh [--tests]" ;;
esac

# One source that includes every header: templates are read, and each header is read once.
mkdir -p "$build_root"
all=$build_root/all_headers.cpp
(cd include && find mpmpbd -name '*.hpp' | sort | sed 's/.*/#include <&>/') >"$all"

# What must not compile, and projects that are no part of this tree, are left out.
sources=("$all")
while IFS= read -r source; do
  sources+=("$source")
done < <(find "${folders[@]}" -name '*.cpp' -not -path '*/fail/*' -not -path '*/package/*' | sort)

# Flags by hand, not from a build: g++ builds hold options that clang-tidy does not know.
printf '%s\0' "${sources[@]}" |
  xargs -0 -n 1 -P "$jobs" sh -c 'exec clang-tidy --quiet --config-file=.clang-tidy "$1" -- \
    -std=c++20 -fopenmp -Iinclude -Itests -isystem /usr/include/eigen3 -isystem /usr/include/hdf5/serial 2>/dev/null' sh
