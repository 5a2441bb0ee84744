"""Files, other packages' meshes, pictures, what notebooks show."""

import base64
import os
import pathlib
import re
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest

import orbifit


@pytest.mark.parametrize("ending", ["ply", "obj", "off"])
@pytest.mark.parametrize("kind", [str, pathlib.Path, lambda file: str(file).encode()])
def test_mesh_files(mesh, tmp_path, ending, kind):
    file = kind(tmp_path / f"m.{ending}")
    orbifit.write_mesh(file, mesh)
    assert orbifit.read_mesh(file) == mesh
    assert orbifit.Mesh.of(file) == mesh


def test_scan_files(mesh, tmp_path):
    scan = orbifit.scan(mesh, width=60, height=45)
    scan.save(tmp_path / "s.ply")
    again = orbifit.read_scan(tmp_path / "s.ply")
    assert np.array_equal(again.points, scan.points) and np.array_equal(again.viewpoints, scan.viewpoints)


@pytest.mark.parametrize("call", [orbifit.read_mesh, orbifit.read_scan, orbifit.detect])
def test_missing_files(call, tmp_path):
    with pytest.raises(orbifit.InputError, match="none.ply: no such file"):
        call(tmp_path / "none.ply")


def test_errors_are_under_one_roof():
    assert issubclass(orbifit.InputError, (orbifit.Error, ValueError))
    assert issubclass(orbifit.TimeoutError, TimeoutError)
    assert orbifit.InputError.__module__ == "orbifit"


def test_meshes_of_other_packages(mesh):
    trimesh = SimpleNamespace(vertices=mesh.vertices, faces=mesh.faces)
    open3d = SimpleNamespace(vertices=mesh.vertices, triangles=mesh.faces)
    meshio = SimpleNamespace(points=mesh.vertices, cells=[SimpleNamespace(type="triangle", data=mesh.faces)])
    for other in (trimesh, open3d, meshio, (mesh.vertices, mesh.faces), [mesh.vertices, mesh.faces]):
        assert orbifit.Mesh.of(other) == mesh
    assert orbifit.Mesh.of(mesh) is mesh
    assert orbifit.Mesh.from_trimesh(trimesh) == mesh == orbifit.Mesh.from_open3d(open3d)
    points, cells, data = mesh.to_triple()
    assert np.array_equal(points, mesh.vertices) and cells[0][0] == "triangle" and data == {}
    with pytest.raises(TypeError, match="a mesh must be"):
        orbifit.Mesh.of(7)


def test_quads_of_meshio_are_cut(tmp_path):
    square = SimpleNamespace(
        points=np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]),
        cells=[SimpleNamespace(type="line", data=np.array([[0, 1]])),
               SimpleNamespace(type="quad", data=np.array([[0, 1, 2, 3]]))],
    )
    mesh = orbifit.Mesh.from_meshio(square)
    assert mesh.faces.tolist() == [[0, 1, 2], [0, 2, 3]]
    mesh.save(tmp_path / "q.obj")
    assert "f 1 2 3 4" in (tmp_path / "q.obj").read_text()


def test_open3d_itself(mesh):
    pytest.importorskip("open3d")
    assert orbifit.Mesh.from_open3d(mesh.to_open3d()) == mesh
    scan = orbifit.scan(mesh, width=60, height=45)
    assert np.array_equal(orbifit.PointCloud.from_open3d(scan.to_open3d()).points, scan.points)


def test_trimesh_itself(mesh):
    pytest.importorskip("trimesh")
    assert orbifit.Mesh.from_trimesh(mesh.to_trimesh()) == mesh


class Trimesh:
    """What trimesh makes of its arguments: its own kind of arrays, vertices merged and moved unless told not to."""

    class Tracked(np.ndarray):
        pass

    def __init__(self, vertices, faces, process=True):
        assert vertices.flags.writeable and faces.flags.writeable
        self.vertices = (vertices if not process else np.unique(vertices, axis=0)).view(self.Tracked)
        self.faces = faces.astype(np.int64).view(self.Tracked)


