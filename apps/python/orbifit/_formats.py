"""Meshes and scans to and from other packages, and annotations as others read them; none of those is needed."""

import json
from typing import TYPE_CHECKING, Any, Dict, List, Tuple

import numpy as np

if TYPE_CHECKING:
    from orbifit import Annotation, Mesh, MeshLike, PointCloud, Region


def mesh_from_trimesh(mesh: Any) -> "Mesh":
    """The mesh of a ``trimesh.Trimesh``; its order is kept."""
    return _core.Mesh(mesh.vertices, mesh.faces)


def mesh_to_trimesh(self: "Mesh") -> Any:
    """A ``trimesh.Trimesh``, not processed: order and number of vertices stay."""
    import trimesh

    return trimesh.Trimesh(np.array(self.vertices), np.array(self.faces), process=False)


def mesh_from_open3d(mesh: Any) -> "Mesh":
    """The mesh of an ``open3d.geometry.TriangleMesh``."""
    return _core.Mesh(np.asarray(mesh.vertices), np.asarray(mesh.triangles))


def mesh_to_open3d(self: "Mesh") -> Any:
    """An ``open3d.geometry.TriangleMesh`` with vertex normals."""
    import open3d

    mesh = open3d.geometry.TriangleMesh(
        open3d.utility.Vector3dVector(np.array(self.vertices)), open3d.utility.Vector3iVector(np.array(self.faces))
    )
    mesh.compute_vertex_normals()
    return mesh


def mesh_from_meshio(mesh: Any) -> "Mesh":
    """The mesh of a ``meshio.Mesh``: its triangles, and its quads cut in two, in the order of its blocks."""
    return _core.Mesh.of(mesh)


def mesh_to_meshio(self: "Mesh") -> Any:
    """A ``meshio.Mesh`` of triangles."""
    import meshio

    return meshio.Mesh(*self.to_triple())


def mesh_to_triple(self: "Mesh") -> Tuple[np.ndarray, List[Tuple[str, np.ndarray]], Dict[str, np.ndarray]]:
    """(points, cells, point data), as meshio takes them: ``meshio.Mesh(*mesh.to_triple())``."""
    return np.array(self.vertices), [("triangle", np.array(self.faces))], {}


def scan_from_open3d(cloud: Any) -> "PointCloud":
    """The scan of an ``open3d.geometry.PointCloud``, with its normals where it has some."""
    return _core.PointCloud.of(cloud)


def scan_to_open3d(self: "PointCloud") -> Any:
    """An ``open3d.geometry.PointCloud``."""
    import open3d

    cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(np.array(self.points)))
    if self.normals is not None:
        cloud.normals = open3d.utility.Vector3dVector(np.array(self.normals))
    return cloud


def annotation_to_dict(self: "Annotation") -> Dict[str, Any]:
    """What the annotation's file holds."""
    result: Dict[str, Any] = json.loads(self.to_json())
    return result


def annotation_from_dict(values: Dict[str, Any], mesh: "MeshLike") -> "Annotation":
    """Of what an annotation's file holds.

    Raises:
        InputError: naming the key and the reason.
    """
    return _core.Annotation.from_json(json.dumps(values), mesh)


def annotation_to_bop(self: "Annotation") -> Dict[str, Any]:
    """The model's entry of BOP's ``models_info.json``: diameter, bounds and the symmetries of the whole.

    Taken are the rotations of the largest group of a region that holds every face; lengths are in the mesh's unit
    (BOP's is millimetres). Of a group that is continuous about an axis and turns that over the half turn is a discrete
    symmetry besides; of all rotations about a point three axes are written.

    Raises:
        InputError: the annotation does not know its mesh: see :meth:`with_mesh`.
    """
    if self.mesh is None:
        raise _core.InputError("annotation: does not know its mesh; with_mesh() tells it")
    vertices = self.mesh.vertices
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    entry: Dict[str, Any] = {"diameter": _diameter(vertices)}
    for axis, name in enumerate("xyz"):
        entry[f"min_{name}"] = float(low[axis])
        entry[f"size_{name}"] = float(high[axis] - low[axis])
    whole = [region for region in self.regions if len(region.faces) == self.mesh_faces]
    if whole:
        largest = max(whole, key=lambda region: (region.continuous, region.order))
        discrete, continuous = _bop_symmetries(largest)
        if discrete:
            entry["symmetries_discrete"] = [matrix.ravel().tolist() for matrix in discrete]
        if continuous:
            entry["symmetries_continuous"] = continuous
    return entry


def _bop_symmetries(region: "Region") -> Tuple[List[np.ndarray], List[Dict[str, Any]]]:
    centre = region.centre
    if not region.continuous:
        matrices = [np.vstack([element, [0, 0, 0, 1]]) for element in region.elements[1:]]
        return [matrix for matrix in matrices if np.linalg.det(matrix[:3, :3]) > 0], []
    if region.axis is None:  # K, Kh
        return [], [{"axis": list(axis), "offset": centre.tolist()} for axis in np.eye(3)]
    discrete = []
    if region.group in ("Dinf", "Dinfh"):
        across = np.cross(region.axis, np.eye(3)[np.argmin(np.abs(region.axis))])
        across /= np.linalg.norm(across)
        half_turn = np.eye(4)
        half_turn[:3, :3] = 2 * np.outer(across, across) - np.eye(3)
        half_turn[:3, 3] = centre - half_turn[:3, :3] @ centre
        discrete.append(half_turn)
    return discrete, [{"axis": region.axis.tolist(), "offset": centre.tolist()}]


def _diameter(points: np.ndarray) -> float:
    """The largest distance of two points: those far from the centre first, until no pair can be farther apart."""
    distances = np.linalg.norm(points - (points.min(axis=0) + points.max(axis=0)) / 2, axis=1)
    order = np.argsort(-distances, kind="stable")
    points, distances = points[order], distances[order]
    largest = 0.0
    for i in range(len(points)):
        reach = int(np.searchsorted(-distances, distances[i] - largest))  # others nearer to the centre are too near
        if reach <= i:
            break
        largest = max(largest, float(np.sqrt(((points[i:reach] - points[i]) ** 2).sum(axis=1).max())))
    return largest


def add_to(core: Any) -> None:
    """Gives the classes of the compiled module their methods."""
    global _core
    _core = core
    _method(core.Mesh, "to_trimesh", mesh_to_trimesh)
    _method(core.Mesh, "to_open3d", mesh_to_open3d)
    _method(core.Mesh, "to_meshio", mesh_to_meshio)
    _method(core.Mesh, "to_triple", mesh_to_triple)
    _method(core.Mesh, "from_trimesh", mesh_from_trimesh, static=True)
    _method(core.Mesh, "from_open3d", mesh_from_open3d, static=True)
    _method(core.Mesh, "from_meshio", mesh_from_meshio, static=True)
    _method(core.PointCloud, "to_open3d", scan_to_open3d)
    _method(core.PointCloud, "from_open3d", scan_from_open3d, static=True)
    _method(core.Annotation, "to_dict", annotation_to_dict)
    _method(core.Annotation, "from_dict", annotation_from_dict, static=True)
    _method(core.Annotation, "to_bop", annotation_to_bop)


def _method(owner: Any, name: str, function: Any, static: bool = False) -> None:
    function.__name__ = name
    function.__qualname__ = f"{owner.__name__}.{name}"
    setattr(owner, name, staticmethod(function) if static else function)


_core: Any = None
