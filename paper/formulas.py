"""Write the formulas of every exact solution as LaTeX, for the supplement: ``python paper/formulas.py FILE``.

The formulas come from the objects that the study computes with; nothing is typed.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import sympy as sp
from sympy.printing.latex import LatexPrinter

from manufactured import (
    Body,
    Case,
    Combined,
    ContactFace,
    KelvinVoigt,
    Kind,
    Prescribed,
    SingularField,
    Yield,
    catalogue,
)
from manufactured.exact import ExactSolution, Face
from manufactured.factor import UNIFORM
from manufactured.profile import HERMITE, ZERO, Piecewise, Profile
from study.present.templates import prose

y = sp.Symbol("y")
STANDARD = (
    r"the polygon \((0,0), (1,0), (1,1), (0,1)\); "
    r"\(\Gamma_1\): \((1,1)\)--\((0,1)\); \(\Gamma_3\): \((0,0)\)--\((1,0)\)"
)
"""The unit square, clamped on top, in contact at the bottom."""


class Printer(LatexPrinter):
    """Print truncated powers as (x)_+^a, and numbers that are not rational with six digits."""

    def _print_pos(self, expr: sp.Expr, exp: str | None = None) -> str:
        base, power = expr.args
        shown = rf"({self._print(base)})_+" + ("" if power == 1 else f"^{{{self._print(power)}}}")
        return shown if exp is None else f"({shown})^{{{exp}}}"


def formula(value: object) -> str:
    """Return LaTeX of a formula or a number, without the fixed sizes of parentheses that forbid line breaks."""
    found = sp.sympify(value)
    found = found.xreplace({number: rational(number) for number in found.atoms(sp.Float)})
    text = Printer({"fold_short_frac": True, "mul_symbol": None}).doprint(found)
    return text.replace(r"\left", "").replace(r"\right", "")


def rational(number: sp.Float) -> sp.Expr:
    """Return the fraction with a small denominator that equals a number up to rounding, or six of its digits."""
    near = sp.nsimplify(number, rational=True, tolerance=1e-13)
    return near if abs(near - number) <= 1e-12 * abs(number) and near.q <= 2000 else sp.Float(number, 6)


def point(x: object) -> str:
    return "(" + ",".join(formula(float(value)) for value in np.asarray(x)) + ")"


def body(of: Body) -> str:
    """Return the vertices of the parts of the boundary, by their kinds, and the final time."""
    kinds = {Kind.CLAMPED: r"\Gamma_1", Kind.LOADED: r"\Gamma_2", Kind.CONTACT: r"\Gamma_3"}
    if of.dim == 3:
        ends = of.vertices.min(axis=1), of.vertices.max(axis=1)
        parts = [f"the box from \\({point(ends[0])}\\) to \\({point(ends[1])}\\)"]
        place = lambda part: f"outward normal \\({point(part.normal)}\\)"  # noqa: E731
    else:
        parts = [f"the polygon \\({', '.join(map(point, of.vertices.T))}\\)"]
        place = lambda part: f"\\({point(part.corners[:, 0])}\\)--\\({point(part.corners[:, 1])}\\)"  # noqa: E731
    for kind, name in kinds.items():
        if kind is not Kind.LOADED and of.of(kind):
            parts.append(f"\\({name}\\): " + ", ".join(map(place, of.of(kind))))
    text = "; ".join(parts)
    return ("standard body" if text == STANDARD else text) + (f"; \\(T={formula(of.T)}\\)" if of.T != 1 else "")


def matrix(entries: np.ndarray) -> str:
    """Return an isotropic tensor by Lamé's constants, another one by its matrix in Mandel's components."""
    lam, mu = float(entries[0, 1]), float(entries[-1, -1]) / 2
    d = {3: 2, 6: 3}[len(entries)]
    normal = np.zeros_like(entries)
    normal[:d, :d] = lam
    if np.allclose(entries, 2 * mu * np.eye(len(entries)) + normal, atol=1e-13):
        tau, trace = sp.Symbol(r"\tau"), sp.Symbol(r"(\operatorname{tr}\tau)I")
        return r"\tau\mapsto " + " + ".join(
            formula(rational(sp.Float(factor)) * of) for factor, of in ((2 * mu, tau), (lam, trace)) if factor
        ).replace("+ - ", "- ")
    if np.count_nonzero(entries - np.diag(np.diag(entries))) == 0:
        return rf"\operatorname{{diag}}{point(np.diag(entries))}"
    return matrix_of(entries)


def law(of: KelvinVoigt) -> str:
    """Return the two operators of a law."""
    found = [rf"\(\A={matrix(of.A.matrix)}\)" if of.A.factor is UNIFORM else factored("A", of.A)]
    elastic = of.G
    if isinstance(elastic, Yield):
        found.append(rf"\(\G\varepsilon={projected(elastic)}\)")
    elif isinstance(elastic, Combined):
        stress = point(elastic.prestress)
        found.append(
            rf"\(\G\varepsilon=S+C\varepsilon+{projected(elastic.yielding)}\), \(S={stress}\), "
            rf"\(C={matrix(elastic.linear.matrix)}\)"
        )
    else:
        found.append(rf"\(\G={matrix(elastic.matrix)}\)" if elastic.factor is UNIFORM else factored("G", elastic))
    return ", ".join(found)


def factored(name: str, operator: object) -> str:
    """Return an operator that varies in space: a factor times a tensor."""
    return rf"\(\{name}=\alpha(x)\,[{matrix(operator.matrix)}]\), \(\alpha={formula(operator.factor.formula)}\)"


def projected(operator: Yield) -> str:
    """Return the law (3.3) with its convex set."""
    deviatoric = not np.allclose(operator.convex.projector, np.eye(len(operator.convex.projector)))
    inside = r"|\operatorname{dev}\tau|" if deviatoric else r"|\tau|"
    constant, radius = formula(operator.beta), formula(operator.convex.radius)
    return rf"{constant}\,(\varepsilon-P\varepsilon)\) with \(P\) onto \(\{{{inside}\le {radius}\}}"


def piecewise(of: Piecewise) -> str:
    """Return a piecewise polynomial of the depth y."""
    pieces = [formula(sum(rational(sp.Float(c)) * y**k for k, c in enumerate(piece))) for piece in of.pieces]
    if len(pieces) == 1:
        return f"{pieces[0]}"
    starts = (0.0, *of.ends)
    shown = [rf"{text}\ (y\in[{formula(a)},{formula(b)}])" for text, a, b in zip(pieces, starts, of.ends, strict=False)]
    return r",\ ".join(shown)


def profile(of: Profile) -> str:
    """Return φ of the lifting, or all functions of the depth where the lifting has another form."""
    usual = of.e is ZERO and of.c == of.d and len(of.b.pieces) == 1
    usual = usual and np.allclose(of.d.pieces[0], (0.0, *of.b.pieces[0])[: len(of.d.pieces[0])])
    if usual and len(of.d.pieces[0]) == len(of.b.pieces[0]) + 1:
        if of.b.pieces == (HERMITE,) and of.depth == 1:
            return r"\(\varphi=\varphi_0\)"
        return rf"\(\varphi={piecewise(of.b)}\) for \(y\le {formula(of.depth)}\)"
    names = "abcdef"
    shown = "; ".join(rf"\({name}={piecewise(getattr(of, name))}\)" for name in names if getattr(of, name) is not ZERO)
    return rf"\(u_s=a\nabla_sw+e\nabla_sq+cr+fz\), \(u_n=bw+dq\) with {shown}"


def face(of: Face) -> Iterator[str]:
    """Yield the contact data of one piece of Γ3."""
    yield rf"\(w={formula(of.gap)}\)"
    if of.initial_gap != 0:
        yield rf"initial gap \(g={formula(of.initial_gap)}\)"
    for number, z in enumerate(getattr(of, "slip", ()), start=1):
        yield rf"slip \(z_{number}={formula(z)}\)"
    strain = getattr(of, "strain", None)
    if isinstance(strain, Prescribed):
        begin = 0.0
        for end, q in strain.phases:
            yield rf"\(q={formula(q)}\) for \({formula(begin)}\le t\le {formula(end)}\)"
            begin = end
        yield r"\(p\) from \eqref{eq:memory}"
    else:
        yield rf"\(p={formula(of.pressure if strain is None else strain.pressure)}\)"
        initial = getattr(strain, "initial", None)
        if initial is not None:
            yield rf"\(q_0={formula(initial)}\)"
    if isinstance(of, ContactFace):
        yield profile(of.profile)
    else:
        yield singular(of.field)


def singular(of: SingularField) -> str:
    """Return a singular field by its monomials."""
    sums = []
    for name, terms in (("1", of.x), ("2", of.y)):
        shown = [
            ("y\\," if term.m else "") + rf"({formula(sp.sympify(complex(term.c)))})\,z^{{{formula(term.beta)}}}"
            for term in terms
            if term.c
        ]
        sums.append(rf"U_{name}=\operatorname{{Re}}[{'+'.join(shown)}]")
    axes = "" if np.allclose(of.frame, np.eye(2)) else rf", axes \({matrix_of(of.frame)}\)"
    cut = r"\(\chi=1\)"
    if of.radial is not None:
        cut = rf"\(\chi={piecewise(of.radial).replace('y', 'r')}\) for \(r\le {formula(of.radial.ends[-1])}\)"
    elif of.depth is not None:
        cut = rf"\(\chi={piecewise(of.depth)}\) for \(y\le {formula(of.depth.ends[-1])}\)"
    return (
        rf"\(u=\theta\chi U\) about \({point(of.centre)}\){axes}, \(z=x+\mathrm iy\), "
        rf"\(\theta={formula(of.theta)}\), \({sums[0]}\), \({sums[1]}\), {cut}"
    )


def matrix_of(entries: np.ndarray) -> str:
    rows = [" & ".join(formula(float(x)) for x in row) for row in entries]
    return r"\bigl(\begin{smallmatrix}" + r"\\".join(rows) + r"\end{smallmatrix}\bigr)"


def described(case: Case) -> str:
    """Return the paragraph of one case."""
    solution: ExactSolution = case.solution
    pieces = []
    for number, one in enumerate(solution.faces, start=1):
        name = f"face {number}: " if len(solution.faces) > 1 else ""
        pieces.append(name + "; ".join(face(one)))
    pieces += [f"added: {singular(one)}" for one in solution.others]
    text = ". ".join([body(solution.body), law(solution.law), *pieces])
    return rf"\par\smallskip\noindent\textbf{{{prose(case.name)}}}: {text}."


def written() -> str:
    """Return the paragraphs of all cases of the catalogue."""
    return "\n".join(["% Written by paper/formulas.py from the catalogue.", *map(described, catalogue()), ""])


if __name__ == "__main__":
    path = Path(sys.argv[1])
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(written(), encoding="utf-8")
