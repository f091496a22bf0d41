"""What other tools would say of the same cases: claims of regressions, the fit of a network.

    python studies/concealed/peers.py --seeds 0-999 --every   # all settings, for the tuning
    python studies/concealed/peer_tuning.py --seeds 0-999     # which settings to report
    python studies/concealed/peers.py --seeds 1000-1599       # those alone, for the report

Each peer sees model, recordings and sensing, as symhyb does, and opens no seal. It regresses what
the known equations leave over. The equations are those of the generators, which are the model
file's (a test compares them). See ``peer_library`` for the columns.
"""

import argparse
import json
import time
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from laws import Array
from peer_library import Term, spoken
from peer_motion import Recorded, estimate, read
from peer_regression import (
    YARDSTICK,
    Packed,
    fit_of,
    left_over,
    pack,
    regression,
    sparse,
)
from peer_stepwise import SMOOTHED, stepwise
from plans import folder_of, seeds_of
from sklearn.neural_network import MLPRegressor

THRESHOLDS = (0.003, 0.01, 0.02, 0.05, 0.1, 0.2, 0.4)  # of the known force
WINDOWS = (11, 21, 41, 81)  # samples of a smoothing polynomial of order 3
HALVES = (15, 30, 60, 120)  # samples: half of a weak test function
LIBRARIES = ("plain", "wide")
HIDDEN = ((16,), (32, 32))
PEERS = ("pysindy", "weak", "deltaf", "mlp")  # with settings to choose
FIXED = Path(__file__).resolve().parent / "results" / "peers.json"


@dataclass(frozen=True, slots=True)
class Setting:
    """One point of a peer's grid."""

    peer: str
    library: str = "plain"
    window: int = 21
    threshold: float = 0.03
    hidden: tuple[int, ...] = ()

    @property
    def name(self) -> str:
        """How it is called in files."""
        if self.peer == "mlp":
            return f"mlp {self.window} {'x'.join(map(str, self.hidden))}"
        return f"{self.peer} {self.library} {self.window} {self.threshold:g}"


STEPWISE = Setting("stepwise", "wide", SMOOTHED, 0.0)  # the criterion is all that it has


def grid() -> list[Setting]:
    """Every setting that is tried on the development seeds."""
    found = [
        Setting(peer, library, window, threshold)
        for peer, windows in (("pysindy", WINDOWS), ("weak", HALVES), ("deltaf", WINDOWS))
        for library in LIBRARIES
        for window in windows
        for threshold in THRESHOLDS
    ]
    return found + [Setting("mlp", window=w, hidden=h) for w in WINDOWS[1:3] for h in HIDDEN]


def of_name(name: str) -> Setting:
    """The setting that has this name."""
    return next(one for one in (STEPWISE, *grid()) if one.name == name)


Kept = dict[Setting, tuple[list[Term], Packed, float]]


def claims(train: Recorded, one: Setting) -> dict[str, Any]:
    """What a setting says of a recording, in the form of a diagnosis, with its seconds."""
    return stepwise(train) if one == STEPWISE else _regressed(train, one, {})[0]


def _regressed(
    train: Recorded, one: Setting, kept: Kept
) -> tuple[dict[str, Any], list[Term], Array]:
    """What a regression says, its terms and their values; ``kept`` are those that were made."""
    begin, basis = time.process_time(), replace(one, threshold=0.0)
    if basis not in kept:
        window = YARDSTICK if one.peer == "weak" else one.window
        way = "pysindy" if one.peer == "weak" else one.peer
        e, wide = estimate(way, train, window), one.library == "wide"
        terms, rows = regression(one.peer, train.system, e, wide, one.window)
        kept[basis] = terms, pack(*rows), time.process_time() - begin
        begin = time.process_time()
    terms, packed, shared = kept[basis]
    value, spread = sparse(packed, one.threshold)
    found = spoken(terms, value, spread)
    verdict = "missing physics" if found else "nothing missing"
    diagnosis = {
        "verdict": verdict,
        "found": found,
        "parameters": [],
        "measurement": [],
        "alternatives": [],
    }
    return {"seconds": time.process_time() - begin + shared, "diagnosis": diagnosis}, terms, value