def test_to_trimesh_keeps_the_order(mesh, monkeypatch):
    monkeypatch.setitem(sys.modules, "trimesh", SimpleNamespace(Trimesh=Trimesh))
    assert orbifit.Mesh.from_trimesh(mesh.to_trimesh()) == mesh == orbifit.Mesh.of(mesh.to_trimesh())


def test_meshio_itself(mesh):
    meshio = pytest.importorskip("meshio")
    assert orbifit.Mesh.from_meshio(mesh.to_meshio()) == mesh
    assert isinstance(mesh.to_meshio(), meshio.Mesh)


def test_correspondences_of_the_program_are_read_by_numpy(mesh, annotation, tmp_path):
    program = pathlib.Path(os.environ.get("ORBIFIT_BUILD", "")) / "apps" / "orbifit"
    if not program.is_file():
        pytest.skip("ORBIFIT_BUILD names no build folder")
    mesh.save(tmp_path / "m.ply")
    annotation.save(tmp_path / "a.json")
    subprocess.run([program, "convert", tmp_path / "a.json", tmp_path / "c.npz", "--mesh", tmp_path / "m.ply", "--quiet"],
                   check=True, stdout=subprocess.DEVNULL)
    region = annotation.regions[0]
    with np.load(tmp_path / "c.npz", allow_pickle=False) as found:
        vertices, images, motions = found["vertices"], found["images"], found["motions"]
        orbits, distances, elements = found["orbits"], found["distances"], found["elements"]
    assert np.array_equal(elements, np.arange(region.order)) and np.allclose(motions, region.elements, atol=1e-9)
    assert images.shape == distances.shape == (len(elements), len(vertices)) and orbits.shape == vertices.shape
    points = mesh.vertices
    for motion, image, distance in zip(motions, images, distances):
        there = image >= 0
        offs = points[vertices] @ motion[:, :3].T + motion[:, 3] - points[image]
        assert there.all() and np.linalg.norm(offs, axis=1).max() < 1e-9 * mesh.diagonal
        assert distance.max() < 1e-9
    assert all(len(set(orbits[np.searchsorted(vertices, image[:50])] - orbits[:50])) == 1 for image in images)


def test_pictures(mesh, annotation, tmp_path):
    picture = orbifit.render(mesh, annotation, region=0, width=64, height=48, samples=1)
    assert picture.shape == (48, 64, 3) and picture.dtype == np.uint8 and np.ptp(picture) > 50
    assert not np.array_equal(picture, orbifit.render(mesh, width=64, height=48, samples=1))
    orbifit.write_png(tmp_path / "p.png", picture)
    assert (tmp_path / "p.png").read_bytes() == orbifit.encode_png(picture)
    assert orbifit.contact_sheet([picture, picture], ["a", "b"], 2).shape[1] > 128
    with pytest.raises(orbifit.UsageError):
        orbifit.render(mesh, width=-3)
    with pytest.raises(orbifit.UsageError, match="no region 99"):
        orbifit.render(mesh, annotation, region=99)


def pictures_in(page):
    return [base64.b64decode(data) for data in re.findall(r"base64,([^\"]+)\"", page)]


def test_notebooks_show_a_picture_and_a_table(mesh, annotation, subspace):
    for thing in (mesh, annotation, subspace, orbifit.fit(mesh, orbifit.scan(mesh), annotation, pose=np.eye(4))):
        (picture,) = pictures_in(thing._repr_html_())
        assert picture.startswith(b"\x89PNG")
    page = annotation._repr_html_()
    assert page.count("<tr>") >= 1 + len(annotation.regions)
    odd = annotation.to_dict()
    odd["regions"][0]["name"] = "<script>"
    page = orbifit.Annotation.from_dict(odd, mesh)._repr_html_()
    assert "<script>" not in page and "&lt;script&gt;" in page


def test_reprs_say_what_there_is(mesh, annotation, subspace):
    assert repr(mesh) == f"<orbifit.Mesh: {len(mesh.vertices)} vertices, {len(mesh)} faces>"
    assert "regions (C4v" in repr(annotation) and "degrees of freedom" in repr(subspace)
    assert repr(annotation.regions[0]).startswith("<orbifit.Region 0: C4v")
