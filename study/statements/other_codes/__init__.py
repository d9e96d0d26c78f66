"""Other people's codes on the exact solutions: the tasks they are given, and whether their errors are ours.

``tasks`` states the problems, ``judge`` measures the errors of this study on them and compares.
"""
