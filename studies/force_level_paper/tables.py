"""The tables of README.md from the kept results; nothing there is typed by hand.

python studies/force_level_paper/tables.py          # writes the part between the marks
"""

import json
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

HERE = Path(__file__).resolve().parent
README = HERE / "README.md"
BEGIN, END = "<!-- results: tables.py writes them -->", "<!-- end of the results -->"
ROWS = ("default", "chosen", "sparse", "combined")
WORDS = {
    "default": "default network",
    "chosen": "chosen network",
    "sparse": "sparse",
    "combined": "sparse and network",
    "regression": "regression (STLSQ)",
    "alone": "no correction",
}
COMPARED = (("alone", "force"), *((row, "force") for row in ROWS), ("sparse", "rates"))
FEW = tuple(pair for pair in COMPARED if pair[0] not in ("chosen", "combined"))
KNOWN = "as recorded"
PAPER = (("displacement", "0.031 / 0.021 / 0.018"), ("velocity", "0.071 / 0.055 / 0.051"))
ACCURATE, BETTER = 0.01, 5.0  # the bars: of the uncorrected RMSE; against the default network
Sets = Sequence[dict[str, Any]]


def read(folder: Path = HERE / "results") -> Sets:
    """All kept sets in the order of their seeds."""
    files = sorted(folder.glob("[0-9]*.json"))
    return [json.loads(file.read_text(encoding="utf-8")) for file in files]


def numbers(values: Iterable[float | None]) -> list[float]:
    """What is null is worse than everything."""
    return [float("inf") if value is None else float(value) for value in values]


def quantile(found: Sequence[float], share: float) -> float:
    """Of what may be infinite, which has no value in between."""
    method = "linear" if np.isfinite(found).all() else "nearest"
    return float(np.quantile(found, share, method=method))  # type: ignore[call-overload]


def middle(values: Iterable[float | None]) -> float:
    return quantile(numbers(values), 0.5)


def shown(value: float, digits: int = 2) -> str:
    if not np.isfinite(value):
        return "runs away"
    return f"{value:.{digits}g}" if 1e-3 <= abs(value) < 1000 or value == 0 else f"{value:.0e}"


def spread(values: Iterable[float | None]) -> str:
    """Median and quartiles."""
    found = numbers(values)
    if not found:
        return "–"
    low, half, high = (shown(quantile(found, x)) for x in (0.25, 0.5, 0.75))
    return f"{half} ({low} – {high})"


def table(head: Sequence[str], lines: Iterable[Sequence[str]]) -> str:
    rows = [head, ["---"] * len(head), *lines]
    return "\n".join("| " + " | ".join(row) + " |" for row in rows)


def right(found: dict[str, Any]) -> bool:
    """Whether the laws are those that were left out: drag and dry friction, nothing else."""
    kinds = sorted(kind for kind, _ in found["sparse"]["elements"].values())
    return kinds == ["drag", "friction"]


def laws(sets: Sets, key: str) -> str:
    """Which laws were found, and how often."""
    kinds = Counter(
        " and ".join(sorted(kind for kind, _ in one[key]["sparse"]["elements"].values()))
        or "nothing claimed"
        for one in sets
    )
    return ", ".join(f"{name} in {count}" for name, count in kinds.most_common())


def about(sets: Sets) -> str:
    seeds = [one["seed"] for one in sets]
    machine = [one["machine"] for one in sets]
    ranges = ", ".join(
        f"{key} {min(it[key] for it in machine):.3g} to "
        f"{max(it[key] for it in machine):.3g} {unit}".strip()
        for key, unit in (
            ("m", "kg"),
            ("c", "N/m³"),
            ("d", "N·s²/m²"),
            ("mu", ""),
            ("F", "N"),
            ("f", "Hz"),
            ("q0", "m"),
        )
    )
    return (
        f"{len(sets)} parameter sets, seeds {min(seeds)} to {max(seeds)}; {ranges}; "
        f"{sum(one['discarded'] for one in sets)} draws were discarded because a perturbation of "
        f"their start grows. {np.median([one['seconds'] for one in sets]):.0f} s a set on one "
        "core of a busy machine.\n\n"
        f"The diagnosis named: {laws(sets, 'learned')}. From the place alone: "
        f"{laws(sets, 'learned from place')}. Left out are drag and friction."
    )


