"""Whether links and joints are one tree, and the order in which it is walked: without recursion."""

from collections.abc import Iterator, Mapping, Sequence

from symhyb.errors import Problem, did_you_mean
from symhyb.imports.robot import Joint, Link
from symhyb.model.tables import shorten

LISTED = 5  # names in one sentence
COMPARED = 200  # names, with which a wrong one is compared


def nearest(name: str, known: Sequence[str]) -> str:
    """The cure for a wrong name; none among so many that comparing would take long."""
    return did_you_mean(name, known) if len(known) <= COMPARED else ""


def walk(links: Mapping[str, Link], joints: Sequence[Joint]) -> tuple[str, tuple[Joint, ...]]:
    """The root, and the joints in the order of the tree: a parent before its children, and a chain
    before what branches off later. Links and joints are those of a tree (:func:`tree_problems`)."""
    below: dict[str, list[Joint]] = {}
    for joint in joints:
        below.setdefault(joint.parent, []).append(joint)
    root = _roots(links, joints)[0]
    order: list[Joint] = []
    open_ = list(reversed(below.get(root, [])))
    while open_:
        joint = open_.pop()
        order.append(joint)
        open_ += reversed(below.get(joint.child, []))
    return root, tuple(order)


def tree_problems(
    links: Mapping[str, Link], joints: Sequence[Joint], file: str
) -> Iterator[Problem]:
    """What keeps links and joints from being one tree."""
    hung: dict[str, Joint] = {}
    known, sound = list(links), True
    for joint in joints:
        place = f"joint.{shorten(joint.name)}"
        for end in ("parent", "child"):
            link = getattr(joint, end)
            if link not in links:
                sound = False
                text = f"'{shorten(link)}' is not a link{nearest(link, known)}"
                yield Problem(text, f"{place}.{end}", file, joint.line)
        if joint.child in hung:
            sound = False
            text = f"'{shorten(joint.child)}' hangs on the joint"
            other = shorten(hung[joint.child].name)
            cure = "a link hangs on one joint; a closed loop is a constraint of the model file"
            yield Problem(f"{text} '{other}' already; {cure}", f"{place}.child", file, joint.line)
        hung.setdefault(joint.child, joint)
    if not links:
        yield Problem("has no link", file=file)
        return
    if not sound:
        return
    roots = _roots(links, joints)
    if len(roots) > 1:
        text = f"has {len(roots)} links that hang on nothing ({_listed(roots)})"
        cure = "one is the root; tie the others to it by joints, or remove them"
        yield Problem(f"{text}; {cure}", file=file)
    lost = _unreached(links, joints, roots)
    if lost:
        text = f"the links {_listed(lost)} hang on each other in a circle, and not on the root"
        yield Problem(text, f"link.{shorten(lost[0])}", file, links[lost[0]].line)


def _roots(links: Mapping[str, Link], joints: Sequence[Joint]) -> list[str]:
    children = {joint.child for joint in joints}
    return [name for name in links if name not in children]


def _unreached(
    links: Mapping[str, Link], joints: Sequence[Joint], roots: Sequence[str]
) -> list[str]:
    below: dict[str, list[str]] = {}
    for joint in joints:
        below.setdefault(joint.parent, []).append(joint.child)
    reached, open_ = set(roots), list(roots)
    while open_:
        for child in below.get(open_.pop(), []):
            if child not in reached:
                reached.add(child)
                open_.append(child)
    return [name for name in links if name not in reached]


def _listed(names: Sequence[str]) -> str:
    listed = ", ".join(shorten(name) for name in names[:LISTED])
    return listed + (f" and {len(names) - LISTED} more" if len(names) > LISTED else "")
