"""Compares a fit with registrations of Open3D: rigid ICP, and as-rigid-as-possible deformation onto nearest points.

    compare_registration.py OUT

OUT gets comparison.csv and comparison.png. The truth is known, so that what the scan did not see is judged too. Open3D
has no non-rigid registration of a mesh to a scan; the usual way to one with it is what is done here: nearest points
within a distance that shrinks as targets of its deform_as_rigid_as_possible(). Without Open3D only ours is run.
"""

import csv
import importlib
import sys
import time
from pathlib import Path
from typing import Any, Callable, List, Tuple

import numpy as np
import numpy.typing as npt

import orbifit

Array = npt.NDArray[np.float64]


def rigid(o3d: Any, mesh: orbifit.Mesh, scan: orbifit.PointCloud) -> Array:
    """Open3D's point-to-point ICP of the template's vertices, from the right pose."""
    source = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(np.array(mesh.vertices)))
    target = scan.to_open3d()
    criteria = o3d.pipelines.registration.ICPConvergenceCriteria(max_iteration=100)
    found = o3d.pipelines.registration.registration_icp(
        target, source, 0.1 * mesh.diagonal, np.eye(4),
        o3d.pipelines.registration.TransformationEstimationPointToPoint(), criteria,
    )
    pose = np.linalg.inv(np.asarray(found.transformation))  # the scan, which is a part, onto the template
    moved: Array = mesh.vertices @ pose[:3, :3].T + pose[:3, 3]
    return moved


def non_rigid(o3d: Any, mesh: orbifit.Mesh, scan: orbifit.PointCloud) -> Array:
    """As-rigid-as-possible onto the nearest points of the scan, again and again, after the rigid one."""
    moved = rigid(o3d, mesh, scan)
    tree = o3d.geometry.KDTreeFlann(scan.to_open3d())
    parts = np.asarray(mesh.to_open3d().cluster_connected_triangles()[0])
    corners = np.asarray(mesh.faces)
    chosen = np.linspace(0, len(moved) - 1, 300).astype(int)
    for reach in np.linspace(0.06, 0.02, 5) * mesh.diagonal:
        shape = mesh.with_vertices(moved).to_open3d()
        handles, targets, taken = [], [], set()
        for vertex in chosen:
            count, (nearest, *_), (squared, *_) = tree.search_knn_vector_3d(moved[vertex], 1)
            if count and squared < reach**2 and nearest not in taken:  # two vertices in one place: singular again
                taken.add(nearest)
                handles.append(vertex)
                targets.append(scan.points[nearest])
        for part in np.unique(parts):  # Open3D's system is singular where a connected part has no handle
            if not np.isin(handles, corners[parts == part]).any():
                handles.append(corners[parts == part][0, 0])
                targets.append(moved[handles[-1]])
        shape = shape.deform_as_rigid_as_possible(
            o3d.utility.IntVector(handles), o3d.utility.Vector3dVector(np.array(targets)), max_iter=10
        )
        moved = np.asarray(shape.vertices)
    return moved


def main(out: Path) -> None:
    out.mkdir(parents=True, exist_ok=True)
    mesh, _ = orbifit.generate("stool")
    truth, _ = orbifit.generate("stool", height=0.54, seat_width=0.42)  # vertex by vertex a deformation of the other
    scan = orbifit.scan(truth, noise=0.001)
    annotation = orbifit.detect(mesh)

    def ours(_: Any, mesh: orbifit.Mesh, scan: orbifit.PointCloud) -> Array:
        return orbifit.fit(mesh, scan, annotation, pose=np.eye(4)).mesh.vertices

    methods: List[Tuple[str, Callable[[Any, orbifit.Mesh, orbifit.PointCloud], Array]]] = [("Orbifit", ours)]
    o3d: Any = None
    try:
        o3d = importlib.import_module("open3d")
    except ImportError:
        print("Open3D is not installed: only ours is run")
    if o3d is not None:
        methods += [("Open3D, rigid", rigid), ("Open3D, as rigid as possible", non_rigid)]

    rows, pictures = [], []
    for name, method in methods:
        begin = time.perf_counter()
        fitted = mesh.with_vertices(method(o3d, mesh, scan))
        seconds = time.perf_counter() - begin
        errors = np.linalg.norm(fitted.vertices - truth.vertices, axis=1) / truth.diagonal
        kept = orbifit.check(mesh, annotation, fitted, mode="moving").residual
        rows.append([name, f"{errors.mean():.5f}", f"{errors.max():.5f}", f"{kept:.1e}", f"{seconds:.2f}"])
        pictures.append(orbifit.render(fitted, points=scan, frame=truth, width=360, height=360))
    header = ["method", "mean error", "largest error", "asymmetry added", "seconds"]
    with open(out / "comparison.csv", "w", newline="") as stream:
        csv.writer(stream).writerows([header, *rows])
    for row in [header, *rows]:
        print(f"{row[0]:30}" + "".join(f"{cell:>17}" for cell in row[1:]))
    orbifit.write_png(out / "comparison.png", orbifit.contact_sheet(pictures, [row[0] for row in rows], len(rows)))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
