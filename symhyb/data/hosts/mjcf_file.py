"""An MJCF before MuJoCo gets it: what is not given to it, and what is taken out.

No file that an MJCF names is opened. Meshes, fields of heights and textures are removed; a mesh
that has mass, or that touches what is around it, is a problem instead.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np

from symhyb.data.files.xml_file import Node
from symhyb.errors import Problem, visible
from symhyb.limits import DECLARED
from symhyb.model.tables import shorten

ROOT = "world"
WEIGHS = "its mass is that of a mesh, which is not read; give it an <inertial>"
TOUCHES = (
    'is a mesh or a field of heights that can touch others, which is not read; give it contype="0" '
    'conaffinity="0", or put a plain shape in its place'
)


def problems_of(root: Node, file: str) -> Iterator[Problem]:
    """What is not given to MuJoCo: other files, programs, and more than a machine has."""
    if root.tag != "mujoco":
        said = f"is no MJCF: its outermost element is <{shorten(root.tag)}>, not <mujoco>"
        yield Problem(said, file=file, line=root.line)
    open_, count = [root], 0
    while open_:
        node = open_.pop()
        open_ += node.children
        count += node.tag == "body"
        if node.tag in ("include", "plugin", "extension", "attach", "model"):
            if node.tag == "include":
                cure = "put in what it includes, or save the model with MuJoCo: mj_saveLastXML"
            else:
                cure = "remove it"
            yield Problem(f"<{node.tag}> is not read; {cure}", file=file, line=node.line)
    if count > DECLARED:
        yield Problem(f"has {count} bodies; at most {DECLARED} are read", file=file)


def touching(mujoco: Any, spec: Any) -> tuple[str, ...]:
    """The shapes out of files that can touch others."""
    pairs = {name for pair in spec.pairs for name in (pair.geomname1, pair.geomname2)}
    return tuple(
        shown(geom.name) or f"a shape of {shown(geom.parent.name) or 'a body'}"
        for geom in _filed(mujoco, spec)
        if geom.contype or geom.conaffinity or (geom.name and geom.name in pairs)
    )


def stripped(mujoco: Any, spec: Any) -> tuple[str, ...]:
    """Take all from a model that files are opened for, or that claims memory; return the bodies
    whose mass was that of a mesh."""
    filed = _filed(mujoco, spec)
    heavy = dict.fromkeys(shown(geom.parent.name) for geom in filed if _weighs(geom, spec))
    for painted in (spec.geoms, spec.sites, spec.tendons):
        for one in painted:
            one.material = ""
    kinds = (spec.meshes, spec.hfields, spec.skins, spec.materials, spec.textures)
    for one in (*filed, *(one for kind in kinds for one in list(kind))):
        spec.delete(one)
    spec.memory = spec.njmax = spec.nconmax = spec.nstack = -1
    return tuple(heavy)


def shown(name: str) -> str:
    """A name of the file on one line, for sentences."""
    return visible(" ".join(name.split()))


def _filed(mujoco: Any, spec: Any) -> list[Any]:
    """The shapes whose form is in a file."""
    shapes = (mujoco.mjtGeom.mjGEOM_MESH, mujoco.mjtGeom.mjGEOM_SDF, mujoco.mjtGeom.mjGEOM_HFIELD)
    return [geom for geom in spec.geoms if geom.type in shapes]


def _weighs(geom: Any, spec: Any) -> bool:
    """Whether the mass of a body is that of a shape, among others."""
    stated = geom.parent.explicitinertial and spec.compiler.inertiafromgeom != 1
    nothing = geom.mass == 0 or (np.isnan(geom.mass) and geom.density == 0)
    return geom.parent.name != ROOT and not stated and not nothing
