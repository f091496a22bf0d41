"""A recording larger than memory, passed along once and piece by piece.

What a diagnosis works on, the windows of a search, has a bounded size. A recording of a day has
more than that in it: when the model lacks most, and whether it lacks the same at all times. The
mean squares of ΔF and the Gram matrices of the forces of all laws add up over pieces, so that they
are had in bounded memory; the laws are a proposal (:mod:`symhyb.correction.search.force_screen`),
and the stretches where they leave most are those to diagnose.
"""

import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import reduce

import numpy as np

from symhyb.asked import asked
from symhyb.correction.search.force_screen import BAND, ForceScreen, force_screen
from symhyb.correction.search.preparing import Prepared, laws_at, stages_of, thinned_run
from symhyb.correction.search.score import choice_of
from symhyb.correction.search.selection import Subset
from symhyb.correction.search.setting import middle_of
from symhyb.correction.search.trials import first_guess
from symhyb.data.pieces import Piece, pieces_of
from symhyb.data.recording import Recording
from symhyb.data.rows import Span
from symhyb.data.thin import thinned
from symhyb.discrepancy.places.hypotheses import (
    Hypothesis,
    Library,
    library,
    places_of,
    with_channels,
)
from symhyb.discrepancy.recorded.course import course_of
from symhyb.discrepancy.recorded.even import Even, even_of, smoothed
from symhyb.discrepancy.recorded.motion import Motion, motion_of
from symhyb.discrepancy.recorded.residual import applied_force, discrepancy
from symhyb.discrepancy.recorded.runs import Run, cut_within, noise_sd
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.errors import InputError, Problem
from symhyb.judgement import NOISE_FACTOR, NOTABLE
from symhyb.model.types import Model
from symhyb.model.vocabulary import KINDS
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.steps import Say, silent

BEGIN_ROWS = 200_000  # samples from which motion, noise and the scales of laws are taken
FORCES_MOST = 2**20  # numbers: forces of all laws along a piece
GRAMS_MOST = 2**23  # numbers: the Gram matrices of all stretches
STRETCHES = 100  # of a recording
FIRST_STRETCH = 10  # windows
OVERLAP = 4  # windows, or knots, by which pieces overlap at either end


@dataclass(frozen=True, slots=True, eq=False)
class Stretch:
    """What a model lacks from ``start`` to ``end``, in s: RMS of ΔF in ``force`` (n,) and of what
    is applied in ``applied`` (n,), by coordinate, SI; ``left`` (f,) by free coordinate is the part
    of the modulated force that the proposed laws leave, an RMS in its unit; NaN where it is not
    known."""

    start: float
    end: float
    force: Array
    applied: Array
    left: Array


@dataclass(frozen=True, slots=True, eq=False)
class Proposed:
    """A law that least squares of forces proposes, with its values by key, SI. No decision."""

    hypothesis: Hypothesis
    values: Mapping[str, float]


@dataclass(frozen=True, slots=True, eq=False)
class Scan:
    """What one passage along a ``file`` shows: of ``samples`` at distances of ``step_s``, averaged
    over blocks of ``averaged`` samples; knots of the smoothed motion are ``spacing_s`` apart.
    ``proposed`` are laws for the whole, ``screen`` their Gram matrices (None where reactions of
    constraints hide forces, or all motion is imposed)."""

    model: Model
    file: str
    samples: int
    step_s: float
    averaged: int
    spacing_s: float
    stretches: tuple[Stretch, ...]
    proposed: tuple[Proposed, ...]
    screen: ForceScreen | None

    @property
    def free(self) -> tuple[int, ...]:
        """The coordinates that are not imposed."""
        coordinates = enumerate(self.model.coordinates)
        return tuple(i for i, coordinate in coordinates if not coordinate.imposed)

    @property
    def usual(self) -> Array:
        """What is left (f,) in half of the stretches at most, SI; NaN where it is not known."""
        known = [one.left for one in self.stretches if np.isfinite(one.left).all()]
        return np.median(known, axis=0) if known else np.full(len(self.free), np.nan)

    @property
    def unlike(self) -> tuple[Stretch, ...]:
        """The stretches in which the proposed laws leave more than twice the usual on a coordinate,
        the worst first."""
        usual = self.usual
        times = [(float(np.max(one.left / usual)), one) for one in self.stretches]
        found = [(more, one) for more, one in times if more > NOISE_FACTOR]
        return tuple(one for _, one in sorted(found, key=lambda pair: -pair[0]))


