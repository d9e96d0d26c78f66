"""Old name of ``study.run.tasks``, until all imports name the new one."""  # moved

from study.run.tasks import plain, write_task

__all__ = ["plain", "write_task"]
