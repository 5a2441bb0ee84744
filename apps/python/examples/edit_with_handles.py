"""Edits a chair with handles: the seat goes up, one foot outwards, and every symmetric part follows.

    edit_with_handles.py OUT

OUT gets edited.ply, its annotation and edited.png.
"""

import sys
from pathlib import Path

import numpy as np

import orbifit


def translation(x: float, y: float, z: float) -> "np.ndarray[tuple[int, int], np.dtype[np.float64]]":
    motion = np.eye(4)
    motion[:3, 3] = x, y, z
    return motion


def main(out: Path) -> None:
    out.mkdir(parents=True, exist_ok=True)
    mesh, _ = orbifit.generate("chair")
    annotation = orbifit.detect(mesh)
    subspace = orbifit.Subspace(mesh, annotation)
    print(annotation, subspace, sep="\n")

    deformer = orbifit.Deformer(subspace)
    deformer.set_handles(
        [
            orbifit.Handle.near(mesh, [0, 0, 0.43], 0.2, name="seat"),
            orbifit.Handle.near(mesh, [0.23, 0.23, 0], 0.08, name="one foot"),
            orbifit.Handle.near(mesh, [0, 0.27, 0.93], 0.12, name="crest"),
        ]
    )
    # The handles are factorised once; solving for other motions takes a fraction of a millisecond.
    frames = []
    for share in (0.0, 0.5, 1.0):
        motions = np.array(
            [translation(0, 0, 0.06 * share), translation(0.02 * share, 0.02 * share, 0),
             translation(0, 0.01 * share, 0.09 * share)]
        )
        edit = deformer.solve(motions)
        frames.append(subspace.deformed(edit))

    edited = frames[-1]
    residual = orbifit.check(mesh, subspace.annotation, edited).residual
    print(f"handles missed by {edit.handle_error:.2g}, symmetric to {residual:.0e} of the diagonal")
    edited.save(out / "edited.ply")
    subspace.annotation_of(edit).save(out / "edited.json")
    pictures = [orbifit.render(frame, width=360, height=360, frame=edited) for frame in frames]
    orbifit.write_png(out / "edited.png", orbifit.contact_sheet(pictures, ["at rest", "half", "edited"], 3))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
