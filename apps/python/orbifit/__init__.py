"""Finds the symmetries of a 3D shape, and edits it or fits it to a scan without breaking them."""

import functools
import types
from typing import Any, Callable, Union

from . import _core
from . import _formats, _html
from ._core import *  # noqa: F403

__version__: str = _core.__version__

#: Whatever stands for an array of numbers.
ArrayLike = Any
#: Whatever stands for a mesh: :class:`Mesh`, a pair (vertices, faces), a mesh of trimesh, Open3D or meshio, a file.
MeshLike = Any
#: Whatever stands for a scan: :class:`PointCloud`, points, a point cloud of Open3D, a file, a list of those.
ScanLike = Any
#: A file's name.
PathLike = Any
#: Coordinates in a subspace: numbers, or a :class:`Deformation`.
StateLike = Any
#: A function of a stage's name and a fraction in [0, 1]; True for a bar of tqdm; False or None for none.
Progress = Union[Callable[[str, float], object], bool, None]

__all__ = sorted(name for name in vars(_core) if not name.startswith("_"))

# What is written in Python of the classes that the library has, and what they are called.
_formats.add_to(_core)
_html.add_to(_core)


def _picklable(function: Any) -> Any:
    """A function of the compiled module as one of Python, which processes can send to one another by its name."""

    @functools.wraps(function)
    def call(*arguments: Any, **options: Any) -> Any:
        return function(*arguments, **options)

    call.__qualname__ = function.__name__
    return call


for _name in __all__:
    if isinstance(getattr(_core, _name), types.BuiltinFunctionType):
        globals()[_name] = _picklable(getattr(_core, _name))
    globals()[_name].__module__ = "orbifit"
del _name