@asked
def scan(
    model: Model,
    path: str | os.PathLike[str],
    columns: Mapping[str, str] | None = None,
    *,
    span: Span = (None, None),
    stretches: int = STRETCHES,
    say: Say = silent,
) -> Scan:
    """Pass once along a recording of any length in a Parquet, CSV or MDF file or a bag.

    ``columns`` and ``span``, in s, are as for :func:`.read_recording`. What is lacking is summed
    over at most so many ``stretches`` of equal length, fewer where the Gram matrices of a large
    machine ask for it. Memory does not grow with the file.

    Raises:
        InputError: as :func:`.read_recording`; the format is not read in pieces; the machine is an
            FMU or a file of MuJoCo.
    """
    if model.engine is not None:
        text = "a scan needs the equations of the machine, which an FMU or MuJoCo does not give"
        raise InputError(Problem(text, file=str(path)))
    if stretches < 1:
        raise InputError(Problem(f"stretches is {stretches}; at least 1 is needed"))
    given, file = dict(columns or {}), str(path)
    beginning = next(pieces_of(path, model, given, rows=BEGIN_ROWS, span=span)).recording
    passage = _Passage.of(model, beginning)
    sums = _Sums(passage, float(beginning.t[0]), passage.most(stretches))
    rows, overlap = passage.rows, passage.overlap
    for piece in pieces_of(path, model, given, rows=rows, overlap=overlap, span=span):
        say(f"{file}: t = {piece.recording.t[0]:.6g} s")
        sums.add(piece)
    say(f"{file}: laws at the level of forces")
    return sums.result(file)


