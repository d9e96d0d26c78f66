"""Old name of ``study.run.fingerprint``, until all imports name the new one."""  # moved

from study.run.fingerprint import ROOT

__all__ = ["ROOT"]
