#!/usr/bin/env bash
# Has Khronos' glTF validator look at what the program writes; it is installed into FOLDER where it is not there yet.
# run.sh ORBIFIT FOLDER
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
package=gltf-validator@2.0.0-dev.3.10
command -v node >/dev/null && command -v npm >/dev/null || { echo "SKIPPED: there is no node or no npm"; exit 77; }
mkdir -p "$2"
if [ "$(cat "$2/.holds" 2>/dev/null)" != $package ]; then
  echo '{"private": true}' >"$2/package.json"
  npm install --prefix "$2" --ignore-scripts --no-audit --no-fund --loglevel=error $package >"$2/npm.log" 2>&1 || {
    cat "$2/npm.log"
    grep -qE 'ENOTFOUND|EAI_AGAIN|ECONN|ETIMEDOUT|ENETUNREACH|EHOSTUNREACH|network' "$2/npm.log" || exit 1
    echo "SKIPPED: the package $package cannot be reached"
    exit 77
  }
  echo $package >"$2/.holds"
fi
exec node "$here/validator_test.mjs" "$1" "$2"
