# ruff: noqa: E501 – every column has one line.
"""The tables of a result directory: the meaning, the unit and the empty cells of every column.

Reading, checks and the tables in ``docs/reference/columns.md`` follow from ``SCHEMA``. To add a column, add a line here,
and write the column where the rows are measured.
"""

from collections.abc import Iterator
from dataclasses import dataclass

TEXT = "text"
COUNT = "count"
"""Units of columns with text and with whole numbers. All measured quantities are dimensionless, with the unit 1."""


@dataclass(frozen=True)
class Column:
    """A column of a table.

    Attributes:
        unit: TEXT, COUNT, or 1 for a dimensionless number.
        meaning: what the cells say, in Markdown with formulas.
        empty: when a cell is empty; if this text is empty, a cell of a number always has one.
    """

    unit: str
    meaning: str
    empty: str = ""


@dataclass(frozen=True)
class Table:
    """A table in a result directory.

    Attributes:
        key: the columns that identify a measurement.
        columns: name ↦ column, in the order of the file.
        within: further columns that, together with the key, identify a row if one measurement has several rows.
        command: the command that writes the file, if it is not ``study run``.
        note: sentences about the table, in Markdown.
    """

    key: tuple[str, ...]
    columns: dict[str, Column]
    within: tuple[str, ...] = ()
    command: str = ""
    note: str = ""

    @property
    def numbers(self) -> list[str]:
        """The columns that contain numbers or empty cells."""
        return [name for name, column in self.columns.items() if column.unit != TEXT]


def columns(text: str) -> dict[str, Column]:
    """Return columns from lines NAME | UNIT | MEANING | WHEN A CELL IS EMPTY; the last part may be missing."""
    parts = [[part.strip() for part in line.split(" | ")] for line in text.strip().splitlines()]
    return {name: Column(*others) for name, *others in parts}


def markdown(name: str) -> Iterator[str]:
    """Yield the lines that describe the columns of a table in the documentation."""
    table = SCHEMA[name]
    yield f"## Columns of `{name}`\n"
    if table.note:
        yield f"{table.note}\n"
    yield "| column | unit | meaning | empty |"
    yield "|---|---|---|---|"
    for column, about in table.columns.items():
        mark = f"**`{column}`**" if column in (*table.key, *table.within) else f"`{column}`"
        yield f"| {mark} | {about.unit} | {about.meaning} | {about.empty or '–'} |"
    yield ""


