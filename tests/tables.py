"""Data files as tables of texts."""

import pandas as pd


def texts(path):
    """The table in a data file, with its cells as they are written."""
    return pd.read_csv(path, dtype=str, keep_default_na=False)
