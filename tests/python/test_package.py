"""The stub, the examples, their types, the documentation, the installation."""

import os
import pathlib
import subprocess
import sys

import pytest

import orbifit

ROOT = pathlib.Path(__file__).resolve().parents[2]
PYTHON = ROOT / "apps" / "python"
EXAMPLES = sorted((PYTHON / "examples").glob("*.py"))


def run(*command, **options):
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=280, **options)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    return done.stdout


def test_the_stub_is_what_the_signatures_say():
    run(sys.executable, PYTHON / "backend" / "make_stub.py", "--check")


def test_types(tmp_path):
    pytest.importorskip("mypy")
    environment = dict(os.environ, MYPYPATH=str(PYTHON))
    run(sys.executable, "-m", "mypy", "--strict", "--ignore-missing-imports", "--cache-dir", tmp_path, *EXAMPLES,
        env=environment)


@pytest.mark.parametrize("name", ["edit_with_handles", "fit_scan", "compare_registration"])
def test_example(name, tmp_path):
    print(run(sys.executable, PYTHON / "examples" / f"{name}.py", tmp_path))
    assert list(tmp_path.glob("*.png"))


def test_example_of_a_folder(tmp_path):
    for name in ("bar", "yard_tool"):
        orbifit.generate(name, **({"detail": 1} if name == "yard_tool" else {}))[0].save(tmp_path / f"{name}.ply")
    (tmp_path / "broken.obj").write_text("v 0 0\n")
    out = tmp_path / "out"
    listed = run(sys.executable, PYTHON / "examples" / "annotate_folder.py", tmp_path, out, "--processes", 2)
    assert "broken.obj: line 1" in listed
    assert sorted(file.name for file in out.iterdir()) == [
        "bar.json", "bar.png", "list.csv", "yard_tool.json", "yard_tool.png"]
    assert orbifit.Annotation.load(out / "bar.json", tmp_path / "bar.ply").regions[0].group == "D4h"


def test_documentation_builds_without_warnings(tmp_path):
    pytest.importorskip("sphinx")
    pytest.importorskip("furo")
    run(sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-b", "html", "-d", tmp_path / "doctrees",
        PYTHON / "docs", tmp_path / "html")
    page = (tmp_path / "html" / "api.html").read_text()
    for name in orbifit.__all__:
        assert f'id="orbifit.{name}"' in page, name


def test_pip_installs_what_was_built(tmp_path):
    pytest.importorskip("pip")
    build = pathlib.Path(os.environ.get("ORBIFIT_BUILD", ""))
    if not (build / "CMakeCache.txt").is_file():
        pytest.skip("ORBIFIT_BUILD names no build folder")
    run(sys.executable, "-m", "pip", "install", "--no-build-isolation", "--no-index", "--no-deps", "--quiet", "--target", tmp_path / "site",
        "--config-settings", f"build-dir={build}", PYTHON)
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    environment["PYTHONPATH"] = str(tmp_path / "site")
    code = "import orbifit; print(orbifit.__file__, orbifit.__version__); orbifit.detect(orbifit.generate('bar')[0])"
    where, version = run(sys.executable, "-c", code, env=environment, cwd=tmp_path).split()
    assert where == str(tmp_path / "site" / "orbifit" / "__init__.py") and version == orbifit.__version__
    listed = (next((tmp_path / "site").glob("orbifit-*.dist-info")) / "RECORD").read_text()
    assert "orbifit/__init__.pyi,sha256=" in listed and "orbifit/py.typed,sha256=" in listed
