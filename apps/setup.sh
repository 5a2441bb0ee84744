#!/usr/bin/env bash
# What demo.sh and tests/run.sh have in common: installs the Debian packages that are missing and builds a release.
# Sourced; leaves the variables `root` and `build`.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build/release

# Everything that a bare Debian 12 lacks; the only list of packages.
packages=(
  g++ cmake ninja-build
  libeigen3-dev libceres-dev libpcl-dev libflann-dev liblz4-dev libgtest-dev
  libembree-dev libtbb-dev libcli11-dev nlohmann-json3-dev libstb-dev
  libcgal-demo # real meshes
)

missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing+=("$package")
done
if ((${#missing[@]})); then
  echo "Installing ${missing[*]}"
  as_root=()
  if ((EUID != 0)); then
    command -v sudo >/dev/null || { echo "Run as root, or install: ${missing[*]}" >&2; exit 1; }
    as_root=(sudo)
  fi
  "${as_root[@]}" apt-get update -qq
  DEBIAN_FRONTEND=noninteractive "${as_root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
fi

# A minimal image may leave out documentation, and with it the meshes that libcgal-demo brings.
meshes=/usr/share/doc/libcgal-dev/data.tar.gz

build_release() {
  echo "Building into ${build#"$root"/}"
  (cd "$root" && cmake --preset release -Wno-dev "$@" >"$build.log" 2>&1 || { cat "$build.log" >&2; exit 1; })
  cmake --build "$build"
}
mkdir -p "$root/build"
