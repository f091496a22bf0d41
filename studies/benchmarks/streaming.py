"""A recording larger than memory: how fast it is scanned, over how fast it is read.

An arm of two links moves along sums of sines for as many samples as are asked for; its torques
follow from its equations, written here by hand, with dry friction in the elbow that the model file
does not know. The file is Parquet, 3.6 GB for 10⁸ samples.
"""

import tempfile
from pathlib import Path

import numpy as np
from timing import Row, in_turns, middle, milliseconds

import symhyb as sh
from symhyb.data.pieces import pieces_of
from symhyb.scanning import scan

ROOT = Path(__file__).resolve().parents[2]
MODEL = ROOT / "models" / "two_link_arm.toml"
STEP, TURN_S, NOISE, COULOMB = 1e-3, 200, 2e-4, 0.8
NAMES = ("t", "first", "second", "torque_1", "torque_2")


def turn() -> np.ndarray:
    """Angles and torques (4, N), SI, of one turn that closes."""
    g, m_1, m_2, load, l_1, a_1, l_2, a_2 = 9.81, 4.2, 2.1, 0.8, 0.55, 0.24, 0.45, 0.18
    inertia_1, inertia_2, d_1, d_2 = 0.11, 0.035, 0.6, 0.3
    random = np.random.default_rng(5)
    t = np.arange(round(TURN_S / STEP)) * STEP
    omega = 2 * np.pi * random.integers(20, 300, (2, 6)) / TURN_S
    size = random.uniform(0.05, 0.14, (2, 6))
    angle = omega[..., None] * t + random.uniform(0, 2 * np.pi, (2, 6))[..., None]
    alpha, beta = np.array([0.4, -0.8])[:, None] + np.einsum("ij,ijt->it", size, np.sin(angle))
    va, vb = np.einsum("ij,ijt->it", size * omega, np.cos(angle))
    aa, ab = -np.einsum("ij,ijt->it", size * omega**2, np.sin(angle))
    m = m_2 + load  # forearm and load as one body
    a = (m_2 * a_2 + load * l_2) / m
    inertia = inertia_2 + m_2 * (a_2 - a) ** 2 + load * (l_2 - a) ** 2
    bent = l_1 * a * m * np.cos(beta)
    own = inertia + m * a**2
    upper = inertia_1 + m_1 * a_1**2 + own + m * l_1**2 + 2 * bent
    turned = -l_1 * a * m * np.sin(beta)
    fall = g * m * a * np.cos(alpha + beta)
    falls = g * (m_1 * a_1 + m * l_1) * np.cos(alpha) + fall
    torque_1 = upper * aa + (own + bent) * ab + turned * (2 * va * vb + vb**2) + falls + d_1 * va
    torque_2 = (own + bent) * aa + own * ab - turned * va**2 + fall + d_2 * vb
    torque_2 += COULOMB * np.tanh(vb / 0.005)
    return np.stack([alpha, beta, torque_1, torque_2])


def write_day(path: Path, samples: int) -> None:
    """Write so many samples, turn after turn, with noise of its own in each."""
    import pyarrow as arrow
    import pyarrow.parquet as parquet

    whole, done = turn(), 0
    schema = arrow.schema([(name, arrow.float64()) for name in NAMES])
    with parquet.ParquetWriter(path, schema, use_dictionary=False) as file:
        while done < samples:
            count = min(whole.shape[1], samples - done)
            columns = whole[:, :count].copy()
            columns[:2] += NOISE * np.random.default_rng(done).standard_normal((2, count))
            t = (done + np.arange(count)) * STEP
            file.write_table(arrow.table([t, *columns], schema=schema))
            done += count


def rows(samples: int = 100_000_000) -> list[Row]:
    """The bar of a scan, beside reading the same pieces and doing nothing."""
    model = sh.read_model(MODEL)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "day.parquet"
        write_day(path, samples)

        def read() -> None:
            for _ in pieces_of(path, model, rows=200_000):
                pass

        times = middle(in_turns({"read": read, "scan": lambda: scan(model, path)}, 1))
    note = f"{milliseconds(times['read'])}, {milliseconds(times['scan'])}"
    what = "rate of a scan over that of reading"
    name = f"{samples:.0e} samples of an arm of two links"
    return [Row(name, what, times["read"] / times["scan"], 1 / 3, True, "×", note)]