@dataclass(frozen=True, slots=True, eq=False)
class _Passage:
    """What stays the same along the recording: the machine, laws and windows of its beginning."""

    model: Model
    machine: Machine
    laws: Library | None
    sd: Array
    step_s: float
    averaged: int
    like: Motion
    window_s: float
    band_hz: float

    @classmethod
    def of(cls, model: Model, beginning: Recording) -> "_Passage":
        extended = with_channels(model)
        machine = build(extended)
        first = Run(beginning, motion_of(beginning, machine), np.empty(0))
        shortest = float(np.min(first.motion.periods()))
        run = thinned_run(first, machine, shortest)
        sd = noise_sd([run], machine)
        step = float(np.median(np.diff(beginning.t)))
        averaged = beginning.t.size // run.recording.t.size
        laws, window = None, shortest
        if machine.free and not machine.constraints:
            known = Prepared(extended, machine, (replace(run, sd=sd),), (), sd, shortest)
            places = places_of(extended)
            tried = tuple(filter(_plain, laws_at(known, places)))
            laws = library(extended, places, tried)
            window = middle_of(stages_of(known)).length_s
        return cls(extended, machine, laws, sd, step, averaged, run.motion, window, BAND / shortest)

    @property
    def columns(self) -> int:
        """Columns of the Gram matrices, what is lacking among them."""
        return 0 if self.laws is None else sum(map(len, self.laws.columns)) + 1

    @property
    def overlap(self) -> int:
        """Samples."""
        return int(OVERLAP * max(self.window_s, self.like.spacing_s) / self.step_s) + 1

    @property
    def rows(self) -> int:
        """Samples of a piece."""
        wide = self.machine.n * max(self.columns, 1)
        return max(FORCES_MOST // wide * self.averaged, 8 * self.overlap)

    def most(self, stretches: int) -> int:
        """How many stretches at most, twice so many while they are summed."""
        gram = 2 * max(len(self.machine.free), 1) * max(self.columns, 1) ** 2
        return max(min(stretches, GRAMS_MOST // (2 * gram)), 1)


@dataclass(slots=True, eq=False)
class _Part:
    """Sums over one stretch: of the ``samples`` of the file and those that are ``counted``; of the
    squares of ΔF and of what is applied (n,) each; the ``screen`` of its windows."""

    samples: int
    counted: int
    force: Array
    applied: Array
    screen: ForceScreen | None

    def plus(self, other: "_Part") -> "_Part":
        if self.screen is None or other.screen is None:
            screen = self.screen or other.screen
        else:
            screen = self.screen.plus(other.screen)
        return _Part(
            self.samples + other.samples,
            self.counted + other.counted,
            self.force + other.force,
            self.applied + other.applied,
            screen,
        )


class _Sums:
    """Sums by stretch of time. Where there would be more than twice as many stretches as are
    wanted, neighbours become one."""

    def __init__(self, passage: _Passage, begin: float, most: int) -> None:
        self.passage, self.begin, self.most = passage, begin, most
        self.length = FIRST_STRETCH * passage.window_s
        self.parts: dict[int, _Part] = {}
        self.last = begin
        self.even: Even | None = None

    def add(self, piece: Piece) -> None:
        """Add what the samples of a piece show that are its own."""
        recording, passage = piece.recording, self.passage
        self.last = float(recording.t[-1])
        while (self.last - self.begin) / self.length >= 2 * self.most:
            self._halve()
        run = self._run(recording)
        machine, t = passage.machine, run.recording.t
        course = course_of(run.recording, machine, run.motion)
        force = discrepancy(machine, course, machine.values)
        applied = applied_force(machine, course)
        cut = None if passage.laws is None else cut_within(run, machine, passage.window_s)
        own = (t >= piece.first) & (t < piece.last)
        here = np.floor((t - self.begin) / self.length).astype(int)
        for index in np.unique(here[own]).tolist():
            rows = own & (here == index)
            screen = None if cut is None else self._screen(cut, piece, index)
            count = int(rows.sum())
            part = _Part(
                count * passage.averaged,
                count,
                np.sum(force[rows] ** 2, axis=0),
                np.sum(applied[rows] ** 2, axis=0),
                screen,
            )
            known = self.parts.get(index)
            self.parts[index] = part if known is None else known.plus(part)

    def _screen(self, cut: Cut, piece: Piece, index: int) -> ForceScreen | None:
        """The screen of the windows that begin in a stretch and are the piece's own."""
        begins = cut.block.t[:, 0]
        mine = (begins >= piece.first) & (begins < piece.last)
        mine &= np.floor((begins - self.begin) / self.length) == index
        if not mine.any():
            return None
        passage = self.passage
        assert passage.laws is not None
        some = cut.chosen(np.flatnonzero(mine))
        return force_screen(passage.machine, passage.laws, [some], passage.band_hz)

    def _run(self, recording: Recording) -> Run:
        """A piece of the recording, thinned, with its smoothed motion."""
        passage = self.passage
        short, machine, like = thinned(recording, passage.averaged), passage.machine, passage.like
        if self.even is None or self.even.samples != short.t.size:
            self.even = even_of(short, machine, like)
        return Run(short, smoothed(short, machine, self.even, like), passage.sd)

    def _halve(self) -> None:
        self.length *= 2
        joined: dict[int, _Part] = {}
        for index, part in sorted(self.parts.items()):
            known = joined.get(index // 2)
            joined[index // 2] = part if known is None else known.plus(part)
        self.parts = joined

    def result(self, file: str) -> Scan:
        """What all pieces show together."""
        passage = self.passage
        while (self.last - self.begin) / self.length > self.most:
            self._halve()
        screens = [part.screen for part in self.parts.values() if part.screen is not None]
        screen = reduce(ForceScreen.plus, screens) if screens else None
        subset, proposed = _proposed(screen)
        stretches = []
        for index, part in sorted(self.parts.items()):
            left = np.full(len(passage.machine.free), np.nan)
            if subset is not None and part.screen is not None:
                left = np.sqrt(part.screen.left(subset) / part.screen.count)
            begin = self.begin + index * self.length
            force, applied = (np.sqrt(x / part.counted) for x in (part.force, part.applied))
            end = min(begin + self.length, self.last)
            stretches.append(Stretch(begin, end, force, applied, left))
        return Scan(
            passage.model,
            file,
            sum(part.samples for part in self.parts.values()),
            passage.step_s,
            passage.averaged,
            passage.like.spacing_s,
            tuple(stretches),
            proposed,
            screen,
        )


def _plain(law: Hypothesis) -> bool:
    """Whether a law has no memory, which would begin anew with each piece, and takes on no shapes
    between those of others."""
    return not (law.variant or law.bent or KINDS[law.kind].states)


def _proposed(screen: ForceScreen | None) -> tuple[Subset | None, tuple[Proposed, ...]]:
    """The laws that pay over the whole recording, with their values."""
    if screen is None:
        return None, ()
    families = {cause.family for cause in screen.hypotheses}
    subset = screen.whole(choice_of(len(families)), frozenset())
    if subset is None:
        return None, ()
    rows = first_guess(screen.problem(screen.begin()), subset)
    pairs = zip(subset.causes, rows, strict=True)
    shown = [(cause, row) for cause, row in pairs if _matters(screen, subset, cause)]
    return subset, tuple(Proposed(screen.hypotheses[cause], row) for cause, row in shown)


def _matters(screen: ForceScreen, subset: Subset, cause: int) -> bool:
    """Whether a law of the subset exerts a notable part of what is lacking on a coordinate. With
    so many samples the least force is significant."""
    mix = np.zeros(screen.grams.shape[1])
    known = [c for one in subset.causes for c in screen.columns[one]]
    mix[known] = subset.values
    mix[[c for c in known if c not in screen.columns[cause]]] = 0.0
    exerts, lacks = mix @ screen.total @ mix, screen.total[:, -1, -1]
    return bool(np.any(exerts > NOTABLE**2 * lacks))
