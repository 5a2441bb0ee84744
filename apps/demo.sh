#!/usr/bin/env bash
# The whole pipeline on a real mesh and on a generated chair: detect, check, deform, check, scan, fit, check. Prints what
# it finds and leaves out/index.html, which needs nothing else.
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

install_packages "${program_packages[@]}"
build_release -DORBIFIT_BUILD_TESTS=OFF -DORBIFIT_BUILD_BASELINES=OFF
orbifit=$build/apps/orbifit
out=$root/out
rm -rf "$out"
mkdir -p "$out/models"
cd "$out"

# A real mesh, of those that CGAL's demonstration brings; the package is taken apart rather than installed, since it
# depends on fifty others.
meshes=/usr/share/doc/libcgal-dev/data.tar.gz
if [ ! -f "$meshes" ]; then
  cd models
  apt-get download -qq libcgal-demo 2>/dev/null || { "${as_root[@]}" apt-get update -qq && apt-get download -qq libcgal-demo; }
  dpkg-deb -x libcgal-demo_*.deb .
  rm libcgal-demo_*.deb
  cd ..
  meshes=models$meshes
fi
tar xzOf "$meshes" data/meshes/pinion.off >models/pinion.off

sections=()

# run NAME COMMAND ...: one step, shown, timed, its figures kept in NAME.json.
run() {
  local name=$1 start end
  shift
  echo
  echo "\$ orbifit $*"
  start=$(date +%s.%N)
  "$orbifit" "$@" | tee "$name.txt"
  end=$(date +%s.%N)
  seconds=$(awk "BEGIN { printf \"%.2f\", $end - $start }")
  echo "($seconds s)"
}

json() { sed 's/\\/\\\\/g; s/"/\\"/g' | awk '{ printf "%s\\n", $0 }'; }

# section TITLE TEXT NAME PICTURE CAPTION [PICTURE CAPTION ...]: what the page shows of the step NAME.
section() {
  local title=$1 text=$2 name=$3 pictures=() rows=() line
  shift 3
  while (($#)); do
    pictures+=("{\"file\":\"$1\",\"caption\":\"$2\"}")
    shift 2
  done
  while IFS= read -r line; do
    [ -z "$line" ] || rows+=("[\"$(printf '%s' "$line" | json | sed 's/\\n$//')\"]")
  done <"$name.txt"
  local joined_pictures joined_rows
  joined_pictures=$(IFS=,; echo "${pictures[*]:-}")
  joined_rows=$(IFS=,; echo "${rows[*]:-}")
  sections+=("{\"title\":\"$title\",\"text\":\"$text ($seconds s)\",\"pictures\":[$joined_pictures],\"tables\":[{\"headers\":[\"orbifit says\"],\"rows\":[$joined_rows]}]}")
}

picture() { # picture OUT MESH ARGUMENTS ...
  local file=$1
  shift
  "$orbifit" render "$@" --width 640 --height 520 --quiet -o "$file" >/dev/null
}

echo "== A real mesh: a pinion"
cat >pinion_handles.json <<'JSON'
{ "handles": [ { "name": "one tooth", "centre": [-0.781, -0.157, -0.421], "radius": 0.25, "translation": [-0.205, -0.031, -0.171] },
               { "name": "the bore", "centre": [-0.602, -0.084, -0.053], "radius": 0.15 } ] }
JSON
run pinion_detect detect models/pinion.off -o pinion.json --preview pinion_regions.png
section "Detect" "The symmetries of a real mesh, found without help." pinion_detect pinion_regions.png "regions"
run pinion_check check models/pinion.off pinion.json
section "Check" "How far the mesh itself is from symmetric." pinion_check
run pinion_deform deform models/pinion.off pinion.json --handles pinion_handles.json -o pinion_edited.ply
picture pinion_edited.png models/pinion.off --compare pinion_edited.ply
section "Deform" "One end of one tooth is pulled; all follow." pinion_deform pinion_edited.png "before and after"
run pinion_recheck check models/pinion.off pinion.json --deformed pinion_edited.ply
section "Check" "What the deformation added to the residual." pinion_recheck

echo
echo "== A generated chair"
cat >chair_handles.json <<'JSON'
{ "handles": [ { "name": "seat", "centre": [0, 0, 0.43], "radius": 0.2, "translation": [0, 0, 0.06] },
               { "name": "one foot", "centre": [0.23, 0.23, 0], "radius": 0.08, "translation": [0.02, 0.02, 0] },
               { "name": "crest", "centre": [0, 0.27, 0.93], "radius": 0.12, "translation": [0, 0.01, 0.09] } ] }
JSON
run chair_generate generate chair -o models
run chair_detect detect models/chair.ply -o chair.json --preview chair_regions.png
section "Detect" "A chair of sixteen parts: nested regions and a row of slats." chair_detect chair_regions.png "regions and patterns"
run chair_check check models/chair.ply chair.json --max-residual 1e-9
section "Check" "The chair at rest." chair_check
run chair_deform deform models/chair.ply chair.json --handles chair_handles.json -o chair_edited.ply --annotation-out chair_edited.json
picture chair_edited.png models/chair.ply --compare chair_edited.ply
section "Deform" "Three handles: the seat up, one foot out, the crest up." chair_deform chair_edited.png "before and after"
run chair_recheck check models/chair.ply chair.json --deformed chair_edited.ply --mode moving
section "Check" "The whole stays symmetric to rounding; parts do as far as the lift of the paper keeps them." chair_recheck
run chair_edit edit models/chair.ply chair.json -o editor.html
run chair_scan scan chair_edited.ply --views 1 --azimuth 40 --noise 0.001 -o scan.ply
picture scan.png chair_edited.ply --points scan.ply
section "Scan" "The edited chair seen by one virtual depth camera." chair_scan scan.png "the scan"
run chair_fit fit models/chair.ply scan.ply --annotation chair.json -o chair_fitted.ply --report chair_fit.json --annotation-out chair_fitted.json
picture fit.png chair_fitted.ply --points scan.ply
picture fit_truth.png chair_fitted.ply --compare chair_edited.ply --azimuth 220
section "Fit" "The original chair fitted to the scan; its hidden sides are completed by symmetry." chair_fit fit.png "scan over fit" fit_truth.png "fit and truth from behind, where the scan saw nothing"
run chair_fit_check check models/chair.ply chair.json --deformed chair_fitted.ply --mode moving
section "Check" "The fitted chair." chair_fit_check

printf '{"title":"Orbifit: detect, deform, fit","intro":"%s","sections":[%s]}\n' \
  "Made by apps/demo.sh with the commands shown in the terminal. Distances are fractions of the diagonal." \
  "$(IFS=,; echo "${sections[*]}")" >steps.json
"$orbifit" report steps.json -o index.html >/dev/null
echo
echo "Pictures and figures: out/index.html; the chair to be edited in a browser: out/editor.html"
