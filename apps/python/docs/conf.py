"""Sphinx: the Python package's pages. The package must be importable."""

import orbifit

project = "Orbifit"
author = "The authors of Orbifit"
release = orbifit.__version__
extensions = ["sphinx.ext.autodoc", "sphinx.ext.napoleon"]
html_theme = "furo"
html_title = f"Orbifit {release}: Python"
autodoc_member_order = "groupwise"
autodoc_default_options = {"members": True}
autoclass_content = "both"
python_use_unqualified_type_names = True


def plain(app, what, name, obj, options, signature, result):  # type: ignore[no-untyped-def]
    """Signatures without the name of the compiled module."""
    def short(text):  # type: ignore[no-untyped-def]
        return text and text.replace("orbifit._core.", "").replace("numpy.", "").replace("ndarray[float64]", "ndarray")

    return short(signature), short(result)


def setup(app):  # type: ignore[no-untyped-def]
    app.connect("autodoc-process-signature", plain)
