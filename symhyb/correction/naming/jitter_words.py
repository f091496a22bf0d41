"""What is said of the clock of a sensor."""

from symhyb.correction.adequacy.clock_jitter import Jitter
from symhyb.discrepancy.words.wording import quantity_text


def jitter_sentence(one: Jitter) -> str:
    """How far off the times of a sensor are, and what that does."""
    time = quantity_text(one.time_s, "s", digits=2)
    return (
        f"The noise of {one.sensor} grows with its rate, as if its samples were taken {time} (one "
        "standard deviation) beside their time stamps: its clock jitters."
    )
