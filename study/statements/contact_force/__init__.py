"""The contact force itself: −σ^h_ν against p on Γ3, and u^h_ν between the vertices.

A rate in V hardly weighs contact: where all of Γ3 is pressed down a multiplier that is wrong by a fifth leaves u^h as
it is, and penalty methods that stagnate pass. Beside Proposition 5.4, which says nothing of it, the force has orders of
its own. ``measure`` has the quantities, ``judge`` predicts their orders.
"""
