"""Check a built site: ``python docs/_site/check_site.py build/site``.

Every link within the site leads to a file and a place on it that exist, nothing is loaded from the
network, and every public name has its entry.
"""

import sys
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import symhyb

LOADED = {"script": "src", "img": "src", "link": "href", "source": "src", "iframe": "src"}
NOT_LOADED = {"canonical", "next", "prev", "search", "index"}  # links that only point somewhere


class Page(HTMLParser):
    """What a page names (``ids``), where it leads (``links``) and what it loads (``loaded``)."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.ids: set[str] = set()
        self.links: list[str] = []
        self.loaded: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = {key: value or "" for key, value in attrs}
        self.ids |= {given[key] for key in ("id", "name") if key in given}
        if tag == "a" and "href" in given:
            self.links.append(given["href"])
        elif LOADED.get(tag, "") in given and given.get("rel") not in NOT_LOADED:
            self.loaded.append(given[LOADED[tag]])


def faults(site: Path) -> Iterator[str]:
    """What is wrong with a site, a sentence each."""
    files = sorted(site.rglob("*.html"))
    pages = {file.resolve(): Page(file.read_text(encoding="utf-8")) for file in files}
    if not pages:
        yield f"{site} holds no page"
        return
    for file, page in pages.items():
        where = file.relative_to(site.resolve()).as_posix()
        for address in page.loaded:
            if urlsplit(address).scheme not in ("", "data") or address.startswith("//"):
                yield f"{where} loads {address} from the network"
            elif not urlsplit(address).scheme and not target(file, address).is_file():
                yield f"{where} loads {address}, which is not there"
        for address in dict.fromkeys(page.links):
            if wrong := astray(file, address, pages, site.resolve()):
                yield f"{where}: {address} {wrong}"
    entries = set().union(*(page.ids for page in pages.values()))
    lacking = [name for name in symhyb.__all__ if f"symhyb.{name}" not in entries]
    yield from (f"symhyb.{name} has no entry" for name in lacking)


def target(file: Path, address: str) -> Path:
    """The file that an address on a page means."""
    path = unquote(urlsplit(address).path)
    return (file.parent / path).resolve() if path else file


def astray(file: Path, address: str, pages: dict[Path, Page], site: Path) -> str:
    """Why a link leads nowhere, empty where it leads somewhere or out of the site."""
    parts = urlsplit(address)
    if parts.scheme or parts.netloc:
        return ""
    aim = target(file, address)
    if not aim.is_file() or not aim.is_relative_to(site):
        return "leads to no file of the site"
    anchor = unquote(parts.fragment)
    if anchor and aim in pages and anchor not in pages[aim].ids:
        return "leads to no such place"
    return ""


def main() -> int:
    """Say what is wrong; 0 if nothing is."""
    found = list(faults(Path(sys.argv[1])))
    print(*found, sep="\n", end="\n" if found else "")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
