#!/usr/bin/env bash
# Builds the editor's page, without a mesh: build.sh [OUT], by default apps/editor/dist/editor.html, which is what
# `orbifit edit` fills in. The core comes out in build/wasm/apps/editor/core. The same sources give the same bytes, in
# any folder. Exits with 77 where npm's packages cannot be reached.
source "$(dirname "${BASH_SOURCE[0]}")/../setup.sh"

out=${1:-$root/apps/editor/dist/editor.html}
install_packages "${editor_packages[@]}"
command -v npm >/dev/null || install_packages npm
export NODE_PATH=/usr/share/nodejs # where Debian keeps the modules of emscripten
wasm=$root/build/wasm
echo "Building into build/wasm"
(cd "$root" && emcmake cmake -S . -B "$wasm" -G Ninja -Wno-dev -DCMAKE_BUILD_TYPE=Release -DORBIFIT_PORTABLE=ON \
  -DORBIFIT_BUILD_TESTS=OFF -DORBIFIT_BUILD_BASELINES=OFF >"$wasm.log" 2>&1) || { cat "$wasm.log" >&2; exit 1; }
cmake --build "$wasm"
unset NODE_PATH

cd "$root/apps/editor"
[ -d node_modules ] && cmp -s package-lock.json node_modules/.of-lock || {
  npm ci --ignore-scripts --no-audit --no-fund --loglevel=error 2>"$wasm.npm.log" || {
    cat "$wasm.npm.log" >&2
    grep -qE 'ENOTFOUND|EAI_AGAIN|ECONN|ETIMEDOUT|ENETUNREACH|EHOSTUNREACH|network' "$wasm.npm.log" || exit 1
    echo "The packages from npm cannot be reached" >&2
    exit 77
  }
  cp package-lock.json node_modules/.of-lock
}
npm run --silent check
node build.mjs "$wasm/apps/editor/core" "$out"
