"""``study faults`` measures which checks notice deliberate faults of the program, and in which cases."""

import argparse

import pandas as pd
from tabulate import tabulate

from manufactured.self_proof import prove
from study.cli.common import progress_bar
from study.cli.options import FAILED, OK
from study.controls.faults import FAULTS
from study.controls.matrix import measure_case
from study.fem.naming import absolute, choose, is_own, name_of, resolve
from study.ledger.datafiles import write_csv
from study.ledger.faults import in_words, missed, summary
from study.ledger.schema import TABLES
from study.ledger.text import folded
from study.run.executor import Processes
from study.run.fingerprint import of_everything, problem
from study.run.plan import COVER
from study.run.store import Store


def do_faults(options: argparse.Namespace) -> int:
    """Measure the matrix fault × case × check, write it and print which fault each case notices.

    Returns:
        0 if every fault is noticed as the rules demand, else 1.
    """
    store = Store(options.out)
    store.check()
    cases = [absolute(name) for name in options.case or COVER]
    for name in filter(is_own, cases):
        prove(resolve(name).solution, f"case {name}")
    names = [choose("fault", name, FAULTS).name for name in options.fault or [fault.name for fault in FAULTS]]
    code = f"{of_everything()} {' '.join(names)}"
    keys = {case: (f"faults__{name_of(case)}", f"{code} {problem(case)}") for case in cases}
    rows: list[dict[str, object]] = []
    with Processes(options.jobs) as executor, store.locked(), progress_bar(len(cases), f"{len(cases)} cases") as bar:
        stored = {case: store.load(*keys[case]) for case in cases}
        waiting = {case: executor.submit(measure_case, case, names) for case in cases if stored[case] is None}
        for case in cases:
            found = stored[case]
            if found is None:
                found = {"rows": waiting[case].result()}
                store.save(*keys[case], found)
            rows += found["rows"]
            bar.update()
    table = pd.DataFrame(rows, columns=list(TABLES["faults.csv"].columns))
    written = write_csv(options.out / "data" / "faults.csv", table)
    heads = {"errors": "noticed by errors", "any_check": "by any check"}
    print(f"\n{tabulate(summary(table).rename(columns=heads), 'keys', showindex=False)}\ndata: {written}")
    lacking = missed(table)
    print(folded(f"{len(names)} faults, {len(cases)} cases; not noticed as the rules demand: {in_words(lacking)}"))
    # A selection of cases need not notice every fault.
    return FAILED if lacking and not options.case else OK
