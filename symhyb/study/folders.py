"""Which files a study may name: its own folder and its project, nothing else of the machine.

A study comes from a stranger like any other file. What it names is read, and what is wrong with
it is reported, so a name that leads elsewhere is refused before anything is opened or listed.
"""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from symhyb.data.files.bag_file import files_of_bag
from symhyb.data.files.formats import files_of
from symhyb.errors import InputError, did_you_mean
from symhyb.model.tables import shorten

MARKS = (".git", "pyproject.toml")
"""What the folder of a project holds."""


@dataclass(frozen=True, slots=True)
class Folders:
    """The folder ``home`` of a study, from which its names lead, and the ``allowed`` ones."""

    home: Path
    allowed: tuple[Path, ...]

    def path(self, name: str) -> Path:
        """The file that a name in the study means, as the working directory sees it.

        Raises:
            ValueError: it is no name of a file, there is none, or it lies in no allowed folder;
                the message says which and how to mend it.
        """
        if "\0" in name:
            raise ValueError("is no name of a file")
        path, said = Path(os.path.normpath(self.home / name)), shorten(name)
        try:
            for file in files_of(path):
                self._require(file, said)
                inside = files_of_bag(file) if file.is_dir() else ()
                for one in inside:
                    self._require(one, said)
                if not inside and not file.is_file():
                    raise ValueError(f"there is no file '{said}'{self._near(path)}")
        except InputError as error:
            raise ValueError(error.problems[0].text) from None
        except OSError as error:
            raise ValueError(f"'{said}' cannot be a file: {error.strerror}") from None
        return path

    def holds(self, folder: Path) -> bool:
        """Whether a folder that a name in the study means is one of the allowed, or below one."""
        return self._holds(self.home / folder)

    def _require(self, path: Path, said: str) -> None:
        if not self._holds(path):
            raise ValueError(
                f"'{said}' lies outside of the study's folder and project, and is not looked"
                " at; move it there, or allow its folder with --within FOLDER"
            )

    def _holds(self, path: Path) -> bool:
        real = Path(os.path.realpath(path))
        return any(real.is_relative_to(folder) for folder in self.allowed)

    def _near(self, path: Path) -> str:
        around = path.parent
        beside = around.iterdir() if around.is_dir() and self._holds(around) else ()
        return did_you_mean(path.name, sorted(other.name for other in beside))


def folders_of(study: Path, within: Sequence[str | os.PathLike[str]] = ()) -> Folders:
    """The folders whose files ``study`` may name: that of the study, that of the project (the
    nearest folder above it that holds one of ``MARKS``), and those ``within``."""
    home = Path(os.path.realpath(study.parent))
    own = os.path.expanduser("~")  # stays as it is where nobody knows the home folder
    nobody = {Path(home.anchor), Path(os.path.realpath(own))}
    above = (folder for folder in (home, *home.parents) if folder not in nobody)
    project = next((one for one in above if any((one / mark).exists() for mark in MARKS)), home)
    asked = (Path(os.path.realpath(folder)) for folder in within)
    return Folders(study.parent, tuple(dict.fromkeys((home, project, *asked))))
