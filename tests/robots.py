"""Robots as URDF text: by hand with every kind of joint, and drawn at random."""

from collections.abc import Sequence

import numpy as np

Numbers = Sequence[float]


def _words(values: Numbers) -> str:
    return " ".join(repr(float(value)) for value in values)


def link(
    name: str,
    mass: float = 1.0,
    centre: Numbers = (0.1, 0.02, -0.03),
    tensor: Numbers = (0.02, 0.001, -0.002, 0.03, 0.0015, 0.025),
    rpy: Numbers = (0.0, 0.0, 0.0),
) -> str:
    """A link; ``tensor`` is ixx, ixy, ixz, iyy, iyz, izz."""
    keys = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    inertia = " ".join(f'{key}="{value!r}"' for key, value in zip(keys, tensor, strict=True))
    return (
        f'<link name="{name}"><inertial><origin xyz="{_words(centre)}" rpy="{_words(rpy)}"/>'
        f'<mass value="{mass!r}"/><inertia {inertia}/></inertial></link>\n'
    )


def joint(
    name: str,
    kind: str,
    parent: str,
    child: str,
    xyz: Numbers = (0.0, 0.0, 0.0),
    rpy: Numbers = (0.0, 0.0, 0.0),
    axis: Numbers = (0.0, 0.0, 1.0),
    more: str = "",
) -> str:
    """A joint; ``more`` stands inside of it."""
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{_words(xyz)}" rpy="{_words(rpy)}"/><axis xyz="{_words(axis)}"/>'
        f"{more}</joint>\n"
    )


def robot(*parts: str, name: str = "robot") -> str:
    """The whole file."""
    return f'<robot name="{name}">\n{"".join(parts)}</robot>\n'


ARM = robot(
    link("base"),
    link("upper", 3.0, (0.2, 0.0, 0.01), rpy=(0.3, -0.4, 0.5)),
    link("plate", 0.4),
    link("fore", 1.5),
    link("slide", 0.7),
    link("tool", 0.2, rpy=(-0.7, 0.1, 0.2)),
    link("finger", 0.1),
    joint("shoulder", "revolute", "base", "upper", (0.1, 0.2, 0.3), (0.4, -0.2, 0.9), (0, 1, 0)),
    joint("weld", "fixed", "upper", "plate", (0.3, 0.1, 0.0), (0.5, 0.6, -0.7)),
    joint("elbow", "continuous", "plate", "fore", (0.2, 0.0, 0.1), (0.1, 0.2, 0.3), (1, 2, -0.5)),
    joint("reach", "prismatic", "fore", "slide", (0.0, 0.1, 0.2), (-0.3, 0.8, 0.1), (1, 1, 0)),
    joint("twist", "revolute", "slide", "tool", (0.1, 0.0, 0.0), (np.pi / 2, 0, 0), (0, -1, 0)),
    joint("grip", "revolute", "tool", "finger", (0.0, 0.05, 0.02), (0, 0, 0.3), (3, 0, 4)),
    name="arm",
)

KINDS = ("revolute", "continuous", "prismatic", "fixed")
AXES = ((1, 0, 0), (0, -1, 0), (0, 0, 1), (1, 1, 0), (0, 2, -1), (-1, 0, 3), (1, 2, 3), (-2, 1, -1))


def drawn(seed: int, joints: int = 6) -> str:
    """A tree of ``joints`` joints of all kinds with one coordinate, and welds between them."""
    rng = np.random.default_rng(seed)

    def three(size: float) -> list[float]:
        return [float(value) for value in rng.uniform(-size, size, 3)]

    parts = [link("l0")]
    for number in range(1, joints + 1):
        moments = rng.uniform(0.01, 0.02, 3)  # any three of these are those of a body
        products = rng.uniform(-0.001, 0.001, 3)
        tensor = (moments[0], *products[:2], moments[1], products[2], moments[2])
        mass, numbers = float(rng.uniform(0.1, 3)), [float(value) for value in tensor]
        parts.append(link(f"l{number}", mass, three(0.2), numbers, three(3)))
        kind = str(rng.choice(KINDS, p=[0.4, 0.2, 0.2, 0.2]))
        parent = f"l{rng.integers(max(0, number - 3), number)}"
        axis = AXES[int(rng.integers(len(AXES)))]
        turn = three(3) if rng.uniform() < 0.5 else list(rng.integers(-2, 3, 3) * (np.pi / 2))
        parts.append(joint(f"j{number}", kind, parent, f"l{number}", three(0.5), turn, axis))
    return robot(*parts, name=f"drawn_{seed}")
