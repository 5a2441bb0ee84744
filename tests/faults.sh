#!/usr/bin/env bash
# Lets calls of the system fail in the middle of every command: `tests/faults.sh ORBIFIT LIBRARY [SAMPLES [KIND ...]]`.
# LIBRARY is tests/faults/faulty_system.cpp, built; SAMPLES moments are tried of each kind of fault and command (3 unless
# given), of all kinds unless some are named:
#   memory    one allocation fails; or it and all later ones
#   disk      the disk is full from some write on
#   input     a file ends at some read, as one that was cut meanwhile
#   signal    SIGINT or SIGTERM after some part of the command's time
#   output    once a command: an output in a folder that does not exist, and one where a folder stands in its way
# Each command either succeeds or ends with a documented exit code and a message; what stands among its outputs is whole:
# the bytes of an undisturbed run; nothing else lies there, and the inputs are as they were. Prints a table, and what
# broke the rule; ends with 1 then. Moments are evenly spread, but those of memory also hit the first allocations.
set -uo pipefail

orbifit=$(realpath "${1:?usage: tests/faults.sh ORBIFIT LIBRARY [SAMPLES [KIND ...]]}")
library=$(realpath "${2:?usage: tests/faults.sh ORBIFIT LIBRARY [SAMPLES [KIND ...]]}")
samples=${3:-3}
kinds=" ${*:4} "
[[ $kinds != "  " ]] || kinds=" memory disk input signal output "
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
mkdir in
"$orbifit" generate bar -o in --quiet
"$orbifit" scan in/bar.ply --views 2 --width 60 --height 60 -o in/scan.ply --quiet
cat >in/handles.json <<'END'
{"handles": [{"name": "end", "vertices": [0], "translation": [0.1, 0, 0]}, {"name": "held", "vertices": [5]}]}
END
"$orbifit" subspace in/bar.ply in/bar.annotation.json --samples 60 -o in/bar.basis --quiet
sha256sum in/* >inputs

commands=(
  "info in/bar.ply"
  "detect in/bar.ply -o out/a.json --colour out/a.ply --preview out/a.png"
  "check in/bar.ply in/bar.annotation.json"
  "symmetrize in/bar.ply in/bar.annotation.json -o out/a.ply"
  "subspace in/bar.ply in/bar.annotation.json --samples 60 -o out/a.basis"
  "deform in/bar.ply in/bar.annotation.json --handles in/handles.json --samples 60 -o out/a.obj"
  "deform in/bar.ply in/bar.annotation.json --basis in/bar.basis --handles in/handles.json -o out/a.glb"
  "fit in/bar.ply in/scan.ply --annotation in/bar.annotation.json -o out/a.obj"
  "scan in/bar.ply --views 2 --width 60 --height 60 -o out/a.pcd"
  "convert in/bar.ply out/a.stl"
  "render in/bar.ply --width 80 --height 60 -o out/a.png"
  "generate bar -o out"
  "edit in/bar.ply in/bar.annotation.json -o out/a.html"
)

failed=0
declare -A tried=() ended=()

# judge KIND CODE COMMAND WHAT: by the rule above.
judge() {
  local kind=$1 code=$2 command=$3 what=$4 file reason=""
  tried[$kind]=$((${tried[$kind]:-0} + 1))
  ended[$kind]="${ended[$kind]:-}$code "
  case $kind:$code in
    *:0) diff -rq whole out >/dev/null || reason="success, but outputs differ" ;;
    memory:1 | disk:3 | input:3 | output:3 | signal:130) ;;
    signal:143) ;; # before the program has begun the system ends it, without a word
    *) reason="exit code $code" ;;
  esac
  if ((code != 0)); then
    [[ $kind == signal && ! -s err ]] || [[ $(tail -n 1 err) == "orbifit: "* ]] || reason+=" without a message at the end"
    for file in $(find out -mindepth 1 -type f -o -mindepth 1 -name '.*'); do
      cmp -s "$file" "whole/${file#out/}" || reason+=" leaves $file"
    done
  fi
  sha256sum --status -c inputs || reason+=" changes its input"
  [[ -z $reason ]] && return
  failed=1
  echo "BROKEN by $what: $command: $reason: $(tail -n 1 err)"
}

# disturbed KIND COMMAND VARIABLE=VALUE: one run with a call that fails.
disturbed() {
  rm -rf out && mkdir out
  env "$3" LD_PRELOAD="$library" "$orbifit" $2 --threads 2 >/dev/null 2>err
  judge "$1" $? "$2" "$3"
}

# asked KIND: whether it is to be tried.
asked() { [[ $kinds == *" $1 "* ]]; }

# moments COUNT: as many numbers up to COUNT as there are samples, evenly spread.
moments() { local i; for ((i = 0; i < samples && i < $1; ++i)); do echo $(($1 * (2 * i + 1) / (2 * (samples < $1 ? samples : $1)) + 1)); done; }

for command in "${commands[@]}"; do
  rm -rf out whole && mkdir out
  started=$EPOCHREALTIME
  ORBIFIT_COUNT_CALLS=$folder/counts LD_PRELOAD="$library" "$orbifit" $command --threads 2 >/dev/null 2>err ||
    { echo "BROKEN undisturbed: $command: $(tail -n 1 err)"; failed=1; continue; }
  microseconds=$((${EPOCHREALTIME/./} - ${started/./}))
  mv out whole
  read -r allocations writes reads <counts
  if asked memory; then
    for n in 1 20 300 $(moments "$allocations"); do
      disturbed memory "$command" ORBIFIT_FAIL_ALLOCATION=$n
      disturbed memory "$command" ORBIFIT_FAIL_ALLOCATION=$n+
    done
  fi
  if asked disk; then
    for n in $(moments "$writes"); do disturbed disk "$command" ORBIFIT_FAIL_WRITE=$n; done
  fi
  if asked input; then
    for n in $(moments "$reads"); do disturbed input "$command" ORBIFIT_END_READ=$n; done
  fi
  if asked signal; then
    for after in $(moments "$microseconds"); do
      for signal in INT TERM; do
        rm -rf out && mkdir out
        # Straight from this shell, which itself ignores nothing: a background job of a script would ignore SIGINT.
        timeout --preserve-status -s $signal "$((after / 1000000)).$(printf %06d $((after % 1000000)))" \
          "$orbifit" $command --threads 2 >/dev/null 2>err
        judge signal $? "$command" "SIG$signal after $after us"
      done
    done
  fi
  asked output && [[ $command == *" out"* ]] || continue
  rm -rf out && mkdir out
  "$orbifit" ${command// out/ \/dev\/null\/out} >/dev/null 2>err
  judge output $? "$command" "no such folder"
  [[ $command == generate* ]] && continue
  rm -rf out && mkdir -p out
  for word in $command; do [[ $word == out/* ]] && mkdir "$word"; done
  "$orbifit" $command >/dev/null 2>err
  judge output $? "$command" "a folder in the way"
done

for kind in $kinds; do
  echo "$kind: ${tried[$kind]:-0} faults, exit codes $(tr ' ' '\n' <<<"${ended[$kind]:-}" | grep . | sort -n | uniq -c | awk '{printf "%s%s: %s", s, $2, $1; s = ", "}')"
done
exit "$failed"
