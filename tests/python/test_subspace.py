"""Subspaces, edits, checks, fits."""

import pickle

import numpy as np
import pytest

import orbifit


def test_any_coordinates_are_symmetric(subspace):
    q = np.random.default_rng(3).normal(size=subspace.degrees_of_freedom) * 0.02 * subspace.mesh.diagonal
    assert subspace.residuals(q).max() < 1e-12
    assert orbifit.check(subspace.mesh, subspace.annotation, subspace.deformed(q)).residual < 1e-12
    assert np.array_equal(subspace.deformed(q).vertices, subspace.mesh.vertices + subspace.lift(q))


def test_the_basis_is_linear_in_the_samples(subspace):
    rows, columns = subspace.basis.shape
    assert rows == 3 * len(subspace.samples) and columns == subspace.degrees_of_freedom
    assert np.linalg.matrix_rank(subspace.basis) == columns


def test_an_edit_follows_its_handles(subspace, lift):
    deformer = orbifit.Deformer(subspace)
    with pytest.raises(orbifit.UsageError, match="set_handles"):
        deformer.solve()
    deformer.set_handles(lift)
    edit = deformer.solve()
    assert edit.handle_error < 0.02 * subspace.mesh.diagonal
    height = np.ptp(subspace.deformed(edit).vertices[:, 2]) - np.ptp(subspace.mesh.vertices[:, 2])
    assert height == pytest.approx(0.1 * subspace.mesh.diagonal, rel=0.2)
    assert orbifit.check(subspace.mesh, subspace.annotation, subspace.deformed(edit)).residual < 1e-12
    assert np.array_equal(deformer.solve([lift[0].motion, np.eye(4)]).q, edit.q)
    carried = subspace.annotation_of(edit)
    assert orbifit.check(carried.mesh, carried).residual < 1e-9
    with pytest.raises(orbifit.UsageError, match="motions has 1 of them; there are 2 handles"):
        deformer.solve([np.eye(4)])
    with pytest.raises(orbifit.InputError, match="off orthogonal"):
        deformer.solve([2 * np.eye(3, 4), np.eye(3, 4)])
    with pytest.raises(orbifit.InputError, match=r"handles\[0\]: takes no vertex"):
        deformer.set_handles([[]])


def test_moving_groups_turn(mesh, annotation, lift):
    subspace = orbifit.Subspace(mesh, annotation, mode="moving", samples=150)
    deformer = orbifit.Deformer(subspace)
    deformer.set_handles(lift)
    edit = deformer.solve(iterations=4)
    assert subspace.residuals(edit).max() < 1e-9
    assert not np.array_equal(deformer.solve(iterations=2, start=edit).q, edit.q)


def test_files_and_pickles_give_the_same_displacements(subspace, tmp_path):
    q = np.linspace(-1, 1, subspace.degrees_of_freedom)
    subspace.save(tmp_path / "s.basis")
    for again in (orbifit.Subspace.load(tmp_path / "s.basis", subspace.mesh, subspace.annotation),
                  pickle.loads(pickle.dumps(subspace))):
        assert np.array_equal(again.lift(q), subspace.lift(q))
        assert again.annotation == subspace.annotation
    with pytest.raises(orbifit.InputError):
        orbifit.Subspace.load(tmp_path / "none.basis", subspace.mesh, subspace.annotation)


def test_options_are_refused_with_their_rule(mesh, annotation):
    for options, message in (
        ({"mode": "loose"}, "mode is 'loose'; it must be 'fixed', 'floating' or 'moving'"),
        ({"lift": "none"}, "lift is 'none'"),
        ({"radius": -1.0}, "radius is"),
        ({"radius": 0.1, "samples": 50}, "cannot both be given"),
        ({"threads": 0}, "threads is 0; it must be from 1 to 4096"),
        ({"timeout": 0.0}, "timeout is"),
        ({"relative_radii": np.zeros(len(mesh.vertices))}, ""),
    ):
        with pytest.raises(orbifit.UsageError, match=message):
            orbifit.Subspace(mesh, annotation, **options)
    with pytest.raises(orbifit.UsageError, match="tolerance"):
        orbifit.detect(mesh, tolerance=7)


