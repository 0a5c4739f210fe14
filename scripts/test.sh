#!/usr/bin/env bash
# Sets up, builds and tests. The last lines are ctest's, the exit status is that of the first failure.
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

usage() {
  cat <<'TEXT'
Usage: scripts/test.sh [options]

Without options: a Release build and every tier but `long`: unit, physics, fail (programs that must
not compile), headers (each compiled alone), package (projects that use the installed library) and
device (skipped without a GPU).

  --unit              build and run the tier `unit` only
  --long              run the tier `long` too (hours)
  --sanitize NAME     asan-ubsan or tsan: build with it and run the tiers unit and physics,
                      with --unit only the first
  --preset NAME       another preset of CMakePresets.json (default: release)
  --python            build the Python module and run its tests, too
  --cuda auto|on|off  what MPMPBD_CUDA is set to (default: the preset's)
  --cuda-arch LIST    GPU architectures (default: 75, which every later GPU runs too)
  --only-cuda         compile the .cu sources and stop
  --no-setup          the machine is set up already
  -j N                jobs at a time (default: number of cores)
TEXT
}

preset=release
sanitizer=
cuda=
arch=75
tiers=all
long=no
only_cuda=no
python=no
setup=yes
while (($#)); do
  case $1 in
    --unit) tiers=unit ;;
    --long) long=yes ;;
    --sanitize) sanitizer=${2:?--sanitize needs a name} && shift ;;
    --preset) preset=${2:?--preset needs a name} && shift ;;
    --python) python=yes ;;
    --cuda) cuda=${2:?--cuda needs auto, on or off} && shift ;;
    --cuda-arch) arch=${2:?--cuda-arch needs a list} && shift ;;
    --only-cuda) only_cuda=yes ;;
    --no-setup) setup=no ;;
    -j) jobs=${2:?-j needs a number} && shift ;;
    -j[0-9]*) jobs=${1#-j} ;;
    -h | --help) usage && exit ;;
    *) usage >&2 && die "unknown option '$1'" ;;
  esac
  shift
done
case $sanitizer in
  '') ;;
  asan-ubsan | tsan)
    preset=$sanitizer
    cuda=off
    [[ $tiers == unit ]] || tiers=sanitized
    ;;
  *) die "--sanitize takes asan-ubsan or tsan, not '$sanitizer'" ;;
esac

[[ -z $sanitizer || $python == no ]] || die "--python and --sanitize do not go together: Python is not instrumented"

build=$build_root/$preset
cd "$root"

purpose='test'
[[ $preset =~ ^(asan-ubsan|tsan|clang)$ ]] && purpose='ci'
if [[ $setup == yes ]]; then
  # A run that compiles no .cu uses the CUDA compiler that is there, but does not fetch one.
  if [[ ${cuda,,} == off || $preset =~ ^(clang|debug)$ || ($tiers == unit && -z $cuda) ]]; then
    step "set-up" scripts/setup.sh "$purpose" --no-cuda
  else
    step "set-up" scripts/setup.sh "$purpose"
  fi
  [[ $python == no ]] || step "set-up for Python" scripts/setup.sh python --no-cuda
fi

if [[ ${cuda,,} != off ]]; then
  nvcc=$(find_nvcc)
  [[ -z $nvcc ]] || export CUDACXX=$nvcc
fi
options=("-DCMAKE_CUDA_ARCHITECTURES=$arch")
cuobjdump=$(find_cuobjdump)
[[ ${cuda,,} == off || -z $cuobjdump ]] || options+=("-DMPMPBD_CUOBJDUMP=$cuobjdump")
[[ -z $cuda ]] || options+=("-DMPMPBD_CUDA=${cuda^^}")
options+=("-DMPMPBD_PYTHON=${python^^}")
[[ $python == no ]] || options+=("-DPython_EXECUTABLE=$(python_of_module)")
# What -O2 takes longer to compile with asan than the preset's -O1, only the tier physics wins back.
if [[ $sanitizer == asan-ubsan && $tiers != unit ]]; then
  options+=("-DCMAKE_CXX_FLAGS_RELWITHDEBINFO=-O2 -g1")
fi
step "configure $preset" cmake --preset "$preset" -B "$build" "${options[@]}"

# Our .cu sources that this build compiles; those of the consumers in tests/package are their own.
cuda_sources() {
  local without=(-path tests/device/forms -prune -o)
  ! grep -q '^MPMPBD_DEVICE_FORMS:BOOL=ON' "$build/CMakeCache.txt" || without=()
  ! grep -q '^MPMPBD_CATALOG_CUDA_ALL:BOOL=OFF' "$build/CMakeCache.txt" || without+=(-path src/catalog/cuda/more -prune -o)
  find src tests/device tests/support bench examples "${without[@]}" -name '*.cu' -print 2>/dev/null
}
build_target() { cmake --build "$build" -j "$jobs" --target "$@"; }

compiled_with=$(sed -n 's/^MPMPBD_CUDA_COMPILED_WITH:INTERNAL=//p' "$build/CMakeCache.txt")
if [[ -n $compiled_with && $tiers == all ]]; then
  step "build CUDA" build_target mpmpbd_device
fi
if [[ $only_cuda == no ]]; then
  case $tiers in
    unit) step "build" build_target mpmpbd_unit ;;
    sanitized) step "build" build_target mpmpbd_unit mpmpbd_physics ;;
    all) step "build" build_target all ;;
  esac
fi

if [[ -n $compiled_with && $tiers == all ]]; then
  while read -r source; do
    [[ -n $(find "$build" -name "$(basename "$source").o" -print -quit) ]] ||
      die "$source was not compiled"
  done < <(cuda_sources)
  say "CUDA: compiled with $compiled_with ($(cuda_sources | wc -l) sources, architectures $arch)"
elif [[ -n $compiled_with ]]; then
  say "CUDA: not part of this run"
else
  [[ ${cuda,,} != on ]] || die "CUDA is required, but no .cu was compiled"
  say "CUDA: not available"
fi
[[ $only_cuda == no ]] || exit 0

case $tiers in
  unit) labels=unit ;;
  sanitized) labels='unit|physics' ;;
  all) labels='unit|physics|fail|headers|package|device' ;;
esac
if [[ $long == yes ]]; then
  build_target mpmpbd_long
  labels+='|long'
else
  say "tier long, not run here:"
  ctest --test-dir "$build" -N -L '^long$' | sed -n 's/^ *Test *#[0-9]*: /   /p'
fi

# The first error that a sanitizer finds ends its run.
only=()
[[ -z $sanitizer ]] || only=(--stop-on-failure)
say "test"
exec ctest --test-dir "$build" -j "$jobs" -L "^($labels)\$" --output-on-failure --no-tests=error "${only[@]}"
