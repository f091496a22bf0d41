"""The honest baseline: forward selection of terms by simulation error and BIC.

Windows of the recording with free initial states are simulated with the known equations and the
terms chosen so far; of the three terms that promise most (linearised) the best is added, all is
fitted anew by Gauss-Newton, and the term stays if

    N ln(RSS/N) + k ln N        N residuals, k terms

falls. There is no judgement beside that number. Terms are those of the other peers; parameters with
an sd are fitted along, what is known of each is one residual. On the rig, whose motion is imposed,
the force of its cell takes the place of the simulated motion.
"""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from laws import Array
from peer_library import PUSHING, Term, columns, known, spoken
from peer_motion import Recorded, estimate
from scipy.signal import savgol_coeffs, savgol_filter
from systems import System, Values

LENGTH, SUBSTEPS = 100, 2  # samples of a window, steps of Runge-Kutta between two samples
SMOOTHED = 21  # samples of the polynomial from which windows start
ROUNDS, MOST, TRIED = 6, 6, 3  # of Gauss-Newton; terms at most; terms tried at each step
NUDGE = 1e-4  # of its size: the step of finite differences
CLEAR = 3.0  # standard deviations from which a parameter counts as another than the file's

Acting = Sequence[tuple[Term, float, slice]]  # a term, its value, and in which of the runs it acts


@dataclass(frozen=True, slots=True, eq=False)
class Windows:
    """Residuals of the channels y (m, L, W) count in their noise ``sd`` (m, 1, 1, 1); inputs u
    (k, L, W), times t (L, W), states (2n, L, W) as smoothed and accelerations (n, L, W)."""

    system: System
    y: Array
    sd: Array
    u: Array
    t: Array
    x: Array
    a: Array


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """Parameters (shifts in their sd) and terms (in their size) ``x`` (F,) with covariance (F, F),
    the states (2n, W) that windows begin with, the criterion."""

    x: Array
    covariance: Array
    begin: Array
    bic: float


@dataclass(frozen=True, slots=True, eq=False)
class Search:
    """Windows, parameters that are ``free`` with nominal values ``p`` and ``spread``, terms and the
    ``size`` of each."""

    windows: Windows
    p: Values
    spread: dict[str, float]
    terms: list[Term]
    size: Array

    def values(self, x: Array) -> Values:
        """The parameters after shifts (F,)."""
        moved = zip(self.spread, x, strict=False)
        return {**self.p, **{k: self.p[k] + self.spread[k] * float(d) for k, d in moved}}


def stepwise(recorded: Recorded) -> dict[str, Any]:
    """What the stepwise fit says of a recording, in the form of a diagnosis."""
    started, search = time.process_time(), prepared(recorded)
    chosen: list[int] = []
    none = np.zeros(len(search.spread))
    best = fitted(search, chosen, none, search.windows.x[:, 0])
    while best is not None and len(chosen) < MOST:
        order = [k for k in promising(search, chosen, best) if k not in chosen][:TRIED]
        fits = [
            (fitted(search, [*chosen, k], np.append(best.x, 0.0), best.begin), k) for k in order
        ]
        better = [(fit.bic, k, fit) for fit, k in fits if fit is not None and fit.bic < best.bic]
        if not better:
            break
        _, k, best = min(better, key=lambda one: one[0])
        chosen.append(k)
    said = {"seconds": time.process_time() - started}
    if best is None:
        return said | {"sentence": "the model does not run along the recording"}
    return said | {"diagnosis": _diagnosis(search, chosen, best)}


