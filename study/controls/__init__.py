"""Negative controls: deliberate defects that named checks must notice; the command ``study controls``.

A verdict that cannot fail proves nothing. Each control replaces one part of the study by a wrong one, measures and
judges with the functions of the study, and expects a named check of the ledger to fail. Without the defect, every check
of the same setting must hold. Only this command, ``study sensitivity`` and runs of a user's own case use defects.
"""
