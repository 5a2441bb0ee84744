"""What several tests use: small models, their annotations and subspaces, made once."""

import numpy as np
import pytest

import orbifit


@pytest.fixture(scope="session")
def stool():
    """A model of few faces, and its true annotation."""
    return orbifit.generate("stool")


@pytest.fixture(scope="session")
def mesh(stool):
    return stool[0]


@pytest.fixture(scope="session")
def annotation(stool):
    return stool[1]


@pytest.fixture(scope="session")
def subspace(stool):
    return orbifit.Subspace(*stool)


@pytest.fixture
def lift(mesh):
    """A handle on the top that moves up, and one at the feet that is held."""
    z = mesh.vertices[:, 2]
    up = np.eye(4)
    up[2, 3] = 0.1 * mesh.diagonal
    margin = 0.02 * mesh.diagonal
    return [orbifit.Handle(np.flatnonzero(z > z.max() - margin), up), np.flatnonzero(z < z.min() + margin)]


@pytest.fixture(scope="session")
def box():
    """Twelve faces, whose group is D2h."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 2) for z in (0, 3)], float)
    faces = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6],
             [0, 6, 4], [1, 5, 7], [1, 7, 3]]
    return orbifit.Mesh(corners, faces)
