#!/usr/bin/env bash
# Which lines of the readers the tests of bad input reach: `tests/coverage.sh`, from anywhere. Builds these tests once
# more, with clang's coverage, runs them, and prints a line a file; build/coverage/lines holds each line with its count.
# Some forty minutes on two cores; not part of CI. Files that read may write as well, which bad input does not reach.
source "$(dirname "${BASH_SOURCE[0]}")/../apps/setup.sh"

install_packages "${program_packages[@]}" "${test_packages[@]}" "${fuzz_packages[@]}"
build=$root/build/coverage
(cd "$root" && cmake --preset fuzz -B "$build" -Wno-dev -DORBIFIT_BUILD_FUZZERS=OFF -DORBIFIT_BUILD_TESTS=ON -DORBIFIT_BUILD_BASELINES=ON \
  -DCMAKE_CXX_FLAGS="-fprofile-instr-generate -fcoverage-mapping" >"$build.log" 2>&1) || { cat "$build.log" >&2; exit 1; }
cmake --build "$build" --target robustness_test batch_test

rm -rf "$build/profiles"
export LLVM_PROFILE_FILE=$build/profiles/%m.profraw
programs=("$build/tests/robustness/robustness_test" "$build/tests/datasets_tools/batch/batch_test" "$build/apps/orbifit")
"${programs[0]}"
"${programs[1]}" --gtest_filter='*Manifest*'
llvm-profdata-14 merge -o "$build/profile" "$build"/profiles/*.profraw
export LLVM_PROFILE_FILE=/dev/null
objects=("${programs[0]}" "${programs[@]/#/-object=}")
llvm-cov-14 show "${objects[@]}" -instr-profile="$build/profile" >"$build/lines" 2>/dev/null
llvm-cov-14 report "${objects[@]}" -instr-profile="$build/profile" 2>/dev/null |
  awk '$1 ~ /model\/src\/files\/|subspace\/src\/io\/|deformation\/handles\.cpp|landmarks\.cpp|batch\/manifest\.cpp/ { print $1, $8, $9, $10 }' |
  column -t
