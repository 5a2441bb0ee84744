#!/usr/bin/env bash
# Builds the editor's page from its source. build_test.sh FOLDER
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
rm -f "$1/editor.html"
(source "$root/apps/setup.sh" && install_packages "${editor_packages[@]}") || {
  echo "SKIPPED: the packages to build the editor's page cannot be installed here"
  exit 77
}
"$root/apps/editor/build.sh" "$1/editor.html"
code=$?
((code != 77)) || echo "SKIPPED: the packages from npm cannot be reached"
exit $code