def paper_table(sets: Sets) -> str:
    """Table 1: RMSE as recorded, for every formulation and host."""
    lines = []
    for i, what in enumerate(("displacement, m", "velocity, m/s")):
        for row in (*ROWS, "regression", "alone"):
            cells = [f"{WORDS[row]}, {what}"]
            for level in ("rates", "force"):
                found = [one["simulated"][KNOWN][row].get(level) for one in sets]
                cells.append(spread(pair[i] for pair in found) if None not in found else "–")
            for host in ("Exudyn", "MuJoCo"):
                if row not in ROWS:
                    cells.append("–")
                    continue
                cells.append(
                    spread(hosted(one, row, host, "me", "0.001", "error")[i] for one in sets)
                )
            lines.append(cells)
    quoted = "; ".join(f"{what} {said}" for what, said in PAPER)
    return (
        table(
            ("correction", "continuous, CVODES", "force, CVODES", "force, Exudyn", "force, MuJoCo"),
            lines,
        )
        + f"\n\nThe three columns of the paper's table: {quoted} (default network; its parameters "
        "are not printed, so that nothing but the size can be compared)."
    )


def hosted(
    one: dict[str, Any], row: str, host: str, coupling: str, h: str, key: str
) -> list[float | None]:
    """A pair of errors in a host; of a correction that says nothing, those of the host alone."""
    made = one["hosts"][row]
    if not made:
        alone: list[float | None] = one["simulated"][KNOWN]["alone"]["force"]
        return alone if key == "error" else [0.0, 0.0]
    pair: list[float | None] = made[host][coupling][h][key]
    return pair


def nrmse_table(sets: Sets) -> str:
    lines = []
    for row in (*ROWS, "regression", "noise"):
        cells = [WORDS.get(row, "the true force: what noise alone leaves")]
        for level in ("rates", "force"):
            for i in (0, 1):
                found = [one["nrmse"][row].get(level) for one in sets]
                cells.append(spread(pair[i] for pair in found) if None not in found else "–")
        lines.append(cells)
    return table(("correction", "Δq'' train", "Δq'' test", "ΔF train", "ΔF test"), lines)


def share(one: dict[str, Any], error: float | None) -> float:
    """A displacement error over that of the model without correction."""
    whole = one["simulated"][KNOWN]["alone"]["force"][0]
    return float("inf") if error is None else error / whole


def separated(sets: Sets) -> str:
    """Learning error beside coupling errors, in % of the uncorrected RMSE."""
    lines = []
    for row in ROWS:
        learning = [share(one, one["simulated"][KNOWN][row]["force"][0]) for one in sets]
        cells = [WORDS[row], spread(100 * x for x in learning)]
        for coupling, h in (("casadi", "0.001"), ("me", "0.001"), ("cs", "0.001"), ("cs", "0.01")):
            found = [
                100 * share(one, hosted(one, row, host, coupling, h, "coupling")[0])
                for one in sets
                for host in ("Exudyn", "MuJoCo")
            ]
            cells.append(f"{shown(middle(found))} (≤ {shown(max(found))})")
        lines.append(cells)
    return table(
        (
            "correction",
            "learning error",
            "CasADi, 1 ms",
            "model exchange, 1 ms",
            "co-simulation, 1 ms",
            "co-simulation, 10 ms",
        ),
        lines,
    )


def by_host(sets: Sets) -> str:
    """Coupling errors host by host, over all corrections."""
    lines = []
    for coupling, name in (
        ("casadi", "CasADi function"),
        ("me", "FMU, model exchange"),
        ("cs", "FMU, co-simulation"),
    ):
        for h in ("0.01", "0.001"):
            cells = [name, f"{1000 * float(h):g} ms"]
            for host in ("Exudyn", "MuJoCo"):
                found = [
                    100 * share(one, hosted(one, row, host, coupling, h, "coupling")[0])
                    for one in sets
                    for row in ROWS
                    if one["hosts"][row]
                ]
                cells.append(f"{shown(middle(found))} % (≤ {shown(max(found))} %)")
            lines.append(cells)
    return table(("coupling", "step", "Exudyn", "MuJoCo"), lines)


