"""The cases, one file per exact solution, named after it; ``manufactured.catalogue`` lists them.

The docstring of each begins with its formulas, gap w, pressure p and contact zone {ψ ≥ 0}, and then states the
predicted order with its reason. Parts that several cases share are in separate modules: materials in ``laws``, fronts
in ``advancing_front`` and ``rough_front``, the strain under the law (3.3) in ``yielding``, factors in ``constants``.
"""
