"""Answers that nobody reads by chance."""

import base64
import json
from pathlib import Path
from typing import Any


def seal(values: dict[str, Any]) -> str:
    """Encode each value, so that nobody reads the answer by chance."""
    encoded = {k: base64.b64encode(json.dumps(v).encode()).decode() for k, v in values.items()}
    return json.dumps(encoded, indent=1) + "\n"


def unseal(path: Path) -> dict[str, Any]:
    """Open a sealed answer."""
    sealed = json.loads(path.read_text(encoding="ascii"))
    return {key: json.loads(base64.b64decode(value)) for key, value in sealed.items()}
