"""What is in a recording, printed and as plain values."""

from collections.abc import Iterator
from math import log10
from typing import Any

from symhyb.console.sparkline import sparkline
from symhyb.console.terminal import table_console
from symhyb.data.look import Look, Signal
from symhyb.discrepancy.words.amounts import joined, number_text, percent_text, quantity_text
from symhyb.looking import Seen

NARROW, WIDEST = 24, 60  # letters of a picture
MARGIN = 4
NAMED = 3  # gaps and rests that are listed
VISIBLE = 1e-7  # of the deviation of a channel: less is rounding


def print_look(seen: Seen) -> None:
    """Print what is in a recording: time first, then each channel with a small picture, then what
    was noticed, and the first checks against a model if there is one."""
    look = seen.look
    print(f"{look.name}: {time_sentence(look)}")
    for sentence in gap_sentences(look):
        print(f"  {sentence}")
    width = min(max(table_console().width - 2 * MARGIN, NARROW), WIDEST)
    for one in look.signals:
        print(f"\n  {one.name}{f' [{one.unit}]' if one.unit else ' (no unit stated)'}")
        for row in sparkline(one.values, width):
            print(" " * MARGIN + row)
        for sentence in signal_sentences(one, look):
            print(" " * MARGIN + sentence)
    notes = [*look.notes, *seen.left]
    if notes:
        print("\nNoticed:", *(f"  {note}" for note in notes), sep="\n")
    if seen.checks is not None:
        from symhyb.console.comparison import print_first_checks

        print("\nAgainst the model:")
        print_first_checks(seen.checks)


def signal_sentences(one: Signal, look: Look) -> Iterator[str]:
    """Say what one channel shows, a line each."""
    if one.low == one.high:
        yield f"constant at {_amount(one, one.low)}"
        return
    yield (
        f"{number_text(one.low)} … {_amount(one, one.high)},"
        f" mean {number_text(_rounded(one.mean, one))}, deviation {number_text(one.deviation)}"
    )
    facts = []
    if abs(one.rate * look.step - 1) > 0.1:
        facts.append(f"{number_text(one.rate)} Hz")
    if one.missing:
        facts.append(f"{one.missing} of {one.values.size} samples missing")
    if one.noise is not None and one.noise > VISIBLE * one.deviation:
        facts.append(f"noise at most {_amount(one, one.noise, 2)} (white)")
    if one.grain is not None:
        facts.append(f"steps of {_amount(one, one.grain)}")
    if facts:
        yield "; ".join(facts)
    if one.rest:
        length = sum(end - start for start, end in one.rest)
        first = ", ".join(f"{a:.4g} … {b:.4g} s" for a, b in one.rest[:NAMED])
        more = f" and {len(one.rest) - NAMED} more" if len(one.rest) > NAMED else ""
        share = length / float(look.t[-1] - look.t[0])
        yield f"at rest for {percent_text(min(share, 1.0))} of the time: {first}{more}"
    if one.peaks:
        said = [
            f"{number_text(p.frequency, digits=3)} Hz ({percent_text(p.share)})" for p in one.peaks
        ]
        yield f"frequencies that stand out: {joined(said)} of its variance"


def look_facts(seen: Seen) -> dict[str, Any]:
    """Give what is in a recording as plain values, channels in their own units; with a model the
    first checks as ``compare`` gives them."""
    look, checked = seen.look, {}
    if seen.checks is not None:
        from symhyb.console.comparison import check_facts

        checked = {"first_checks": check_facts(seen.checks)}
    return {
        "recording": look.name,
        "samples": look.t.size,
        "span": [float(look.t[0]), float(look.t[-1])],
        "step": look.step,
        "jitter": look.jitter,
        "gaps": [list(gap) for gap in look.gaps],
        "channels": {
            one.name: {
                "unit": one.unit or None,
                "low": one.low,
                "high": one.high,
                "mean": one.mean,
                "deviation": one.deviation,
                "missing": one.missing,
                "rate": one.rate,
                "noise": one.noise,
                "grain": one.grain,
                "rest": [list(span) for span in one.rest],
                "peaks": [{"frequency": p.frequency, "share": p.share} for p in one.peaks],
            }
            for one in look.signals
        },
        "notes": [*look.notes, *seen.left],
        **checked,
    }


def _rounded(value: float, one: Signal) -> float:
    """A value that is no more than rounding beside its channel is 0."""
    return 0.0 if abs(value) < 1e-9 * max(abs(one.low), abs(one.high)) else value


def time_sentence(look: Look) -> str:
    """Say how many samples there are, when, and at what rate."""
    first, last = _moment(look, look.t[0]), _moment(look, look.t[-1])
    span = f"{look.t.size} samples from {first} to {last} s"
    rate = f"{number_text(1 / look.step)} Hz"
    if look.even:
        return f"{span}, {rate}, evenly sampled"
    return f"{span}, about {rate}; steps differ by {percent_text(look.jitter)}"


def _moment(look: Look, time: float) -> str:
    """A time in s, with so many digits that six count within the recording: seconds since 1970
    are large beside it."""
    lasting = float(look.t[-1] - look.t[0])
    largest = max(abs(float(look.t[0])), abs(float(look.t[-1])))
    more = int(log10(largest / lasting)) if lasting > 0 and largest > lasting else 0
    return f"{time:.{6 + more}g}"


def gap_sentences(look: Look) -> Iterator[str]:
    """Say where gaps in time are, if there are any."""
    if look.gaps:
        first = ", ".join(
            f"{_moment(look, a)} … {_moment(look, b)} s" for a, b in look.gaps[:NAMED]
        )
        more = f" and {len(look.gaps) - NAMED} more" if len(look.gaps) > NAMED else ""
        yield f"gaps in time: {first}{more}"


def _amount(one: Signal, value: float, digits: int = 4) -> str:
    return quantity_text(value, one.unit or "1", digits=digits)
