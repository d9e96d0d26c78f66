"""Negative controls: deliberate defects of the study that its checks must notice; the command ``study controls``.

Each control replaces one part of the study by a wrong one. Then the study measures and judges as usual, and one named
check must fail. Without the defect, every check on the same case and meshes must hold. Only this command, ``study
sensitivity`` and runs of a user's own case use defects.
"""
