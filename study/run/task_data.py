"""Old name of ``study.run.tasks``, until all imports name the new one."""  # moved

from study.run.tasks import frozen, march, with_foundation

__all__ = ["frozen", "march", "with_foundation"]
