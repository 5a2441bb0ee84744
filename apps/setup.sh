#!/usr/bin/env bash
# What demo.sh and tests/run.sh have in common: installs the Debian packages that are missing and builds a release.
# Sourced; leaves the variables `root` and `build`.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build/release

# What a bare Debian 12 lacks; the only lists of packages.
program_packages=( # to build orbifit and its libraries
  g++ cmake ninja-build
  libeigen3-dev libflann-dev liblz4-dev libembree-dev libtbb-dev
  libcli11-dev nlohmann-json3-dev libstb-dev libsqlite3-dev libxxhash-dev libdraco-dev lib3mf-dev libzip-dev
)
test_packages=( # for the baselines, the adapters, the Python package, the tests and cpack besides
  libceres-dev libpcl-dev libopenmesh-dev libgtest-dev
  python3-dev pybind11-dev python3-numpy python3-pip
  python3-pytest python3-hypothesis python3-distributed mypy python3-sphinx furo
  parallel slurmctld slurmd slurm-client munge snakemake sqlite3 procps faketime locales
  doxygen dpkg-dev file
)
fuzz_packages=( # for tests/fuzz.sh
  clang-14 libclang-rt-14-dev llvm-14
)
mutation_packages=( # for tests/mutants.sh
  python3-clang-14
)
editor_packages=( # to build the editor's page anew, and to try it in a browser
  emscripten libnanoflann-dev nodejs chromium
)

as_root=()
((EUID == 0)) || as_root=(sudo)

# install_packages NAME ...: those that are missing.
install_packages() {
  local package missing=()
  for package in "$@"; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing+=("$package")
  done
  ((${#missing[@]})) || return 0
  if ((${#as_root[@]})) && ! command -v sudo >/dev/null; then
    echo "Run as root, or install: ${missing[*]}" >&2
    exit 1
  fi
  echo "Installing ${missing[*]}"
  "${as_root[@]}" apt-get update -qq
  DEBIAN_FRONTEND=noninteractive "${as_root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
}

# build_release [-DNAME=VALUE ...]: configures and builds all.
build_release() {
  echo "Building into ${build#"$root"/}"
  (cd "$root" && cmake --preset release -Wno-dev "$@" >"$build.log" 2>&1 || { cat "$build.log" >&2; exit 1; })
  cmake --build "$build"
}
mkdir -p "$root/build"
