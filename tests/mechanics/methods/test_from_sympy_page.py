"""The example of the page is what it says."""

import re
from pathlib import Path

PAGE = (Path(__file__).parents[3] / "docs" / "from-sympy.md").read_text(encoding="utf-8")


def test_the_page_prints_what_it_shows(capsys) -> None:
    (code,) = re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL)
    (shown,) = re.findall(r"```toml\n(.*?)```", PAGE, flags=re.DOTALL)
    exec(compile(code, "from-sympy.md", "exec"), {})
    assert capsys.readouterr().out.rstrip() == shown.rstrip()
