"""Which channels are late, by how much, and which of them by one delay that they share."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace

import numpy as np

from symhyb.correction.search.trajectory import Refined
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.results import Alternative, Measurement
from symhyb.model.delays import channels_of, delay_paths, shared_delays
from symhyb.model.types import Model


def late_channels(final: Refined, doubt: Collection[Hypothesis] = ()) -> Iterator[Measurement]:
    """The delay of each channel that one of the causes delays, but those in ``doubt``: what it has
    by itself and what it shares. Those that have a shared delay alone, and the same with it, stand
    together."""
    model, causes = final.machine.model, [c for c in final.causes if c.kind == "delay"]
    claimed = [cause.path for cause in causes if cause not in doubt]
    channels = channels_of(model)
    stated = {one.name: one.delay.si for one in channels if one.delay is not None}
    groups = shared_delays(model)
    same = [path for path, names in groups.items() if len({stated[name] for name in names}) == 1]
    for channel in channels:
        paths = [path for path in delay_paths(channel) if path in claimed]
        if not paths or channel.delay is None:
            continue
        value, sd = _sum(final, paths)
        value += 0.0 if channel.delay.path in paths else channel.delay.si
        together = 1 + list(groups).index(paths[0]) if paths[0] in same else 0
        factor, unit = channel.delay.unit.factor, channel.delay.unit.text
        yield Measurement(channel.name, "delay", value / factor, sd / factor, unit, together)


def _sum(final: Refined, paths: Sequence[str]) -> tuple[float, float]:
    """The sum of fitted delays with its deviation, s."""
    own = [final.paths.index(path) for path in paths]
    variance = float(final.fit.covariance[np.ix_(own, own)].sum())
    return float(sum(final.value(path)[0] for path in paths)), float(np.sqrt(max(variance, 0.0)))


def shared_path(model: Model, channel: str) -> str:
    """The path of the delay that a channel shares; empty if it shares none."""
    return next((path for path, names in shared_delays(model).items() if channel in names), "")


def channel_by_channel(
    model: Model, alternatives: Sequence[Alternative]
) -> tuple[Alternative, ...]:
    """Alternatives in which a delay that channels share stands with each of them, together, and
    what stands instead of it instead of that of the first; ``model`` has what they share."""
    shared = shared_delays(model)
    sides = {path.removesuffix(".delay"): names for path, names in shared.items()}
    number = max((one.together for one in alternatives), default=0)
    rows: list[Alternative] = []
    for one in alternatives:
        if one.instead_of in shared:
            one = replace(one, instead_of=f"{shared[one.instead_of][0]}.delay")
        names = sides.get(one.channel or "") if one.kind == "delay" else None
        if names is None:
            rows.append(one)
            continue
        number += not one.together
        together = one.together or number
        rows += [replace(one, channel=name, together=together) for name in names]
    return tuple(rows)
