"""Recordings of machines: read, named, converted to SI; and known public ones by name."""

from symhyb.data.catalogue import DATASETS, DataFile, Dataset
from symhyb.data.datasets import fetch, listing
from symhyb.data.recording import Recording, read_recording

__all__ = [
    "DATASETS",
    "DataFile",
    "Dataset",
    "Recording",
    "fetch",
    "listing",
    "read_recording",
]
