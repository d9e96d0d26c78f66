"""Old name of ``study.ledger.files``, until all imports name the new one."""  # moved

from study.ledger.files import UsageError

__all__ = ["UsageError"]
