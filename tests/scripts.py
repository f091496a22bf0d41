"""The scripts of a study as modules: they lie beside each other and import one another by name."""

import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from types import ModuleType

STUDIES = Path(__file__).parents[1] / "studies"


@contextmanager
def scripts(study: str, names: Sequence[str]) -> Iterator[Mapping[str, ModuleType]]:
    """The scripts ``names`` of a folder of studies, by name; afterwards no script of any study is a
    module, and what had one of these names before has it again."""
    path = list(sys.path)
    before = {name: sys.modules.pop(name) for name in names if name in sys.modules}
    sys.path.insert(0, str(STUDIES / study))
    try:
        yield {name: import_module(name) for name in names}
    finally:
        sys.path[:] = path
        for name, module in list(sys.modules.items()):
            file = getattr(module, "__file__", None)
            if file and Path(file).is_relative_to(STUDIES):
                del sys.modules[name]
        sys.modules.update(before)
