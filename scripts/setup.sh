#!/usr/bin/env bash
# Installs what the build needs on Debian 12, and nothing that is there already.
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

usage() {
  cat <<'TEXT'
Usage: scripts/setup.sh [test|demo|python|ci]... [--no-cuda]

  test      compilers, build tools and libraries (default)
  demo      test, and what the demo draws with: ffmpeg, matplotlib
  python    test, and what the Python module needs: pybind11, NumPy, h5py; Gymnasium from PyPI, if that works
  ci        test, and clang with its tools, h5py, what reads machine code of kernels
  --no-cuda do not look for a CUDA compiler

Debian packages are installed as root or by sudo. Without an nvcc >= 12.4 on the machine, the CUDA
compiler is taken from PyPI into the build folder; if that fails, the build goes on without CUDA.
TEXT
}

purposes=()
cuda=yes
for argument in "$@"; do
  case $argument in
    test | demo | python | ci) purposes+=("$argument") ;;
    --no-cuda) cuda=no ;;
    -h | --help) usage && exit ;;
    *) usage >&2 && die "unknown argument '$argument'" ;;
  esac
done

is_for() { [[ " ${purposes[*]} " == *" $1 "* ]]; }

packages=(g++ cmake ninja-build libeigen3-dev libfmt-dev catch2 libcli11-dev libtomlplusplus-dev
  nlohmann-json3-dev libstb-dev libbenchmark-dev librandom123-dev libhdf5-dev libdlpack-dev)
for purpose in "${purposes[@]}"; do
  case $purpose in
    demo) packages+=(ffmpeg python3-matplotlib) ;;
    python) packages+=(pybind11-dev python3-dev python3-numpy python3-h5py python3-venv) ;;
    ci) packages+=(git clang clang-format clang-tidy libomp-dev python3-h5py) ;;
  esac
done

is_installed() {
  [[ $(dpkg-query -W -f '${db:Status-Status}' "$1" 2>/dev/null) == installed ]]
}

install_debian() {
  local missing=() package
  for package in "$@"; do
    is_installed "$package" || missing+=("$package")
  done
  if ((${#missing[@]} == 0)); then
    return
  fi
  local as_root=()
  if ((EUID != 0)); then
    if ! command -v sudo >/dev/null; then
      die "these packages are missing; install them as root: apt-get install ${missing[*]}"
    fi
    as_root=(sudo)
    [[ -t 0 ]] || as_root+=(-n) # nobody is there to type a password
  fi
  say "installing ${missing[*]}"
  local options=(-q -o Acquire::Retries=3 -o DPkg::Lock::Timeout=300)
  "${as_root[@]}" apt-get "${options[@]}" update
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get "${options[@]}" \
    install -y --no-install-recommends "${missing[@]}"
}

# fill <folder> <command>: the folder is there afterwards if the command succeeded, and not otherwise, also when the
# set-up is interrupted: what is half there would be taken for whole the next time.
filling=
trap '[[ -z $filling ]] || rm -rf "$filling"' EXIT
fill() {
  local status=0
  filling=$1
  rm -rf "$filling"
  "$2" || status=$?
  ((status == 0)) || rm -rf "$filling"
  filling=
  return "$status"
}

# The compiler as wheels. pip lays them out as site-packages/nvidia/cu13, which is a toolkit but for
# two names that the linker and CMake look for.
install_cuda_wheels() {
  local toolkit
  python3 -m venv "$cuda_wheels" &&
    timeout 600 "$cuda_wheels/bin/pip" install --quiet --disable-pip-version-check --no-deps \
      nvidia-cuda-nvcc==13.0.88 nvidia-cuda-crt==13.0.88 nvidia-nvvm==13.0.88 \
      nvidia-cuda-runtime==13.0.96 nvidia-cuda-cccl==13.0.85 || return 1
  toolkit=$(dirname "$(dirname "$(nvcc_of_wheels)")")
  [[ -d $toolkit/lib ]] || return 1
  ln -s lib "$toolkit/lib64"
  ln -s libcudart.so.13 "$toolkit/lib/libcudart.so"
  # The proof is a program, not a version number.
  printf '__global__ void f(float* p) { *p = 1; }\nint main() { f<<<1, 1>>>(nullptr); }\n' \
    >"$cuda_wheels/check.cu"
  "$toolkit/bin/nvcc" -std=c++20 -arch=sm_75 "$cuda_wheels/check.cu" -o "$cuda_wheels/check"
}

# What reads machine code (6 MB).
install_cuda_reader() {
  python3 -m venv "$cuda_reader" &&
    timeout 120 "$cuda_reader/bin/pip" install --quiet --disable-pip-version-check --no-deps \
      --retries 1 nvidia-cuda-cuobjdump==13.2.51 nvidia-cuda-nvdisasm==13.2.51
}

# Gymnasium is not in Debian. The module goes without; its spaces and the tests of them do not.
install_gymnasium() {
  /usr/bin/python3 -m venv --system-site-packages "$python_venv" &&
    timeout 120 "$python_venv/bin/pip" install --quiet --disable-pip-version-check 'gymnasium>=1.1'
}

if command -v dpkg-query >/dev/null && command -v apt-get >/dev/null; then
  install_debian "${packages[@]}"
else
  say "not a Debian machine: please provide what these packages hold: ${packages[*]}"
fi

if is_for python && [[ ! -x $python_venv/bin/python ]]; then
  fill "$python_venv" install_gymnasium || say "no Gymnasium: its tests are skipped"
fi

if [[ $cuda == yes ]]; then
  nvcc=$(find_nvcc)
  if [[ -z $nvcc ]]; then
    say "no nvcc >= $cuda_minimum on this machine: taking the compiler from PyPI (about 105 MB)"
    if command -v apt-get >/dev/null; then
      install_debian python3-venv
    fi
    fill "$cuda_wheels" install_cuda_wheels || true
    nvcc=$(find_nvcc)
  fi
  if [[ -n $nvcc ]]; then
    say "CUDA compiler: $nvcc ($(nvcc_version "$nvcc"))"
    if is_for ci && [[ -z $(find_cuobjdump) ]] && ! fill "$cuda_reader" install_cuda_reader; then
      die "no cuobjdump from the toolkit or from PyPI: CI looks at the machine code of kernels"
    fi
  else
    say "CUDA compiler: none; the library is built without CUDA"
  fi
fi
