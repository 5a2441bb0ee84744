#!/usr/bin/env bash
# orbifit batch as its users meet it: killed at any moment, with input of any kind, full disks, folders that are not
# theirs, and twice at once. batch.sh ORBIFIT
set -euo pipefail
orbifit=$1
folder=$(mktemp -d)
trap 'umount "$folder/small" 2>/dev/null || true; rm -rf "$folder"' EXIT
cd "$folder"

fail() {
  echo "FAILED: $*" >&2
  exit 1
}
# expect CODE COMMAND ...: its output goes to the file `said`.
expect() {
  local code=0 wanted=$1
  shift
  "$@" >said 2>&1 || code=$?
  [ "$code" -eq "$wanted" ] || fail "$* ended with $code, not $wanted: $(cat said)"
}
records() { sed -E 's/"seconds":[^,]*,"peak_memory":[^,]*,//' "$1"/results-*.jsonl | sort; }
files() { (cd "$1" && find . -type f ! -name 'results-*' | sort | xargs -d '\n' sha256sum); }
status_of() { grep -F "\"id\":\"$2\"" "$1/results-1.jsonl" | sed -E 's/.*"status":"([a-z_]+)".*/\1/'; }

"$orbifit" generate bar -o one --quiet >/dev/null
"$orbifit" convert one/bar.ply bar.obj --quiet >/dev/null
mkdir models
for i in $(seq 1 24); do { echo "# $i"; cat bar.obj; } >"models/$i.obj"; done

echo "== killed at many moments: with the rest, what one batch leaves"
batch() { "$orbifit" batch models --task info --out "$@" --quiet; }
expect 0 batch whole --jobs 2
for moment in 0.003 0.02 0.05 0.1 0.15 0.2 0.3 0.4 0.6 1; do
  "$orbifit" batch models --task info --out killed --jobs 2 --quiet >/dev/null 2>&1 &
  sleep $moment
  kill -KILL $! 2>/dev/null || true
  wait $! 2>/dev/null || true
done
expect 0 batch killed --jobs 2
diff <(records whole) <(records killed) || fail "other records"
diff <(files whole) <(files killed) || fail "other files"
[ "$(wc -l <killed/results-1.jsonl)" -eq 24 ] || fail "items twice"
[ -z "$(find killed -name '.*.tmp' -o -name '.work*')" ] || fail "something is left"

echo "== shards together are the whole"
for shard in 1/3 2/3 3/3; do expect 0 batch parts --shard $shard; done
diff <(records whole) <(records parts) || fail "other records"
expect 0 "$orbifit" batch status parts
grep -q "24 of 24 items" said || fail "$(cat said)"

echo "== input of any kind"
mkdir odd odd/model.obj
: >odd/empty.obj
printf 'v 0 0 0\nv 1 0 0\n' >odd/nofaces.obj
printf 'v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n' >odd/nan.obj
truncate -s 10G odd/sparse.ply
mkfifo odd/pipe.off
cp bar.obj odd/good.obj
long=$(printf 'x%.0s' $(seq 300))
{
  for name in empty.obj nofaces.obj nan.obj sparse.ply pipe.off model.obj missing.obj good.obj; do
    echo "{\"id\": \"$name\", \"mesh\": \"odd/$name\"}"
  done
  for id in '../up' 'a/b/c' 'new\nline' "$long" ' ' '%'; do echo "{\"id\": \"$id\", \"mesh\": \"odd/good.obj\"}"; done
  echo '{"id": "unknown", "mesh": "odd/good.obj", "options": {"tolerence": 1}}'
  echo '{"id": "writes", "mesh": "odd/good.obj", "options": {"preview": "x.png"}}'
} >odd.jsonl
expect 5 "$orbifit" batch odd.jsonl --task info --out odd_results --item-memory 1G --item-timeout 60
for name in empty.obj nofaces.obj nan.obj pipe.off model.obj missing.obj unknown writes; do
  [ "$(status_of odd_results "$name")" = bad_input ] || fail "$name is $(status_of odd_results "$name")"
done
[ "$(status_of odd_results sparse.ply)" = oom ] || fail "sparse.ply"
[ "$(find odd_results -name '*.json' | wc -l)" -eq 7 ] || fail "results: $(find odd_results)"
[ "$(grep -c '"status":"ok"' odd_results/results-1.jsonl)" -eq 7 ] || fail "good items"
[ ! -e up.json ] && [ ! -e x.png ] || fail "written outside"
expect 5 "$orbifit" batch odd.jsonl --task info --out odd_results --item-memory 1G --item-timeout 60
grep -q "16 done before" said || fail "$(cat said)"
echo '{"id": "a", "mesh": "x"}' >twice.jsonl
echo '{"id": "a", "mesh": "y"}' >>twice.jsonl
expect 3 "$orbifit" batch twice.jsonl --task info --out none
grep -q "line 2: has the id of line 1" said || fail "$(cat said)"
[ ! -e none ] || fail "begun"
expect 2 "$orbifit" batch models --task paint --out none
expect 2 "$orbifit" batch models --task info
expect 2 "$orbifit" batch models --task info --out none --shard 5/4
expect 3 "$orbifit" batch status none

echo "== limits"
expect 5 "$orbifit" batch models --glob '1.obj' --task detect --out slow --item-timeout 0.05
[ "$(status_of slow 1.obj)" = timeout ] || fail "$(cat slow/results-1.jsonl)"
expect 0 "$orbifit" batch models --glob '1.obj' --task info --out thin --item-memory 1G
expect 5 "$orbifit" batch models --glob '2.obj' --task detect --out thin2 --item-memory 2M
[ "$(status_of thin2 2.obj)" = oom ] || fail "$(cat thin2/results-1.jsonl)"

