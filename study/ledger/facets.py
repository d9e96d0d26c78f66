"""Old name of ``study.ledger.pictures``, until all imports name the new one."""  # moved

from study.ledger.pictures import Facets

__all__ = ["Facets"]
