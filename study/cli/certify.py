"""``study certify``: writes proofs of error bounds as files (certificates), and checks them."""

import argparse
import shlex
from functools import partial

from manufactured.body import Kind
from manufactured.static import Static
from study.bound.trajectory import Refined
from study.certify import checker
from study.certify.certified import check_certifiable, make_certificate, write
from study.cli.bound import check_levels
from study.cli.common import tell_written, with_progress
from study.cli.options import OK
from study.fem.naming import choose, family_named, resolve_data
from study.ledger.files import UsageError
from study.run.fingerprint import of_data
from study.run.store import Store
from study.solve.steps import rate_steps
from study.solve.tableau import SCHEMES


def do_certify(options: argparse.Namespace) -> int:
    """Write a certificate (proof of an error bound) for each mesh, check all; return the checker's exit code."""
    name, data, _ = resolve_data(options.problem)
    scheme, family = choose("scheme", options.scheme, SCHEMES), family_named(options.family)
    refined = Refined(options.refine, options.shorter)
    if isinstance(data, Static):
        raise UsageError(f"{name} is a static problem, for which there are no certificates: take `study bound`")
    if not data.body.of(Kind.CONTACT):
        raise UsageError(f"{name} has no contact side, for which there are no certificates: take `study bound`")
    check_certifiable(data)
    if options.refine > checker.REFINEMENTS:
        raise UsageError(f"--refine {options.refine}: a certificate allows at most {checker.REFINEMENTS} refinements")
    check_levels(options, data, family, refined)
    paths, store = [], Store(options.out / name, written=(".",))
    with store.locked():
        store.begin(of_data(data))
        for level in options.levels:
            steps = options.steps or rate_steps(data.body.T, level)
            compute = partial(make_certificate, data, family, level, scheme, steps, refined)
            found = with_progress(f"level {level}", data.body.T, compute)
            paths.append(write(store.directory / f"certificate-{level}.json.gz", found))
    tell_written(paths, "; now they are checked\n")
    code = checker.main([str(path) for path in paths])
    print(f"\nto check them without this package, with a copy of {checker.__file__}:")
    print(f"python checker.py {shlex.join(map(str, paths))}")
    return code or OK
