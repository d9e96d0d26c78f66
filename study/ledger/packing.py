"""Old name of ``study.ledger.pictures``, until all imports name the new one."""  # moved

from study.ledger.pictures import FINE, STEPS, Packed, short

__all__ = ["FINE", "STEPS", "Packed", "short"]
