#!/usr/bin/env bash
# Installs the build BUILD into an empty folder, builds the project beside this script against it, and runs that.
set -euo pipefail
build=$1
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$build" --prefix "$work/prefix" >/dev/null

# configure NAME COMPONENTS [HIDDEN ...]: as on a machine that lacks the hidden packages.
configure() {
  local name=$1 components=$2 package hidden=()
  shift 2
  for package in "$@"; do hidden+=("-DCMAKE_DISABLE_FIND_PACKAGE_$package=ON"); done
  cmake -S "$here" -B "$work/$name" -DCMAKE_PREFIX_PATH="$work/prefix" -DCMAKE_BUILD_TYPE=Release -Wno-dev \
    "-DCOMPONENTS=$components" "${hidden[@]}"
}

# refuses REASON NAME COMPONENTS [HIDDEN ...]: configuring fails and says why.
refuses() {
  local reason=$1
  shift
  if configure "$@" >"$work/log" 2>&1 || ! tr -s '\n ' ' ' <"$work/log" | grep -qF "$reason"; then
    echo "COMPONENTS $2 should be refused with '$reason':" && cat "$work/log"
    exit 1
  fi
}

# Detection alone asks for nothing that other components need.
configure build detection Ceres PCL OpenMesh >/dev/null
cmake --build "$work/build" --parallel 2
"$work/build/consumer"

refuses "the component pcl needs PCL" no_pcl detection\;pcl PCL
refuses "the component openmesh needs OpenMesh" no_openmesh openmesh OpenMesh
refuses "the component baselines needs Ceres" no_ceres baselines Ceres
refuses "there is no component detektion" misspelt detektion
configure adapters pcl\;openmesh Ceres >/dev/null
cmake --build "$work/adapters"
"$work/adapters/adapters"

# The example edits a chair, which then has the symmetries that detection finds in it at rest.
orbifit=$work/prefix/bin/orbifit
"$orbifit" generate chair -o "$work" --quiet >/dev/null
"$work/build/edit" "$work/chair.ply" "$work/edited.ply"
"$orbifit" detect "$work/chair.ply" -o "$work/chair.json" --quiet >/dev/null
"$orbifit" check "$work/chair.ply" "$work/chair.json" --deformed "$work/edited.ply" --max-residual 1e-9
