"""How Sphinx makes the site of these pages: ``python3 -m docs``.

The source folder is the whole checkout, not ``docs``: so README, changelog and the pages beside the
models are pages of the site, too, and a relative link means the same here and on a forge.
"""

from __future__ import annotations

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

import icage  # noqa: E402

project = "icage"
author = "the icage authors"
copyright = "the icage authors, Apache-2.0"
version = release = icage.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "docs.extensions.navigation",
    "docs.extensions.citations",
    "docs.extensions.generated",
]
root_doc = "docs/index"
include_patterns = [
    "docs/**.md",
    "models/**.md",
    "tests/fuzz/log.md",
    "benchmarks/**.md",
    "README.md",
    "CHANGELOG.md",
    "SECURITY.md",
]
exclude_patterns = [".*", "out", "build", "dist", "**/__pycache__", "**/.*", "*.egg-info"]

# Markdown as a forge shows it: the same anchors, no markup of Sphinx.
source_suffix = {".md": "markdown"}
myst_heading_anchors = 4
highlight_language = "none"

# The site asks no host for anything, neither when it is built nor when it is read.
html_theme = "furo"
html_title = "icage"
html_static_path = ["extensions/static"]
html_css_files = ["icage.css"]
html_copy_source = False
html_show_sphinx = False
html_theme_options = {
    "footer_icons": [],
    "light_css_variables": {"color-brand-primary": "#1f5fa8", "color-brand-content": "#1f5fa8"},
    "dark_css_variables": {"color-brand-primary": "#8ab8ee", "color-brand-content": "#8ab8ee"},
}

# The reference of the Python names, from their docstrings.
autodoc_default_options = {"members": True, "member-order": "bysource"}
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_preserve_defaults = True
autodoc_type_aliases = {
    name: name for name in ("FloatArray", "IntArray", "BoolArray", "ArrayLike", "MethodName")
}
python_use_unqualified_type_names = True
python_display_short_literal_types = True
python_maximum_signature_line_length = 80
napoleon_google_docstring = False
napoleon_use_rtype = False

# Every reference must lead somewhere, but for the types in signatures that are another library's,
# whose pages would have to be fetched, or are no public name of ours.
nitpick_ignore_regex = [
    ("py:.*", r"(numpy|np|shapely|pathlib|os|collections|typing|ndarray|dtype|float64)\b.*"),
    ("py:class", r"[A-Z]\w+|'[\w ]+'"),
    ("py:class", r"(icage|sim)\.[a-z_]+\..*"),
]
