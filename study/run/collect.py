"""Old name of ``study.run.results``, until all imports name the new one."""  # moved

from study.run.results import data_files

__all__ = ["data_files"]
