"""Writes a table, given by the names of its columns and a list of cells for each mesh, as programs print tables."""


def joined(sign):
    return lambda cells: "\n".join(sign.join(row) for row in cells)


def markdown(cells):
    header, *rows = cells
    return "\n".join(f"| {' | '.join(row)} |" for row in [header, ["---"] * len(header), *rows])


def aligned(cells):
    return joined("  ")([[cell.rjust(12) for cell in row] for row in cells])


def pairs(cells):
    header, *rows = cells
    return "\n".join(f"{name} = {cell}" for row in rows for name, cell in zip(header, row, strict=True))


def lists(cells):
    return "\n".join(f"{name} = [{', '.join(column)}]" for name, *column in zip(*cells, strict=True))


def latex(cells):
    return "\n".join(" & ".join(row) + r" \\" for row in cells)


def across(cells):
    return "\n".join("  ".join(column) for column in zip(*cells, strict=True))


FORMS = [markdown, aligned, pairs, lists, latex, across, *map(joined, (",", ";", "\t", " "))]
