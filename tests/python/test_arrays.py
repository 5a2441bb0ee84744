"""Arrays in and out: what is taken, what is refused, what is shared. Anything may come in; nothing may crash."""

import sys

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

import orbifit

TETRAHEDRON = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])

REFUSALS = (orbifit.InputError, orbifit.UsageError, TypeError)


@pytest.mark.parametrize(
    "vertices, faces, message",
    [
        (TETRAHEDRON[:, :2], FACES, r"vertices: has the shape \(4, 2\); it must be \(n, 3\)"),
        (TETRAHEDRON.ravel(), FACES, r"vertices: has the shape \(12,\)"),
        (np.zeros((0, 3)), FACES, "vertices: is empty"),
        (TETRAHEDRON, np.zeros((0, 3), int), "faces: is empty"),
        (TETRAHEDRON, FACES[:, :2], r"faces: has the shape \(4, 2\)"),
        (TETRAHEDRON, FACES + 1, r"faces\[1\]: is 4; it must be from 0 to 3"),
        (TETRAHEDRON, FACES - 1, r"faces\[0\]: is -1"),
        (TETRAHEDRON, FACES + 2**40, r"faces\[0\]: is 1099511627776"),
        (TETRAHEDRON, FACES.astype(np.uint64) + np.uint64(2**63), r"faces\[0\]: is 9223372036854775808"),
        (np.where(TETRAHEDRON == 1, np.nan, TETRAHEDRON), FACES, r"vertices\[1\]: holds nan"),
        (np.where(TETRAHEDRON == 1, np.inf, TETRAHEDRON), FACES, r"vertices\[1\]: holds inf"),
        (TETRAHEDRON * 1e200, FACES, r"vertices\[1\]: holds 1e\+200"),
    ],
)
def test_refuses_with_place_and_reason(vertices, faces, message):
    with pytest.raises(orbifit.InputError, match=message):
        orbifit.Mesh(vertices, faces)


@pytest.mark.parametrize("vertices", [TETRAHEDRON + 1j, "text", [["a", "b", "c"]], None, object(), [[1, 2], [3]]])
def test_refuses_what_holds_no_numbers(vertices):
    with pytest.raises(TypeError):
        orbifit.Mesh(vertices, FACES)


def test_refuses_faces_that_are_no_integers():
    with pytest.raises(TypeError, match="faces holds float64; it must hold integers"):
        orbifit.Mesh(TETRAHEDRON, FACES.astype(float))


@pytest.mark.parametrize(
    "change",
    [
        lambda a: a.astype(np.float32),
        lambda a: np.asfortranarray(a),
        lambda a: np.repeat(a, 2, axis=0)[::2],
        lambda a: a[::-1][::-1],
        lambda a: a.astype(">f8"),
        lambda a: a.tolist(),
    ],
)
def test_takes_any_layout(change):
    assert (orbifit.Mesh(change(TETRAHEDRON), FACES.astype(np.uint8)).vertices == TETRAHEDRON).all()


def test_takes_what_may_not_be_written():
    frozen = TETRAHEDRON.copy()
    frozen.setflags(write=False)
    assert len(orbifit.Mesh(frozen, FACES)) == 4


def test_views_are_read_only_and_keep_their_owner_alive():
    mesh = orbifit.Mesh(TETRAHEDRON, FACES)
    vertices, faces = mesh.vertices, mesh.faces
    assert vertices.ctypes.data == mesh.vertices.ctypes.data
    assert (vertices.dtype, faces.dtype) == (np.float64, np.int32)
    with pytest.raises(ValueError):
        vertices[0, 0] = 1
    del mesh
    assert (vertices == TETRAHEDRON).all() and (faces == FACES).all()


def test_input_is_not_kept():
    vertices = TETRAHEDRON.copy()
    before = sys.getrefcount(vertices)
    mesh = orbifit.Mesh(vertices, FACES)
    assert sys.getrefcount(vertices) == before
    vertices[:] = 0
    assert (mesh.vertices == TETRAHEDRON).all()


def test_results_own_their_memory(subspace):
    moved = subspace.lift(np.zeros(subspace.degrees_of_freedom))
    assert moved.flags.writeable and moved.flags.c_contiguous and moved.shape == subspace.mesh.vertices.shape


any_array = st.one_of(
    hnp.arrays(
        dtype=st.one_of(hnp.floating_dtypes(), hnp.integer_dtypes(), hnp.boolean_dtypes(), hnp.complex_number_dtypes(),
                        hnp.unicode_string_dtypes()),
        shape=hnp.array_shapes(min_dims=0, max_dims=4, min_side=0, max_side=5),
    ),
    hnp.arrays(np.float64, st.tuples(st.integers(0, 9), st.just(3))),
    hnp.arrays(np.int64, st.tuples(st.integers(0, 9), st.just(3)), elements=st.integers(-2, 12)),
    st.none(),
    st.text(max_size=3),
    st.lists(st.integers(), max_size=4),
)

many = settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)


@many
@given(any_array, any_array, st.booleans())
def test_any_mesh_is_taken_or_refused(vertices, faces, strided):
    if strided and isinstance(vertices, np.ndarray) and vertices.ndim > 0:
        vertices = vertices[::-2]
    try:
        mesh = orbifit.Mesh(vertices, faces)
    except REFUSALS:
        return
    assert np.isfinite(mesh.vertices).all() and mesh.faces.max() < len(mesh.vertices)


@settings(parent=many, max_examples=40)
@given(hnp.arrays(np.float64, (5, 3), elements=st.floats(-10, 10)),
       hnp.arrays(np.int32, st.tuples(st.integers(1, 8), st.just(3)), elements=st.integers(0, 4)))
def test_any_small_mesh_can_be_detected(vertices, faces):
    try:
        annotation = orbifit.detect(vertices, faces, threads=1, time_budget=0.5)
    except orbifit.InputError:
        return
    assert annotation.mesh_faces == len(faces)


@many
@given(any_array)
def test_any_argument_of_a_subspace_is_taken_or_refused(subspace, value):
    for call in (
        lambda: subspace.lift(value),
        lambda: orbifit.Handle(value),
        lambda: orbifit.Handle([0], value),
        lambda: orbifit.PointCloud(value),
        lambda: orbifit.PointCloud([[0, 0, 0]], value, value),
        lambda: orbifit.Deformer(subspace, threads=value),
        lambda: orbifit.encode_png(value),
        lambda: orbifit.Annotation.from_dict(value, subspace.mesh),
        lambda: subspace.annotation.transformed(value),
        lambda: orbifit.read_mesh(value),
    ):
        try:
            call()
        except REFUSALS:
            pass


def test_a_huge_array_is_refused_before_anything_is_computed():
    huge = np.broadcast_to(np.float64(0), (10**12, 3))  # 24 TB, if anybody copied it
    with pytest.raises((MemoryError, *REFUSALS)):
        orbifit.Mesh(huge, FACES)
