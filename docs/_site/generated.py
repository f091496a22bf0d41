"""Directives whose text is made from the program when the site is built, never typed.

```{public-names} symhyb.model symhyb.exact
```
the names of ``symhyb.__all__`` whose home is in these rooms, each from its docstring; with
``:modules:`` all public names of some modules, with ``:also:`` single ones by their paths.

```{kinds}
```
every kind of element, from :mod:`symhyb.laws`.

```{verbs}
```
every verb of the command line, from its own help.
"""

import re
from typing import Any, ClassVar

from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from _site.kinds import kinds_text
from _site.names import names_text
from _site.verbs import verbs_text


class Generated(SphinxDirective):
    """A directive that stands for the Markdown which ``made`` returns."""

    optional_arguments = 1
    final_argument_whitespace = True
    has_content = False
    option_spec: ClassVar[dict[str, Any]] = {
        "modules": directives.unchanged,
        "also": directives.unchanged,
    }

    def run(self) -> list[nodes.Node]:
        self.env.note_reread()  # the page changes with the program, not with its own text
        return self.parse_text_to_nodes(self.made(), allow_section_headings=True)

    def made(self) -> str:
        raise NotImplementedError


class Names(Generated):
    """Public names of some rooms."""

    def made(self) -> str:
        rooms = self.arguments[0].split() if self.arguments else []
        modules, also = (self.options.get(key, "").split() for key in ("modules", "also"))
        return names_text(rooms, modules, also)


class Kinds(Generated):
    """Kinds of elements."""

    def made(self) -> str:
        return kinds_text()


class Verbs(Generated):
    """Verbs of the command line."""

    def made(self) -> str:
        return verbs_text()


ARRAY = re.compile(r"~?(?:numpy\.)?ndarray\[tuple\[[^\]]*\], ~?(?:numpy\.)?dtype\[([^\]]*)\]\]")


OBJECT = re.compile(r"= <[^<>]*>")


def shorten_arrays(
    app: Sphinx, what: str, name: str, thing: Any, options: Any, given: str, returned: str
) -> tuple[str | None, str | None]:
    """Write an array as ``NDArray``, since its shape and unit stand in the docstring, and a default
    that is no literal as dots."""
    short = [text and ARRAY.sub("~numpy.typing.NDArray", text) for text in (given, returned)]
    short = [text and OBJECT.sub("= ...", text) for text in short]
    return short[0], short[1]


def in_our_words(app: Sphinx, doctree: nodes.document) -> None:
    """What Sphinx writes into lists of fields, as the pages write it."""
    for field in doctree.findall(nodes.field):
        for name in field.findall(nodes.field_name):
            if name.astext() == "Variables":
                name.children = [nodes.Text("Attributes")]
        for text in list(field.findall(nodes.Text)):
            if text == " -- ":
                text.parent.replace(text, nodes.Text(": "))


def setup(app: Sphinx) -> dict[str, Any]:
    """Join the build."""
    app.add_directive("public-names", Names)
    app.add_directive("kinds", Kinds)
    app.add_directive("verbs", Verbs)
    app.connect("doctree-read", in_our_words)
    app.connect("autodoc-process-signature", shorten_arrays)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
