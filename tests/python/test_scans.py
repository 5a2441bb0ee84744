"""Scans: several of one object, depth images, what a fit is told of them."""

import json
import struct
import zlib

import numpy as np
import pytest

import orbifit

MOVE = np.array([[0.0, 0, 1, 3], [1, 0, 0, -2], [0, 1, 0, 1], [0, 0, 0, 1]])  # of the second scan


@pytest.fixture(scope="module")
def views(mesh):
    """The stool from two sides, the second scan in a frame of its own."""
    first = orbifit.scan(mesh, noise=0.001)
    second = orbifit.scan(mesh, noise=0.001, azimuth=160)
    return first, orbifit.PointCloud(moved(second.points, MOVE), viewpoints=moved(second.viewpoints, MOVE))


def moved(points, motion):
    return points @ motion[:3, :3].T + motion[:3, 3]


def test_scans_have_a_frame_each(mesh, annotation, views):
    fit = orbifit.fit(mesh, list(views), annotation)
    assert fit.converged and len(fit.others) == 1
    # The stool is symmetric: its second scan lies as well where any of its elements takes it.
    back = fit.others[0] @ MOVE
    offs = [np.abs(moved(mesh.vertices, back) - moved(mesh.vertices, element)).max()
            for element in annotation.regions[0].elements]
    assert min(offs) < 0.03 * mesh.diagonal
    assert len(fit.scan) == len(views[0]) + len(views[1])
    assert np.allclose(fit.scan.points[len(views[0]):], moved(views[1].points, fit.others[0]))
    alone = orbifit.fit(mesh, views[0], annotation)
    assert alone.others == [] and alone.scan is views[0]
    assert fit.figures["hidden_fraction"] < alone.figures["hidden_fraction"]


def test_scans_in_one_frame_are_one(mesh, annotation, views):
    back = orbifit.PointCloud(moved(views[1].points, np.linalg.inv(MOVE)))
    fit = orbifit.fit(mesh, (views[0], back), annotation, one_frame=True)
    assert fit.converged and fit.others == [] and len(fit.scan) == len(views[0]) + len(back)
    assert fit.scan.viewpoints is None  # not known of both
    aligned = orbifit.fit(mesh, [views[0], back], annotation, aligned=True)
    assert aligned.converged and aligned.others == [] and aligned.placements == []


@pytest.mark.parametrize("seed", [1, 2, 4])
def test_a_scan_of_something_else_takes_no_part(mesh, annotation, views, seed):
    noise = np.random.default_rng(seed).normal(size=(400, 3))
    fit = orbifit.fit(mesh, [views[0], noise * [1, 1, 1e-3]], annotation)
    assert fit.converged and fit.others == [None] and len(fit.scan) == len(views[0])


def test_scale(mesh, annotation, views):
    large = orbifit.PointCloud(2 * views[0].points, viewpoints=2 * views[0].viewpoints)
    assert orbifit.fit(mesh, large, annotation).scale == pytest.approx(2, rel=0.02)
    assert orbifit.fit(mesh, large, annotation, scale="fixed").scale == 1
    with pytest.raises(orbifit.UsageError, match="scale is 'half'; it must be 'any' or 'fixed'"):
        orbifit.fit(mesh, large, annotation, scale="half")


def test_detail_is_added_on_request(mesh, annotation, views):
    plain = orbifit.fit(mesh, views[0], annotation, aligned=True)
    assert plain.detail_levels == [] and plain.figures["detail_rms"] == 0
    dents = orbifit.scan(orbifit.Mesh(dented(mesh), mesh.faces), views=3)
    fit = orbifit.fit(mesh, dents, annotation, aligned=True, refinements=0, detail=True)
    assert fit.detail_levels[0]["kept"] and fit.figures["detail_rms"] > 0
    assert fit.symmetry_residual < 1e-12
    assert fit.rms < orbifit.fit(mesh, dents, annotation, aligned=True, refinements=0).rms


def dented(mesh):
    """Waves in height, as symmetric as the stool, which stands upright."""
    vertices = np.array(mesh.vertices)
    size = np.linalg.norm(np.ptp(vertices, axis=0))
    out = vertices * [1, 1, 0] / np.maximum(np.linalg.norm(vertices[:, :2], axis=1), 1e-9 * size)[:, None]
    return vertices + 0.004 * size * np.sin(vertices[:, 2:] * (100 / size)) * out


def test_levels_say_how_fine(mesh, annotation, subspace, views):
    levels = orbifit.fit(mesh, views[0], annotation).levels
    assert levels[0]["kept"] and levels[0]["degrees_of_freedom"] > 0
    assert all(a["samples"] < b["samples"] for a, b in zip(levels, levels[1:]))
    assert len(orbifit.fit(mesh, views[0], subspace=subspace).levels) == 1


def test_a_list_that_holds_itself(mesh):
    scans = []
    scans.append(scans)
    with pytest.raises((RecursionError, TypeError, orbifit.InputError)):
        orbifit.fit(mesh, scans)
    with pytest.raises((TypeError, orbifit.InputError)):
        orbifit.fit(mesh, [])


def grey_png(file, pixels):
    """A PNG of 16 bits of grey."""
    height, width = pixels.shape
    rows = b"".join(b"\0" + row.astype(">u2").tobytes() for row in pixels)
    chunks = [(b"IHDR", struct.pack(">IIBBBBB", width, height, 16, 0, 0, 0, 0)), (b"IDAT", zlib.compress(rows)),
              (b"IEND", b"")]
    file.write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)) for kind, data in chunks))


def test_depth_images(tmp_path):
    depth = np.zeros((3, 4))
    depth[1, 2], depth[2, 0] = 1500, 800
    grey_png(tmp_path / "d.png", depth)
    scan = orbifit.read_depth_image(tmp_path / "d.png", (2, 4, 1, 0.5))
    assert np.allclose(scan.points, [[0.75, 0.1875, 1.5], [-0.4, 0.3, 0.8]])
    assert np.array_equal(scan.viewpoints, [[0, 0, 0]])
    grey_png(tmp_path / "m.png", depth > 1000)
    (tmp_path / "e.json").write_text(json.dumps({"camera_to_world": [MOVE.tolist()]}))
    (pose,) = orbifit.read_extrinsics(tmp_path / "e.json")
    cut = orbifit.read_depth_image(tmp_path / "d.png", (2, 4, 1, 0.5), pose=pose, mask=tmp_path / "m.png", depth_scale=1)
    assert np.allclose(cut.points, moved(np.array([[750, 187.5, 1500.0]]), MOVE))
    assert np.array_equal(cut.viewpoints, [MOVE[:3, 3]])
    with pytest.raises(orbifit.InputError, match="d.png: intrinsics: the principal point"):
        orbifit.read_depth_image(tmp_path / "d.png", (2, 4, 9, 9))
    with pytest.raises(orbifit.UsageError, match="focal length"):
        orbifit.read_depth_image(tmp_path / "d.png", (0, 4, 1, 1))
    with pytest.raises(orbifit.InputError, match="none.png"):
        orbifit.read_depth_image(tmp_path / "none.png", (2, 4, 1, 1))
