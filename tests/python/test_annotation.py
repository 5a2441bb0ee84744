"""Annotations: contents, files, pickles, what is made of them."""

import json
import pickle

import numpy as np
import pytest

import orbifit


def test_detects_what_the_model_has(mesh, annotation):
    found = orbifit.detect(mesh, threads=1)
    assert found.regions[0].group == annotation.regions[0].group
    assert len(found.regions[0].faces) == len(mesh)
    assert orbifit.detect(mesh.vertices, mesh.faces, threads=2) == found


def test_elements_form_a_group_and_are_not_copied(annotation):
    region = annotation.regions[0]
    assert region.elements.shape == (region.order, 3, 4) and not region.elements.flags.owndata
    assert np.array_equal(region.elements[0], np.eye(3, 4))
    square = np.zeros((region.order, 4, 4))
    square[:, :3], square[:, 3, 3] = region.elements, 1
    for a in square:
        for b in square:
            assert np.abs(square - a @ b).max(axis=(1, 2)).min() < 1e-12


def test_elements_map_the_region_onto_itself(mesh, annotation):
    region = annotation.regions[0]
    points = mesh.vertices[np.unique(mesh.faces[region.faces])]
    for element in region.elements:
        images = points[:40] @ element[:, :3].T + element[:, 3]
        nearest = np.linalg.norm(images[:, None] - points[None], axis=2).min(axis=1)
        assert nearest.max() < 1e-9 * mesh.diagonal


def test_views_keep_the_annotation_alive(mesh):
    region = orbifit.generate("stool")[1].regions[0]
    elements, faces = region.elements, region.faces
    del region
    assert np.array_equal(elements[0], np.eye(3, 4)) and faces[0] == 0


def test_files_and_pickles_keep_everything(mesh, annotation, tmp_path):
    file = tmp_path / "a.json"
    annotation.save(file)
    assert orbifit.Annotation.load(file, mesh) == annotation
    assert orbifit.read_annotation(str(file), mesh) == annotation
    assert json.loads(file.read_text()) == annotation.to_dict()
    assert orbifit.Annotation.from_dict(annotation.to_dict(), mesh) == annotation
    for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1):
        again = pickle.loads(pickle.dumps(annotation, protocol))
        assert again == annotation and again.mesh is None
        assert again.with_mesh(mesh).mesh is mesh
    region = pickle.loads(pickle.dumps(annotation.regions[1]))
    assert np.array_equal(region.elements, annotation.regions[1].elements)


def test_restrict_keeps_what_is_named(annotation):
    kept = annotation.restrict([2, 0])
    assert [region.id for region in kept.regions] == [0, 2]
    assert len(annotation.without([0]).regions) == len(annotation.regions) - 1
    with pytest.raises(orbifit.UsageError, match="no region 999"):
        annotation.restrict([999])


def test_regions_are_made_by_hand(mesh, annotation):
    truth = annotation.regions[0]
    made = orbifit.Region(truth.group, np.ones(len(mesh), bool)[: len(mesh)].nonzero()[0], centre=truth.centre,
                          axis=truth.axis, towards=[1, 0, 0], name="whole")
    one = orbifit.Annotation(mesh, [made])
    assert orbifit.check(mesh, one).residual < 1e-12
    with pytest.raises(orbifit.UsageError, match="no Schoenflies symbol"):
        orbifit.Region("C4x", [0], centre=[0, 0, 0])
    with pytest.raises(orbifit.UsageError, match="axis must be given"):
        orbifit.Region("C4", [0], centre=[0, 0, 0])
    with pytest.raises(orbifit.InputError, match="has faces that the mesh has not"):
        orbifit.Annotation(mesh, [orbifit.Region("Ci", [len(mesh)], centre=[0, 0, 0])])


def test_bop_lists_the_rotations_of_the_whole(mesh, annotation):
    entry = annotation.to_bop()
    rotations = np.array(entry["symmetries_discrete"]).reshape(-1, 4, 4)
    assert annotation.regions[0].group == "C4v" and len(rotations) == 3
    assert np.allclose(np.linalg.det(rotations[:, :3, :3]), 1)
    sample = mesh.vertices[:: max(1, len(mesh.vertices) // 1500)]
    pairs = np.linalg.norm(sample[:, None] - sample[None], axis=2).max()
    assert pairs <= entry["diameter"] * (1 + 1e-12) and entry["diameter"] <= mesh.diagonal * (1 + 1e-12)
    assert entry["size_z"] == pytest.approx(np.ptp(mesh.vertices[:, 2]))


def test_bop_of_surfaces_of_revolution():
    angles = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    ring = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(60)])
    vertices = np.vstack([ring, ring + [0, 0, 2]])
    i, j = np.arange(60), (np.arange(60) + 1) % 60
    faces = np.vstack([np.column_stack([i, j, j + 60]), np.column_stack([i, j + 60, i + 60])])
    region = orbifit.Region("Dinfh", np.arange(120), centre=[0, 0, 1], axis=[0, 0, 1])
    entry = orbifit.Annotation((vertices, faces), [region]).to_bop()
    assert entry["symmetries_continuous"] == [{"axis": [0, 0, 1], "offset": [0, 0, 1]}]
    (half_turn,) = np.array(entry["symmetries_discrete"]).reshape(-1, 4, 4)
    assert np.allclose(half_turn @ [0.3, 0.4, 2, 1] @ [0, 0, 1, 0], 0)
    assert entry["diameter"] == pytest.approx(np.sqrt(8))


def test_an_annotation_of_another_mesh_is_refused(mesh, annotation):
    other = orbifit.generate("bar")[0]
    for call in (lambda: orbifit.Subspace(other, annotation), lambda: orbifit.check(other, annotation),
                 lambda: orbifit.symmetrize(other, annotation), lambda: annotation.with_mesh(other)):
        with pytest.raises(orbifit.InputError, match="is of a mesh with"):
            call()


def test_transformed_goes_along(mesh, annotation):
    map_ = np.diag([2.0, 2, 2, 1])
    map_[:3, 3] = [1, 2, 3]
    moved = annotation.transformed(map_)
    assert orbifit.check(moved.mesh, moved).residual < 1e-12
    assert moved.mesh_diagonal == pytest.approx(2 * annotation.mesh_diagonal)
