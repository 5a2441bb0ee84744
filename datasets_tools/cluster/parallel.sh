#!/usr/bin/env bash
# A batch on the processors of one machine by GNU parallel, a shard a slot; slots on others by its own --sshlogin.
#   parallel.sh SHARDS SLOTS LOG orbifit batch SOURCE --task TASK --out DIR ...
# A shard that was killed is begun again, up to three times, and goes on where it was. LOG is parallel's record of it.
set -euo pipefail
shards=$1 slots=$2 log=$3
shift 3
# Some items that failed (5) are no reason to begin again: the same would fail.
run_shard() {
  local code=0
  "${@:2}" --shard "$1" --jobs 1 --quiet || code=$?
  ((code == 5)) || return "$code"
}
export -f run_shard
seq 1 "$shards" | parallel --will-cite --jobs "$slots" --joblog "$log" --retries 4 --quote run_shard "{}/$shards" "$@"
