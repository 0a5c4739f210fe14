#!/usr/bin/env bash
# Formats our C++ and CUDA sources by .clang-format; --check only says which files differ.
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
cd "$root"

mode=(-i)
case ${1:-} in
  '') ;;
  --check) mode=(--dry-run --Werror) ;;
  *) die "usage: scripts/format.sh [--check]" ;;
esac
files=()
while IFS= read -r -d '' file; do
  [[ ! -f $file ]] || files+=("$file")
done < <(git ls-files -z --cached --others --exclude-standard '*.hpp' '*.cpp' '*.cuh' '*.cu')
wait "$!" || die "git does not list the files of $root; run this in a clone"
clang-format --style=file "${mode[@]}" "${files[@]}"
