"""What runs in the page: Bokeh, the page's own script, and a policy that allows nothing else."""

import json
from base64 import b64encode
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from importlib import resources
from typing import Any

from markupsafe import Markup

from symhyb.report.canvas import DARK
from symhyb.report.live import Live

# what HTML could read as the end of a script; JSON knows these letters by their numbers too
_ESCAPED = str.maketrans({letter: f"\\u{ord(letter):04x}" for letter in "<>&\u2028\u2029"})


@dataclass(frozen=True, slots=True)
class Embedded:
    """The ``data`` by the name of who reads it, the ``scripts`` that draw it, and the ``policy`` of
    a page with these scripts: none other is run, and nothing is fetched from anywhere."""

    policy: str
    data: Mapping[str, Markup]
    scripts: tuple[Markup, ...]


def embedded(figures: Sequence[Live], motion: Mapping[str, Any] | None = None) -> Embedded:
    """What a page with these figures holds, and one with a machine in ``motion``; of none no script
    at all."""
    scripts: list[str] = []
    data: dict[str, Markup] = {}
    if motion is not None:  # first: it waits for nothing
        scripts.append(script_of("motion.js"))
        data["motion"] = _written(motion)
    if figures:
        scripts += [library(), painting() + script_of("page.js")]
        data["figures"] = _written({"items": [one.item for one in figures], "dark": DARK})
    return Embedded(policy_of(scripts), data, tuple(map(Markup, scripts)))


def _written(data: Mapping[str, Any]) -> Markup:
    """Data as JSON that ends no script."""
    text = json.dumps(data, allow_nan=False, separators=(",", ":"))
    return Markup(text.translate(_ESCAPED))


def policy_of(scripts: Sequence[str]) -> str:
    """The content security policy of a page that runs these scripts alone."""
    hashes = [f"'sha256-{_hash(script)}'" for script in scripts] or ["'none'"]
    return (
        "default-src 'none'; base-uri 'none'; form-action 'none'; img-src data:; "
        f"style-src 'unsafe-inline'; script-src {' '.join(hashes)}"
    )


@cache
def library() -> str:
    """The script of Bokeh, with its licence; it has nothing that ends a script element."""
    folder = resources.files("bokeh") / "server" / "static" / "js"
    text = folder.joinpath("bokeh.min.js").read_text("utf-8").replace("\r", "")
    return text.replace("</script", "<\\/script").replace("<!--", "<\\!--")


def script_of(name: str) -> str:
    """A script of this package."""
    return resources.files("symhyb.report").joinpath(name).read_text("utf-8")


def painting() -> str:
    """The script that gives figures the colours of a light or a dark screen."""
    return script_of("paint.js")


def _hash(script: str) -> str:
    return b64encode(sha256(script.encode()).digest()).decode("ascii")
