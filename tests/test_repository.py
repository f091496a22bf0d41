"""What travels with the repository: no trace of the machine it was written on, no dead links."""

import re
import subprocess
import tomllib
from functools import cache
from pathlib import Path

import pytest

from symhyb.model.read import parse_model

ROOT = Path(__file__).parent.parent
LONGEST_FILE = 400

# Put together from parts, so that this file does not find itself.
MACHINE_PATHS = [f"/{folder}/" for folder in ("work", "root", "home")] + ["/" + "tmp/[A-Za-z]"]
REGISTRY_HOSTS = [
    r"\.".join(host)
    for host in (("pypi", "org"), ("pythonhosted", "org"), ("anaconda", "org"), ("npmjs", "org"))
]
FORBIDDEN = re.compile(r"(?<![\w.])(" + "|".join(MACHINE_PATHS) + ")|" + "|".join(REGISTRY_HOSTS))
LINK = re.compile(r"""\]\(\s*<?([^)\s>]+)|(?:src|href)=["']([^"']+)""")


@cache
def committed() -> tuple[Path, ...]:
    """Every file that is committed or would be."""
    git = ["git", "-c", "safe.directory=*"]  # a checkout may belong to another user
    command = [*git, "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    listed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    files = (ROOT / name for name in sorted(filter(None, listed.split("\0"))))
    return tuple(file for file in files if file.is_file())


def text_of(file: Path) -> str:
    """The text of a file, empty for a picture or other binary."""
    content = file.read_bytes()
    return "" if b"\0" in content else content.decode("utf-8")


def name_of(file: Path) -> str:
    return file.relative_to(ROOT).as_posix()


def without_code(text: str) -> str:
    """A page without its code: what stands there is not a link."""
    return re.sub(r"```.*?```|`[^`\n]*`", "", text, flags=re.DOTALL)


def anchors(page: str) -> set[str]:
    """The anchors that headings get: lower case, blanks as hyphens, punctuation dropped."""
    headings = re.findall(r"^#+\s+(.+?)\s*$", re.sub(r"```.*?```", "", page, flags=re.DOTALL), re.M)
    plain = (re.sub(r"[^\w\- ]", "", heading.lower()) for heading in headings)
    return {heading.replace(" ", "-") for heading in plain}


def dead(page: Path) -> list[str]:
    """The relative links of a page that lead nowhere inside the repository."""
    lost = []
    for target in (a or b for a, b in LINK.findall(without_code(text_of(page)))):
        if re.match(r"[a-z][a-z+.-]*:", target):
            continue
        path, _, anchor = target.partition("#")
        file = (page.parent / path).resolve() if path else page
        inside = file.exists() and file.is_relative_to(ROOT.resolve())
        if not inside or (anchor and file.suffix == ".md" and anchor not in anchors(text_of(file))):
            lost.append(target)
    return lost


def test_no_file_names_a_path_of_a_machine_or_a_package_registry() -> None:
    traces = [
        f"{name_of(file)}: {found.group()}"
        for file in committed()
        for found in FORBIDDEN.finditer(text_of(file))
    ]
    assert not traces, "\n".join(traces)


@pytest.mark.parametrize("path", ["work", "root", "home", "tmp"])
def test_a_path_of_a_machine_would_be_seen(path: str) -> None:
    assert FORBIDDEN.search(f"see /{path}/notes.md")
    assert not FORBIDDEN.search(f"see ../{path}/notes.md")


def test_links_lead_to_files_of_the_repository() -> None:
    pages = [file for file in committed() if file.suffix == ".md"]
    assert {name_of(page): dead(page) for page in pages if dead(page)} == {}


def test_every_page_of_docs_is_reached_through_links_from_its_index() -> None:
    index = text_of(ROOT / "docs" / "index.md")
    pages = {file.name for file in ROOT.glob("docs/*.md")} - {"index.md"}
    assert pages <= {a or b for a, b in LINK.findall(index)}


def test_the_model_file_of_the_documentation_is_valid_and_so_is_its_correction() -> None:
    blocks = re.findall(
        r"^```toml\n(.*?)^```", text_of(ROOT / "docs" / "model-file.md"), re.M | re.S
    )
    whole, correction, change = blocks
    assert parse_model(whole).title
    assert parse_model(whole + correction).elements[-1].found
    again = re.sub(r"^k = .*\n", change, whole, flags=re.M)
    assert [parameter.was for parameter in parse_model(again).parameters] == [None, 980.0]


def test_no_file_of_the_package_is_too_long() -> None:
    lengths = {
        name_of(file): len(text_of(file).splitlines())
        for file in committed()
        if file.suffix == ".py" and file.is_relative_to(ROOT / "symhyb")
    }
    assert {name: lines for name, lines in lengths.items() if lines > LONGEST_FILE} == {}


def test_changes_that_alter_numbers_come_first_in_the_changelog() -> None:
    headings = re.findall(r"^#+ (.+)$", text_of(ROOT / "CHANGELOG.md"), re.M)
    assert headings[0] == "Changes numbers"


def pins(name: str) -> list[str]:
    """The lines of a file of constraints that are no comment."""
    lines = text_of(ROOT / name).splitlines()
    return [line for line in lines if line and not line.startswith("#")]


@pytest.mark.parametrize("name", ["constraints.txt", "constraints-oldest.txt"])
def test_constraints_are_bare_versions(name: str) -> None:
    bare = re.compile(r"[A-Za-z0-9._-]+==[0-9][0-9A-Za-z.]*")
    assert [pin for pin in pins(name) if not bare.fullmatch(pin)] == []


def test_the_oldest_versions_that_are_allowed_are_those_that_are_tested() -> None:
    project = tomllib.loads(text_of(ROOT / "pyproject.toml"))["project"]
    extras = project["optional-dependencies"]
    formats = ("mat73", "parquet", "excel", "mdf", "rosbag", "ulog", "tdms")
    own = [extras[name] for name in (*formats, "fmi", "mjcf", "urdf", "xarray", "arviz")]
    needed = {*project["dependencies"], *(one for extra in own for one in extra)}
    oldest = {pin.replace("==", ">=") for pin in pins("constraints-oldest.txt")}
    assert needed - oldest == set()


def test_what_is_cited_is_the_version_and_the_licence_of_the_project() -> None:
    project = tomllib.loads(text_of(ROOT / "pyproject.toml"))["project"]
    cited = dict(
        re.findall(r"^(version|license|title): (.+)$", text_of(ROOT / "CITATION.cff"), re.M)
    )
    assert cited["version"] == project["version"]
    assert cited["license"] == project["license"]
    assert project["name"] in cited["title"]
