"""Tables of contents from the links that pages hold anyway, and links to folders.

The pages are plain Markdown, to be read on a code host as well, so none of them holds a toctree. A
page of contents lists others under headings; each heading with such a list becomes a hidden
toctree with the heading as its caption, and the words of a link the title in the side bar:

    ## Reference
    - [The model file](model-file.md): format 1      ->     caption Reference, The model file

A page of a folder whose name is ``index`` gets the other pages of its folder too, those that it
does not list in the order of their names.
"""

import re
from collections.abc import Collection, Iterator
from pathlib import Path, PurePosixPath
from typing import Any

from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx

LISTED = re.compile(r"^\s*[-*] \[([^\]]+)\]\(([^)#\s]+\.md)\)", re.MULTILINE)
HEADING = re.compile(r"^## +(.+?)\s*$", re.MULTILINE)
PAGES = ("README.md", "index.md")  # what stands for a folder


def sections(text: str) -> Iterator[tuple[str, str]]:
    """The headings of second rank of a page, each with what follows it; first what precedes all."""
    parts = HEADING.split(text)
    yield "", parts[0]
    yield from zip(parts[1::2], parts[2::2], strict=True)


def toctrees(docname: str, text: str, beside: Collection[str] = ()) -> str:
    """The toctrees of a page of contents, as MyST: of what it lists, then of the pages ``beside``
    it that it does not list. ``docname`` is its path without the ending. Nothing if the page has a
    toctree of its own."""
    if "{toctree}" in text:
        return ""
    here = PurePosixPath(docname).parent
    top = here.name == "docs"
    made, seen = [], {docname}
    for heading, body in sections(text):
        entries = []
        for title, target in LISTED.findall(body):
            name = resolved(here, target)
            if name not in seen:
                seen.add(name)
                entries.append(f"{title} </{name}>")
        if entries:
            made.append(toctree(entries, heading if top else ""))
    others = [f"/{name}" for name in sorted(beside) if name not in seen]
    if others:
        made.append(toctree(others, ""))
    return "".join(made)


def toctree(entries: list[str], caption: str) -> str:
    """One hidden toctree."""
    options = [":hidden:", *([f":caption: {caption}"] if caption else [])]
    return "\n".join(["", "```{toctree}", *options, "", *entries, "```", ""])


def resolved(folder: PurePosixPath, target: str) -> str:
    """The page that a relative link means, without its ending."""
    parts: list[str] = []
    for part in (folder / target).parts:
        if part == "..":
            parts.pop()
        else:
            parts.append(part)
    return "/".join(parts).removesuffix(".md")


def titled(text: str, title: str) -> str:
    """A page under a title, its own headings one rank lower."""
    return f"# {title}\n\n" + re.sub(r"^(#+ )", r"#\1", text, flags=re.MULTILINE)


def add_toctrees(app: Sphinx, docname: str, source: list[str]) -> None:
    """Append its toctrees to a page of contents while it is read, and give a page without a title
    of its own the one that is configured."""
    if docname in app.config.contents_titles:
        source[0] = titled(source[0], app.config.contents_titles[docname])
    if docname in app.config.contents_pages:
        folder = docname.rpartition("/")[0]
        beside = {name for name in app.env.found_docs if name.rpartition("/")[0] == folder}
        source[0] += toctrees(docname, source[0], beside if folder != "docs" else ())


def lead_into_folders(app: Sphinx, doctree: nodes.document) -> None:
    """A link to a folder leads to its README or index, or is plain text: the site lists none."""
    docname = app.env.docname
    here = Path(app.srcdir) / PurePosixPath(docname).parent
    for link in list(doctree.findall(addnodes.pending_xref)):
        folder = here / link["reftarget"]
        if link["reftype"] != "myst" or not folder.is_dir():
            continue
        name = resolved(PurePosixPath(docname).parent, link["reftarget"])
        page = next((f"{name}/{page}" for page in PAGES if (folder / page).exists()), "")
        if page.removesuffix(".md") in app.env.found_docs:
            link["refdomain"], link["reftarget"] = "doc", page.removesuffix(".md")
        else:
            link.replace_self(link.children)


def setup(app: Sphinx) -> dict[str, Any]:
    """Join the build."""
    app.add_config_value("contents_pages", (), "env", (list, tuple))
    app.add_config_value("contents_titles", {}, "env", (dict,))
    app.connect("source-read", add_toctrees)
    app.connect("doctree-read", lead_into_folders)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
