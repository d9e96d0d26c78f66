"""Old name of ``study.run.executor``, until all imports name the new one."""  # moved

from study.run.executor import Processes

__all__ = ["Processes"]
