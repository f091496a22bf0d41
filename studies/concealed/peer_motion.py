"""Recordings as a peer reads them, and the motion that it estimates from them."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pysindy as ps
from laws import Array
from peer_library import Estimate
from plans import ENGINE_SYSTEMS, SYSTEMS
from scipy.signal import savgol_filter
from systems import System


@dataclass(frozen=True, slots=True, eq=False)
class Recorded:
    """A recording: t (N,), inputs u (k, N), positions q (n, N), rates v where they are sensed, the
    force of the rig's cell where there is one."""

    system: System
    t: Array
    u: Array
    q: Array
    v: Array | None
    cell: Array | None


def read(folder: Path, name: str) -> Recorded:
    """Read train.csv or holdout.csv of a case."""
    system = next(s for s in (*SYSTEMS, *ENGINE_SYSTEMS) if s.name == folder.name.split("-", 1)[1])
    return recorded(system, folder / name)


def recorded(system: System, path: Path) -> Recorded:
    """Read a recording of a machine."""
    head = path.read_text(encoding="utf-8").split("\n", 1)[0].split(",")
    table = dict(zip(head, np.loadtxt(path, delimiter=",", skiprows=1).T, strict=True))
    t, size = table["t"], table["t"].size
    u = np.array([table[k] for k in system.inputs]).reshape(-1, size)
    if system.imposed:
        return Recorded(system, t, u, table["x"][None], None, table["cell"][None])
    q = np.array([table[f"pos_{c}"] for c in system.coordinates])
    sensed = f"rate_{system.coordinates[0]}" in table
    v = np.array([table[f"rate_{c}"] for c in system.coordinates]) if sensed else None
    return Recorded(system, t, u, q, v, None)


def estimate(peer: str, r: Recorded, window: int) -> Estimate:
    """Motion from a recording: PySINDy's smoothed finite differences one after the other, or one
    Savitzky-Golay polynomial for q, v and a."""
    step = float(r.t[1] - r.t[0])
    if peer == "pysindy":
        rate = ps.SmoothedFiniteDifference(smoother_kws={"window_length": window, "polyorder": 3})
        v = np.asarray(rate(r.q.T, r.t)).T if r.v is None else r.v
        a = np.asarray(rate(v.T, r.t)).T
        q, v = (savgol_filter(x, window, 3, axis=1) for x in (r.q, v))
    else:
        q = savgol_filter(r.q, window, 3, axis=1)
        if r.v is None:
            v, a = (savgol_filter(r.q, window, 3, k, step, axis=1) for k in (1, 2))
        else:
            v, a = (savgol_filter(r.v, window, 3, k, step, axis=1) for k in (0, 1))
    cell = np.zeros_like(q) if r.cell is None else r.cell
    keep = slice(window, -window)
    parts = (q, v, a, r.u, cell)
    return Estimate(r.t[keep], *(np.asarray(x)[:, keep] for x in parts))
