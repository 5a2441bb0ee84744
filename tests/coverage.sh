#!/usr/bin/env bash
# Which lines of the readers the bad input, the fuzzers' corpus in the repository and, where there is one, what
# tests/fuzz.sh learnt reach: `tests/coverage.sh`, from anywhere. Builds the fuzzers once more, with clang's coverage, and
# prints a line a file; build/coverage/lines holds each line with its count. Not part of CI.
source "$(dirname "${BASH_SOURCE[0]}")/../apps/setup.sh"

install_packages "${program_packages[@]}" "${fuzz_packages[@]}"
build=$root/build/coverage
(cd "$root" && cmake --preset fuzz -B "$build" -Wno-dev -DCMAKE_CXX_FLAGS="-fprofile-instr-generate -fcoverage-mapping" \
  >"$build.log" 2>&1) || { cat "$build.log" >&2; exit 1; }
cmake --build "$build" --target fuzzers

rm -rf "$build/seeds" "$build/profiles"
mkdir -p "$build/seeds" "$build/profiles"
"$build/tests/fuzz/write_bad_input" "$build/seeds" >/dev/null
rm -f "$build"/seeds/large_* "$build"/seeds/shape_3000_*
objects=()
for fuzzer in "$build"/tests/fuzz/fuzz_*; do
  name=${fuzzer##*/fuzz_}
  mkdir -p "$build/empty" "$root/tests/fuzz/corpus/$name" "$root/build/fuzz/corpus/$name"
  LLVM_PROFILE_FILE=$build/profiles/$name.profraw "$fuzzer" -runs=0 -max_len=65536 "$build/empty" "$build/seeds" \
    "$root/tests/fuzz/corpus/$name" "$root/build/fuzz/corpus/$name" 2>/dev/null
  objects+=(-object "$fuzzer")
done
llvm-profdata-14 merge -o "$build/profile" "$build"/profiles/*.profraw
readers=("$root"/detection/model/src/files/*.cpp "$root"/subspace/src/io/*.cpp "$root"/subspace/src/deformation/handles.cpp
  "$root"/fitting/src/registration/landmarks.cpp "$root"/datasets_tools/src/batch/manifest.cpp)
llvm-cov-14 show "${objects[@]}" -instr-profile="$build/profile" "${readers[@]}" >"$build/lines"
llvm-cov-14 report "${objects[@]}" -instr-profile="$build/profile" "${readers[@]}" |
  awk 'NF > 8 { print $1, $8, $9, $10 }' | column -t
