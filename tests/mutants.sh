#!/usr/bin/env bash
# Mutation testing: do the tests of subspace, of point groups and of verification notice operators that are flipped?
# `tests/mutants.sh [MOST [SEED [groups] [verification] [subspace]]]`, from anywhere: MOST (100) mutants of each, all three by
# default, drawn with SEED (1), all compiled at once in a copy of the sources (build/mutants) and tried one after another
# with the tests of their own folder. Prints those that survive and a table. Some two hours on two cores; not part of CI.
source "$(dirname "${BASH_SOURCE[0]}")/../apps/setup.sh"
most=${1:-100} seed=${2:-1}
shift $(($# < 2 ? $# : 2))
selected=" ${*:-groups verification subspace} "

install_packages "${program_packages[@]}" "${test_packages[@]}" "${mutation_packages[@]}"
work=$root/build/mutants
copy=$work/source
mkdir -p "$work"
rm -rf "$copy"
mkdir "$copy"
(cd "$root" && git ls-files -z | xargs -0 cp --parents -t "$copy")
(cd "$copy" && cmake --preset dev -B "$work/flags" -Wno-dev >"$work/flags.log")

# tried FOLDER TARGET PROGRAM SOURCE ...: mutants of the sources against one test program.
tried() {
  local name=$1 target=$2 program=$3
  shift 3
  [[ $selected == *" $name "* ]] || return 0
  echo "== $name"
  /usr/bin/python3 "$root/tests/mutants/instrument.py" "$work/flags/compile_commands.json" "$most" "$seed" "$work/$name.tsv" "$@"
  cmake --build "$work/release" --target "$target" >"$work/$name.log" 2>&1 || { tail -n 40 "$work/$name.log" >&2; exit 1; }
  /usr/bin/python3 "$root/tests/mutants/run_mutants.py" "$work/$name.tsv" "$work/release/$program"
  for source in "$@"; do cp "$root/${source#"$copy"/}" "$source"; done # the next one's tests run without these
}
(cd "$copy" && cmake --preset release -B "$work/release" -Wno-dev -DORBIFIT_BUILD_TESTS=ON -DORBIFIT_BUILD_BASELINES=ON \
  -DCMAKE_CXX_FLAGS=-D_GLIBCXX_ASSERTIONS >"$work/release.log") # what reaches past an end is noticed
tried groups model_test tests/detection/model/model_test "$copy"/detection/model/src/groups/*.cpp
tried verification detection_test tests/detection/detection_test "$copy"/detection/src/group/*.cpp
tried subspace subspace_test tests/subspace/subspace_test "$copy"/subspace/src/{basis,symmetry,sampling,rest_shape,deformation}/*.cpp
