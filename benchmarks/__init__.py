"""Benchmarks: how much a contact step, a level and its growth cost, and what others take. No verdict rests on them."""