def prepared(recorded: Recorded) -> Search:
    """Windows and library of a recording."""
    system, p = recorded.system, recorded.system.values()
    e = estimate("deltaf", recorded, SMOOTHED)
    M, Q = known(system, p, e)
    missing = np.einsum("ijn,jn->in", M, e.a) - Q.sum(axis=0)
    terms, forces = columns(system, p, e, True, missing)
    rms = np.sqrt(np.mean(forces**2, axis=(1, 2)))
    keep, count = slice(SMOOTHED, -SMOOTHED), e.t.size // LENGTH

    def cut(x: Array) -> Array:
        used = np.atleast_2d(x)[:, : count * LENGTH]
        return np.swapaxes(used.reshape(len(used), count, LENGTH), 1, 2)

    channels = [recorded.q, *([] if recorded.v is None else [recorded.v])]
    raw = np.concatenate(channels) if recorded.cell is None else recorded.cell
    noise = raw - savgol_filter(raw, SMOOTHED, 3, axis=1)
    freed = 1 - savgol_coeffs(SMOOTHED, 3)[SMOOTHED // 2]
    sd = np.sqrt(np.mean(noise[:, keep] ** 2, axis=1) / freed)[:, None, None, None]
    states = cut(np.concatenate([e.q, e.v]))
    windows = Windows(system, cut(raw[:, keep]), sd, cut(e.u), cut(e.t)[0], states, cut(e.a))
    entries = system.parameters().items()
    spread = {k: float(entry["sd"]) for k, entry in entries if entry.get("sd")}
    size = np.sqrt(np.mean(Q**2)) / np.where(rms > 0, rms, 1.0)
    return Search(windows, p, spread, terms, size)


def shown(w: Windows, p: Values, acting: Acting, begin: Array) -> Array:
    """What the channels show (m, L, B, W) in B runs of all windows that begin with (2n, B, W)."""
    if w.system.imposed:
        x, u, a = (np.repeat(x[:, None], begin.shape[1], axis=1) for x in (w.x, w.u, w.a))
        M, Q = _equations(w.system, p, acting, x, u, w.t)
        return np.swapaxes(np.einsum("ij...,j...->i...", M, a) - Q, 1, 2)
    n, x, result = w.system.n, begin, []
    step = float(w.t[1, 0] - w.t[0, 0]) / SUBSTEPS

    def rates(x: Array, row: int, share: float) -> Array:
        u = w.u[:, row] + share * (w.u[:, row + 1] - w.u[:, row])
        u = np.broadcast_to(u[:, None], (len(u), *x.shape[1:]))
        t = w.t[row] + share * SUBSTEPS * step
        M, Q = _equations(w.system, p, acting, x, u, t)
        if n == 1:
            return np.concatenate([x[n:], Q / M[0]])
        a = np.linalg.solve(np.moveaxis(M, (0, 1), (-2, -1)), np.moveaxis(Q, 0, -1)[..., None])
        return np.concatenate([x[n:], np.moveaxis(a[..., 0], -1, 0)])

    for row in range(LENGTH):
        result.append(x[: len(w.y)])
        for part in range(SUBSTEPS if row < LENGTH - 1 else 0):
            a, b, c = (part / SUBSTEPS, (part + 0.5) / SUBSTEPS, (part + 1) / SUBSTEPS)
            k1 = rates(x, row, a)
            k2 = rates(x + step / 2 * k1, row, b)
            k3 = rates(x + step / 2 * k2, row, b)
            x = x + step / 6 * (k1 + 2 * k2 + 2 * k3 + rates(x + step * k3, row, c))
    return np.stack(result, axis=1)


def _equations(
    system: System, p: Values, acting: Acting, x: Array, u: Array, t: Array
) -> tuple[Array, Array]:
    """M (n, n, …) and generalized forces (n, …) with the terms that act."""
    q, v = x[: system.n], x[system.n :]
    M, Q = system.mass(p, q), system.forces(p, q, v, u).sum(axis=0)
    paths = {term.place: system.path(p, q, term.place) for term, _, _ in acting}
    for term, value, runs in acting:
        s, J = paths[term.place][0][runs], paths[term.place][1][:, runs]
        if term.kind == "added_mass":
            M[:, :, runs] += value * J[:, None] * J[None]
        else:
            pushes = term.kind in PUSHING and term.place in system.coordinates
            force = value * term.shape(s, (J * v[:, runs]).sum(axis=0), t)
            Q[:, runs] += (force if pushes else -force) * J
    return M, Q


def _linear(
    search: Search, chosen: Sequence[int], x: Array, begin: Array, more: Sequence[int] = ()
) -> tuple[Array, Array, Array]:
    """Residuals (W, R), their slopes by starts (W, R, 2n) and by shifts, chosen terms and ``more``
    (W, R, F), by finite differences in one batch of runs, parameters apart."""
    w, free = search.windows, len(search.spread)
    states = 0 if w.system.imposed else len(begin)
    reach = NUDGE * np.sqrt(np.mean(w.x**2, axis=(1, 2)))
    wanted = [*chosen, *more]
    starts = np.repeat(begin[:, None], 1 + states + len(wanted), axis=1)
    for i in range(states):
        starts[i, 1 + i] += reach[i]
    acting: list[tuple[Term, float, slice]] = []
    for k, value in zip(chosen, x[free:], strict=True):
        acting.append((search.terms[k], value * search.size[k], slice(None)))
    for i, k in enumerate(wanted):
        run = 1 + states + i
        acting.append((search.terms[k], NUDGE * search.size[k], slice(run, run + 1)))
    y = shown(w, search.values(x), acting, starts) / w.sd
    columns = [(y[:, :, 1 + i] - y[:, :, 0]) / reach[i] for i in range(states)]
    for j in range(free):
        moved = x.copy()
        moved[j] += NUDGE
        one = shown(w, search.values(moved), acting[: len(chosen)], begin[:, None]) / w.sd
        columns.append((one[:, :, 0] - y[:, :, 0]) / NUDGE)
    columns += [(y[:, :, 1 + states + i] - y[:, :, 0]) / NUDGE for i in range(len(wanted))]
    rows = np.moveaxis(np.array(columns), -1, 0).reshape(w.y.shape[2], len(columns), -1)
    J = np.swapaxes(rows, 1, 2)
    r = np.moveaxis(y[:, :, 0] - w.y / w.sd[..., 0], -1, 0).reshape(len(J), -1)
    return r, J[:, :, :states], J[:, :, states:]


def _reduced(r: Array, starts: Array, J: Array) -> tuple[Array, Array]:
    """Residuals and slopes without what the windows' own starts can do, all windows in one."""
    Q = np.linalg.qr(starts)[0]
    r = r - np.einsum("wrs,ws->wr", Q, np.einsum("wrs,wr->ws", Q, r))
    J = J - np.einsum("wrs,wsf->wrf", Q, np.einsum("wrs,wrf->wsf", Q, J))
    return r.ravel(), J.reshape(-1, J.shape[2])


def _rss(search: Search, chosen: Sequence[int], x: Array, begin: Array) -> float:
    w, free = search.windows, len(search.spread)
    acting = [
        (search.terms[k], value * search.size[k], slice(None))
        for k, value in zip(chosen, x[free:], strict=True)
    ]
    y = shown(w, search.values(x), acting, begin[:, None])[:, :, 0]
    total = float(np.sum(((y - w.y) / w.sd[..., 0]) ** 2) + np.sum(x[:free] ** 2))
    return total if np.isfinite(total) else np.inf


def fitted(search: Search, chosen: Sequence[int], x: Array, begin: Array) -> Fit | None:
    """All numbers fitted by Gauss-Newton with halved steps; None where nothing runs."""
    free, count = len(search.spread), search.windows.y.size
    with np.errstate(all="ignore"):
        rss = _rss(search, chosen, x, begin)
        if not np.isfinite(rss):
            return None
        prior = np.diag(np.arange(x.size) < free).astype(float)
        for _ in range(ROUNDS):
            r, starts, J = _linear(search, chosen, x, begin)
            if not (np.isfinite(r).all() and np.isfinite(J).all()):
                return None
            flat, reduced = _reduced(r, starts, J)
            inverse = np.linalg.pinv(reduced.T @ reduced + prior)
            dx = -inverse @ (reduced.T @ flat + prior @ x)
            rest = r + J @ dx
            ds = -np.einsum("wsr,wr->sw", np.linalg.pinv(starts), rest) if starts.size else 0.0
            before = rss
            for share in (1.0, 0.5, 0.25, 0.1):
                trial = _rss(search, chosen, x + share * dx, begin + share * ds)
                if trial < rss:
                    x, begin, rss = x + share * dx, begin + share * ds, trial
                    break
            if rss > before * (1 - 1e-4):
                break
    bic = count * np.log(rss / count) + len(chosen) * np.log(count)
    return Fit(x, inverse * rss / count, begin, float(bic))


def promising(search: Search, chosen: Sequence[int], fit: Fit) -> list[int]:
    """All terms, first the one that takes most of the residuals to first order."""
    every = list(range(len(search.terms)))
    with np.errstate(all="ignore"):
        flat, J = _reduced(*_linear(search, chosen, fit.x, fit.begin, every))
        J = np.nan_to_num(J, posinf=0.0, neginf=0.0)
        own = J[:, : fit.x.size]
        new = J[:, fit.x.size :] - own @ (np.linalg.pinv(own) @ J[:, fit.x.size :])
        power = np.sum(new**2, axis=0)
        gain = (flat @ new) ** 2 / np.where(power > 1e-9 * power.max(), power, np.inf)
    return [int(k) for k in np.argsort(-np.nan_to_num(gain))]


def _diagnosis(search: Search, chosen: Sequence[int], fit: Fit) -> dict[str, Any]:
    """Chosen terms as found effects, parameters that moved clearly as parameters."""
    free, sd = len(search.spread), np.sqrt(np.diag(fit.covariance))
    value, spread = np.zeros(len(search.terms)), np.zeros(len(search.terms))
    value[list(chosen)] = fit.x[free:] * search.size[list(chosen)]
    spread[list(chosen)] = sd[free:] * search.size[list(chosen)]
    names, values = list(search.spread), search.values(fit.x)
    moved = [
        {"name": names[j], "value": values[names[j]], "sd": float(sd[j] * search.spread[names[j]])}
        for j in range(free)
        if abs(fit.x[j]) > CLEAR * sd[j]
    ]
    found = spoken(search.terms, value, spread)
    verdict = "missing physics" if found else "parameters" if moved else "nothing missing"
    return {
        "verdict": verdict,
        "found": found,
        "parameters": moved,
        "measurement": [],
        "alternatives": [],
    }
