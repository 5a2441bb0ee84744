"""Writes the stub of the package, orbifit/__init__.pyi, from what signatures its docstrings state.

    PYTHONPATH=build/release/python python3 apps/python/backend/make_stub.py [--check]

With --check it compares instead, and exits with 1 where the stub is not what it would write.
"""

import difflib
import inspect
import re
import sys
import types
from pathlib import Path
from typing import Any, Iterator, List

import orbifit

STUB = Path(__file__).resolve().parents[1] / "orbifit" / "__init__.pyi"

HEADER = '''"""Made by apps/python/backend/make_stub.py."""

import os
from typing import Any, Callable, Dict, Iterable, List, Optional, Sequence, Tuple, Union

import numpy
import numpy.typing

ArrayLike = numpy.typing.ArrayLike
PathLike = Union[str, bytes, "os.PathLike[str]", "os.PathLike[bytes]"]
MeshLike = Any
ScanLike = Any
StateLike = Union["Deformation", numpy.typing.ArrayLike]
Progress = Union[Callable[[str, float], object], bool, None]

__version__: str
__all__: List[str]
'''

# What pybind11 calls a type, and its name in Python.
NAMES = [
    (r"orbifit\._core\.", ""),
    (r"numpy\.ndarray\[numpy\.(\w+)\]", r"numpy.typing.NDArray[numpy.\1]"),
    (r"numpy\.ndarray\[bool\]", "numpy.typing.NDArray[numpy.bool_]"),
    (r"\bIterable\b(?!\[)", "Iterable[Any]"),
    (r"\bdict\b", "Dict[str, Any]"),
    (r"\blist\b", "List[Dict[str, Any]]"),
]


def named(text: str) -> str:
    for pattern, name in NAMES:
        text = re.sub(pattern, name, text)
    return text


def arguments_of(text: str) -> str:
    """Arguments with their types; defaults that are no constants become `...`."""
    text = re.sub(r"= (<[^>]*>|\([^)]*\)|\[[^\]]*\])", "= ...", named(text))
    text = re.sub(r": (?!Progress)(\w+) = None", r": Optional[\1] = None", text)  # pointers
    return re.sub(r"\bList\[", "Sequence[", text)  # any sequence may be given


def signature_of(function: Any) -> "tuple[str, str]":
    """Arguments and result."""
    function = getattr(function, "__wrapped__", function)
    if isinstance(function, types.FunctionType):
        text = str(inspect.signature(function))
        found = re.match(r"^\((.*)\) -> (.+)$", text)
    else:
        found = re.match(r"^\w+\((.*)\) -> (.+)$", (function.__doc__ or "").split("\n")[0])
    if found is None:
        raise SystemExit(f"{function} states no signature")
    arguments, result = found.groups()
    if isinstance(function, types.FunctionType):
        plain = [re.sub(r"\b(np|numpy)\.ndarray\b", "numpy.typing.NDArray[Any]", t.replace("'", "").replace("typing.", ""))
                 for t in (arguments, result)]
        return re.sub(r"^self: \w+", "self", plain[0]), plain[1]
    return re.sub(r"^self: [\w.]+", "self", arguments_of(arguments)).replace("**kwargs", "**parameters: float"), named(result)


def property_line(name: str, value: property) -> str:
    first = (value.fget.__doc__ or "").strip().split("\n")[0]
    found = re.match(r"^\(.*\) -> (.+)$", first)
    if found is None:
        raise SystemExit(f"the property {name} states no type")
    return f"    @property\n    def {name}(self) -> {named(found.group(1))}: ..."


SPECIAL = {
    "__init__": None,
    "__len__": None,
    "__eq__": "    def __eq__(self, other: object) -> bool: ...",
    "__repr__": "    def __repr__(self) -> str: ...",
    "_repr_html_": "    def _repr_html_(self) -> str: ...",
}


def class_lines(name: str, cls: type) -> Iterator[str]:
    bases = [base.__name__ for base in cls.__bases__ if base is not object and base.__name__ != "pybind11_object"]
    if issubclass(cls, BaseException):
        bases = ["__builtins_TimeoutError" if b == "TimeoutError" and cls is orbifit.TimeoutError else b for b in bases]
        yield f"class {name}({', '.join(bases)}): ...".replace("__builtins_TimeoutError", "builtins.TimeoutError")
        return
    yield f"class {name}:"
    for member, value in sorted(vars(cls).items()):
        if member.startswith("_") and member not in SPECIAL:
            continue
        if isinstance(value, property):
            yield property_line(member, value)
        elif SPECIAL.get(member):
            yield str(SPECIAL[member])
        elif isinstance(value, staticmethod):
            arguments, result = signature_of(value.__func__)
            yield f"    @staticmethod\n    def {member}({arguments}) -> {result}: ..."
        elif callable(value):
            doc = (value.__doc__ or "").split("\n")[0]
            if member == "__init__" and not doc.startswith("__init__("):
                continue
            if member == "__init__" and "*args" in doc:
                continue
            arguments, result = signature_of(value)
            yield f"    def {member}({arguments}) -> {result}: ..."


def stub() -> str:
    lines: List[str] = [HEADER]
    names = orbifit.__all__
    classes = [name for name in names if isinstance(getattr(orbifit, name), type)]
    errors = [name for name in classes if issubclass(getattr(orbifit, name), BaseException)]
    for name in sorted(errors, key=lambda name: (name != "Error", name)):
        lines += class_lines(name, getattr(orbifit, name))
    for name in classes:
        if name not in errors:
            lines.append("")
            lines += class_lines(name, getattr(orbifit, name))
    lines.append("")
    for name in names:
        if name not in classes:
            arguments, result = signature_of(getattr(orbifit, name))
            lines.append(f"def {name}({arguments}) -> {result}: ...")
    return "\n".join(lines).replace("import os\n", "import builtins\nimport os\n") + "\n"


def main(arguments: List[str]) -> int:
    made = stub()
    if arguments != ["--check"]:
        STUB.write_text(made)
        return 0
    there = STUB.read_text() if STUB.exists() else ""
    sys.stdout.writelines(difflib.unified_diff(there.splitlines(True), made.splitlines(True), "there", "made"))
    return 0 if there == made else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
