"""How often would the noise of a recording alone earn a cause: a parametric bootstrap of the score.

    python studies/concealed/threshold.py --seeds 1,3,5 [--draws 4000]

Under the null the whitened residual of the windows is white, so that what the candidate columns see
of it is b ~ N(0, G) with their Gram matrix G, initial states projected out. Each draw is searched
for the single cause that gains most beyond its price. What is printed of each case: the 99 %
quantile of the best gain of any cause, the least price of a cause, and the share of draws that earn
one. Bounds and signs are left out, which makes the share too high.
"""

import argparse
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import symhyb as sh
from symhyb.correction.search.preparing import prepare, settle
from symhyb.correction.search.score import choice_of
from symhyb.correction.search.setting import along_motion

CASES = Path(__file__).parents[2] / "build" / "concealed"


def best_gains(
    gram: NDArray[np.float64], columns: list[tuple[int, ...]], draws: int, seed: int
) -> NDArray[np.float64]:
    """The gain of every cause in every draw (draws, causes), χ²."""
    scale = np.sqrt(np.maximum(np.diag(gram), 1e-300))
    power, axes = np.linalg.eigh(gram / scale / scale[:, None])
    root = axes * np.sqrt(np.maximum(power, 0.0))
    seen = np.random.default_rng(seed).standard_normal((draws, len(scale))) @ root.T
    gains = np.zeros((draws, len(columns)))
    for i, chosen in enumerate(columns):
        rows = list(chosen)
        block = (gram / scale / scale[:, None])[np.ix_(rows, rows)]
        part = seen[:, rows]
        gains[:, i] = np.sum(part * (part @ np.linalg.pinv(block, rcond=1e-8)), axis=1)
    return gains


def looked_at(folder: Path, draws: int) -> tuple[float, float, float, int]:
    """The 99 % quantile of the best gain, the least price of a cause, the share of draws that earn
    one, and the number of causes."""
    model = sh.read_model(folder / "model.toml")
    setting = settle(prepare(model, sh.read_recording(folder / "train.csv", model)))
    problem = along_motion(setting, setting.stages[-1])
    samples = sum(np.isfinite(cut.block.y).sum() for cut in setting.stages[-1].cuts)
    gram = (problem.gram + problem.held)[:-1, :-1]
    count = len({cause.family for cause in setting.hypotheses})
    numbers = np.array([cause.numbers for cause in problem.hypotheses])
    stated = np.array([problem.prior[list(rows)].any() for rows in problem.columns])
    price = numbers * np.log(samples) + np.where(stated, 0.0, choice_of(count))
    gains = best_gains(gram, list(problem.columns), draws, seed=int(folder.name[:5]))
    earned = float(np.mean((gains > price).any(axis=1)))
    return float(np.quantile(gains.max(axis=1), 0.99)), float(price.min()), earned, count


def main() -> None:
    """Print a line for every case."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", required=True)
    parser.add_argument("--draws", type=int, default=4000)
    options = parser.parse_args()
    for seed in options.seeds.split(","):
        for folder in sorted(CASES.glob(f"{int(seed):05}-*")):
            quantile, price, earned, count = looked_at(folder, options.draws)
            print(
                f"{folder.name}: 99 % of draws gain less than {quantile:.1f}, a cause of {count} "
                f"costs at least {price:.1f}, {100 * earned:.2f} % of draws earn one",
                flush=True,
            )


if __name__ == "__main__":
    main()