def excitations(sets: Sets, key: str = "simulated") -> str:
    """Displacement errors under every excitation, over the noise of the recording."""
    lines, columns = [], COMPARED if key == "simulated" else FEW
    for name in sets[0][key]:
        cells = [name]
        for row, level in columns:
            cells.append(
                spread(
                    None
                    if (error := one[key][name][row][level][0]) is None
                    else error / one["noise"][0]
                    for one in sets
                )
            )
        cells.append(shown(middle(ratio(one, name, key) for one in sets)))
        lines.append(cells)
    names = [
        WORDS[row] if level == "force" else "sparse, of rates (STLSQ)" for row, level in columns
    ]
    return table(("excitation", *names, "default / sparse"), lines)


def ratio(one: dict[str, Any], name: str, key: str = "simulated") -> float:
    """How many times better the sparse correction is than the default network."""
    default, sparse = (one[key][name][row]["force"][0] for row in ("default", "sparse"))
    if sparse is None:
        return 0.0
    return float("inf") if default is None else default / sparse


def lags(sets: Sets) -> str:
    """Phase lags in ms, at the start and later; what couplings add."""
    lines = []
    for row in ("alone", *ROWS):
        pairs = [one["simulated"][KNOWN][row]["lag"] for one in sets]
        cells = [f"{WORDS[row]}, CVODES"]
        lines.append([*cells, *(spread(late(pair[i]) for pair in pairs) for i in (0, 1))])
    for h in ("0.001", "0.01"):
        for coupling, name in (("me", "model exchange"), ("cs", "co-simulation")):
            cells = [f"added by {name}, {1000 * float(h):g} ms (sparse)"]
            for i in (0, 1):
                found = []
                for one in sets:
                    made = one["hosts"]["sparse"]
                    if made:
                        host = made["MuJoCo"][coupling][h]["lag"][i]
                        base = one["simulated"][KNOWN]["sparse"]["lag"][i]
                        found.append(late(None if None in (host, base) else host - base))
                cells.append(spread(found))
            lines.append(cells)
    return table(("simulation", "first two periods", "last five periods"), lines)


def late(lag: float | None) -> float | None:
    """Milliseconds, whatever the direction."""
    return None if lag is None else 1000 * abs(lag)


def bars(sets: Sets) -> str:
    """What was asked for beforehand, and whether it is met."""
    unseen = [name for name in sets[0]["simulated"] if name != KNOWN]
    ratios = [ratio(one, name) for one in sets for name in unseen]
    named = [one for one in sets if right(one["learned"])]
    good = [ratio(one, name) for one in named for name in unseen]
    floor = [share_of_noise(one, name) for one in sets for name in one["simulated"]]
    fine = [share_of_noise(one, name) for one in named for name in one["simulated"]]
    worst = max(
        share(one, hosted(one, row, host, "me", "0.001", "coupling")[0])
        for one in sets
        for row in ROWS
        for host in ("Exudyn", "MuJoCo")
    )
    lines = [
        judged(
            "sparse: displacement RMSE over the noise of the recording, median over sets and "
            "excitations",
            "≤ 1",
            middle(floor),
            lambda x: x <= 1,
            within(floor),
        ),
        judged(
            "the same where the diagnosis named drag and friction "
            f"({len(named)} of {len(sets)} sets)",
            "≤ 1",
            middle(fine),
            lambda x: x <= 1,
            within(fine),
        ),
        judged(
            "default network over sparse, unseen excitations, median",
            f"≥ {BETTER:g}",
            middle(ratios),
            lambda x: x >= BETTER,
            beyond(ratios),
        ),
        judged(
            "the same where the diagnosis named drag and friction",
            f"≥ {BETTER:g}",
            middle(good),
            lambda x: x >= BETTER,
            beyond(good),
        ),
        judged(
            "model exchange at 1 ms against CVODES, of the uncorrected RMSE, worst",
            f"≤ {100 * ACCURATE:g} %",
            100 * worst,
            lambda x: x <= 100 * ACCURATE,
            "%",
        ),
    ]
    return table(("bar", "asked", "measured", ""), lines)