UNKNOWN = "if the exact solution is unknown"
MESH_PLACE = ("case", "family", "level")
NORMS = "Norms are taken in $L^2(0,T)$ and divided by the norm of the exact quantity."
STRESS_NORMS = """Errors are root mean squares over the time steps. Errors of stresses and of the pressure are divided by the norm of σ, the
others by the norm of the exact quantity."""
SCHEMA = {
    "rates.csv": Table(
        ("case", "family", "scheme", "level"),
        columns(r"""
claim | text | the proposition that is judged with this row
case | text | the exact solution
family | text | the mesh family
scheme | text | the time scheme
dim | count | dimension of the body
level | count | number of cells along a side
h | 1 | mesh size, $(d!\,\lvert\Omega\rvert / \text{number of cells})^{1/d}$
dofs | count | number of unknowns
steps | count | number of time steps
k | 1 | length of a time step
error | 1 | maximum of $\lVert u - u^h\rVert_V$ over time
at | 1 | time of this maximum
interpolation_error | 1 | maximum of $\lVert u - \Pi^h u\rVert_V$ over time
discrete_error | 1 | maximum of $\lVert \Pi^h u - u^h\rVert_V$ over time
time_share | 1 | distance of the displacements computed with the time steps $k$ and $k/2$, divided by the error
order | 1 | observed order of `error` between this level and the level before | on the first level
interpolation_at | 1 | time of the largest interpolation error
predicted_interpolation | 1 | leading term of the interpolation error, from second derivatives of $u$
discrete_at | 1 | time of the largest discrete error
initial_error | 1 | error at $t = 0$
discrete_time_share | 1 | distance of the displacements computed with $k$ and $k/2$, divided by the discrete error
residual | 1 | largest residual of a contact solve
quadrature_change | 1 | relative change of the error if the degrees of the quadrature rules are higher by two
clamped | 1 | largest $\lvert u^h\rvert$ on Γ1 over the largest $\lvert u^h\rvert$
parallelogram | 1 | largest violation of the parallelogram law, divided by the largest $\lVert \Pi^h u - u^h\rVert_V^2$
"""),
        note=r"""The norm is $\lVert v\rVert_V = (A\varepsilon(v), \varepsilon(v))_Q^{1/2}$. Two computations have the time steps $k$ and $k/2$. The one
with $k/2$ is taken as $u^h$; maxima over time are maxima over its time steps.""",
    ),
    "claims.csv": Table(
        ("label", "key", "case", "family"),
        columns("""
label | text | the statement, as it is numbered in the paper, or a name
statement | text | what is claimed
case | text | the exact solution
quantity | text | the judged quantity in words
expected | text | the tolerance window, and the reason for it
observed | 1 | the measured value that is shown | if nothing was measured
low | 1 | the smallest of the values that are judged | if nothing was measured
high | 1 | the largest of the values that are judged | if nothing was measured
verdict | text | *holds*, *fails* or *undecided*; *reported* or *missed* if nothing is claimed
key | text | the name of one check of this statement
family | text | the mesh family | if the check concerns several families
kind | text | *claim*, *consequence*, *accuracy* or *identity*
window_low | 1 | lower end of the tolerance window | if there is no window
window_high | 1 | upper end of the tolerance window | if there is no window
"""),
    ),
    "cases.csv": Table(
        ("case",),
        columns("""
case | text | the exact solution
summary | text | contact zone and pressure, in words
dimension | count | dimension of the body
law | text | the material law
zone | text | how the contact fronts move
regularity | text | what limits the smoothness of the solution
expected_order | 1 | the predicted order of the error
proved_order | 1 | the order that is proved | if none is proved
twin | text | the case whose solution is the same in another position | if there is none
statements | text | the statements that are tested with this case
reason | text | the reason for the orders
"""),
    ),
    "equivalence.csv": Table(
        MESH_PLACE,
        columns(r"""
case | text | the exact solution
form | text | the space of discrete strains that defines Problem 3.2, always *strains of V^h*
level | count | number of cells along a side
h | 1 | mesh size
steps | count | number of time steps
displacement_gap | 1 | difference of both displacements, divided by the largest norm over time
stress_gap | 1 | difference of both stresses, divided by the largest norm over time
admissibility | 1 | violation of $\sigma \in \Sigma^h(t)$
energy_gap | 1 | violation of (4.14), $(\sigma, \varepsilon(u))_Q = (f, u)_V$, divided by the largest $\lvert (f, u)_V\rvert$
membership | 1 | violation of $u \in K^h$
displacement_bound | 1 | bound of `displacement_gap` from the duality gap of the solver
stress_bound | 1 | bound of `stress_gap` from the duality gap of the solver
family | text | the mesh family
"""),
        note="Problem 3.1 is the displacement problem, Problem 3.2 the stress problem.",
    ),
    "stresses.csv": Table(
        MESH_PLACE,
        columns(r"""
case | text | the exact solution
family | text | the mesh family
level | count | number of cells along a side
h | 1 | mesh size
steps | count | number of time steps
unknowns | count | number of unknowns of the stress problem
stress | 1 | $\lVert\sigma - \sigma^h\rVert_Q$
stress_sup | 1 | the largest of these norms over the steps, relative to the largest $\lVert\sigma\rVert_Q$
best | 1 | lower bound of `stress`: error of the best approximation of σ by stresses that are linear on each third of a cell (a cell is split at its centroid)
strain | 1 | $\lVert\varepsilon(u) - \varepsilon^h\rVert_Q$, where the material law gives $\varepsilon^h$ from $\sigma^h$
pressure | 1 | $\lVert\sigma_\nu - \sigma^h_\nu\rVert_{L^2(\Gamma_3)}$
displacement | 1 | $(\sum_T \sum_{e \subset \partial T} \frac13 \lvert T\rvert\, \text{mean}_e \lvert u - m\rvert^2)^{1/2}$, a discrete $L^2$ norm of $u - m$ over the edges $e$ of the cells $T$; $m$ is the displacement of the edges, linear on each edge, whose moments are the Lagrange multipliers of equilibrium, and $u$ is projected onto such functions
primal_stress | 1 | norm of the difference between the stresses of this problem and of Problem 5.1 with the same time steps
primal_displacement | 1 | as `displacement`, with $u^h$ of Problem 5.1 instead of $u$
admissibility | 1 | largest violation at a point, relative to the largest $\lvert\sigma^h\nu\rvert$, of $\sigma_\tau = 0$, $\sigma_\nu \le 0$, $\sigma\nu = P f_2$ (the load projected onto functions that are linear on each edge) and of the continuity of $\sigma\nu$
time_share | 1 | change of the stress when the time step $k$ is doubled, divided by `stress`
"""),
        note=STRESS_NORMS,
    ),
    "contact.csv": Table(
        MESH_PLACE,
        columns(r"""
case | text | the exact solution
family | text | the mesh family
level | count | number of cells along a side
h | 1 | mesh size
steps | count | number of time steps
pressure | 1 | $\lVert p - p^h\rVert_{L^2(\Gamma_3)}$, where $p^h$ is piecewise linear and its moments are the nodal forces
dual | 1 | dual norm: supremum of $\langle p - p^h, v_\nu\rangle/\lVert v\rVert_V$ over $V^h$
resultant | 1 | $\langle p - p^h, 1\rangle$ on each face, the error of the total force
pressure_time_share | 1 | error in time of `pressure`: relative difference with half as many time steps
dual_time_share | 1 | error in time of `dual`
resultant_time_share | 1 | error in time of `resultant`
penetration | 1 | largest $(u^h_\nu)_+$ between vertices, divided by the largest $\lvert u^h\rvert$
pulling | 1 | largest nodal force of the wrong sign, divided by the largest nodal force
clamped | count | number of pieces of Γ3 that meet Γ1; if it is not 0, the order of `resultant` is not judged
"""),
        note=NORMS,
    ),
    "recomputed.csv": Table(
        ("case", "family", "scheme", "level"),
        columns(r"""
case | text | the exact solution
family | text | the mesh family
scheme | text | the time scheme
level | count | number of cells along a side
h | 1 | mesh size
error | 1 | `error` of `rates.csv`, from other quadrature, assembly and solvers
interpolation_error | 1 | `interpolation_error` of `rates.csv`, computed in the same way
discrete_error | 1 | `discrete_error` of `rates.csv`, computed in the same way
start | 1 | relative difference between the two computations of $u^h_0$
displacement | 1 | relative difference of $u^h$, the maximum over time in $V$
multipliers | 1 | relative difference of all nodal forces
displacement_same_load | 1 | `displacement` if both computations use the same load
multipliers_same_load | 1 | `multipliers` if both computations use the same load
"""),
    ),
    "statements.csv": Table(
        ("label", *MESH_PLACE),
        columns("""
label | text | the statement, as it is numbered in the paper, or a name
case | text | the exact solution
family | text | the mesh family
level | count | number of cells along a side
h | 1 | mesh size
quantity | text | a measured quantity in words
value | 1 | its value
"""),
        ("quantity",),
    ),
    "bounds.csv": Table(
        ("trajectory", "case", "family", "scheme", "level"),
        columns(rf"""
case | text | the exact solution, or the problem
family | text | the mesh family
scheme | text | the time scheme
trajectory | text | `bound` if $\tilde u = u_h$, `enclosure` if $\tilde u$ is a more accurate displacement
level | count | number of cells along a side
h | 1 | mesh size
steps | count | number of time steps
expected_order | 1 | the predicted order of the error | if none is predicted
error | 1 | the largest error over the sampled times | {UNKNOWN}
lowest | 1 | lower end of the interval that contains the largest error
highest | 1 | upper end of this interval
above | 1 | largest quotient error / upper bound over time, at most 1 if the bounds are correct | {UNKNOWN}
below | 1 | largest quotient lower bound / error over time, at most 1 if the bounds are correct | {UNKNOWN}
upper | 1 | largest quotient upper bound / error, over the second half of the time | {UNKNOWN}
lower | 1 | smallest quotient lower bound / error, over the second half of the time | {UNKNOWN}
residual | 1 | part of the bound: integral over time of the norm of the residual of the material law
contact | 1 | part of the bound: integral over time of the work of the normal stress $\tilde\sigma_\nu$ on $\tilde u_\nu$
oscillation | 1 | part of the bound: integral over time of a bound of the work of $f - P f$, the loads minus their projection onto linear functions on cells and edges
bending | 1 | part of the bound: integral over time of the dual norm of $P f$ minus its quadratic interpolant in time
"""),
        note=r"""The bounds are computed from a displacement $\tilde u$. Let $d = \lVert\tilde u - u_h\rVert_V$, and let $y$ be the computed bound of
$\lVert u - \tilde u\rVert_V$. Then the error $\lVert u - u_h\rVert_V$ lies between $d - y$ and $d + y$. In the case *junction* the exact $f_0$ is zero,
but the computed $f_0$ has rounding errors that grow towards the singular point. There `oscillation` consists of these errors: it changes by up to 10 %
from processor to processor, which changes the upper bound by about 10⁻⁵ of its value.""",
    ),
    "enclosures.csv": Table(
        ("trajectory", "case", "family", "scheme", "level"),
        columns(rf"""
trajectory | text | as in `bounds.csv`
case | text | the exact solution, or the problem
family | text | the mesh family
scheme | text | the time scheme
level | count | number of cells along a side
time | 1 | the time
error | 1 | the error at this time | {UNKNOWN}
distance | 1 | $d = \lVert\tilde u - u_h\rVert_V$ at this time
bound | 1 | $y$ at this time, the computed bound of $\lVert u - \tilde u\rVert_V$
"""),
        ("time",),
    ),
    "faults.csv": Table(
        ("fault", "size", "case"),
        columns("""
equation | text | the equation or condition of the paper that the fault violates
fault | text | the deliberate fault
size | 1 | its size δ
single | count | 1 if the fault concerns only single vertices or cells, or only contact forces, so that orders need not notice it; otherwise 0
case | text | the exact solution
dim | count | dimension of the body
distance | 1 | maximum over time of the distance between the discrete solutions with and without the fault, in the energy norm, on the finest level; infinite if the faulty problem cannot be solved | if the faulty space has other unknowns
error | 1 | the error without the fault on the finest level
by_error | text | the checks of the order and size of the error that fail with the fault
by_others | text | the other checks that fail
"""),
        command="study faults",
    ),
    "seeds.csv": Table(
        ("seed",),
        columns("""
seed | count | the number from which the random meshes are computed
rules | text | hash of quantities, tolerance windows and levels; a seed counts only if its hash is the hash of the seed that was judged last
judged | count | the number of checks that were judged; −1 while the seed is measured
alarms | count | the number of these checks that did not hold; −1 while the seed is measured
"""),
        command="study seeds",
        note="The rows stand in the order in which the seeds were drawn.",
    ),
    "codes/classes.csv": Table(
        ("series",),
        columns("""
series | count | number of the series: a code with fixed parameters on the meshes of one case and mesh family
code | text | the code
version | text | its version
variant | text | its parameters
case | text | the exact solution
family | text | the mesh family
class | text | how well the code solves the problem, or *not expressed*
order_in_v | 1 | observed order of the error of the displacement in $V$ | with one mesh
order_of_distance | 1 | observed order of the column `distance` of `codes/errors.csv` | with one mesh
order_of_pressure | 1 | observed order of the error of the contact pressure | with one mesh
invariance | 1 | all loads are multiplied by ten and the displacement is divided by ten: its change in $V$, divided by the discretisation error | if it was not measured
reason | text | why the code cannot express the problem | if it can
"""),
        command="make codes",
    ),
    "codes/errors.csv": Table(
        ("series", "level"),
        columns(r"""
series | count | number of the series in `codes/classes.csv`
level | count | number of cells along a side
h | 1 | mesh size
error | 1 | $\lVert u - u^h\rVert_V$ of the displacement of the code
best | 1 | $\lVert u - u^h\rVert_V$ of the discrete contact solution, the finite-element solution with exact contact constraints at the vertices
discrete | 1 | $\lVert \Pi^h u - u^h\rVert_V$ of the displacement of the code
distance | 1 | distance of the displacement of the code from the discrete contact solution, in $V$
pressure | 1 | error $\lVert p - p^h\rVert_{L^2(\Gamma_3)}$ of the contact pressure of the code, divided by the largest $\lVert p\rVert$
best_pressure | 1 | this error of the contact pressure of the discrete contact solution
penetration | 1 | largest penetration
resultant | 1 | error of the total contact force
tangential | 1 | largest tangential contact force
solves | 1 | number of linear systems that were solved | if the code does not tell
"""),
        command="make codes",
    ),
}
"""Name of a file, in the folder ``data`` if it has no other ↦ its table."""
TEXT_COLUMNS = {name for table in SCHEMA.values() for name, column in table.columns.items() if column.unit == TEXT}
"""Columns that hold text in some table, even if a cell looks like a number or is empty. None holds numbers in another."""
