"""Old name of ``study.ledger.text``, until all imports name the new one."""  # moved

from study.ledger.text import is_narrow, width

__all__ = ["is_narrow", "width"]
