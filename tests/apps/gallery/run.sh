#!/usr/bin/env bash
# The gallery of 10 000 items in a real browser: which cards exist, which pictures are loaded, how long a scroll takes,
# what the filters leave. run.sh ORBIFIT [SCREENSHOT]. Exit 77: skipped, with the reason.
set -euo pipefail
orbifit=$1
tests=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
browser=$(command -v chromium || true)
[ -n "$browser" ] || { echo "skipped: chromium is not installed"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

# Results of one real item, under 10 000 names.
"$orbifit" generate bar -o models --quiet >/dev/null
rm -f models/*.json
"$orbifit" batch models --task info --out results --quiet >/dev/null
cd results
awk '{
  split("C2v C4v D4h Cinfv Oh", groups, " ")
  for (i = 1; i <= 10000; ++i) {
    line = $0
    sub(/"id":"bar.ply"/, sprintf("\"id\":\"m%05d\"", i), line)
    sub(/"mesh":/, "\"regions\":[{\"group\":\"" groups[1 + i % 5] "\",\"area\":1}],\"mesh\":", line)
    sub(/"hash":"[0-9a-f]*","vertices":[0-9]*/, sprintf("\"hash\":\"%032x\",\"vertices\":%d", i, 100 * i), line)
    sub(/"shape":\[[^]]*\]/, sprintf("\"shape\":[%g,%g,%g,%g,1]", exp(int(i / 1000) / 10), exp(int(i / 100) % 10 / 10), exp(int(i / 10) % 10 / 10), exp(i % 10 / 10)), line)
    if (i % 100 == 0) sub(/"status":"ok","message":""/, "\"status\":\"crash\",\"message\":\"<b>Segmentation fault</b>\"", line)
    print line
  }
}' results-1.jsonl >many
mv many results-1.jsonl
for i in $(seq -f %05g 1 10000); do echo "bar.ply+thumbnail.png m$i+thumbnail.png"; done | xargs -n 2 -P 2 ln
cd ..
"$orbifit" batch report results --quiet >/dev/null

cp "$tests/checks.js" results/gallery/checks.js
sed 's|</body>|<script src="checks.js"></script></body>|' results/gallery/index.html >results/gallery/checked.html
options=(--headless=new --no-sandbox --disable-gpu --hide-scrollbars --window-size=1100,800 "--user-data-dir=$folder/profile")
timeout 100 "$browser" "${options[@]}" --virtual-time-budget=60000 --dump-dom "file://$folder/results/gallery/checked.html" >dom 2>browser.log ||
  { cat browser.log; exit 1; }
said=$(sed -n '/<pre id="checks">/,/<\/pre>/p' dom | sed 's/.*<pre id="checks">//; s/<\/pre>.*//')
[ -n "$said" ] || { tail -5 browser.log; echo "the checks did not end"; exit 1; }
echo "$said"
[ "${2:-}" = "" ] || timeout 60 "$browser" "${options[@]}" "--screenshot=$2" "file://$folder/results/gallery/index.html" >/dev/null 2>&1
case $said in *FAILED*) exit 1 ;; esac
