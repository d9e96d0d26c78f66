"""Old name of ``study.ledger.compare``, until all imports name the new one."""  # moved

from study.ledger.compare import difference

__all__ = ["difference"]
