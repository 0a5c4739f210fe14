#!/usr/bin/env bash
# Deliberate mistakes in the physics, one at a time: does a test notice?
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

usage() {
  cat <<'TEXT'
Usage: scripts/mutants.sh [options] [NAME...]

Applies each patch of tests/mutants, or those named (05, 05_flip_of_wrong_sign), to a copy of the
tree, builds the tests that are likely to notice (`# likely:` in the patch) and runs them until the
first fails. If none does, the rest of the tier `unit` follows. A mutant that no test notices has
SURVIVED, one that does not compile is BROKEN: both make the exit status 1.

  --check   only see whether the patches apply (a second)
  --likely  leave out the rest of the tier
  --report  write docs/results/mutants.md
  -j N      jobs at a time of a build (default: number of cores)
TEXT
}

only_check=no
rest=yes
report=
patches=()
while (($#)); do
  case $1 in
    --check) only_check=yes ;;
    --likely) rest=no ;;
    --report) report=$root/docs/results/mutants.md ;;
    -j) jobs=${2:?-j needs a number} && shift ;;
    -j[0-9]*) jobs=${1#-j} ;;
    -h | --help) usage && exit ;;
    -*) usage >&2 && die "unknown option '$1'" ;;
    *)
      found=("$root/tests/mutants/$1"*.patch)
      [[ -f ${found[0]} ]] || die "no patch '$1' in tests/mutants"
      patches+=("${found[@]}")
      ;;
  esac
  shift
done
cd "$root"
((${#patches[@]})) || patches=("$root"/tests/mutants/*.patch)

work=$build_root/mutants
tree=$work/tree
build=$work/build
log=$work/log
mkdir -p "$tree"

# header NAME PATCH: what its line `# NAME: ` says.
header() { sed -n "s/^# $1: //p" "$2" | head -n 1; }

for patch in "${patches[@]}"; do
  [[ -n $(header what "$patch") && -n $(header likely "$patch") ]] ||
    die "$patch does not begin with '# what: ' and '# likely: '"
  git apply --check "$patch" || die "$patch does not apply; take it along with what it changes"
done
say "${#patches[@]} patches apply"
[[ $only_check == no ]] || exit 0

# The tree as it is now, without what git ignores. Files that are equal keep their time, so that the
# build goes on where it was; what differs, a patch left behind too, gets a new one.
copy_tree() {
  local file
  git ls-files -z --cached --others --exclude-standard |
    while IFS= read -r -d '' file; do [[ ! -f $file ]] || printf '%s\0' "$file"; done |
    sort -zu >"$work/files"
  while IFS= read -r -d '' file; do
    cmp -s "$file" "$tree/$file" || cp --parents "$file" "$tree"
  done <"$work/files"
  (cd "$tree" && find . -type f -printf '%P\0' | sort -zu | comm -z -13 "$work/files" - | xargs -0r rm)
}

# The copy is no part of a repository. Reversing a patch gives its files a new time, too.
in_tree() { (cd "$tree" && GIT_CEILING_DIRECTORIES=$work git apply "$@"); }

# Builds and runs tests one after the other until one fails, and prints that one.
# Exit status 0: one failed; 1: none did; 2: one does not compile.
first_to_fail() {
  local test
  for test in "$@"; do
    cmake --build "$build" -j "$jobs" --target "test_${test/\//_}" >"$log" 2>&1 || return 2
    ctest --test-dir "$build" -R "^$test\$" --no-tests=error >>"$log" 2>&1 && continue
    echo "$test"
    return 0
  done
  return 1
}

# judge PATCH: prints the test that notices it, or SURVIVED, or BROKEN.
judge() {
  local likely others=() status=0
  read -ra likely <<<"$(header likely "$1")"
  first_to_fail "${likely[@]}" || status=$?
  if ((status == 1)) && [[ $rest == yes ]]; then
    status=0
    mapfile -t others < <(comm -23 "$work/unit" <(printf '%s\n' "${likely[@]}" | sort))
    first_to_fail "${others[@]}" || status=$?
  fi
  case $status in
    1) echo SURVIVED ;;
    2) echo BROKEN ;;
  esac
}

copy_tree
cmake --preset release -S "$tree" -B "$build" -DMPMPBD_CUDA=OFF -DMPMPBD_BENCH=OFF \
  -DMPMPBD_EXAMPLES=OFF >"$log" 2>&1 || die "the copy cannot be configured, see $log"
ctest --test-dir "$build" -N -L '^unit$' | sed -n 's/^ *Test *#[0-9]*: //p' | sort >"$work/unit"

# The control: without a mistake none of these tests fails.
mapfile -t all < <(for patch in "${patches[@]}"; do header likely "$patch"; done | tr ' ' '\n' | sort -u)
say "control: ${#all[@]} tests without a mistake"
begin=$SECONDS
status=0
failed=$(first_to_fail "${all[@]}") || status=$?
((status == 1)) || die "without a mistake ${failed:-a test that does not compile} fails, see $log"
say "control: $((SECONDS - begin)) s"

rows=()
missed=()
for patch in "${patches[@]}"; do
  name=$(basename "$patch" .patch)
  begin=$SECONDS
  in_tree "$patch"
  verdict=$(judge "$patch")
  in_tree --reverse "$patch"
  [[ $verdict != BROKEN ]] || cp "$log" "$work/$name.log"
  rows+=("| $name | $(header what "$patch") | $verdict | $((SECONDS - begin)) |")
  [[ $verdict != SURVIVED && $verdict != BROKEN ]] || missed+=("$name: $verdict")
  say "$name: $verdict, $((SECONDS - begin)) s"
done

caught="$((${#patches[@]} - ${#missed[@]})) of ${#patches[@]} mutants are caught"
if [[ -n $report ]]; then
  {
    cat <<TEXT
# Mutants

Deliberate mistakes in the physics, one at a time (the patches of tests/mutants): what each is and which
physics should notice, and the first test that failed with it. Without a mistake all of these tests pass.
A mutant that no test notices would be a hole in the tests.

$caught. Written by scripts/mutants.sh --report on top of commit $(git rev-parse --short HEAD),
$(date -u +%F), $(c++ --version | head -n 1).

| mutant | what | caught by | seconds to build and run |
|---|---|---|---|
TEXT
    printf '%s\n' "${rows[@]}"
  } >"$report"
  say "wrote $report"
fi
say "$caught"
if ((${#missed[@]})); then
  printf '   %s\n' "${missed[@]}"
  exit 1
fi
