r"""Where a body may carry something: the ends of what is welded to it.

    body o────[weld]── wrist ──[weld]── hand         the hand is a tip of the body: a leaf of the
         └──(moves)── …                              tree of links, beside the body's own origin

Sites, which an MJCF declares, are tips too. A place counts once. Of many places, as of a hand full
of frames of sensors, those farthest from the origin of the body are kept.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from symhyb.imports.rigid import Pose
from symhyb.imports.robot import Array, Robot

SAME_PLACE = 1e-9  # m: two places are one, and a component is 0
MOST = 3  # tips of one body


@dataclass(frozen=True, slots=True, eq=False)
class Tip:
    """A place by its ``name``, that of a link or a site, ``at`` (3,), m, in the axes of the body
    and counted from its origin."""

    name: str
    at: Array


def tips_of(
    robot: Robot, body: str, welded: Sequence[str], poses: Mapping[str, Pose]
) -> tuple[tuple[Tip, ...], list[str]]:
    """The tips of a ``body`` with its ``welded`` links, whose ``poses`` are in its axes, in the
    order of the tree; and a note where some are left out."""
    found: list[Tip] = []
    for tip in _ends(robot, body, welded, poses):
        taken = (np.zeros(3), *(other.at for other in found))
        if all(np.linalg.norm(tip.at - at) > SAME_PLACE for at in taken):
            found.append(tip)
    if len(found) <= MOST:
        return tuple(found), []
    ranked = sorted(found, key=lambda tip: -float(np.linalg.norm(tip.at)))
    kept = tuple(tip for tip in found if tip in ranked[:MOST])
    note = (
        f"{len(found)} ends are rigid with the link '{body}': points are the {MOST} that are "
        f"farthest from its origin, {', '.join(tip.name for tip in kept)}"
    )
    return kept, [note]


def _ends(
    robot: Robot, body: str, welded: Sequence[str], poses: Mapping[str, Pose]
) -> Iterator[Tip]:
    """The leaves among the welded links, then the sites of the body, at any place."""
    carriers = {joint.parent for joint in robot.joints}
    for link in welded:
        if link not in carriers:
            yield _tip(link, poses[link].at)
    for site in robot.sites:
        if site.link in (body, *welded):
            pose = poses[site.link]
            yield _tip(site.name, pose.turned @ np.array(site.at) + pose.at)


def _tip(name: str, at: Array) -> Tip:
    return Tip(name, np.where(np.abs(at) < SAME_PLACE, 0.0, at))
