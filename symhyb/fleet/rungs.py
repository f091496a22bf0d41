"""Which of several structures a fleet has: their evidence in all recordings together.

One structure for all units, and recordings that err independently, so that logarithms of evidence
are summed. Beside that stands in how many recordings each structure is the likeliest: a sum may
rest on few of them.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from symhyb.correction.structures import shares
from symhyb.errors import InputError, Problem, did_you_mean
from symhyb.tasks.outcome import FAILED, Outcome, Outcomes
from symhyb.tasks.rows import rungs_of


@dataclass(frozen=True, slots=True)
class Weighed:
    """A structure of a fleet: the ln of its ``evidence`` in all ``recordings`` together, less that
    of the likeliest, its ``probability`` by that, equal ones before, and in how many recordings it
    is the ``likeliest``."""

    name: str
    evidence: float
    probability: float
    likeliest: int
    recordings: int


def weighed(outcomes: Outcomes) -> tuple[Weighed, ...]:
    """The structures that all finished tasks of a study compared, in its order; none where they
    compared none.

    Raises:
        InputError: its tasks compared different structures.
    """
    every = [rungs_of(one) for one in outcomes.tasks if one.fitted is not None]
    names = {tuple(rung.name for rung in rungs) for rungs in every}
    if len(names) > 1:
        text = "its tasks compared different structures; run the study again in a new folder"
        raise InputError(Problem(text))
    if not names or not every[0]:
        return ()
    logs = np.array([[rung.evidence for rung in rungs] for rungs in every])
    total = logs.sum(axis=0)
    if not np.isfinite(total).any():
        raise InputError(Problem("each of its structures cannot be simulated in some recording"))
    best = np.bincount(np.argmax(logs, axis=1), minlength=logs.shape[1])
    return tuple(
        Weighed(rung.name, float(ln), float(part), int(count), len(every))
        for rung, ln, part, count in zip(
            every[0], total - total.max(), shares(total), best, strict=True
        )
    )


def with_structure(outcomes: Outcomes, name: str = "") -> tuple[tuple[Weighed, ...], str, Outcomes]:
    """The structures that tasks compared, the one whose numbers are compared (the one of this name,
    else the likeliest), and the outcomes with its numbers; as they are where none were compared.

    Raises:
        InputError: its tasks compared different structures, or there is none of that name.
    """
    found = weighed(outcomes)
    chosen = chosen_rung(found, name)
    return found, chosen, in_structure(outcomes, chosen) if chosen else outcomes


def chosen_rung(found: Sequence[Weighed], name: str = "") -> str:
    """The name of the structure that is asked for, else of the likeliest; empty without any.

    Raises:
        InputError: there is none of that name.
    """
    names = [one.name for one in found]
    if name and name not in names:
        near = did_you_mean(name, names) if names else "; the tasks compared no structures"
        raise InputError(Problem(f"no such structure was fitted{near}", f"--structure {name}"))
    return name or max(found, key=lambda one: one.probability).name if found else ""


def in_structure(outcomes: Outcomes, name: str) -> Outcomes:
    """The outcomes with the numbers of one structure, as if it alone had been fitted; tasks in
    which it cannot be simulated count as failed."""
    return replace(outcomes, tasks=tuple(_in(one, name) for one in outcomes.tasks))


def _in(one: Outcome, name: str) -> Outcome:
    if one.fitted is None:
        return one
    rung = next(rung for rung in one.fitted.rungs if rung.name == name)
    if rung.fitted is None:
        text = f"the structure '{name}' cannot be simulated"
        return replace(one, state=FAILED, failure=text, fitted=None)
    return replace(one, fitted=replace(rung.fitted, rungs=one.fitted.rungs))
