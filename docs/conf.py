"""The site of the documentation: ``make docs`` builds it into build/site.

The source folder is the whole repository, not this one: pages link to READMEs of studies and to
files of models just as they do on a code host, and each such link is one of the site. Nothing is
fetched: no inventories of other projects, and the theme has its scripts and fonts with it.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import symhyb

project = "symhyb"
author = "The symhyb authors"
copyright = author
version = release = symhyb.__version__

root_doc = "docs/index"
include_patterns = ["*.md", "docs/**.md", "studies/*/README.md"]
exclude_patterns = [".*", "build", "dist", "out", "symhyb", "tests", "models", "**/__pycache__"]
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "_site.contents",
    "_site.generated",
]
contents_titles = {"CHANGELOG": "Changes"}
contents_pages = (
    "docs/index",
    "docs/method",
    "docs/tutorials/index",
    "docs/how-to/index",
    "docs/reference/python/index",
    "docs/evidence/index",
)

smartquotes = False  # q'' is a second derivative
myst_enable_extensions = ["html_image"]  # pictures with a width, as a code host takes them
myst_heading_anchors = 4
suppress_warnings = ["myst.header"]  # a page may begin a section at a lower rank

autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_member_order = "bysource"
napoleon_numpy_docstring = False
napoleon_use_ivar = True
python_use_unqualified_type_names = True
maximum_signature_line_length = 76
add_module_names = False
toc_object_entries_show_parents = "hide"
nitpicky = True
nitpick_ignore = [("py:exc", "ExpressionError")]
nitpick_ignore_regex = [
    (r"py:.*", r"(?!symhyb\b)[\w.]+\.\w+"),  # of other projects, whose inventories are not fetched
    # what values keep inside
    (r"py:class", r"symhyb\.(numeric|correction|discrepancy)\.\w+\.\w+\.\w+"),
    (r"py:class", r"symhyb\.model\.(fmu|local|mujoco)\.\w+"),
    (r"py:mod", r"symhyb\..*"),  # rooms of the program, which no page shows
]

html_theme = "furo"
html_title = "symhyb"
html_extra_path = ["_site/root"]
html_static_path = ["_site/static"]
html_css_files = ["site.css"]
html_show_sphinx = False
html_copy_source = False
html_show_sourcelink = False
