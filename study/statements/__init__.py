"""The numbered statements that are measured one by one, in the source's order; orders of convergence are in ``claims``."""
