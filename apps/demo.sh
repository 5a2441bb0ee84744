#!/usr/bin/env bash
# The whole pipeline on a real mesh and on a generated chair: detect, check, deform, check, scan, fit, check. Prints what
# it finds and leaves out/index.html, which shows each step with its command and links to the files beside it.
# ORBIFIT, where it is set, is run in place of the program that is built here.
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

install_packages "${program_packages[@]}"
orbifit=${ORBIFIT:-$build/apps/orbifit}
[ -n "${ORBIFIT:-}" ] || build_release -DORBIFIT_BUILD_TESTS=OFF -DORBIFIT_BUILD_BASELINES=OFF
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

# run NAME COMMAND ...: one step, shown, timed; what it prints is kept for the page.
run() {
  local name=$1 start end
  shift
  command="orbifit $*"
  echo
  echo "\$ $command"
  start=$(date +%s.%N)
  "$orbifit" "$@" | tee "$name.txt"
  end=$(date +%s.%N)
  seconds=$(awk "BEGIN { printf \"%.2f\", $end - $start }")
  echo "($seconds s)"
}

# text: standard input as a JSON string.
text() { sed 's/\\/\\\\/g; s/"/\\"/g; s/\t/  /g' | awk 'BEGIN { printf "\"" } { printf "%s%s", (NR > 1 ? "\\n" : ""), $0 } END { printf "\"" }'; }

# section TITLE TEXT NAME [picture FILE CAPTION | regions MESH ANNOTATION | file FILE] ...: the step NAME on the page.
section() {
  local title=$1 words=$2 name=$3 pictures=() files=() regions=
  shift 3
  while (($#)); do
    case $1 in
      picture) pictures+=("{\"file\":\"$2\",\"caption\":\"$3\"}"); files+=("\"$2\""); shift 3 ;;
      regions) regions=",\"regions\":{\"mesh\":\"$2\",\"annotation\":\"$3\"}"; shift 3 ;;
      file) files+=("\"$2\""); shift 2 ;;
    esac
  done
  local IFS=,
  sections+=("{\"title\":\"$title\",\"text\":\"$words ($seconds s)\",\"command\":$(text <<<"$command"),\"output\":$(text <"$name.txt"),\"pictures\":[${pictures[*]:-}],\"files\":[${files[*]:-}]$regions}")
}

picture() { # picture OUT ARGUMENTS ...
  local file=$1
  shift
  "$orbifit" render "$@" --width 400 --height 320 --quiet -o "$file"
}

echo "== A real mesh: a pinion"
cat >pinion_handles.json <<'JSON'
{ "handles": [ { "name": "one tooth", "centre": [-0.781, -0.157, -0.421], "radius": 0.25, "translation": [-0.205, -0.031, -0.171] },
               { "name": "the bore", "centre": [-0.602, -0.084, -0.053], "radius": 0.15 } ] }
JSON
run pinion_detect detect models/pinion.off -o pinion.json --preview pinion_regions.png
section "Pinion: detect" "The symmetries of a real mesh, found without help." pinion_detect \
  regions models/pinion.off pinion.json file models/pinion.off file pinion.json file pinion_regions.png
run pinion_check check models/pinion.off pinion.json
section "Pinion: check at rest" "How far the mesh itself is from symmetric, region by region." pinion_check
run pinion_deform deform models/pinion.off pinion.json --handles pinion_handles.json -o pinion_edited.ply
# The axis of the whole, upwards: the pinion lies askew in its file.
up=$(sed -n 's/.*"axis": \[\(.*\)\].*/\1/p' pinion.json | awk -F, 'NR == 1 { s = $3 < 0 ? -1 : 1; print s * $1, s * $2, s * $3 }')
# shellcheck disable=SC2086
picture pinion_edited.png models/pinion.off --compare pinion_edited.ply --up $up
section "Pinion: deform" "One end of one tooth is pulled; all teeth follow." pinion_deform \
  picture pinion_edited.png "before and after" file pinion_handles.json file pinion_edited.ply
