"""Loops of a robot: which joints they hold, and their pins once links are welded to bodies."""

from collections.abc import Iterator, Mapping

import numpy as np

from symhyb.imports.rigid import Pose
from symhyb.imports.robot import Joint, Pin, Robot, Site


def in_loops(robot: Robot) -> frozenset[str]:
    """The joints that pins and relations hold, and those that these follow."""
    by_child = {joint.child: joint for joint in robot.joints}
    by_name = {joint.name: joint for joint in robot.joints}
    found = {name for item in robot.relations for name in (item.joint, item.of) if name}
    for pin in robot.pins:
        first, second = ({*_up(end.link, by_child)} for end in pin.ends)
        found |= first ^ second
    for name in tuple(found):
        joint = by_name[name]
        while joint.mimic is not None:
            joint = by_name[joint.mimic.joint]
        found.add(joint.name)
    return frozenset(found)


def _up(link: str, by_child: Mapping[str, Joint]) -> Iterator[str]:
    """The joints on which a link hangs, by name."""
    while link in by_child:
        yield by_child[link].name
        link = by_child[link].parent


def pinned(
    robot: Robot, places: Mapping[str, tuple[str, Pose]]
) -> tuple[tuple[Pin, ...], tuple[str, ...]]:
    """The pins between bodies in which the links lie at ``places``, and notes on those whose ends
    do not move against each other."""
    found, notes = [], []
    for pin in robot.pins:
        first, second = (_seen(end, places) for end in pin.ends)
        if first.link != second.link:
            found.append(Pin(pin.name, first, second))
            continue
        apart = float(np.linalg.norm(np.subtract(first.at, second.at)))
        notes.append(
            f"the loop '{pin.name}' holds nothing and is left out: its ends are rigid with each "
            f"other, {apart:.3g} m apart"
        )
    return tuple(found), tuple(notes)


def _seen(end: Site, places: Mapping[str, tuple[str, Pose]]) -> Site:
    """A place in the axes of the body that its link lies in."""
    body, pose = places[end.link]
    x, y, z = (float(part) for part in pose.turned @ np.array(end.at) + pose.at)
    return Site(end.name, body, (x, y, z))
