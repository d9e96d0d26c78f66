"""Old name of ``study.ledger.text``, until all imports name the new one."""  # moved

from study.ledger.text import above, below, cell, down, interval, power_of_ten, significant, up

__all__ = ["above", "below", "cell", "down", "interval", "power_of_ten", "significant", "up"]
