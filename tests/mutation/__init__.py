"""Small mistakes in the code that measures and judges, one at a time: which of them would nobody notice?"""
