#!/usr/bin/env bash
# clang-tidy over every header, and over the sources that are named.
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
cd "$root"

# One source that includes every header: templates are read, and each header is read once.
mkdir -p "$build_root"
all=$build_root/all_headers.cpp
(cd include && find mpmpbd -name '*.hpp' | sort | sed 's/.*/#include <&>/') >"$all"

# Flags by hand, not from a build: g++ builds hold options that clang-tidy does not know.
clang-tidy --quiet --config-file=.clang-tidy "$all" "$@" -- \
  -std=c++20 "-I$root/include" "-I$root/tests" -isystem /usr/include/eigen3
