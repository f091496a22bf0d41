"""What may be selected for a channel, and the lines that say the map elsewhere."""

import shlex
import tomllib
from pathlib import Path

from symhyb.workbench.bench import Bench, open_bench, with_column
from symhyb.workbench.mapping import channel_names, choices, map_lines


def test_every_channel_may_have_any_column(rig: dict[str, Path]) -> None:
    bench = open_bench(rig["model"], [rig["second"]])
    time, force, laser = choices(bench)
    assert channel_names(bench) == ("t", "f", "laser")
    assert (time.title, force.title, laser.title) == ("time [s]", "input f [N]", "sensor laser [m]")
    assert (time.found, force.found, laser.found) == ("t", "f", None)
    assert [one for one, _ in laser.offered] == ["", "t", "f", "way [mm]"]


def test_an_expression_of_the_command_line_stays_a_choice(bench: Bench) -> None:
    mapped = with_column(bench, "laser", "2*laser")
    laser = choices(mapped)[2]
    assert laser.chosen == "2*laser"
    assert ("2*laser", "2*laser") in laser.offered


def test_the_lines_say_the_same_map_to_a_shell_and_to_a_study(rig: dict[str, Path]) -> None:
    bench = open_bench(rig["model"], [rig["second"]])
    assert map_lines(bench) == ""
    lines = map_lines(with_column(with_column(bench, "laser", "way [mm]"), "f", "2*f")).splitlines()
    assert shlex.split(lines[1]) == ["--map", "laser=way [mm]", "--map", "f=2*f"]
    study = tomllib.loads("\n".join(lines[2:]))
    assert study == {"map": {"laser": "way [mm]", "f": "2*f"}}
    assert map_lines(with_column(with_column(bench, "laser", "f"), "laser", "")) == ""
