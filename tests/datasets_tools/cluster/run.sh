#!/usr/bin/env bash
# Runs a batch as datasets_tools/cluster does, on this machine, kills some of it midway, and compares what is left with
# one uninterrupted batch: run.sh parallel|slurm|snakemake|dask|simulate ORBIFIT. Exit 77: skipped, with the reason.
set -euo pipefail
kind=$1 orbifit=$2
tests=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
cluster=$tests/../../../datasets_tools/cluster
folder=$(mktemp -d)
stops=()
clean() {
  local stop
  for stop in "${stops[@]:-}"; do [ -z "$stop" ] || kill "$stop" 2>/dev/null || true; done
  wait 2>/dev/null || true
  rm -rf "$folder"
}
trap clean EXIT
cd "$folder"
PATH=/usr/bin:$PATH # the packages that setup.sh installs are those of Debian's Python

skip() {
  echo "skipped: $*"
  exit 77
}
need() { command -v "$1" >/dev/null || skip "$1 is not installed"; }

# Enough items that a shard is under way when it is killed; one of them is no mesh.
make_models() {
  mkdir models
  "$orbifit" generate bar -o models --quiet >/dev/null
  rm -f models/*.json
  local i
  for i in $(seq 1 40); do { echo "# $i"; cat bar.obj; } >"models/bar$i.obj"; done
  : >models/empty.obj
}
prepare() {
  "$orbifit" generate bar -o one --quiet >/dev/null
  "$orbifit" convert one/bar.ply bar.obj --quiet >/dev/null
  make_models
  rm models/bar.ply
  "$orbifit" batch models --task info --out expected --quiet >/dev/null || [ $? -eq 5 ]
}

# The records without their order, times and memory.
records() { cat "$1"/results-*.jsonl | sed -E 's/"seconds":[^,]*,"peak_memory":[^,]*,//' | sort; }
files() { (cd "$1" && find . -type f ! -name 'results-*' ! -path './.shards/*' | sort | xargs -d '\n' sha256sum); }
compare() {
  diff <(records expected) <(records "$1")
  diff <(files expected) <(files "$1")
  [ "$(cat "$1"/results-*.jsonl | wc -l)" -eq 41 ]
  echo "41 items, the same records and files as one uninterrupted batch"
}

# kill_one PATTERN: the first orbifit of this test with that in its call, as soon as its shard has a result.
kill_one() {
  local process
  for _ in $(seq 1 600); do
    if [ -s "$2" ]; then
      for process in $(pgrep -f "^$orbifit batch models .*$1" || true); do
        # Of the batch and its items the batch: it has the other for its parent.
        grep -q orbifit "/proc/$(ps -o ppid= -p "$process" | tr -d ' ')/comm" 2>/dev/null && continue
        kill -KILL "$process" && echo "killed process $process of shard $1" && return 0
      done
    fi
    sleep 0.02
  done
  echo "no process of shard $1 to kill" >&2
  return 1
}

case $kind in
  parallel)
    need parallel
    prepare
    "$cluster/parallel.sh" 4 2 log "$orbifit" batch models --task info --out results --threads 1 &
    kill_one 1/4 results/results-1.jsonl
    wait $!
    cat log
    compare results
    ;;

  slurm)
    for program in munged slurmctld slurmd sbatch; do need "$program"; done
    prepare
    chmod 755 "$folder"
    (umask 077 && head -c 1024 /dev/urandom >key)
    munged --force --foreground --socket="$folder/munge.socket" --key-file="$folder/key" --pid-file="$folder/munged.pid" \
      --log-file="$folder/munged.log" --seed-file="$folder/seed" >munged.out 2>&1 &
    stops+=($!)
    sed -e "s|FOLDER|$folder|g; s|HOST|$(hostname -s)|g; s|CPUS|$(nproc)|g; s|USER|$(id -un)|g" "$tests/slurm.conf" >slurm.conf
    mkdir state spool
    export SLURM_CONF=$folder/slurm.conf
    slurmctld -D >slurmctld.out 2>&1 &
    stops+=($!)
    slurmd -D >slurmd.out 2>&1 &
    stops+=($!)
    for _ in $(seq 1 100); do
      sinfo -h -o %T 2>/dev/null | grep -q idle && break
      sleep 0.1
    done
    sinfo -h -o %T 2>/dev/null | grep -q idle || skip "Slurm's daemons do not start: $(tail -qn 1 munged.out slurmctld.out slurmd.out | tr '\n' ' ')"
    sbatch --array=1-4 "$cluster/slurm.sbatch" "$orbifit" batch models --task info --out results
    kill_one 2/4 results/results-2.jsonl
    for _ in $(seq 1 900); do
      [ -n "$(squeue -h)" ] || break
      sleep 0.1
    done
    echo "Slurm's record of the tasks:"
    cat accounting
    [ "$(grep -c 'JobState=COMPLETED' accounting)" -eq 4 ]
    compare results
    ;;

  snakemake)
    need snakemake
    prepare
    snakemake --quiet --snakefile "$cluster/Snakefile" --cores 2 \
      --config "orbifit=$orbifit" source=models task=info out=results shards=4 'more=--threads 1' >snakemake.log 2>&1 &
    kill_one 3/4 results/results-3.jsonl
    wait $! || { cat snakemake.log; exit 1; }
    compare results
    ;;

  dask)
    need python3
    python3 -c 'import distributed' 2>/dev/null || skip "Dask's distributed (python3-distributed) is not installed"
    prepare
    "$cluster/dask_batch.py" 4 "$orbifit" batch models --task info --out results --threads 1 &
    kill_one 4/4 results/results-4.jsonl
    code=0
    wait $! || code=$?
    [ "$code" -eq 5 ] # the empty file
    compare results
    ;;

  simulate)
    need python3
    python3 -c 'import numpy' 2>/dev/null || skip "numpy (python3-numpy) is not installed"
    # Ten workers that never fail and items of one second: arithmetic.
    seq 50 | sed 's/.*/1/' >seconds
    "$cluster/simulate" seconds --items 1e5 --workers 10 --shards 1000 --mtbf-hours 0 --overhead 0 >plain
    "$cluster/simulate" seconds --items 1e5 --workers 10 --shards 1000 --mtbf-hours 0 --overhead 0 >again
    cmp plain again
    python3 - <<'PY'
import json
plain = json.load(open("plain"))
assert plain["failures"] == 0 and plain["lost_hours"] == 0, plain
assert 1e5 / 10 / 3600 <= plain["makespan_hours"] + 1e-3 and plain["efficiency"] > 0.97, plain
assert abs(plain["processor_hours"] - 1e5 / 3600) < 0.1, plain
PY
    "$cluster/simulate" seconds --items 1e5 --workers 10 --shards 10 --mtbf-hours 0.5 --restart-seconds 600 --overhead 0 >worse
    python3 - <<'PY'
import json
plain, worse = json.load(open("plain")), json.load(open("worse"))
# 28 processor hours at a failure each half hour.
assert 30 < worse["failures"] < 90 and worse["makespan_hours"] > plain["makespan_hours"] * 1.2, worse
PY
    ;;
esac
