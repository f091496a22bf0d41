"""What a diagnosis claims against what acts: wrong, refused, class right, false nothing, failed.

The README says how every kind is judged.
"""

from dataclasses import dataclass
from typing import Any

from shared import Claim, claimed

OUTCOMES = ("wrong", "refused", "class right", "false nothing", "failed")
NEARLY = 0.01  # relative, of a period of samples
SPAN = 3.0  # sd; a value within it claims nothing false
LIKELY = 0.5  # probability from which a class counts as stated
EMPIRICAL = ("law", "network", "curve")  # a fit without a name: it states the class "law"
SOON = 0.5  # s; so near is the instant of a change right
SHAPES = (
    "exponent",
    "critical",
    "frequency",
    "slope",
)  # numbers of a law that the seal of an old kind holds
ACTUATORS = {  # and what else has one number, in seals
    "dead_band": "band",
    "limit": "most",
    "rate_limit": "rate",
    "lag": "tau",
    "sensor_lag": "tau",
}
COUPLINGS = {  # key and the sign of its push on the first coordinate by the second
    "gyroscopic": ("coefficient", 1.0),
    "circulatory": ("stiffness", 1.0),
    "skew_spring": ("stiffness", -1.0),
    "skew_damper": ("damping", -1.0),
}
NEUTRAL = {"gain": 1.0, "offset": 0.0, "delay": 0.0}  # what a channel without a fault has


@dataclass(frozen=True, slots=True)
class Row:
    """The score of one case: ``wrong`` claims in words, the class that was stated, whether it was
    stated where the effect acts (None: no place to compare), whether all claimed numbers of a
    concealed listed law are within 3 sd (None: no such law was claimed), and by what share of its
    range the worst sensor of the ``unseen`` recording is missed in a free run, by the model and by
    the corrected one."""

    case: str
    kind: str
    machine: str
    outcome: str
    verdict: str = ""
    wrong: tuple[str, ...] = ()
    stated: str = ""
    placed: bool | None = None
    covered: bool | None = None
    seconds: float = 0.0
    cpu: float | None = None
    sentence: str = ""
    unseen: tuple[float, float] | None = None


def score_case(name: str, result: dict[str, Any], answer: dict[str, Any]) -> Row:
    """Compare what was claimed with what acts."""
    reported = result.get("diagnosis")
    start = Row(
        name,
        answer["kind"],
        answer["machine"],
        "failed",
        seconds=result.get("seconds", 0.0),
        cpu=result.get("cpu_seconds"),
        sentence=str(result.get("sentence") or result.get("crash", "")),
    )
    return start if reported is None else _judged(start, reported, answer)


def _judged(start: Row, reported: dict[str, Any], answer: dict[str, Any]) -> Row:
    claims = claimed(reported)
    law = next((c for c in claims if _is_truth(c, answer)), None)
    accepted = law is not None or any(_is_accepted(c, answer) for c in claims)
    wrong = [_words(c) for c in claims if not _holds(c, answer)]
    wrong += [
        f"{one['kind']} of {', '.join(one['channels'])}"
        for one in reported.get("channels", ())
        if one["kind"] not in answer["accepted"]
    ]
    wrong += [
        f"course of {name}"
        for one in reported.get("courses", ())
        if (name := one.get("parameter") or one.get("channel")) != answer["place"]
        or "time-varying" not in answer["classes"]
    ]
    stated, where = _stated(reported)
    if not stated and _dated(reported, answer):
        stated = "time-varying"
    right = accepted or stated in answer["classes"]
    if stated and not right:
        wrong.append(f"class {stated}")
    verdict, nothing = reported["verdict"], "noise" in answer["classes"]
    if verdict == "undecided":
        outcome = "class right" if right and not nothing else "refused"
    elif verdict == "nothing missing":
        outcome = "class right" if nothing else "false nothing"
    elif wrong:
        outcome = "wrong"
    else:  # harmless claims alone leave what acts unsaid
        outcome = "class right" if right or nothing else "false nothing"
    places = {answer["place"], *answer["place"].split("-")} - {""}
    return Row(
        start.case,
        start.kind,
        start.machine,
        outcome,
        verdict,
        tuple(wrong) if outcome == "wrong" else (),
        stated,
        bool(places & where) if stated and places else None,
        None if law is None else _covered(law, answer),
        start.seconds,
        start.cpu,
        reported["sentence"],
        missed(reported),
    )


