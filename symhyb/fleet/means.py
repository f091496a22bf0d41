"""Means of groups of peers and slopes over conditions, by generalised least squares.

A recording has the mean m of its group of peers, slopes b over its conditions x, and an error whose
covariance V over the recordings of its unit is known:

    y_i = Z_i m + X_i b + e_i,    e_i ~ N(0, V_i)

Groups that have units in common make a part. Parts share the slopes alone, so that the normal
equations are an arrow, [Σ XᵀV⁻¹X, B; Bᵀ, D] with a block of D for each part, and are solved by the
Schur complement of D: a study of hundreds of groups costs no more than its units do.
Sizes: N units, R recordings of one, K numbers, G groups, Q parts, L groups of the largest part, P
conditions.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

Array = NDArray[np.float64]
Places = NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class Unit:
    """The estimates of one unit: ``y`` (R, K) with covariances ``s`` (R, K, K), and conditions
    ``x`` (R, P + 1), the first of which is 1; ``peers`` (R, G) are 1 in the column of the group of
    each recording, which is one of all where they are not stated. ``numerics`` (R, K) is what the
    numerics of each fit may err by, one standard deviation; ``effects`` (T,) are 1 for values of
    groupings that it has, dimensionless. Numbers in any one scale."""

    y: Array
    s: Array
    x: Array
    peers: Array = field(default_factory=lambda: np.ones((1, 1)))
    numerics: Array = field(default_factory=lambda: np.zeros((1, 1)))
    effects: Array = field(default_factory=lambda: np.zeros(0))

    @property
    def groups(self) -> Array:
        """Of which group each recording is (R, G)."""
        return np.broadcast_to(self.peers, (len(self.y), self.peers.shape[1]))

    @property
    def columns(self) -> Array:
        """What its recordings have in the mean of the means of groups and of slopes (G + P,)."""
        return np.concatenate([self.groups.mean(axis=0), self.x[:, 1:].mean(axis=0)])


def groups_of(units: Sequence[Unit]) -> NDArray[np.bool_]:
    """Of which groups of peers each unit has recordings (N, G)."""
    return np.array([one.groups.any(axis=0) for one in units])


@dataclass(frozen=True, slots=True, eq=False)
class Layout:
    """Of G groups the ``part`` (G,) that each belongs to and its ``place`` (G,) there."""

    part: Places
    place: Places

    @property
    def sizes(self) -> tuple[int, int]:
        """Q and L."""
        return int(self.part.max()) + 1, int(self.place.max()) + 1


@dataclass(frozen=True, slots=True, eq=False)
class Batch:
    """Units (n) with as many recordings: y (n, RK), S (n, RK, RK), slopes x (n, RK, PK), means z
    (n, RK, LK) of the ``part`` (n,) that each is of; numbers in the units of Unit."""

    y: Array
    s: Array
    x: Array
    z: Array
    part: Places
    count: int


@dataclass(frozen=True, slots=True, eq=False)
class Means:
    """The estimate: ``means`` (Q, LK) of groups, ``slopes`` (PK,), and the parts of their
    covariance: D⁻¹ (Q, LK, LK), D⁻¹Bᵀ (Q, LK, PK) and that of the slopes (PK, PK); ``logdet`` of
    the normal equations. Numbers in the units of Unit."""

    layout: Layout
    means: Array
    slopes: Array
    inverse: Array
    leaning: Array
    covariance: Array
    logdet: float

    def rest(self, batch: Batch) -> Array:
        """y less what is expected (n, RK), in its units."""
        expected = np.einsum("nil,nl->ni", batch.z, self.means[batch.part]) + batch.x @ self.slopes
        return np.asarray(batch.y - expected)

    def error(self, batch: Batch) -> Array:
        """The covariance of what is expected of each unit (n, RK, RK)."""
        own = batch.z @ self.inverse[batch.part] @ np.swapaxes(batch.z, 1, 2)
        lever = batch.x - batch.z @ self.leaning[batch.part]
        return np.asarray(own + lever @ self.covariance @ np.swapaxes(lever, 1, 2))

    def overall(self, size: int) -> tuple[Array, Array]:
        """The mean of the means of all groups and the slopes (P + 1, K) of ``size`` numbers, in
        their units, with their covariance."""
        groups = self.layout.part.size
        chosen = np.zeros((self.means.shape[0], size, self.means.shape[1]))
        for part, place in zip(self.layout.part, self.layout.place, strict=True):
            chosen[part, :, place * size : (place + 1) * size] = np.eye(size) / groups
        mean = np.einsum("qkl,ql->k", chosen, self.means)
        leaning = np.einsum("qkl,qlp->kp", chosen, self.leaning)
        own = np.einsum("qkl,qlm,qjm->kj", chosen, self.inverse, chosen, optimize=True)
        beside = -leaning @ self.covariance
        covariance = np.block([[own - beside @ leaning.T, beside], [beside.T, self.covariance]])
        return np.concatenate([mean, self.slopes]).reshape(-1, size), covariance


def layout_of(units: Sequence[Unit]) -> Layout:
    """Which groups have units in common."""
    having = groups_of(units).astype(np.float64)
    _, part = connected_components(having.T @ having, directed=False)
    place = np.zeros(part.size, dtype=np.int64)
    for which in range(int(part.max()) + 1):
        inside = np.flatnonzero(part == which)
        place[inside] = np.arange(inside.size)
    return Layout(np.asarray(part, dtype=np.int64), place)


def batches_of(units: Sequence[Unit], layout: Layout) -> Iterator[Batch]:
    """The units by how many recordings they have, in their order."""
    size, most = units[0].y.shape[1], layout.sizes[1]
    for count in sorted({len(one.y) for one in units}):
        alike = [one for one in units if len(one.y) == count]
        s = np.zeros((len(alike), count * size, count * size))
        for r in range(count):
            rows = slice(r * size, (r + 1) * size)
            s[:, rows, rows] = [one.s[r] for one in alike]
        which = np.array([one.groups.argmax(axis=1) for one in alike])
        local = np.eye(most)[layout.place[which]]
        slopes = np.array([one.x[:, 1:] for one in alike])
        yield Batch(
            np.array([one.y.ravel() for one in alike]),
            s,
            np.kron(slopes, np.eye(size)),
            np.kron(local, np.eye(size)),
            layout.part[which[:, 0]],
            count,
        )


def means_of(batches: Sequence[Batch], inverses: Sequence[Array], layout: Layout) -> Means:
    """The means and slopes under V⁻¹ of all units (n, RK, RK) of each batch."""
    parts = layout.sizes[0]
    wide, narrow = batches[0].z.shape[2], batches[0].x.shape[2]
    size = wide // layout.sizes[1]
    slopes, right = np.zeros((narrow, narrow)), np.zeros(narrow)
    beside, blocks = np.zeros((parts, narrow, wide)), np.zeros((parts, wide, wide))
    held = np.zeros((parts, wide))
    for one, inverse in zip(batches, inverses, strict=True):
        of_x, of_z = inverse @ one.x, inverse @ one.z
        slopes += np.einsum("nip,niq->pq", one.x, of_x, optimize=True)
        right += np.einsum("nip,ni->p", of_x, one.y, optimize=True)
        np.add.at(beside, one.part, np.swapaxes(one.x, 1, 2) @ of_z)
        np.add.at(blocks, one.part, np.swapaxes(one.z, 1, 2) @ of_z)
        np.add.at(held, one.part, np.einsum("nil,ni->nl", of_z, one.y))
    there = np.zeros((parts, layout.sizes[1]))
    there[layout.part, layout.place] = 1.0
    blocks += np.eye(wide) * np.repeat(1.0 - there, size, axis=1)[:, None, :]  # places of no group
    of_means = np.asarray(np.linalg.inv(blocks))
    leaning = of_means @ np.swapaxes(beside, 1, 2)
    schur = slopes - np.einsum("qpl,qlr->pr", beside, leaning, optimize=True)
    covariance = np.asarray(np.linalg.inv(schur))
    own = np.einsum("qlm,qm->ql", of_means, held)
    found = covariance @ (right - np.einsum("qpl,ql->p", beside, own))
    logdet = float(np.linalg.slogdet(blocks)[1].sum() + np.linalg.slogdet(schur)[1])
    return Means(layout, own - leaning @ found, found, of_means, leaning, covariance, logdet)
