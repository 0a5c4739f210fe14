# shellcheck shell=bash
# What the scripts share. Sourced, not run: sets `root`, `build_root`, `jobs` and a few functions.
# shellcheck disable=SC2034 # those who source it use the variables

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build_root=$(realpath -m -- "${MPMPBD_BUILD_ROOT:-$root/build}") # from where it is called, before any `cd`
jobs=${MPMPBD_JOBS:-$(nproc 2>/dev/null || echo 2)}
python_venv="$build_root/python-venv" # Debian's Python with Gymnasium, by scripts/setup.sh python
cuda_minimum=12.4
cuda_wheels="$build_root/cuda-toolkit" # the compiler from PyPI, where the machine has none
cuda_reader="$build_root/cuda-reader"  # what reads its machine code, likewise

say() { printf '== %s\n' "$*"; }
die() {
  printf 'error: %s\n' "$*" >&2
  exit 1
}

# step NAME COMMAND...: runs it and prints how long it took.
step() {
  local name=$1 begin=$SECONDS status=0
  shift
  say "$name"
  "$@" || status=$?
  if ((status == 0)); then
    say "$name: $((SECONDS - begin)) s"
  else
    say "$name: failed after $((SECONDS - begin)) s (exit status $status)"
  fi
  return "$status"
}

# Another Python may come before Debian's, for which matplotlib is installed.
python_with_matplotlib() {
  python3 -c 'import matplotlib' 2>/dev/null && echo python3 || echo /usr/bin/python3
}

# The Python that the module is built for: Debian's, whose NumPy it uses, with Gymnasium where that was installed.
python_of_module() {
  [[ -x $python_venv/bin/python ]] && echo "$python_venv/bin/python" && return
  python3 -c 'import numpy' 2>/dev/null && python3 -c 'import sys; print(sys.executable)' || echo /usr/bin/python3
}

# Those of this machine's GPUs, as "80;90"; where there are none, 75, which every later GPU runs too.
gpu_architectures() {
  local found
  found=$(nvidia-smi --query-gpu=compute_cap --format=csv,noheader 2>/dev/null | tr -d . | sort -u | paste -sd ';' || true)
  [[ $found =~ ^[0-9]+(;[0-9]+)*$ ]] && echo "$found" || echo 75
}

# The version of the compiler $1, or nothing.
nvcc_version() { "$1" --version 2>/dev/null | sed -n 's/.*, V\([0-9.]*\).*/\1/p'; }

# version_at_least HAVE WANT
version_at_least() {
  [[ -n $1 ]] && [[ $(printf '%s\n%s\n' "$2" "$1" | sort -V | head -n 1) == "$2" ]]
}

# The nvcc inside our own toolkit folder, or nothing.
nvcc_of_wheels() {
  local nvcc
  for nvcc in "$cuda_wheels"/lib/python3*/site-packages/nvidia/cu*/bin/nvcc; do
    if [[ -x $nvcc ]]; then
      echo "$nvcc"
      return
    fi
  done
}

# What reads machine code: the toolkit's own, or that of the wheels; or nothing.
find_cuobjdump() {
  local nvcc program
  nvcc=$(find_nvcc)
  for program in "${nvcc:+$(dirname "$nvcc")/cuobjdump}" "$(command -v cuobjdump || true)" \
    "$cuda_reader"/lib/python3*/site-packages/nvidia/cu*/bin/cuobjdump; do
    if [[ -n $program && -x $program ]]; then
      echo "$program"
      return
    fi
  done
}

# Prints the first nvcc that is new enough: the machine's own, else the one of the wheels.
find_nvcc() {
  local nvcc
  for nvcc in "${CUDACXX:-}" "$(command -v nvcc || true)" \
    "${CUDA_HOME:+$CUDA_HOME/bin/nvcc}" /usr/local/cuda/bin/nvcc "$(nvcc_of_wheels)"; do
    if [[ -n $nvcc && -x $nvcc ]] && version_at_least "$(nvcc_version "$nvcc")" "$cuda_minimum"; then
      echo "$nvcc"
      return
    fi
  done
}
