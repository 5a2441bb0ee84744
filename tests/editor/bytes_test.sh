#!/usr/bin/env bash
# The page that is kept in apps/editor/dist has the bytes of the one built from its source. bytes_test.sh FOLDER
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
[ -f "$1/editor.html" ] || { echo "SKIPPED: the page has not been built"; exit 77; }
cmp "$1/editor.html" "$root/apps/editor/dist/editor.html" || {
  echo "The page that is kept is not the one that its source gives: apps/editor/build.sh makes it anew"
  exit 1
}
