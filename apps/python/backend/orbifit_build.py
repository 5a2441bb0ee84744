"""PEP 517: builds a wheel with CMake, with what Debian packages alone.

``pip install .`` builds into build/python of the project. Another build folder, already configured, can be given:
``--config-settings build-dir=FOLDER``.
"""

import base64
import csv
import hashlib
import io
import os
import re
import subprocess
import sys
import sysconfig
import tarfile
import tempfile
import zipfile
from pathlib import Path
from typing import Any, Dict, List, Mapping, Optional

ROOT = Path(__file__).resolve().parents[3]
PACKAGE = "apps/python"
NUMPY = "numpy>=1.24"

Settings = Optional[Mapping[str, Any]]


def get_requires_for_build_wheel(config_settings: Settings = None) -> List[str]:
    return []  # a compiler and the libraries are no Python packages: README lists them


def get_requires_for_build_sdist(config_settings: Settings = None) -> List[str]:
    return []


def build_wheel(wheel_directory: str, config_settings: Settings = None, metadata_directory: Optional[str] = None) -> str:
    name = f"orbifit-{_version()}-{_tag()}.whl"
    with tempfile.TemporaryDirectory() as staging:
        build = _built(dict(config_settings or {}))
        subprocess.run(
            ["cmake", "--install", str(build), "--component", "python", "--strip", "--prefix", staging],
            check=True, stdout=subprocess.DEVNULL,
        )
        package = next(Path(staging).rglob("orbifit/__init__.py")).parent
        _write_wheel(Path(wheel_directory) / name, _package_files(package))
    return name


def prepare_metadata_for_build_wheel(metadata_directory: str, config_settings: Settings = None) -> str:
    """Without this pip would build the wheel twice."""
    folder = f"orbifit-{_version()}.dist-info"
    for name, content in _info_files().items():
        file = Path(metadata_directory) / name
        file.parent.mkdir(exist_ok=True)
        file.write_bytes(content)
    return folder


def build_sdist(sdist_directory: str, config_settings: Settings = None) -> str:
    """The whole project: the package is a part of it."""
    base = f"orbifit-{_version()}"
    listed = subprocess.run(["git", "-C", str(ROOT), "ls-files", "-z"], capture_output=True, check=True).stdout
    with tarfile.open(Path(sdist_directory) / f"{base}.tar.gz", "w:gz", format=tarfile.PAX_FORMAT) as archive:
        for file in listed.decode().rstrip("\0").split("\0"):
            if (ROOT / file).is_file():
                archive.add(ROOT / file, f"{base}/{file}")
        _add_text(archive, f"{base}/PKG-INFO", _metadata())
        project = (ROOT / PACKAGE / "pyproject.toml").read_text().replace('"backend"', f'"{PACKAGE}/backend"')
        _add_text(archive, f"{base}/pyproject.toml", project)
    return f"{base}.tar.gz"


def _version() -> str:
    found = re.search(r"project\(orbifit VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())
    if found is None:
        raise RuntimeError("CMakeLists.txt names no version")
    return found.group(1)


def _tag() -> str:
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{python}-{python}-{re.sub('[-.]', '_', sysconfig.get_platform())}"


def _built(settings: Dict[str, Any]) -> Path:
    given = settings.get("build-dir")
    build = Path(given).resolve() if given else ROOT / "build" / "python"
    if not given:
        configure = [
            "cmake", "-S", str(ROOT), "-B", str(build), "-DCMAKE_BUILD_TYPE=Release", "-DORBIFIT_BUILD_PYTHON=ON",
            "-DORBIFIT_BUILD_TESTS=OFF", "-DORBIFIT_BUILD_BASELINES=OFF", f"-DPython_EXECUTABLE={sys.executable}",
            "-Wno-dev",
        ]
        subprocess.run(configure, check=True)
    jobs = str(len(os.sched_getaffinity(0)))
    subprocess.run(["cmake", "--build", str(build), "--target", "orbifit_python", "--parallel", jobs], check=True)
    return build


def _metadata() -> str:
    return (
        f"Metadata-Version: 2.1\nName: orbifit\nVersion: {_version()}\n"
        "Summary: Finds, keeps and fits the symmetries of 3D shapes\nLicense: BSD-3-Clause\n"
        f"Requires-Python: >=3.9\nRequires-Dist: {NUMPY}\n"
    )


def _package_files(package: Path) -> Dict[str, bytes]:
    files = {f"orbifit/{file.name}": file.read_bytes() for file in sorted(package.iterdir()) if file.is_file()}
    return {**files, **_info_files()}


def _info_files() -> Dict[str, bytes]:
    files = {}
    info = f"orbifit-{_version()}.dist-info"
    files[f"{info}/METADATA"] = _metadata().encode()
    files[f"{info}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: orbifit\nRoot-Is-Purelib: false\nTag: {_tag()}\n".encode()
    files[f"{info}/LICENSE"] = (ROOT / "LICENSE").read_bytes()
    return files


def _write_wheel(wheel: Path, files: Dict[str, bytes]) -> None:
    record = f"orbifit-{_version()}.dist-info/RECORD"
    rows = io.StringIO()
    writer = csv.writer(rows, lineterminator="\n")
    for name, content in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        writer.writerow([name, f"sha256={digest}", len(content)])
    writer.writerow([record, "", ""])
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in [*files.items(), (record, rows.getvalue().encode())]:
            entry = zipfile.ZipInfo(name)  # of one date: the same files give the same bytes
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o100755 if name.endswith(".so") else 0o100644) << 16
            archive.writestr(entry, content)


def _add_text(archive: tarfile.TarFile, name: str, text: str) -> None:
    entry = tarfile.TarInfo(name)
    entry.size = len(text.encode())
    archive.addfile(entry, io.BytesIO(text.encode()))