def missed(reported: dict[str, Any]) -> tuple[float, float] | None:
    """The error of free runs along the unseen recording before and after, over the range."""
    scores = (reported.get("scores") or {}).get("holdout") or {}
    each = [
        max((value for value in found.values() if value is not None), default=None)
        for found in (
            scores.get(time, {}).get("free_run_nrmse", {}) for time in ("before", "after")
        )
    ]
    return None if None in each else (each[0], each[1])


def _stated(reported: dict[str, Any]) -> tuple[str, set[str]]:
    """The most probable class, if it is likely, and where it is said to act."""
    classes = reported.get("classes") or []
    best = max(classes, key=lambda one: one.get("probability") or 0.0, default=None)
    if best is None or (best.get("probability") or 0.0) < LIKELY:
        return "", set()
    where = best.get("channel") or best.get("place") or ()
    if isinstance(where, dict):
        (where,) = where.values()
    names = [where] if isinstance(where, str) else list(where)
    return str(best["kind"]), {*names, "-".join(names)}


def _is_truth(claim: Claim, answer: dict[str, Any]) -> bool:
    """Whether a claim is the listed law that is concealed."""
    if not answer["law"]:
        return False
    kind, place, key, _ = answer["law"]
    return claim.kind == kind and claim.where == place and key in claim.values


def _covered(claim: Claim, answer: dict[str, Any]) -> bool:
    """Whether every number of a claimed true law is within 3 sd; one that is not there is 0."""
    _, _, key, true = answer["law"]
    return all(
        abs(value - (true if name == key else 0.0)) <= SPAN * sd
        for name, (value, sd) in claim.values.items()
    )


def _is_accepted(claim: Claim, answer: dict[str, Any]) -> bool:
    """Whether a claim of the vocabulary is a right answer for the kind, where it acts, and the
    shape that it states, if the seal holds it, is the true one; so is the number of an actuator,
    and that of a coupling with its sign."""
    empirical = "law" in answer["classes"] and claim.kind in EMPIRICAL
    if claim.kind == "held" and "held" in answer["accepted"]:  # one clock holds all inputs
        value, _ = claim.values["value"]
        return abs(value - answer["facts"]["hold"]) <= NEARLY * answer["facts"]["hold"]
    if not (empirical or claim.kind in answer["accepted"]) or claim.where != answer["place"]:
        return False
    true = answer.get("facts", {})
    if claim.kind in ACTUATORS:
        value, sd = claim.values["value"]
        fact = true.get(ACTUATORS[claim.kind])
        return fact is not None and abs(value - fact) <= SPAN * sd
    if claim.kind in COUPLINGS:
        key, sign = COUPLINGS[claim.kind]
        value, sd = claim.values[key]
        return "across" in true and abs(sign * value - true["across"]) <= SPAN * sd
    if "slope" in true and "slope" not in claim.values and not empirical:
        return False  # friction of one level is another law
    stated = {key: pair for key, pair in claim.values.items() if key in SHAPES and key in true}
    return all(abs(value - true[key]) <= SPAN * sd for key, (value, sd) in stated.items())


def _dated(reported: dict[str, Any], answer: dict[str, Any]) -> bool:
    """Whether a mismatch is said to begin when it does, for kinds that begin at an instant."""
    at = answer.get("facts", {}).get("at")
    changes = [one.get("change") or {} for one in reported.get("places", ())]
    times = [change["time_s"] for change in changes if change.get("kind") == "begins"]
    return at is not None and any(abs(time - at) <= SOON for time in times)


def _holds(claim: Claim, answer: dict[str, Any]) -> bool:
    """Whether a claim is true, accepted, or within 3 sd of what is true."""
    if _is_truth(claim, answer) or _is_accepted(claim, answer):
        return True
    value, sd = claim.values.get("value", (float("nan"), 0.0))
    if claim.kind == "parameter":
        name = claim.where.removeprefix("parameter ")
        true = [answer["values"].get(name, float("nan"))]
        if name == answer["place"] and "after" in answer.get("facts", {}):
            true.append(answer["facts"]["after"])
        return any(abs(value - one) <= SPAN * sd for one in true)
    if claim.kind in NEUTRAL and claim.values.keys() == {"value"}:
        return abs(value - NEUTRAL[claim.kind]) <= SPAN * sd
    return False


def _words(claim: Claim) -> str:
    values = ", ".join(f"{key} {v:.4g} ± {sd:.2g}" for key, (v, sd) in claim.values.items())
    return f"{claim.kind} at {claim.where} ({values})"
