"""Deliberate defects that the verdicts must catch: ``study controls``.

A verdict that cannot fail proves nothing. Each control replaces one piece of the study by a wrong one, measures and
judges with the functions of the study, and expects a named row of the ledger to fail. Without the defect every row of
the same setting must hold. No other command runs a defect.
"""
