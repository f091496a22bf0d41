"""The public recordings that are known, printed."""

from symhyb.data.catalogue import DATASETS, Dataset, named, unknown
from symhyb.data.datasets import listing
from symhyb.errors import InputError, Problem


def dataset_of(name: str) -> Dataset:
    """Find a public recording by its name.

    Raises:
        InputError: no recording is known by that name.
    """
    known = named(name)
    if known is None:
        raise InputError(Problem(unknown(name)))
    return known


def print_dataset(dataset: Dataset) -> None:
    """Print what is known of a public recording, with its addresses."""
    print(listing().split("\n\n")[DATASETS.index(dataset)])
    for file in dataset.files:
        print(f"  {file.name}: {file.address}")
        print(f"    {file.size} bytes, SHA-256 {file.sha256}")
