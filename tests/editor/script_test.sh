#!/usr/bin/env bash
# Runs one of the tests in JavaScript beside this file. script_test.sh SCRIPT FOLDER ORBIFIT
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$here/../..
command -v node >/dev/null || { echo "SKIPPED: there is no node"; exit 77; }
[ -f "$2/editor.html" ] || { echo "SKIPPED: the page has not been built"; exit 77; }
EDITOR_WASM=$root/build/wasm/apps/editor/core EDITOR_MODULES=$root/apps/editor ORBIFIT=$3 exec node "$here/$1"
