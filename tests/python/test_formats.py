"""Files, other packages' meshes, pictures, what notebooks show."""

import base64
import pathlib
import re
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
