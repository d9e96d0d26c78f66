"""Deliberate defects that the verdicts must catch: ``study controls``.

A verdict that cannot fail says nothing. Each control measures with one wrong piece, judges with the functions of
the study, and expects a named row of the ledger to fail; without the defect every row of the same setting must hold.
No other command reaches a defect.
"""
