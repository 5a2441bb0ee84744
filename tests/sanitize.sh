#!/bin/sh
# Builds with sanitizers and runs what they are to look at: `tests/sanitize.sh [asan-ubsan] [tsan] [valgrind]`, all by
# default, from anywhere. The first needs clang 14 with its runtime, which leaves out the inner loops of Eigen's products.
# On two cores it takes some three hours, the second some twenty minutes, the third, which runs the demo's commands, some
# ten; not part of CI. Ends with 1 when something was reported.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
jobs=$(nproc)

configure() {
  (cd "$root" && cmake --preset "$@" -Wno-dev -DORBIFIT_BUILD_TESTS=ON >/dev/null)
}

# Every test but the one that builds a program of someone else's, without sanitizers, on the installed libraries. Whole
# test programs at once: a process for each of thousands of tests would take as long as the tests.
asan_ubsan() {
  build=$root/build/asan-ubsan
  configure asan-ubsan -DORBIFIT_BUILD_BASELINES=ON
  cmake --build "$build" -j "$jobs"
  UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1
  LSAN_OPTIONS="suppressions=$root/tests/support/lsan.supp print_suppressions=0"
  export UBSAN_OPTIONS LSAN_OPTIONS
  failed=
  for program in $(find "$build/tests" -name '*_test' -type f -perm -u+x | sort); do
    in_shards "$program" || failed="$failed ${program##*/}"
  done
  ctest --test-dir "$build" -j "$jobs" --timeout 3600 --output-on-failure -R '^[a-z_]*$' -E '^package$' || failed="$failed ctest"
  commands "$build/apps/orbifit"
  if [ -n "$failed" ]; then
    echo "sanitize.sh: failed:$failed" >&2
    exit 1
  fi
}

# in_shards PROGRAM: all its tests, on every core.
in_shards() {
  echo "== ${1##*/}"
  rm -f "$1".[0-9]*.log
  processes=
  for shard in $(seq 0 $((jobs - 1))); do
    (cd "$(dirname "$1")" && GTEST_TOTAL_SHARDS=$jobs GTEST_SHARD_INDEX=$shard "$1" --gtest_brief=1 \
      >"$1.$shard.log" 2>&1) &
    processes="$processes $!"
  done
  status=0
  for process in $processes; do
    wait "$process" || status=1
  done
  # A library that stops a program early may do so with exit code 0.
  for shard in $(seq 0 $((jobs - 1))); do
    grep -q '^\[  PASSED  \]' "$1.$shard.log" || status=1
  done
  cat "$1".[0-9]*.log
  return $status
}

# Whatever runs on several threads.
tsan() {
  configure tsan
  TSAN_OPTIONS="suppressions=$root/tests/support/tsan.supp halt_on_error=1 exitcode=66 second_deadlock_stack=1"
  export TSAN_OPTIONS
  cmake --build "$root/build/tsan" --target orbifit model_test subspace_test -j "$jobs"
  "$root/build/tsan/tests/detection/model/model_test" --gtest_filter='*Parallel*:*Thread*:*SurfaceIndex*:*PointIndex*'
  "$root/build/tsan/tests/subspace/subspace_test" --gtest_filter='*Thread*:SymmetrizeSurface.*:*RadiusField*'
  commands "$root/build/tsan/apps/orbifit"
}

# The demo, each of its commands under valgrind: errors of memory and reads of what was not written, in the libraries too.
valgrind_demo() {
  reports=$(mktemp -d)
  trap 'rm -rf "$reports"' EXIT
  (cd "$root" && cmake --preset release -Wno-dev >/dev/null)
  cmake --build "$root/build/release" --target orbifit -j "$jobs"
  printf '%s\n' '#!/bin/sh' "exec valgrind --quiet --error-exitcode=66 --log-file=$reports/%p \\" \
    "  $root/build/release/apps/orbifit \"\$@\"" >"$reports/orbifit"
  chmod +x "$reports/orbifit"
  ORBIFIT=$reports/orbifit "$root/apps/demo.sh"
  cat "$reports"/[0-9]*
  ! grep -q . "$reports"/[0-9]*
}

# commands PROGRAM: each stage once, on two threads.
commands() {
  folder=$(mktemp -d)
  trap 'rm -rf "$folder"' EXIT
  cd "$folder"
  "$1" generate table -o table
  mesh=$(find table -name '*.obj' -o -name '*.ply' | sort | head -n 1)
  printf '%s\n' '{ "handles": [' \
    '{ "name": "pulled", "vertices": [0], "translation": [0.02, 0, 0] }, { "name": "held", "vertices": [9] } ] }' >handles.json
  "$1" detect "$mesh" -o found.json --threads 2
  "$1" subspace "$mesh" found.json -o basis --threads 2
  for mode in fixed floating moving; do
    "$1" deform "$mesh" found.json --handles handles.json --mode "$mode" -o edited.ply --threads 2
  done
  "$1" symmetrize "$mesh" found.json -o symmetric.ply --threads 2
  "$1" scan "$mesh" --views 3 --noise 0.002 -o scan.ply --threads 2
  "$1" fit "$mesh" scan.ply --annotation found.json -o fitted.ply --threads 2 || [ $? -eq 1 ]
  "$1" check fitted.ply found.json --threads 2
  cd "$root"
  rm -rf "$folder"
}

[ $# -gt 0 ] || set -- asan-ubsan tsan valgrind
for selection; do
  case $selection in
    asan-ubsan) asan_ubsan ;;
    tsan) tsan ;;
    valgrind) valgrind_demo ;;
    *) echo "sanitize.sh: unknown selection '$selection' (asan-ubsan, tsan, valgrind)" >&2; exit 2 ;;
  esac
done
