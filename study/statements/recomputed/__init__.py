"""The numbers of ``rates.csv`` and Problem 5.1 itself, computed once more in another way.

Relations between reported errors are loose: an error that is wrong by five per cent has the same order. ``plain``
solves the same discrete problems by other means, ``measure`` puts both trajectories side by side, ``judge`` compares
its errors with those that stand in ``rates.csv``. Between trajectories a defect of the load, of a modulus, of the start
or of the time steps is seen at first order, not in its square as an error would show it.
"""
