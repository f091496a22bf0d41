"""The cases of the frozen set: the committed list, and the rule that chose its concealed ones."""

import os
import sys
import tomllib
from collections import Counter
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
BENCH = HERE.parent / "concealed"
if str(BENCH) not in sys.path:
    sys.path.append(str(BENCH))

LIST = HERE / "cases.toml"
FIRST_UNUSED = 1600  # seeds from here on are kept for reports
HIDDEN = {1: 5, 2: 3, 3: 2, 4: 1, 6: 1}  # coordinates: concealed cases of a system
NULL = {1: 2, 2: 1, 3: 1}  # coordinates: cases with nothing concealed of a system
KIND_MOST = 2  # cases of one kind,
MANY_MOST = 4  # of "two" and "mixed", which hold many kinds
EXAMPLES, DATA = "SYMHYB_EXAMPLES", "SYMHYB_DATA"


@dataclass(frozen=True, slots=True)
class Case:
    """One case: exactly one of ``seed`` (concealed bench), ``study`` (a folder below studies/)
    and ``example`` (a folder below SYMHYB_EXAMPLES); ``quick``: whether --quick runs it."""

    name: str
    seed: int | None = None
    study: str = ""
    example: str = ""
    quick: bool = False

    @property
    def group(self) -> str:
        """The part of the set: concealed, null, study or example."""
        if self.seed is None:
            return "study" if self.study else "example"
        return "null" if self.seed % 2 else "concealed"


def listed(path: Path = LIST) -> tuple[Case, ...]:
    """All cases of the list, in its order."""
    entries = tomllib.loads(path.read_text(encoding="utf-8"))["case"]
    return tuple(Case(**entry) for entry in entries)


def given_up(path: Path = LIST) -> tuple[int, ...]:
    """The seeds that the rule asked for and that had no complete draw."""
    return tuple(tomllib.loads(path.read_text(encoding="utf-8"))["given_up"])


def chosen(without: Collection[int]) -> Iterator[int]:
    """The rule: seeds in order below 1600, as many of a system as ``HIDDEN`` and ``NULL`` give it,
    no kind more often than ``KIND_MOST``; seeds ``without`` a complete draw are passed over."""
    from plans import plan_of

    kinds: Counter[str] = Counter()
    systems: Counter[tuple[str, bool]] = Counter()
    for seed in range(FIRST_UNUSED):
        plan = plan_of(seed)
        null = bool(seed % 2)
        own = (plan.system.name, null)
        if systems[own] >= (NULL if null else HIDDEN).get(plan.system.n, 0):
            continue
        most = MANY_MOST if plan.kind in ("two", "mixed") else KIND_MOST
        if (not null and kinds[plan.kind] >= most) or seed in without:
            continue
        systems[own] += 1
        kinds[plan.kind] += 1
        yield seed


def missing(case: Case) -> str:
    """Why a case cannot run here, in a sentence, or nothing."""
    if case.example:
        folder = os.environ.get(EXAMPLES, "")
        if not folder:
            return f"skipped: {EXAMPLES} does not name the folder of the examples"
        if not (Path(folder) / case.example / "truth.json").is_file():
            return f"skipped: {folder} holds no {case.example}/truth.json"
    if case.study:
        text = (ROOT / "studies" / case.study / "study.toml").read_text(encoding="utf-8")
        sources = tomllib.loads(text)
        public = any("data" in one for one in (*sources["train"], *sources.get("holdout", ())))
        if public and not os.environ.get(DATA):
            return f"skipped: {DATA} does not name the folder of the public recordings"
    return ""
