"""Annotates every mesh of a folder, in several processes, and draws what was found.

    annotate_folder.py FOLDER OUT [--processes N]

OUT gets NAME.json and NAME.png of each mesh, and list.csv. A mesh that cannot be used is listed with the reason.
"""

import argparse
import csv
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import List

import orbifit

ENDINGS = {".obj", ".off", ".ply", ".stl", ".glb", ".gltf", ".3mf"}
MOST_PICTURES = 8


def draw(annotation: orbifit.Annotation, file: Path) -> None:
    """The largest regions side by side."""
    assert annotation.mesh is not None
    regions = annotation.regions[:MOST_PICTURES]
    pictures = [
        orbifit.render(annotation.mesh, annotation, region=region.id, width=320, height=240) for region in regions
    ]
    if not pictures:
        pictures = [orbifit.render(annotation.mesh, width=320, height=240)]
    captions = [f"{region.id}: {region.group}" for region in regions] or ["no symmetry found"]
    orbifit.write_png(file, orbifit.contact_sheet(pictures, captions, min(4, len(pictures))))


def annotate(file: Path, out: Path) -> List[str]:
    """A row of the list: the mesh, its number of regions and patterns, their groups; or what is wrong with it."""
    try:
        annotation = orbifit.detect(file, threads=1, time_budget=60)
    except orbifit.Error as error:
        return [file.name, "", "", str(error)]
    annotation.save(out / f"{file.stem}.json")
    draw(annotation, out / f"{file.stem}.png")
    groups = " ".join(region.group for region in annotation.regions)
    return [file.name, str(len(annotation.regions)), str(len(annotation.patterns)), groups]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--processes", type=int)
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    files = sorted(file for file in arguments.folder.iterdir() if file.suffix.lower() in ENDINGS)
    with ProcessPoolExecutor(arguments.processes) as pool:
        rows = list(pool.map(annotate, files, [arguments.out] * len(files)))
    with open(arguments.out / "list.csv", "w", newline="") as stream:
        csv.writer(stream).writerows([["mesh", "regions", "patterns", "groups"], *rows])
    for row in rows:
        print("  ".join(row))


if __name__ == "__main__":
    main()
