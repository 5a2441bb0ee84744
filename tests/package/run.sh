#!/usr/bin/env bash
# Installs the build BUILD into an empty folder, builds the project beside this script against it, and runs that.
set -euo pipefail
build=$1
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$build" --prefix "$work/prefix" >/dev/null
cmake -S "$here" -B "$work/build" -DCMAKE_PREFIX_PATH="$work/prefix" -DCMAKE_BUILD_TYPE=Release >/dev/null
cmake --build "$work/build" --parallel 2
"$work/build/consumer"

# The example edits a chair, which then has the symmetries that detection finds in it at rest.
orbifit=$work/prefix/bin/orbifit
"$orbifit" generate chair -o "$work" --quiet >/dev/null
"$work/build/edit" "$work/chair.ply" "$work/edited.ply"
"$orbifit" detect "$work/chair.ply" -o "$work/chair.json" --quiet >/dev/null
"$orbifit" check "$work/chair.ply" "$work/chair.json" --deformed "$work/edited.ply" --max-residual 1e-9
