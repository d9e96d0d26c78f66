"""Negative controls: deliberate defects that named criteria must notice; the command ``study controls``.

A verdict that cannot fail proves nothing. Each control replaces one part of the study by a wrong one, measures and
judges with the functions of the study, and expects a named check of the ledger to fail. Without the defect every check
of the same setting must hold. No other command runs a defect.
"""