def test_radius_field_refines(mesh, annotation):
    base = 0.04 * mesh.diagonal
    foot = mesh.vertices[mesh.vertices[:, 2].argmin()]
    radii = orbifit.radius_field(mesh, base, areas=[(foot, 4 * base, 0.5)])
    assert radii.min() == pytest.approx(0.5 * base) and radii.max() == pytest.approx(base)

    def samples_near(**options):
        samples = orbifit.Subspace(mesh, annotation, radius=base, **options).samples
        return (np.linalg.norm(samples - foot, axis=1) < 3 * base).sum()

    assert samples_near(relative_radii=radii / base) > 1.5 * samples_near()


def test_symmetrize_takes_noise_out(mesh, annotation):
    noise = np.random.default_rng(1).normal(size=mesh.vertices.shape) * 2e-4 * mesh.diagonal
    noisy = mesh.with_vertices(mesh.vertices + noise)
    result = orbifit.symmetrize(noisy, annotation)
    assert orbifit.check(result.mesh, result.annotation).residual < 0.3 * orbifit.check(noisy, annotation).residual
    assert 0 < result.rms_movement <= result.largest_movement < 2e-3


def test_check_wants_the_same_faces(mesh, annotation):
    with pytest.raises(orbifit.InputError, match="no deformation of the mesh"):
        orbifit.check(mesh, annotation, (mesh.vertices, mesh.faces[::-1]))


def test_fits_a_scan(mesh, annotation, subspace, lift):
    deformer = orbifit.Deformer(subspace)
    deformer.set_handles(lift)
    truth = subspace.deformed(deformer.solve())
    scan = orbifit.scan(truth, noise=0.001)
    fit = orbifit.fit(mesh, scan, annotation, pose=np.eye(4))
    assert fit.converged and fit.confidence > 0.9 and fit.symmetry_residual < 1e-12
    assert np.linalg.norm(fit.mesh.vertices - truth.vertices, axis=1).max() < 0.03 * truth.diagonal
    assert fit.seen.dtype == bool and fit.seen.shape == (len(mesh.vertices),) and not fit.seen.all()
    assert len(fit.history["rms"]) == fit.figures["iterations"]
    again = orbifit.fit(mesh, [scan.points[::2], scan.points[1::2]], subspace=subspace, pose=np.eye(4), threads=1,
                        one_frame=True)
    assert again.converged and again.scan.points.shape == scan.points.shape
    with pytest.raises(orbifit.InputError):
        orbifit.fit(mesh, scan.points[:5], annotation)


def test_finds_a_template_in_a_scan(mesh, annotation):
    turn = np.array([[0.0, 0, 1, 3], [1, 0, 0, 2], [0, 1, 0, 1], [0, 0, 0, 1]])
    scan = orbifit.scan(mesh)
    moved = scan.points @ turn[:3, :3].T + turn[:3, 3]
    pose, score = orbifit.find_placements(mesh, moved, annotation)[0]
    assert score > 0.5
    centre = mesh.vertices.mean(axis=0)
    assert np.linalg.norm((pose - turn)[:3] @ [*centre, 1]) < 0.05 * mesh.diagonal


def test_handles_and_landmarks_are_read(mesh, tmp_path):
    (tmp_path / "h.json").write_text('{"handles": [{"name": "a", "vertices": [3, 1], "translation": [0, 0, 1]}]}')
    (handle,) = orbifit.read_handles(tmp_path / "h.json", mesh)
    assert handle.vertices.tolist() == [1, 3] and handle.motion[2, 3] == 1 and handle.name == "a"
    (tmp_path / "l.json").write_text('{"landmarks": [{"vertex": 12, "target": [1, 2, 3]}]}')
    ((vertex, target),) = orbifit.read_landmarks(tmp_path / "l.json", mesh)
    assert vertex == 12 and target.tolist() == [1, 2, 3]


def test_generators_state_their_parameters():
    parameter = orbifit.generators()["chair"]["parameters"]["seat_width"]
    assert parameter["minimum"] < parameter["default"] < parameter["maximum"]
    with pytest.raises(orbifit.UsageError):
        orbifit.generate("chair", seat_width=99)
    with pytest.raises(orbifit.UsageError, match="unknown model"):
        orbifit.generate("sofa")


def test_detects_in_points():
    wheel, _ = orbifit.generate("wheel")
    found = orbifit.detect_points(orbifit.scan(wheel, views=6), time_budget=5)
    assert found.mesh is None and found.mesh_faces > 1000
    with pytest.raises(orbifit.InputError):
        orbifit.detect_points(np.zeros((3, 3)))
