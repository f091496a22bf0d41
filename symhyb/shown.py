"""What a notebook shows of a value: a short card of HTML, escaped, without scripts."""

from collections.abc import Iterable, Sequence
from html import escape

from symhyb.errors import visible

MOST_ROWS, MOST_LETTERS = 30, 300  # of a table; of a cell or a sentence
_CELL = "text-align:left;padding:0 1em 0 0;"


def card(
    title: str,
    text: str = "",
    head: Sequence[str] = (),
    rows: Iterable[Sequence[object]] = (),
    notes: Sequence[str] = (),
    more: str = "",
) -> str:
    """A card with a title, a sentence, a table and notes that unfold; ``more`` is HTML that goes
    below, another card."""
    listed = list(rows)
    parts = ['<div style="max-width:60em">', f"<strong>{safe(title)}</strong>"]
    parts += [f"<p>{safe(text)}</p>"] if text else []
    if listed:
        parts.append("<table><thead><tr>")
        parts += [f'<th style="{_CELL}">{safe(cell)}</th>' for cell in head]
        parts.append("</tr></thead><tbody>")
        parts += [_row(row) for row in listed[:MOST_ROWS]]
        parts.append("</tbody></table>")
        if len(listed) > MOST_ROWS:
            parts.append(f"<p>… and {len(listed) - MOST_ROWS} more</p>")
    if notes:
        listed_notes = "".join(f"<li>{safe(note)}</li>" for note in notes[:MOST_ROWS])
        parts.append(
            f"<details><summary>{len(notes)} note{'s' * (len(notes) > 1)}</summary>"
            f"<ul>{listed_notes}</ul></details>"
        )
    return "".join([*parts, more, "</div>"])


def safe(text: object) -> str:
    """A text as HTML that shows it and obeys nothing in it, cut where it is long."""
    plain = visible(str(text))
    return escape(plain if len(plain) <= MOST_LETTERS else f"{plain[: MOST_LETTERS - 1]}…")


def counted(noun: str, names: Sequence[str], most: int = 6) -> str:
    """Say how many there are and which: ``2 sensors (laser, accel)``, ``no input``."""
    if not names:
        return f"no {noun}"
    plural = f"{noun[:-1]}ies" if noun.endswith("dy") else f"{noun}s"
    listed = ", ".join(names[:most]) + (", …" if len(names) > most else "")
    return f"{len(names)} {noun if len(names) == 1 else plural} ({listed})"


def _row(cells: Sequence[object]) -> str:
    return "<tr>" + "".join(f'<td style="{_CELL}">{safe(cell)}</td>' for cell in cells) + "</tr>"
