"""How results show in notebooks: a picture, rendered by the library, and a table."""

import base64
import html
from typing import TYPE_CHECKING, Any, Iterable, List, Sequence

if TYPE_CHECKING:
    from orbifit import Annotation, CheckReport, FitResult, Mesh, PointCloud, Subspace

WIDTH, HEIGHT = 300, 225  # of one picture, pixels
MOST_PICTURES = 8


def mesh_html(mesh: "Mesh") -> str:
    return _image(_render(mesh)) + _text(repr(mesh))


def scan_html(scan: "PointCloud") -> str:
    return _text(repr(scan))


def annotation_html(annotation: "Annotation") -> str:
    rows = [
        [region.id, region.group, len(region.faces), "" if region.parent is None else region.parent,
         f"{region.residual_max:.2g}", region.name]
        for region in annotation.regions
    ]
    page = _text(repr(annotation)) + _table(["region", "group", "faces", "parent", "residual", "name"], rows)
    if annotation.patterns:
        rows = [[p.id, p.kind, len(p), f"{p.residual_max:.2g}", p.name] for p in annotation.patterns]
        page += _table(["pattern", "kind", "instances", "residual", "name"], rows)
    return _annotation_picture(annotation) + page


def subspace_html(subspace: "Subspace") -> str:
    return _image(_render(subspace.mesh, points=subspace.samples)) + _text(repr(subspace))


def fit_html(fit: "FitResult") -> str:
    pictures = [_render(fit.mesh, points=fit.scan, frame=fit.mesh), _render(fit.mesh)]
    figures = [[name, f"{value:.3g}"] for name, value in fit.figures.items() if not name.startswith("seconds_")]
    return (
        _image(_core.contact_sheet(pictures, ["with the scan", "fitted"], 2))
        + _text(f"{fit!r} {fit.stopped_because}")
        + _table(["figure", "value"], figures)
    )


def check_html(check: "CheckReport") -> str:
    columns = ["id", "group", "vertices", "rest_max", "worst_vertex", "name"]
    rows = [[_short(region[column]) for column in columns] for region in check.regions]
    return _text(repr(check)) + _table(columns, rows)


def _annotation_picture(annotation: "Annotation") -> str:
    mesh = annotation.mesh
    if mesh is None:
        return ""
    pictures: List[Any] = []
    captions: List[str] = []
    for region in annotation.regions[:MOST_PICTURES]:
        pictures.append(_render(mesh, annotation, region=region.id))
        captions.append(f"{region.id}: {region.group}")
    for pattern in annotation.patterns[: MOST_PICTURES - len(pictures)]:
        pictures.append(_render(mesh, annotation, pattern=pattern.id))
        captions.append(f"{pattern.id}: {pattern.kind}")
    if not pictures:
        return _image(_render(mesh))
    return _image(_core.contact_sheet(pictures, captions, min(4, len(pictures))))


def _render(mesh: Any, annotation: Any = None, **options: Any) -> Any:
    return _core.render(mesh, annotation, width=WIDTH, height=HEIGHT, samples=4, **options)


def _image(pixels: Any) -> str:
    data = base64.b64encode(_core.encode_png(pixels)).decode("ascii")
    return f'<img alt="" src="data:image/png;base64,{data}">'


def _text(text: str) -> str:
    return f"<p>{html.escape(text)}</p>"


def _short(value: Any) -> str:
    return f"{value:.2g}" if isinstance(value, float) else str(value)


def _table(headers: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    head = "".join(f"<th>{html.escape(header)}</th>" for header in headers)
    body = "".join(
        "<tr>" + "".join(f"<td>{html.escape(str(cell))}</td>" for cell in row) + "</tr>" for row in rows
    )
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def add_to(core: Any) -> None:
    """Gives the classes of the compiled module what notebooks ask for."""
    global _core
    _core = core
    core.Mesh._repr_html_ = mesh_html
    core.PointCloud._repr_html_ = scan_html
    core.Annotation._repr_html_ = annotation_html
    core.Subspace._repr_html_ = subspace_html
    core.FitResult._repr_html_ = fit_html
    core.CheckReport._repr_html_ = check_html


_core: Any = None
