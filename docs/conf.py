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
autodoc_class_signature = "separated"
napoleon_google_docstring = False
napoleon_use_rtype = False
