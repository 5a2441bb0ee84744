"""Fits a chair to one view of another chair, which stands anywhere, and lets symmetry complete what was not seen.

    fit_scan.py OUT [TEMPLATE SCAN]

OUT gets fitted.ply and fit.png. TEMPLATE and SCAN are files; without them both are made.
"""

import sys
from pathlib import Path
from typing import List

import numpy as np

import orbifit


def made_scan() -> orbifit.PointCloud:
    """One view of a higher and narrower chair, turned and moved."""
    other, _ = orbifit.generate("chair", leg_height=0.52, seat_width=0.38, seat_depth=0.4)
    seen = orbifit.scan(other, noise=0.001)
    assert seen.viewpoints is not None
    cos, sin = np.cos(0.7), np.sin(0.7)
    turn = np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])
    move = np.array([3.0, -2.0, 0.5])
    return orbifit.PointCloud(seen.points @ turn.T + move, viewpoints=seen.viewpoints @ turn.T + move)


def main(out: Path, files: List[str]) -> None:
    out.mkdir(parents=True, exist_ok=True)
    template = orbifit.read_mesh(files[0]) if files else orbifit.generate("chair")[0]
    scan = orbifit.read_scan(files[1]) if files else made_scan()
    fit = orbifit.fit(template, scan, orbifit.detect(template), progress=True)
    print(fit, fit.stopped_because)
    print(f"{fit.inlier_ratio:.1%} of the scan explained, rms {fit.rms:.2%} of the diagonal, "
          f"{1 - fit.seen.mean():.0%} of the vertices not seen, symmetric to {fit.symmetry_residual:.0e}")
    fit.mesh.save(out / "fitted.ply")

    seen = np.where(fit.seen[:, None], [[0.55, 0.7, 0.85]], [[0.9, 0.75, 0.5]])
    pictures = [
        orbifit.render(fit.mesh, points=scan, frame=fit.mesh, width=360, height=360, azimuth=70),
        orbifit.render(fit.mesh, width=360, height=360, azimuth=70),
        orbifit.render(fit.mesh, colours=seen, width=360, height=360, azimuth=250),
    ]
    captions = ["fit and scan", "fit", "from behind: completed in sand"]
    orbifit.write_png(out / "fit.png", orbifit.contact_sheet(pictures, captions, 3))


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])
