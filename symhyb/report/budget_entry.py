"""The time that a diagnosis was allowed, as ``diagnosis.json`` holds it."""

from typing_extensions import TypedDict

from symhyb.discrepancy.results import Budget


class BudgetEntry(TypedDict):
    """The time that was allowed, s, and the comparisons that were not made for want of it; where
    there are any, nothing is claimed."""

    seconds: float
    not_compared: list[str]


def budget_entry(budget: Budget | None) -> BudgetEntry | None:
    """Time and comparisons; None where no time was stated."""
    if budget is None:
        return None
    return {"seconds": budget.seconds, "not_compared": list(budget.not_compared)}
