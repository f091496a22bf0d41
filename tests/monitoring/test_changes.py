"""What blocks say otherwise than a reference: seldom by chance, soon where something changes."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from symhyb.monitoring.changes import (
    EXCEEDED,
    LENGTHS,
    Block,
    Causes,
    Reference,
    changed,
    level,
    named,
    reference_of,
)

Array = NDArray[np.float64]
CAUSES = Causes(((0,), (1,), (2, 3)), np.zeros(3))
LACKING = np.array([0.3, -0.2, 0.1, 0.0])  # what the model lacks already
Draw = Callable[[np.random.Generator, int], Array]


def normal(rng: np.random.Generator, size: int) -> Array:
    return rng.standard_normal(size)


def wild(rng: np.random.Generator, size: int) -> Array:
    return np.asarray(rng.standard_t(1.5, size))


def blocks(seed: int, count: int, change: Array, draw: Draw = normal) -> list[Block]:
    """Blocks of a second, of 40 residuals each, in which ``change`` (4,) acts besides."""
    rng, made = np.random.default_rng(seed), []
    for i in range(count):
        columns = rng.standard_normal((40, 4)) * rng.uniform(0.3, 1.5)
        left = columns @ (LACKING + change) + draw(rng, 40)
        made.append(Block(i, i + 1.0, columns.T @ columns, columns.T @ left))
    return made


def alarms(reference: Reference, run: list[Block], per_day: float) -> int:
    least = level(per_day, 1.0, reference)
    return sum(
        changed(reference, run[max(i - 70, 0) : i + 1], least, CAUSES) is not None
        for i in range(len(run))
    )


@pytest.mark.parametrize("draw", [normal, wild])
def test_a_machine_that_does_not_change_gives_no_alarm(draw: Draw) -> None:
    """A quarter of an hour at one false alarm in a quarter of an hour: none is expected to remain
    of many, for the bound of each test is not sharp."""
    reference = reference_of(blocks(1, 60, np.zeros(4), draw))
    assert alarms(reference, blocks(2, 900, np.zeros(4), draw), per_day=96.0) <= 1


def test_a_cause_that_begins_is_named_with_its_size_and_beginning() -> None:
    reference = reference_of(blocks(1, 60, np.zeros(4)))
    run = blocks(2, 30, np.zeros(4)) + blocks(3, 12, np.array([0.0, 0.8, 0.0, 0.0]))
    least = level(1.0, 1.0, reference)
    hits = [changed(reference, run[: i + 1], least, CAUSES) for i in range(len(run))]
    first = next(i for i, hit in enumerate(hits) if hit is not None)
    assert 30 <= first < 40
    found = hits[-1]
    assert found is not None
    assert found.cause == 1
    assert abs(found.since - 30) <= 1
    assert abs(found.size[0] - 0.8) < 4 * found.sd[0] < 0.4
    assert found.probability > 0.99
    assert not found.rivals


def test_a_cause_of_two_numbers_is_named_with_both() -> None:
    reference = reference_of(blocks(1, 60, np.zeros(4)))
    run = blocks(3, 20, np.array([0.0, 0.0, 0.9, -0.9]))
    found = named(reference, run, 0, 1e-9, CAUSES)
    assert found.cause == 2
    np.testing.assert_allclose(found.size, [0.9, -0.9], atol=4 * found.sd.max())


def test_one_block_that_stands_far_out_is_no_change() -> None:
    reference = reference_of(blocks(1, 60, np.zeros(4)))
    run = blocks(2, 20, np.zeros(4))
    run[10] = Block(10, 11.0, run[10].information, run[10].score + 1e4)
    assert alarms(reference, run, per_day=1.0) == 0


def test_what_does_less_than_the_numerics_are_accurate_to_is_no_change() -> None:
    """The change is large beside the noise, and a ten-thousandth of the motion."""

    def moving(made: list[Block], motion: float) -> list[Block]:
        return [Block(b.start_s, b.end_s, b.information, b.score, motion) for b in made]

    change = np.array([0.8, 0.0, 0.0, 0.0])
    for motion, found in ((0.0, True), (40 * (0.8 / 1e-4) ** 2, False)):
        reference = reference_of(moving(blocks(1, 60, np.zeros(4)), motion))
        run = moving(blocks(3, 20, change), motion)
        hit = changed(reference, run, level(1.0, 1.0, reference), CAUSES)
        assert (hit is not None) == found


def resting_first(seed: int, count: int) -> list[Block]:
    """Blocks of a machine that rests in every third one and otherwise moves 10⁵ noises far, and of
    which the model fails by 150 noises or, where it moves, by as much again."""
    made = []
    for i, block in enumerate(
        blocks(seed, count, np.zeros(4), lambda rng, n: 150 * normal(rng, n))
    ):
        moves = i % 3 > 0
        score = block.score * (2 if moves else 1)
        made.append(Block(block.start_s, block.end_s, block.information, score, 1e10 * moves))
    return made


def test_a_reference_is_as_its_blocks_are_judged_later() -> None:
    """What it scatters by is counted at rest as in motion, so that nothing stands out of it."""
    made = resting_first(1, 60)
    reference = reference_of(made)
    z = np.array([reference.otherwise(block) for block in made])
    np.testing.assert_allclose(np.sum(z**2, axis=0), 59)
    for one in reference.bounded:
        np.testing.assert_allclose(np.clip(z / one.most, -1, 1), one.w)
    assert alarms(reference, made, per_day=1.0) == 0
    assert alarms(reference, resting_first(2, 600), per_day=96.0) <= 1


def test_what_scatters_less_than_the_noise_scatters_as_the_noise() -> None:
    reference = reference_of(blocks(1, 60, np.zeros(4), lambda rng, n: 0.1 * normal(rng, n)))
    np.testing.assert_array_equal(reference.scatter, 1.0)


def test_causes_that_do_the_same_are_rivals() -> None:
    """The second column is the first but for a hair."""

    def alike(made: list[Block]) -> list[Block]:
        mix = np.eye(4)
        mix[:, 1] = [1.0, 1e-3, 0.0, 0.0]
        return [
            Block(b.start_s, b.end_s, mix.T @ b.information @ mix, mix.T @ b.score) for b in made
        ]

    reference = reference_of(alike(blocks(1, 60, np.zeros(4))))
    run = alike(blocks(3, 20, np.array([0.8, 0.0, 0.0, 0.0])))
    found = named(reference, run, 0, 1e-9, CAUSES)
    assert {found.cause, *found.rivals} == {0, 1}
    assert found.probability < 0.9


def test_what_the_reference_hardly_shows_is_not_named() -> None:
    def hidden(made: list[Block]) -> list[Block]:
        only = np.ones(4)
        rows = []
        for i, b in enumerate(made):
            only[0] = float(i == 0)
            rows.append(
                Block(b.start_s, b.end_s, b.information * np.outer(only, only), b.score * only)
            )
        return rows

    reference = reference_of(hidden(blocks(1, 60, np.zeros(4))))
    assert not reference.known[0]
    assert reference.known[1:].all()
    run = blocks(3, 20, np.array([2.0, 0.0, 0.0, 0.0]))
    assert named(reference, run, 0, 1e-9, CAUSES).cause != 0


def test_neighbours_that_resemble_each_other_make_changes_less_certain() -> None:
    rng = np.random.default_rng(4)
    made, slow = [], 0.0
    for i in range(120):
        slow = 0.9 * slow + 0.3 * float(rng.standard_normal())
        made.append(Block(i, i + 1.0, np.eye(1), np.array([slow])))
    reference = reference_of(made)
    assert reference.bounded[0].clustered(8)[0] > 3
    assert reference.bounded[0].clustered(1)[0] == pytest.approx(1)


def test_more_false_alarms_allow_a_larger_level() -> None:
    reference = reference_of(blocks(1, 60, np.zeros(4)))
    one, ten = (level(n, 1.0, reference) for n in (1.0, 10.0))
    assert ten == pytest.approx(10 * one)
    assert one == pytest.approx(1 / 86_400 / (4 * len(LENGTHS) * len(EXCEEDED)))
