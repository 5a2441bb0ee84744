#!/usr/bin/env bash
# The page built from its source has the bytes of the one that is kept in apps/editor/dist. build_test.sh FOLDER
here=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
out=$1/editor.html
(source "$here/apps/setup.sh" && install_packages "${editor_packages[@]}") || {
  echo "SKIPPED: the packages to build the editor's page cannot be installed here"
  exit 77
}
"$here/apps/editor/build.sh" "$out" || exit 1
cmp "$out" "$here/apps/editor/dist/editor.html" || {
  echo "The page that is kept is not the one that its source gives: apps/editor/build.sh makes it anew"
  exit 1
}