def share_of_noise(one: dict[str, Any], name: str) -> float:
    error = one["simulated"][name]["sparse"]["force"][0]
    return float("inf") if error is None else error / one["noise"][0]


def within(values: Sequence[float]) -> str:
    return f"({sum(x <= 1 for x in values)} of {len(values)})"


def beyond(values: Sequence[float]) -> str:
    return f"({sum(x >= BETTER for x in values)} of {len(values)})"


def judged(
    what: str, asked: str, value: float, passes: Callable[[float], bool], more: str = ""
) -> list[str]:
    return [what, asked, f"{shown(value)} {more}", "pass" if passes(value) else "**fail**"]


def cart_pole(folder: Path = HERE / "results") -> str:
    """The machine with two coordinates, worst over the seeds; empty if it was not run."""
    file = folder / "cart_pole.json"
    if not file.exists():
        return "Not run."
    reported = json.loads(file.read_text(encoding="utf-8"))
    lines = []
    for name in reported[0]["simulated"]:
        for row in ("alone", "default", "sparse"):
            found = [one["simulated"][name][row] for one in reported]
            cells = [f"{WORDS[row]}, {name}"]
            for level in ("rates", "force"):
                cells.append(spread(pair[level][0] for pair in found) if level in found[0] else "–")
            for host in ("Exudyn", "MuJoCo"):
                made = [one["hosts"].get(row) for one in reported]
                if name != KNOWN or None in made:
                    cells.append("–")
                    continue
                whole = [one["simulated"][KNOWN]["alone"]["force"][0] for one in reported]
                for coupling in ("me", "cs"):
                    lost = max(
                        100 * numbers([m[host][coupling]["0.001"]["coupling"][0]])[0] / w
                        for m, w in zip(made, whole, strict=True)
                    )
                    cells.append(f"{shown(lost)} %")
            lines.append([*cells, *["–"] * (7 - len(cells))][:7])
    head = (
        "RMSE of x and φ",
        "continuous",
        "force, CVODES",
        "Exudyn, me",
        "Exudyn, cs",
        "MuJoCo, me",
        "MuJoCo, cs",
    )
    named = "; ".join(f"seed {one['seed']}: {one['said']}" for one in reported)
    return (
        f"Seeds of the noise: {len(reported)}. The diagnosis, {named}\n\n"
        + table(head, lines)
        + "\n\nThe columns of the hosts are coupling errors at 1 ms, worst of the seeds, over the "
        "RMSE without correction."
    )


def text(sets: Sets, folder: Path = HERE / "results") -> str:
    """The generated part."""
    parts = (
        ("What was asked for", bars(sets)),
        ("What was run", about(sets)),
        ("Table 1: the recorded excitation simulated", paper_table(sets)),
        ("What is learned of the samples (NRMSE, eq. 16)", nrmse_table(sets)),
        ("Learning error and coupling error, % of the uncorrected RMSE", separated(sets)),
        ("Couplings by host", by_host(sets)),
        ("Other excitations: displacement RMSE over the noise of the recording", excitations(sets)),
        ("From the place alone", excitations(sets, "simulated from place")),
        ("The phase lag, ms", lags(sets)),
        ("A machine with two coordinates", cart_pole(folder)),
    )
    return "\n\n".join(f"### {title}\n\n{body}" for title, body in parts)


def between_marks(page: str, inside: str) -> str:
    """The page with the text between the marks."""
    head, _, rest = page.partition(BEGIN)
    _, mark, tail = rest.partition(END)
    if not mark:
        raise SystemExit(f"the page has no marks '{BEGIN}' and '{END}'")
    return f"{head}{BEGIN}\n\n{inside}\n\n{END}{tail}"


def main() -> None:
    """Write the generated part into README.md."""
    page = README.read_text(encoding="utf-8")
    README.write_text(between_marks(page, text(read())), encoding="utf-8")


if __name__ == "__main__":
    main()
