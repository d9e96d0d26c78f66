"""Data files as tables of texts, and whole directories."""

import pandas as pd


def texts(path):
    """The table in a data file, with its cells as they are written."""
    return pd.read_csv(path, dtype=str, keep_default_na=False)


def everything(directory):
    """Path ↦ content of all files in a directory."""
    return {path: path.read_bytes() for path in directory.rglob("*") if path.is_file()}
