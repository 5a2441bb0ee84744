#!/bin/sh
# Is each type defined once? `tests/one_definition.sh [FOLDER]`: names every type that two files define in one namespace, and
# ends with 1. Two types of one name in one program are undefined behaviour that no compiler reports: the linker keeps one
# of the functions that templates make of them, a vector's say, for both.
set -eu
root=$(cd "${1:-$(dirname "$0")/..}" && pwd)
cd "$root"
find . \( -name build -o -name node_modules -o -name '.?*' \) -prune -o \( -name '*.h' -o -name '*.cpp' \) -print | sort |
  xargs awk '
    FNR == 1 { depth = 0 }
    /^namespace.*[{]$/ { name[++depth] = $2 == "{" ? "" : $2; next }
    /^}  \/\/ namespace/ { if (depth > 0) --depth; next }
    /^(struct|class|union|enum class) [A-Za-z0-9_]+( final)?( : .*)?( *[{].*)?$/ && !/;$/ {
      where = ""
      for (i = 1; i <= depth; ++i) {
        if (name[i] == "") next
        where = where name[i] "::"
      }
      if (where == "") next
      type = where ($1 == "enum" ? $3 : $2)
      if (type in file && file[type] != FILENAME) {
        print type " is defined in " file[type] " and in " FILENAME
        found = 1
      }
      file[type] = FILENAME
    }
    END { exit found }'