run pinion_recheck check models/pinion.off pinion.json --deformed pinion_edited.ply
section "Pinion: check the edit" "The displacement is symmetric to rounding errors, as the step before says. The triangles of this mesh are not symmetric, so distances are measured to the surface between vertices; the excess is what the edit adds to them." pinion_recheck

echo
echo "== A generated chair"
cat >chair_handles.json <<'JSON'
{ "handles": [ { "name": "seat", "centre": [0, 0, 0.43], "radius": 0.2, "translation": [0, 0, 0.06] },
               { "name": "one foot", "centre": [0.23, 0.23, 0], "radius": 0.08, "translation": [0.02, 0.02, 0] },
               { "name": "crest", "centre": [0, 0.27, 0.93], "radius": 0.12, "translation": [0, 0.01, 0.09] } ] }
JSON
run chair_generate generate chair -o models
run chair_detect detect models/chair.ply -o chair.json --preview chair_regions.png
section "Chair: detect" "A generated chair of sixteen parts: nested regions and a row of slats." chair_detect \
  regions models/chair.ply chair.json file models/chair.ply file chair.json file chair_regions.png
run chair_check check models/chair.ply chair.json --max-residual 1e-9
section "Chair: check at rest" "The generated chair is exactly symmetric, to rounding errors." chair_check
run chair_deform deform models/chair.ply chair.json --handles chair_handles.json -o chair_edited.ply --annotation-out chair_edited.json
picture chair_edited.png models/chair.ply --compare chair_edited.ply
section "Chair: deform" "Three handles: the seat up, one foot out, the crest up." chair_deform \
  picture chair_edited.png "before and after" file chair_handles.json file chair_edited.ply file chair_edited.json
run chair_recheck check models/chair.ply chair.json --deformed chair_edited.ply --mode moving
section "Chair: check the edit" "Every region is still exactly symmetric, to rounding errors; each group may have moved rigidly (mode moving)." chair_recheck
run chair_edit edit models/chair.ply chair.json -o editor.html
section "Chair: the editor" "The chair in a page of its own: drag it, and every symmetric part follows." chair_edit file editor.html
run chair_scan scan chair_edited.ply --views 1 --azimuth 40 --noise 0.001 -o scan.ply
"$orbifit" render chair_edited.ply --points scan.ply --width 640 --height 520 --quiet -o scan.png
section "Chair: scan" "The edited chair seen by one virtual depth camera." chair_scan picture scan.png "the scan" file scan.ply
run chair_fit fit models/chair.ply scan.ply --annotation chair.json -o chair_fitted.ply --report chair_fit.json --html chair_fit.html --annotation-out chair_fitted.json
"$orbifit" render chair_fitted.ply --points scan.ply --width 820 --height 660 --quiet -o fit.png
picture fit_truth.png chair_fitted.ply --compare chair_edited.ply --azimuth 220
section "Chair: fit" "The original chair fitted to the scan; its hidden sides are completed by symmetry." chair_fit \
  picture fit.png "the scan over the fit" picture fit_truth.png "the fit and the truth from behind, where the scan saw nothing" \
  file chair_fitted.ply file chair_fit.json file chair_fit.html file chair_fitted.json
run chair_fit_check check models/chair.ply chair.json --deformed chair_fitted.ply --mode moving
section "Chair: check the fit" "The fitted chair keeps every symmetry, to rounding errors." chair_fit_check

printf '{"title":"Orbifit: detect, deform, fit","intro":"%s","sections":[%s]}\n' \
  "Each step shows the command that made it, what it printed and the files that it wrote. Distances are in percent of the diagonal of the mesh\u2019s bounding box; files hold them as fractions." \
  "$(IFS=,; echo "${sections[*]}")" >steps.json
"$orbifit" report steps.json -o index.html --quiet
echo
echo "Pictures, figures and files: out/index.html; the chair to be edited in a browser: out/editor.html"
