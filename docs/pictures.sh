#!/usr/bin/env bash
# Runs what the pages here show and writes their pictures into docs/pictures. Takes the folder of a build (default:
# build/release); the real mesh comes from Debian's libcgal-demo.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
orbifit=${1:-$root/build/release}/apps/orbifit
pictures=$root/docs/pictures
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$pictures"
cd "$work"

# README.md: a chair, found, edited, fitted.
"$orbifit" generate chair -o . >/dev/null
"$orbifit" detect chair.ply -o chair.json --quiet
cat >handles.json <<'JSON'
{ "handles": [
  { "name": "seat", "centre": [0, 0, 0.43], "radius": 0.2, "translation": [0, 0, 0.06] },
  { "name": "one foot", "centre": [0.23, 0.23, 0], "radius": 0.08, "translation": [0.02, 0.02, 0] },
  { "name": "crest", "centre": [0, 0.27, 0.93], "radius": 0.12, "translation": [0, 0.01, 0.09] } ] }
JSON
"$orbifit" deform chair.ply chair.json --handles handles.json -o edited.ply --quiet
"$orbifit" scan edited.ply --views 1 --azimuth 40 --noise 0.001 -o scan.ply --quiet
"$orbifit" fit chair.ply scan.ply --annotation chair.json -o fitted.ply --quiet
"$orbifit" detect chair.ply --colour coloured.ply --quiet >/dev/null
"$orbifit" render coloured.ply --width 380 --height 380 --quiet -o "$pictures/chair_regions.png"
"$orbifit" render edited.ply --width 380 --height 380 --quiet -o "$pictures/chair_edit.png"
"$orbifit" render fitted.ply --points scan.ply --width 380 --height 380 --quiet -o "$pictures/chair_fit.png"

# guide.md: a real part.
apt-get download -qq libcgal-demo 2>/dev/null
dpkg-deb -x libcgal-demo_*.deb .
tar xzOf usr/share/doc/libcgal-dev/data.tar.gz data/meshes/boeing.off >part.off
cat >handles.json <<'JSON'
{ "handles": [ { "name": "outer hole", "centre": [-1.5, 8.97, -2.29], "radius": 1.2, "translation": [-1.5, 0.6, 0] },
               { "name": "end", "centre": [0, 12, 0], "radius": 2.5, "translation": [0, 1.5, 1.5] },
               { "name": "middle", "centre": [-0.6, 0, -1.4], "radius": 2.5 } ] }
JSON
"$orbifit" detect part.off -o part.json --preview "$pictures/regions.png" --quiet
"$orbifit" deform part.off part.json --handles handles.json -o edited.ply --quiet
"$orbifit" render part.off --compare edited.ply --width 560 --height 340 --quiet -o "$pictures/edit.png"
"$orbifit" scan edited.ply --views 1 --azimuth 40 --elevation 50 --noise 0.001 -o scan.ply --quiet
"$orbifit" fit part.off scan.ply --annotation part.json -o fitted.ply --report fit.json --html fit.html --quiet
"$orbifit" render fitted.ply --points scan.ply --width 560 --height 340 --quiet -o "$pictures/fit.png"
du -ch "$pictures"/*.png | tail -n 1