def diagnoses(folder: Path, settings: list[Setting], fits: bool = True) -> dict[str, Any]:
    """What every setting says of a case, by name; a regression serves all its thresholds.

    With ``fits`` also how much of ΔF it leaves on the unseen recording, which takes longer."""
    train, unseen = (read(folder, f"{x}.csv") for x in ("train", "holdout"))
    kept: Kept = {}
    said = {}
    for one in settings:
        if one.peer == "mlp":
            said[one.name] = network(train, unseen, one)
        elif one.peer == "stepwise":
            said[one.name] = stepwise(train)
        else:
            said[one.name], terms, value = _regressed(train, one, kept)
            if fits:
                said[one.name]["fit"] = fit_of(terms, value, train, unseen)
    return said


def network(train: Recorded, unseen: Recorded, setting: Setting) -> dict[str, Any]:
    """A network from state and inputs to ΔF: it has no words, so its fit alone is reported."""
    begin = time.process_time()
    e, later = estimate("deltaf", train, setting.window), estimate("deltaf", unseen, YARDSTICK)
    (wanted, scale), (truth, _) = left_over(train.system, e), left_over(train.system, later)
    x, x_later = (np.vstack([m.q, m.v, m.u]).T for m in (e, later))
    middle, size = x.mean(axis=0), x.std(axis=0) + 1e-300
    most = max(float(np.sqrt(np.mean((wanted / scale) ** 2))), 1e-300)
    rows = np.linspace(0, len(x) - 1, min(len(x), 1500)).astype(int)
    model = MLPRegressor(
        hidden_layer_sizes=setting.hidden,
        early_stopping=True,
        max_iter=150,
        random_state=0,
        learning_rate_init=5e-3,
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that it might still improve
        y = (wanted / scale / most).T[rows]
        model.fit((x[rows] - middle) / size, y[:, 0] if y.shape[1] == 1 else y)
        said = model.predict((x_later - middle) / size).reshape(len(x_later), -1).T * most
    ratio = np.mean((truth / scale - said) ** 2) / np.mean((truth / scale) ** 2)
    return {"seconds": time.process_time() - begin, "fit": float(np.sqrt(ratio))}


def chosen() -> list[Setting]:
    """The settings that are reported: most were chosen on development seeds."""
    names = {row["setting"] for row in json.loads(FIXED.read_text())["chosen"].values()}
    return [of_name(name) for name in sorted(names)]


def cases(seeds: list[int], build: Path) -> Iterator[Path]:
    """The folders of the seeds that were drawn."""
    for seed in seeds:
        folder = folder_of(seed, build)
        if (folder / "train.csv").exists():
            yield folder


def main() -> None:
    """Let the peers diagnose the cases of some seeds; keeps one JSON a case, resumable."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--seeds", default="0-999")
    parser.add_argument("--every", action="store_true", help="all settings of the grid")
    parser.add_argument("-o", "--output", type=Path, default=Path("build/concealed"))
    parser.add_argument("--results", type=Path, default=Path("build/concealed/peers"))
    options = parser.parse_args()
    settings = grid() if options.every else chosen()
    options.results.mkdir(parents=True, exist_ok=True)
    for folder in cases(seeds_of(options.seeds), options.output):
        target = options.results / f"{folder.name}.json"
        said = json.loads(target.read_text()) if target.exists() else {}
        wanted = [
            one
            for one in settings
            if one.name not in said
            or not (options.every or "fit" in said[one.name] or one == STEPWISE)
        ]
        if wanted:
            begin = time.perf_counter()
            try:
                said |= diagnoses(folder, wanted, not options.every)
            except (
                np.linalg.LinAlgError,
                ValueError,
            ) as error:  # counts as a refusal, and is reported
                said |= {one.name: {"seconds": 0.0, "crash": str(error)} for one in wanted}
            part = target.with_suffix(".part")
            part.write_text(json.dumps(said) + "\n", encoding="utf-8")
            part.replace(target)
            print(
                f"{folder.name}: {len(wanted)} in {time.perf_counter() - begin:.1f} s", flush=True
            )


if __name__ == "__main__":
    main()
