"""Every package that an installation brings along, with its licence.

    python studies/reliability/supply.py [--extras formats,fmi]

Walks the requirements of symhyb as they are installed here. Exit status 1 where a package has a
licence that is not among the accepted ones, or is not of the version that constraints.txt pins.
"""

import argparse
import re
import sys
from collections.abc import Iterator, Mapping
from importlib import metadata
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

PINS = Path(__file__).resolve().parents[2] / "constraints.txt"
ACCEPTED = (
    r"\bMIT\b|\bMIT-0\b|\bBSD\b|BSD-[23]|Apache|\bPSF\b|Python Software|\bISC\b|\bZlib\b|\b0BSD\b"
    r"|Unlicense|MPL-2|Mozilla|HPND|CC0"
)
LOOKED_AT = {  # LGPL is used as it is, not changed, and no part of what symhyb ships
    "casadi": "LGPL-3.0",
    "asammdf": "LGPL-3.0, an extra",
    "apsw": "any that the OSI approves, with an extra",
    "nptdms": "LGPL-3.0, an extra",
    "fmpy": "BSD-2-Clause in its files, an extra",
}


def installed(root: str, extras: frozenset[str]) -> dict[str, metadata.Distribution]:
    """What ``root`` with these extras requires here, itself left out, by canonical name."""
    found: dict[str, metadata.Distribution] = {}
    open_ = [(root, extras)]
    seen = set()
    while open_:
        name, wanted = open_.pop()
        if (name, wanted) in seen:
            continue
        seen.add((name, wanted))
        try:
            distribution = metadata.distribution(name)
        except metadata.PackageNotFoundError:
            continue  # an extra that is not installed
        found[canonicalize_name(name)] = distribution
        for text in distribution.requires or ():
            requirement = Requirement(text)
            places = [{"extra": extra} for extra in wanted] or [{"extra": ""}]
            if requirement.marker is None or any(map(requirement.marker.evaluate, places)):
                open_.append((requirement.name, frozenset(requirement.extras)))
    found.pop(canonicalize_name(root), None)
    return dict(sorted(found.items()))


def licence(distribution: metadata.Distribution) -> str:
    """What a package says of its licence, in a line."""
    about = distribution.metadata
    expression = about.get("License-Expression") or ""
    classified = [
        one.rpartition("::")[2].strip()
        for one in about.get_all("Classifier") or ()
        if one.startswith("License ::") and not one.endswith("OSI Approved")
    ]
    said = expression or "; ".join(classified) or (about.get("License") or "").split("\n")[0]
    return said.strip()[:80] or "says nothing"


def pinned() -> dict[str, str]:
    """The versions of constraints.txt by canonical name."""
    rows = re.findall(r"^([\w.-]+)==(\S+)", PINS.read_text(encoding="utf-8"), re.M)
    return {canonicalize_name(name): version for name, version in rows}


def complaints(
    packages: Mapping[str, metadata.Distribution], pins: Mapping[str, str]
) -> Iterator[str]:
    """What is wrong with the packages."""
    for name, one in packages.items():
        if not re.search(ACCEPTED, licence(one), re.I) and name not in LOOKED_AT:
            yield f"{name}: the licence '{licence(one)}' is not among the accepted ones"
        if name not in pins:
            yield f"{name} {one.version} is not pinned in {PINS.name}"
        elif pins[name] != one.version:
            yield f"{name} is {one.version}, pinned is {pins[name]}"


def main() -> int:
    """List the packages, then what is wrong."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--extras", default="", help="of symhyb, with commas")
    extras = frozenset(filter(None, parser.parse_args().extras.split(",")))
    packages = installed("symhyb", extras)
    for name, one in packages.items():
        print(f"{name:24} {one.version:14} {LOOKED_AT.get(name) or licence(one)}")
    wrong = list(complaints(packages, pinned()))
    print("", *(wrong or [f"{len(packages)} packages, all accepted and pinned"]), sep="\n")
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
