"""Old name of ``study.run.plan``, until all imports name the new one."""  # moved

from study.run.plan import Job

__all__ = ["Job"]
