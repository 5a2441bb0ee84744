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
