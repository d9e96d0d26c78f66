"""Old name of ``study.ledger.verdict``, until all imports name the new one."""  # moved

from study.ledger.verdict import agreement, used, worst

__all__ = ["agreement", "used", "worst"]
