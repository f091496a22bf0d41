"""The tasks of a study, printed: what would be run, what came out, and how two studies differ."""

from collections.abc import Sequence

from rich import box
from rich.markup import escape
from rich.table import Table

from symhyb.console.terminal import table_console
from symhyb.discrepancy.words.amounts import number_text, quantity_text
from symhyb.tasks.differences import Difference, Differences, Moved
from symhyb.tasks.expand import Task
from symhyb.tasks.outcome import FAILED, FINISHED, NOT_RUN, Number, Outcome, Outcomes
from symhyb.tasks.run import Ran

MOST_FAILED = 10  # tasks whose failure is printed after a run; the table has all


def print_planned(tasks: Sequence[Task], left: int) -> None:
    """Print the tasks that would be run, and how many of them are not finished."""
    for task in tasks:
        print(f"{task.key[:12]}  {task.name}")
    print(f"{counted(len(tasks), 'task')}, {left} of them not finished")


def print_ran(ran: Ran, directory: object) -> None:
    """Print how a run ended: counts first, then what failed."""
    finished = ran.wanted - len(ran.failed)
    before = f" ({ran.before} before)" if ran.before else ""
    part = f" of {ran.total}" if ran.wanted != ran.total else ""
    print(f"{ran.wanted}{part} tasks: {finished} finished{before}, {len(ran.failed)} failed")
    for name, why in list(ran.failed.items())[:MOST_FAILED]:
        print(f"  {name}: {why}")
    if len(ran.failed) > MOST_FAILED:
        print(f"  and {len(ran.failed) - MOST_FAILED} more")
    print(f"next: symhyb results {directory}")


def print_outcomes(outcomes: Outcomes, times: bool) -> None:
    """Print a row for each task, and how many ended how."""
    console, table = table_console(), Table(box=box.SIMPLE)
    for heading in ("task", "verdict", "found", *(["seconds"] if times else [])):
        table.add_column(heading, overflow="fold")
    for one in outcomes.tasks:
        cells = [one.entry.name, one.verdict or one.state, _found(one)]
        if times:
            cells.append("" if one.seconds is None else f"{one.seconds:.1f}")
        table.add_row(*map(escape, cells))
    if outcomes.title:
        print(outcomes.title)
    with console.capture() as written:
        console.print(table)
    print("\n".join(line.rstrip() for line in written.get().rstrip().splitlines()))
    states = [one.state for one in outcomes.tasks]
    counts = (f"{states.count(state)} {state}" for state in (FINISHED, FAILED, NOT_RUN))
    print(f"\n{counted(len(states), 'task')}: {', '.join(counts)}")


def print_differences(differences: Differences, first: object, second: object) -> None:
    """Print what two studies say differently: a summary, then task by task."""
    tasks = differences.tasks
    verdicts = sum(one.verdicts is not None for one in tasks)
    names = sum(bool(one.only_first or one.only_second) for one in tasks)
    moved = [one for task in tasks for one in task.moved]
    states = sum(one.states is not None for one in tasks)
    print(f"{counted(differences.common, 'task')} of both: {len(tasks)} differ")
    print(f"  {verdicts} in the verdict, {names} in what is found, {states} in how they ended")
    far = max((one.deviations for one in moved if one.deviations is not None), default=None)
    if moved:
        most = "" if far is None else f", the farthest by {number_text(far)} deviations"
        print(f"  {counted(len(moved), 'value')} moved{most}")
    for name, only in ((first, differences.only_first), (second, differences.only_second)):
        if only:
            print(f"only in {name}: {counted(len(only), 'task')}", *only, sep="\n  ")
    for one in tasks:
        print(f"\n{one.task}", *_lines(one), sep="\n  ")


def counted(count: int, what: str) -> str:
    """A number of things."""
    return f"{count} {what}{'' if count == 1 else 's'}"


def _found(outcome: Outcome) -> str:
    if outcome.failure:
        return outcome.failure
    own = ((name, one) for name, one in outcome.found.items() if "@" not in name)
    return "; ".join(f"{name} = {_amount(one)}" for name, one in own)


def _amount(number: Number) -> str:
    return quantity_text(number.value, number.unit, number.sd)


def _lines(one: Difference) -> list[str]:
    lines = []
    if one.states is not None:
        lines.append(f"ended: {one.states[0]} -> {one.states[1]}")
    if one.verdicts is not None:
        lines.append(f"verdict: {one.verdicts[0]} -> {one.verdicts[1]}")
    lines += [f"- {name}" for name in one.only_first] + [f"+ {name}" for name in one.only_second]
    ordered = sorted(one.moved, key=lambda moved: -(moved.deviations or 0.0))
    return lines + [_moved(moved) for moved in ordered]


def _moved(one: Moved) -> str:
    by = "" if one.deviations is None else f" ({number_text(one.deviations)} deviations)"
    return f"{one.name}: {_amount(one.first)} -> {_amount(one.second)}{by}"
