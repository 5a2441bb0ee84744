#!/usr/bin/env bash
# Builds the fuzzers with clang and runs each of them: `tests/fuzz.sh SECONDS [FUZZER ...]`, from anywhere; SECONDS
# is for all together, FUZZER such as obj or basis (all without). Seeds are the files of bad input and of tests/fuzz/corpus. What a fuzzer learns
# stays in build/fuzz/corpus, what it finds goes to build/fuzz/found; ends with 1 then. Not part of CI.
source "$(dirname "${BASH_SOURCE[0]}")/../apps/setup.sh"

seconds=${1:?usage: tests/fuzz.sh SECONDS [FUZZER ...]}
shift
install_packages "${program_packages[@]}" "${fuzz_packages[@]}"
build=$root/build/fuzz
(cd "$root" && cmake --preset fuzz -Wno-dev >"$build.log" 2>&1) || { cat "$build.log" >&2; exit 1; }
cmake --build "$build" --target fuzzers

mkdir -p "$build/seeds" "$build/found"
"$build/tests/fuzz/write_bad_input" "$build/seeds" >/dev/null
rm -f "$build"/seeds/large_* "$build"/seeds/shape_3000_*
(($#)) || set -- $(cd "$build/tests/fuzz" && ls -d fuzz_* | sed 's/^fuzz_//')
export LSAN_OPTIONS="suppressions=$root/tests/support/lsan.supp print_suppressions=0"
jobs=$(nproc)
each=$((seconds * jobs / $#))

# run_fuzzer NAME: one line with its executions and features, or what it found.
run_fuzzer() {
  local corpus=$build/corpus/$1 log=$build/found/$1.log
  mkdir -p "$corpus" "$build/seeds/$1"
  cp -n "$build"/seeds/${pattern[$1]:-$1}_* "$root/tests/fuzz/corpus/$1"/* "$build/seeds/$1/" 2>/dev/null || true
  if nice "$build/tests/fuzz/fuzz_$1" "$corpus" "$build/seeds/$1" -max_total_time="$each" -max_len=65536 -timeout=20 \
    -rss_limit_mb=2048 -malloc_limit_mb=512 -artifact_prefix="$build/found/$1-" -print_final_stats=1 >"$log" 2>&1; then
    echo "$1: $(sed -n 's/stat::number_of_executed_units: *//p' "$log") executions, $(grep -o 'cov: [0-9]*' "$log" | tail -n 1)"
  else
    echo "$1: FOUND, see $log"
    grep -m 3 -e ERROR -e 'runtime error' -e what "$log" || true
    return 1
  fi
}

declare -A pattern=([ply]='ply*' [stl]='stl*' [pcd]='pcd*' [ply_scan]=ply [radius_field]=radii)
failed=0
running=0
for name; do
  run_fuzzer "$name" &
  ((++running < jobs)) || { wait -n || failed=1; ((running--)) || true; }
done
while ((running > 0)); do
  wait -n || failed=1
  ((running--)) || true
done
exit "$failed"