echo "== two at once, interruption"
"$orbifit" batch models --task detect --out both --jobs 1 --quiet >/dev/null 2>&1 &
first=$!
while [ ! -e both/results-1.shard ]; do sleep 0.02; done
expect 3 "$orbifit" batch models --task detect --out both --jobs 1
grep -q "another batch is writing it" said || fail "$(cat said)"
kill -INT $first
code=0
wait $first || code=$?
[ $code -eq 130 ] || fail "interrupted: $code"
[ ! -e both/.work-1 ] || fail "something is left"
! pgrep -f "^$orbifit batch models --task detect --out both" || fail "a process is left"

echo "== a clock that jumps"
faketime=$(find /usr/lib -name libfaketime.so.1 2>/dev/null | head -n 1)
if [ -n "$faketime" ]; then
  echo "+0" >clock
  # The time of day alone: nobody can set the clock that counts since the start.
  jumping=(env "LD_PRELOAD=$faketime" "FAKETIME_TIMESTAMP_FILE=$folder/clock" FAKETIME_NO_CACHE=1 FAKETIME_DONT_FAKE_MONOTONIC=1)
  "${jumping[@]}" "$orbifit" batch models --task info --out jumped --item-timeout 100 --jobs 2 --quiet >/dev/null 2>&1 &
  batch_under_jumps=$!
  while kill -0 $batch_under_jumps 2>/dev/null; do
    for jump in +10y -10y +200s; do echo "$jump" >clock && sleep 0.03; done
  done
  wait $batch_under_jumps || fail "the clock jumped: $(cat jumped/results-1.jsonl)"
  diff <(records whole) <(records jumped) || fail "other records after the clock jumped"
  diff <(files whole) <(files jumped) || fail "other files after the clock jumped"
  ! grep -E '"seconds":(-|[0-9]{2})' jumped/results-1.jsonl || fail "times that include jumps"
  echo "-20y" >clock
  expect 0 "${jumping[@]}" "$orbifit" batch models --task info --out jumped
  grep -q "24 done before" said || fail "$(cat said)"
else
  echo "the clock does not jump: libfaketime is not installed"
fi

echo "== disks and folders that refuse"
(ulimit -f 6 && expect 3 batch limited) || fail "limit on files"
grep -q "cannot be written" said || fail "$(cat said)"
expect 0 batch limited
diff <(records whole) <(records limited) || fail "other records after a full disk"
diff <(files whole) <(files limited) || fail "other files after a full disk"
mkdir small
if mount -t tmpfs -o size=200k none small 2>/dev/null; then
  expect 3 batch small/results
  grep -q "No space left" said || fail "$(cat said)"
  mount -o remount,size=8m small
  expect 0 batch small/results
  diff <(records whole) <(records small/results) || fail "other records after a full disk"
  diff <(files whole) <(files small/results) || fail "other files after a full disk"
  umount small
else
  echo "no disk of 200 kB: a tmpfs cannot be mounted here"
fi
expect 3 "$orbifit" batch models --task info --out /proc/results
mkdir forbidden
chmod 500 forbidden
if [ "$(id -u)" -ne 0 ]; then
  expect 3 "$orbifit" batch models --task info --out forbidden/results
elif chmod 755 "$folder" && setpriv --reuid=65534 --clear-groups "$orbifit" --version >/dev/null 2>&1; then
  expect 3 setpriv --reuid=65534 --clear-groups "$orbifit" batch models --task info --out forbidden/results
  grep -q "Permission denied" said || fail "$(cat said)"
fi

echo "== the other tasks, reports and tables"
"$orbifit" scan one/bar.ply -o scan.ply --quiet >/dev/null
echo '{"id": "bar", "mesh": "one/bar.ply", "scans": ["scan.ply"]}' >fit.jsonl
echo '{"id": "none", "mesh": "one/bar.ply"}' >>fit.jsonl
expect 5 "$orbifit" batch fit.jsonl --task fit --out fits
for kind in .json +fitted.ply +annotation.json +thumbnail.png; do [ -s "fits/bar$kind" ] || fail "fit leaves no bar$kind: $(cat fits/results-1.jsonl)"; done
expect 0 "$orbifit" batch one --task symmetrize --out exact
expect 0 "$orbifit" check exact/bar.ply+symmetric.ply exact/bar.ply.json --max-residual 1e-9
expect 0 "$orbifit" batch report exact
[ -s exact/gallery/index.html ] && [ -s exact/gallery/items.js ] || fail "no gallery"
cp models/1.obj models/copy.obj
expect 0 batch whole
expect 0 "$orbifit" batch export whole --sqlite orbifit.db --csv tables
[ "$(head -n 1 tables/items.csv | cut -c1-9)" = "id,status" ] || fail "$(head -n 1 tables/items.csv)"
[ "$(wc -l <tables/items.csv)" -eq 26 ] || fail "$(wc -l tables/items.csv)"
grep -q '^copy.obj,ok,.*,1.obj,1.obj,' tables/items.csv || fail "the copy is not told"
expect 0 "$orbifit" batch export exact --sqlite exact.db
if command -v sqlite3 >/dev/null; then
  [ "$(sqlite3 orbifit.db 'select count(*), count(same_file_as) from items')" = "25|1" ] || fail "database"
  [ "$(sqlite3 exact.db 'select count(*) from regions join items on items.id = regions.item')" -ge 1 ] || fail "regions"
fi
echo "all as they should be"
