"""Copies of the committed results of a few cases, small enough to draw and to damage in a test."""

import shutil

from places import DATA
from tables import texts

TABLES = ("bounds", "cases", "claims", "enclosures", "equivalence", "rates", "stresses")
SMOOTH, ROUGH = CASES = ("advance-recede", "rough-1.75")
"""A case of Proposition 5.4 and one of Proposition 5.3."""
CORNER = "corner"
SOLID = "cube-two-faces"
"""A body in the plane and one in space, each with two contact faces."""
LEDGER = """label,statement,case,quantity,expected,observed,low,high,verdict,key,family,kind,window_low,window_high
Prop. 5.4,"‖u − u^h‖_{L∞(0,T;V)} = O(h)",advance-recede,"order, shaken, 32 → 64",1 ± 0.1,0.98765,0.95,1.02,holds,order,shaken,claim,0.9,1.1
Prop. 5.4,"‖u − u^h‖_{L∞(0,T;V)} = O(h)",advance-recede,"order, criss-cross",1 ± 0.1,0.71,0.65,0.78,fails,order,criss-cross,claim,0.9,1.1
Prop. 5.4,"‖u − u^h‖_{L∞(0,T;V)} = O(h)",two_faces,time |δ| in max_n e_n,< 5 %,0.0123,,,holds,time,,accuracy,0,0.05
"(3.1), (3.2)",m_A ε:ε ≤ Aε:ε & L_G,,"Γ3,i: eigenvalues of A, and more, and more, and more, and more, and more, and more, and more, and more, and more",≥ 2,2.0,,,undecided,least,,identity,2,inf
Thm 4.2,σ̃ ∈ Σ(t) ⇔ u̇ solves Problem 3.1,two_faces,gap,0,1.2e-09,-inf,1e-08,holds,gap,,consequence,0,0
"""  # noqa: E501
"""A ledger with every verdict, a statement without a case, and text that is hard on LaTeX and Markdown."""


def copy_results(directory, cases=CASES, pictures=(CORNER, SOLID)):
    """Writes the committed tables of some cases, and pictures of some of them, into ``directory / "data"``."""
    data = directory / "data"
    (data / "pictures").mkdir(parents=True)
    for name in TABLES:
        # Pictures are drawn of the cases in cases.csv.
        chosen = (*cases, *pictures) if name == "cases" else cases
        table = texts(DATA / f"{name}.csv")
        table[table["case"].isin([*chosen, "all cases"])].to_csv(data / f"{name}.csv", index=False)
    for case in pictures:
        shutil.copy(DATA / f"pictures/{case}.json.gz", data / "pictures")
    return directory
