#!/usr/bin/env bash
# Do results depend on the compiler? `tests/compilers.sh`, from anywhere: builds the program with GCC with and without
# optimisation, and with Clang, runs each stage on generated shapes, and compares what they write: the same words, groups, faces
# and counts; other numbers to 1e-12 of the shape's size between the two of GCC, and to 1e-9 between GCC and Clang. Some
# twenty minutes on two cores; not part of CI.
source "$(dirname "${BASH_SOURCE[0]}")/../apps/setup.sh"
install_packages "${program_packages[@]}" "${fuzz_packages[@]}"
work=$root/build/compilers

# built NAME -DNAME=VALUE ...
built() {
  local name=$1
  shift
  mkdir -p "$work"
  (cd "$root" && cmake --preset release -B "$work/$name" -Wno-dev -DORBIFIT_BUILD_TESTS=OFF -DORBIFIT_BUILD_BASELINES=OFF \
    "$@" >"$work/$name.log" 2>&1 && cmake --build "$work/$name" --target orbifit >>"$work/$name.log" 2>&1) ||
    { tail -n 40 "$work/$name.log" >&2; exit 1; }
}

# results BUILD FOLDER SHAPE ...: what a build's program writes of each shape, as text.
results() {
  local program=$work/$1/apps/orbifit out=$work/$2 shape
  shift 2
  rm -rf "$out"
  mkdir -p "$out"
  for shape; do
    local mesh=$work/shapes/$shape.obj
    "$program" detect "$mesh" -o "$out/$shape.json" --quiet >/dev/null
    for mode in fixed floating moving; do
      "$program" deform "$mesh" "$work/shapes/$shape.json" --handles "$work/shapes/handles.json" --mode "$mode" \
        -o "$out/$shape-$mode.obj" --quiet >/dev/null
    done
    "$program" symmetrize "$mesh" "$work/shapes/$shape.json" -o "$out/$shape-symmetric.obj" --quiet >/dev/null
  done
}

built release
built debug -DCMAKE_BUILD_TYPE=Debug
built clang -DCMAKE_CXX_COMPILER=clang++-14
release=$work/release/apps/orbifit
all=(bar table fan wheel)
few=(bar) # a minute and more each without optimisation
rm -rf "$work/shapes"
mkdir -p "$work/shapes"
for shape in "${all[@]}"; do
  "$release" generate "$shape" -o "$work/shapes/$shape" --quiet >/dev/null
  "$release" convert "$work/shapes/$shape/$shape.ply" "$work/shapes/$shape.obj" --quiet >/dev/null
  "$release" detect "$work/shapes/$shape.obj" -o "$work/shapes/$shape.json" --quiet >/dev/null
done
printf '%s\n' '{ "handles": [' '{ "name": "pulled", "vertices": [0], "translation": [0.02, 0, 0.01] },' \
  '{ "name": "held", "vertices": [9] } ] }' >"$work/shapes/handles.json"
results release release-results "${all[@]}"
results clang clang-results "${all[@]}"
results release release-few "${few[@]}"
results debug debug-few "${few[@]}"
python3 "$root/tests/compilers/same_numbers.py" "$work/release-few" "$work/debug-few" 1e-12 && debug=0 || debug=1
python3 "$root/tests/compilers/same_numbers.py" "$work/release-results" "$work/clang-results" 1e-9 && clang=0 || clang=1
((debug + clang == 0))
