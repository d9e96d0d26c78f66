"""Executing jobs: any executor, largest first, within memory, and what becomes of jobs that fail or are killed."""

from __future__ import annotations

import multiprocessing
import os
import pickle
import random
import re
import signal
import socket
import subprocess
import sys
import time
import weakref
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, Executor, Future
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from threading import Thread, Timer

import psutil
import pytest
from commands import study
from costly_cases import slow
from distributed import LocalCluster
from tables import everything

from manufactured.self_proof import Finding, SelfProofError
from study.bound.trajectory import Refined
from study.cli import run as run_command
from study.ledger.files import StoreError, UsageError
from study.run.executor import (
    GIB,
    JobsError,
    Pool,
    Processes,
    available,
    connected,
    execute,
    identity,
    local_pool,
    next_job,
    prove,
    run_job,
    save_proofs,
)
from study.run.fingerprint import versions
from study.run.judgement import collect
from study.run.plan import Job, Plan, quick
from study.run.store import Store
from study.statements.enclosure import BoundSetting, EnclosedError
from study.statements.prop_5_4 import FirstOrder, RateSetting
from study.statements.shared.base import Setting
from study.statements.shared.scope import Levels
from study.statements.thm_4_2 import OwnSpace, SameMesh


def ignore(job): ...


def pool(executor, workers=2, together=64 * GIB):
    return Pool([executor] * workers, together, together)


def computed(scope, directory, jobs_of):
    """The data files of a study by their names."""
    plan = Plan.of(scope)
    store = Store(directory)
    execute(plan.jobs, store, jobs_of, ignore)
    collect(plan, store)
    return {str(path.relative_to(directory)): content for path, content in everything(directory).items()}


@pytest.fixture
def store(tmp_path):
    return Store(tmp_path)


class AtOnce(Executor):
    """Runs what is submitted then and there, and remembers the order."""

    def __init__(self):
        self.order = []

    def submit(self, function, /, *args, **kwargs):
        future = Future()
        self.order += args
        try:
            future.set_result(function(*args, **kwargs))
        except Exception as error:
            future.set_exception(error)
        return future


@dataclass(frozen=True)
class Toy:
    name: str
    cost: float = 1.0
    memory: float = 0.0
    deed: Callable[[], object] = bool
    case: str = ""

    @property
    def key(self):
        return self.name

    def fingerprint(self):
        return self.name

    def run(self):
        return {"done": self.deed()}


def test_the_most_expensive_jobs_go_first(store):
    executor = AtOnce()
    jobs = [Toy("a", 1), Toy("b", 3), Toy("c", 2)]
    execute(jobs, store, pool(executor, workers=1), ignore)
    assert [job.name for job in executor.order] == ["b", "c", "a"]


class Circular:
    """A job that refers to what it made from what it made."""

    def run(self):
        self.made = weakref.ref(made := Circular())
        made.itself = made
        return {}


def test_a_large_process_does_not_keep_what_a_job_leaves_in_circles_of_references(monkeypatch):
    monkeypatch.setattr("study.run.executor.CROWDED", 0.0)
    assert run_job(job := Circular()) == {}
    assert job.made() is None


LARGE = Toy("large", 9, 6)
LARGER = Toy("larger", 8, 7)
SMALL = Toy("small", 7, 3)
TINY = Toy("tiny", 1, 1)


HEX = replace(SMALL, case="hexagon")
DISC = replace(TINY, case="cube-disc")


TAKEN = {
    "the most expensive one": ([LARGE, LARGER, SMALL], [], LARGE),
    "one for which there is memory": ([LARGER, SMALL, TINY], [LARGE], SMALL),
    "all memory": ([LARGER], [SMALL], LARGER),
    "none while memory is taken": ([LARGER], [SMALL, TINY], None),
    "one of the case whose formulas are compiled": ([LARGE, HEX, DISC], [], HEX),
}


@pytest.mark.parametrize("taken", TAKEN)
def test_an_idle_worker_takes_the_job_that_memory_and_its_last_case_suggest(taken):
    waiting, running, starting = TAKEN[taken]
    assert next_job(waiting, running, "hexagon", 10) == starting


def test_jobs_that_are_killed_run_again_after_all_others_one_at_a_time(store):
    begun = []

    class Fragile(AtOnce):
        """Breaks at the first call of the two most expensive jobs."""

        def submit(self, function, /, *args, **kwargs):
            job = args[0]
            assert len(begun) < 4 or all(future.done() for _, future in begun)
            broken = job in (LARGE, LARGER) and job not in (other for other, _ in begun)
            begun.append((job, future := Future()))
            answer = partial(future.set_exception, BrokenExecutor()) if broken else partial(future.set_result, {})
            Timer(0.05, answer).start()
            return future

    jobs = [LARGE, LARGER, SMALL, TINY]
    execute(jobs, store, pool(Fragile(), together=100), ignore)
    first = [job for job, _ in begun[:4]]
    again = [job for job, _ in begun[4:]]
    assert first == jobs
    assert sorted(again, key=lambda job: job.name) == [LARGE, LARGER]


def test_as_many_jobs_run_at_once_as_there_are_executors(store):
    begun = []

    class Third(AtOnce):
        """Finishes its jobs when three are running."""

        def submit(self, function, /, *args, **kwargs):
            begun.append(Future())
            for future in begun if len(begun) == 3 else ():
                future.set_result({})
            return begun[-1]

    execute([Toy(name) for name in "abc"], store, pool(Third(), workers=3), ignore)
    assert all(future.done() for future in begun)


def test_a_solution_is_proved_once_and_only_if_it_is_measured(monkeypatch, store):
    cases = ("full-contact", "advance-recede")
    executor = AtOnce()
    for _ in range(2):
        save_proofs(prove([full_contact(2)], cases, store, pool(executor)), store)
        assert executor.order == ["full-contact"]
    monkeypatch.setattr("study.run.fingerprint.versions", lambda: {"sympy": "another"})
    prove([full_contact(2)], cases, store, pool(executor))
    assert len(executor.order) == 2


def test_a_violated_condition_is_raised_and_not_stored(tmp_path, monkeypatch, store):
    violated = Finding("(2.3) u = 0 on Γ1", 1.0, 1e-9, (0.0, 0.0), 0.5)
    monkeypatch.setattr("study.run.executor.examine", lambda solution: [violated, replace(violated, defect=0.0)])
    with pytest.raises(SelfProofError, match="full-contact does not prove itself") as raised:
        prove([full_contact(2)], ("full-contact",), store, pool(AtOnce()))
    assert raised.value.findings == [violated]
    assert [*tmp_path.iterdir()] == []


def test_a_job_that_raises_is_named_and_the_others_are_kept(store):
    bad = Toy("bad", 2, deed=lambda: 1 / 0, case=f"{__file__}:toy")
    with pytest.raises(JobsError, match=r"1 job\(s\) failed.*\nbad: ZeroDivisionError: .*test_execute.py, line \d+\)"):
        execute([bad, Toy("good")], store, pool(AtOnce()), ignore)
    assert store.load("good", "good") == {"done": False}
    assert store.load("bad", "bad") is None


def die():
    os.kill(os.getpid(), signal.SIGKILL)


@dataclass(frozen=True)
class DieOnce:
    """Kills the process it runs in, the first time."""

    mark: Path

    def __call__(self):
        if not self.mark.exists():
            self.mark.touch()
            die()
        return "survived"


OTHERS = [Toy(f"other {i}") for i in range(4)]


def test_a_run_goes_on_with_new_workers_when_one_is_killed(tmp_path, store):
    jobs = [Toy("hit", 2, deed=DieOnce(tmp_path / "mark")), *OTHERS]
    finished = []
    with local_pool(2) as two:
        execute(jobs, store, two, finished.append)
    assert store.load("hit", "hit") == {"done": "survived"}
    assert all(store.load(job.key, job.key) for job in jobs)
    assert sorted(job.key for job in finished) == sorted(job.key for job in jobs)


def test_processes_end_although_work_was_cancelled():
    """The standard pool of Python 3.11.2 alone does not."""
    processes = Processes(1)
    processes.submit(int).result()
    processes.submit(int).cancel()
    ending = Thread(target=processes.shutdown, daemon=True)
    ending.start()
    ending.join(60)
    assert not ending.is_alive()


def test_a_job_that_kills_its_process_again_when_it_is_alone_is_refused_by_name(store):
    jobs = [Toy("killer", 2, GIB, deed=die), *OTHERS]
    with local_pool(2) as two, pytest.raises(JobsError, match=r"^1 job.*\nkiller: .* killed twice.*1\.0 GiB"):
        execute(jobs, store, two, ignore)
    assert all(store.load(job.key, job.key) for job in OTHERS)


@pytest.mark.parametrize("cancels", [True, False])
def test_a_run_ends_when_its_executor(cancels, monkeypatch, store):
    class Gone(AtOnce):
        def submit(self, function, /, *args, **kwargs):
            future = Future()
            if cancels:
                future.cancel()
                future.set_running_or_notify_cancel()
            else:
                # Without this, a run that waits for ever would not fail.
                (late := Timer(20, lambda: future.done() or future.set_exception(TimeoutError("late")))).daemon = True
                late.start()
            return future

    monkeypatch.setattr("study.run.executor.SILENCE", 0.01)
    lost = replace(pool(Gone()), failure=lambda: "the cluster no longer answers: the same command continues")
    with pytest.raises(JobsError, match=r"(?s)cluster no longer answers.*same command"):
        execute([Toy("a")], store, lost, ignore)


def test_a_job_that_no_worker_has_the_memory_for_is_refused_before_any_job_starts(store):
    jobs = [Toy("small", memory=GIB), Toy("rates__case__family__00512", memory=50 * GIB)]
    executor = AtOnce()
    with pytest.raises(UsageError, match=r"^rates__case__family__00512 needs about 50\.0 GiB.*20\.0 GiB are.*--levels"):
        execute(jobs, store, pool(executor, together=20 * GIB), ignore)
    assert executor.order == []


def full_contact(n):
    return Job(FirstOrder(), RateSetting("full-contact", "one-diagonal", n, "midpoint", 2))


PEAK = """
import sys, pickle
for job in pickle.load(sys.stdin.buffer):
    job.run()
    print(open('/proc/self/status').read())
"""
"""Prints the largest resident size of its process after each of some jobs."""
EVERY = [
    Job(FirstOrder(), RateSetting("cube-disc", "shaken", 9, "midpoint", 2)),
    Job(FirstOrder(), RateSetting("cube-disc", "one-diagonal", 18, "midpoint", 2)),
    Job(SameMesh(), Setting("cube-disc", "one-diagonal", 6)),
    Job(OwnSpace(), Setting("full-contact", "shaken", 16)),
    Job(EnclosedError(), BoundSetting("full-contact", "shaken", 20, "midpoint", Refined(1, 1))),
]


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere there is no /proc")
@pytest.mark.parametrize(
    "job",
    [full_contact(48), *(slow(job) for job in EVERY)],
)
def test_no_job_takes_more_memory_than_estimated_nor_much_less(job):
    """The base is most of a small estimate. What grows with the level is compared over the same job at n = 2."""
    least = replace(job, setting=replace(job.setting, level=2))
    jobs = pickle.dumps([least, job])
    found = subprocess.run([sys.executable, "-c", PEAK], input=jobs, capture_output=True, check=True)
    base, whole = (1024.0 * int(kibibytes) for kibibytes in re.findall(r"VmHWM:\s+(\d+) kB", found.stdout.decode()))
    assert whole <= job.memory
    assert 0.1 <= (whole - base) / (job.memory - least.memory) <= 1


def test_memory_is_what_the_tightest_control_group_allows(tmp_path):
    """Below another root lie the files of a Linux system that are read."""
    limits = {"job/memory.max": "max", "job/memory.current": "5", "memory.max": "1000", "memory.current": "700"}
    groups = {f"sys/fs/cgroup/{name}": text for name, text in limits.items()}
    groups["sys/fs/cgroup/memory.stat"] = "anon 600\ninactive_file 50"
    for name, text in {"proc/self/cgroup": "1:cpu:/\n0::/job", **groups}.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text + "\n")
    assert available(tmp_path) == 350


def test_data_are_locked_exactly_where_they_are_there_and_may_be_written(tmp_path, monkeypatch, store):
    """Root may write everywhere, so the system's answer is replaced. Data without a possible lock are refused."""
    with store.steady():
        assert [*tmp_path.iterdir()] == []
    store.data.mkdir()
    for writable, found in ((False, []), (True, [store.data / ".lock"])):
        monkeypatch.setattr(os, "access", lambda path, mode, answer=writable: answer)
        with store.steady():
            assert [*store.data.iterdir()] == found
    (store.data / ".lock").unlink()
    (store.data / ".lock").mkdir()
    monkeypatch.setattr(os, "access", lambda path, mode: path == store.data)
    with pytest.raises(StoreError, match="lock"), store.steady():
        pass


def test_what_a_killed_process_left_half_written_is_removed_and_what_a_living_one_writes_is_not(tmp_path, store):
    """Neither a digit that is no number nor a folder belongs to a process."""
    dead = subprocess.Popen([sys.executable, "-c", ""])
    dead.wait()
    jobs = tmp_path / "data/jobs"
    (jobs / ".folder.0.part").mkdir(parents=True)
    for owner in (dead.pid, 2**31, "9" * 30, "²", os.getpid()):
        for place in (jobs, tmp_path):
            (place / f".a.json.{owner}.part").touch()
    with store.locked():
        left = {path.name for path in tmp_path.rglob("*.part")}
    assert left == {".folder.0.part", ".a.json.².part", f".a.json.{os.getpid()}.part"}


@pytest.mark.parametrize(
    "spoil",
    [
        lambda text: text[: len(text) // 2],
        lambda text: "",
        lambda text: text.replace("0.25", "0.26"),
        lambda text: text.replace('"key": "a"', '"key": "b"'),
        lambda text: text.replace('"sha256"', '"md5"'),
        lambda text: "[]",
        lambda text: text.replace("0.25", 100_000 * "[" + 100_000 * "]"),
        lambda text: text.replace("0.25", 10_000 * "1"),
    ],
    ids=["truncated", "empty", "altered", "of another job", "without a checksum", "foreign", "nested", "many digits"],
)
def test_a_job_file_that_is_not_what_was_written_is_not_believed(spoil, store):
    result = {"v": 0.25, "nan": float("nan"), "list": [1e-17, None, "ũ"]}
    store.save("a", "x", result)
    assert str(store.load("a", "x")) == str(result)
    path = store.path("a")
    changed = spoil(path.read_text())
    assert changed != path.read_text()
    path.write_text(changed)
    assert store.load("a", "x") is None


def test_a_file_of_an_interrupted_result_is_not_taken_for_that_of_an_earlier_one(tmp_path, store):
    file = tmp_path / "trajectory"

    def interrupted():
        file.write_text("bdf2")
        raise KeyboardInterrupt

    def midpoint():
        file.write_text("midpoint")
        return {}

    store.cached("level-2", "midpoint", midpoint, file)
    with pytest.raises(KeyboardInterrupt):
        store.cached("level-2", "bdf2", interrupted, file)
    store.cached("level-2", "midpoint", midpoint, file)
    assert file.read_text() == "midpoint"


def test_a_job_file_that_may_not_be_read_is_refused_by_name(tmp_path, told, store):
    """Root may read all files: a link to itself is one that nobody can."""
    path = store.path(full_contact(2).key)
    path.parent.mkdir(parents=True)
    path.symlink_to(path)
    said = told(f"run --case full-contact --levels 2 --jobs 1 --out {tmp_path}")
    assert f"study: cannot read {path}: Too many levels" in said


MINE = """
from dataclasses import replace
from manufactured import named
mine = replace(named("advance-recede"), name="mine", pace=3)
"""


OWN = """
from manufactured import Case
class Own(Case): ...
mine = Own(**vars(mine))
"""


def dask(workers, threads=1):
    """A scheduler on the loopback interface with worker processes, which start in another directory than the runs."""
    return LocalCluster(n_workers=workers, threads_per_worker=threads, dashboard_address=None)


@pytest.fixture(scope="module")
def cluster():
    """The address of a scheduler with two workers."""
    with dask(2) as started:
        yield started.scheduler_address


@pytest.mark.parametrize("executor", ["processes", slow("cluster")])
def test_another_executor_gives_the_same_files_byte_for_byte(executor, tmp_path, request):
    levels = Levels((2, 4))
    few = replace(quick(), cases=("advance-recede",), plane=levels, rough=levels, equivalence=(2,))
    small = replace(few, every_family=False, statements=False)
    cluster = executor == "cluster"
    with connected(request.getfixturevalue("cluster"), few.cases) if cluster else local_pool(2) as two:
        files = computed(small, tmp_path / "there", two)
    assert computed(small, tmp_path / "here", pool(AtOnce())) == files
    assert any(name.startswith("data/jobs/rates__advance-recede") for name in files)


def test_a_cluster_is_refused_with_the_mend_where_there_is_none(refused, monkeypatch):
    command = "run --case full-contact --cluster"
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{free.getsockname()[1]}"
        assert f"no Dask scheduler answers at {address}" in refused(f"{command} {address}")
    assert "known schemes" in refused(f"{command} http://127.0.0.1:8786")
    assert "missing port" in refused(f"{command} nonsense")
    monkeypatch.setitem(sys.modules, "distributed", None)
    assert "pip install '.[study,cluster]' in a clone" in refused(f"{command} tcp://127.0.0.1:8786")


def test_a_cluster_without_workers_is_refused_with_how_to_start_some(monkeypatch):
    monkeypatch.setattr("study.run.executor.CLUSTER_PATIENCE", 1)
    with dask(0) as empty:
        told = f"has no workers.*dask worker {empty.scheduler_address} "
        with pytest.raises(UsageError, match=told), connected(empty.scheduler_address, []):
            pass


@pytest.mark.slow
def test_workers_with_several_threads_are_refused():
    told = "runs 2 threads, expected 1; start it with dask worker"
    with dask(1, threads=2) as started, pytest.raises(UsageError, match=told), connected(started.scheduler_address, []):
        pass


@pytest.mark.slow
def test_two_workers_on_loopback_measure_a_case_in_a_file_that_is_given_without_its_directory(
    cluster, tmp_path, monkeypatch
):
    (tmp_path / "mine.py").write_text(MINE)
    monkeypatch.chdir(tmp_path)
    assert study(f"run --case mine.py:mine --levels 2 --out r --cluster {cluster}") == 3
    assert (tmp_path / "r/data/jobs/rates__mine__criss-cross__midpoint__00002.json").exists()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "value", "told"),
    [("versions", {**versions(), "numpy": "another"}, r"numpy [\d.]+"), ("code_hash", "another", r"code \w+")],
)
def test_a_worker_that_would_compute_something_else_is_refused(cluster, monkeypatch, name, value, told):
    monkeypatch.setattr(f"study.run.executor.{name}", lambda *patterns: value)
    told = rf"the worker tcp://127.* would not compute the same: {told}, here another"
    with pytest.raises(UsageError, match=told), connected(cluster, ["full-contact"]):
        pass


def test_a_case_is_known_by_what_its_file_says_now_and_a_function_only_to_its_process(tmp_path):
    """A worker serves many runs, and the file may change between two of them."""
    file = tmp_path / "mine.py"
    file.write_text(MINE)
    before = identity([f"{file}:mine"])
    assert identity([f"{file}:mine"]) == before
    for text, known in ((MINE.replace("advance-recede", "travelling-patch"), True), (MINE + OWN, False)):
        file.write_text(text)
        after = identity([f"{file}:mine"])
        assert {key for key in before if before[key] != after[key]} == {f"{file}:mine"}
        assert (identity([f"{file}:mine"]) == after) == known


@contextmanager
def dask_command(*words, count=1):
    """A process of Dask with its children, and its address, when so many schedulers or workers have told theirs."""
    command = [sys.executable, "-m", f"distributed.cli.{words[0]}", *words[1:], "--no-dashboard"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, start_new_session=True) as process:
        try:
            told = (line for line in process.stderr if re.search(r"(Scheduler at|Registered to): +tcp", line))
            said = [next(told) for _ in range(count)]
            Thread(target=process.stderr.read, daemon=True).start()
            yield psutil.Process(process.pid), re.findall(r"tcp://\S+", said[0])[0]
        finally:
            os.killpg(process.pid, signal.SIGKILL)


@pytest.mark.slow
@pytest.mark.parametrize("victim", ["one worker", "workers", "scheduler", "stopped scheduler"])
def test_a_run_loses_one_worker_of_a_cluster_or_ends_soon_after_the_cluster_and_is_continued(victim, tmp_path, store):
    jobs = [full_contact(n) for n in range(32, 48)]
    killed = []
    told = ""

    def run(address, processes):
        def kill_once(job):
            if not killed:
                killed.append(time.monotonic())
                for process in processes[victim.removeprefix("stopped ")]:
                    process.suspend() if victim.startswith("stopped") else process.kill()

        with connected(address, ["full-contact"]) as two:
            processes["one worker"] = [psutil.Process(two.executors[0].submit(os.getpid).result())]
            execute(jobs, store, two, kill_once)

    with (
        dask_command("dask_scheduler", "--host", "127.0.0.1", "--port", "0") as (scheduler, address),
        dask_command("dask_worker", address, "--nworkers", "2", "--nthreads", "1", count=2) as (nanny, _),
    ):
        try:
            run(address, {"scheduler": [scheduler], "workers": [nanny, *nanny.children(recursive=True)]})
        except JobsError as error:
            told = str(error)
    finished = results(tmp_path)
    if victim == "one worker":
        assert told == ""
        assert len(finished) == len(jobs)
    else:
        assert time.monotonic() - killed[0] < 30
        assert re.search(rf"{address} no longer answers.*the same command", told)
    execute(jobs, store, pool(AtOnce()), ignore)
    assert finished.items() <= results(tmp_path).items()
    assert len(results(tmp_path)) == len(jobs)


def results(out):
    """The files of finished jobs and when they were written."""
    return {path: path.stat().st_mtime_ns for path in out.glob("data/jobs/*.json")}


RUN = "run --case full-contact advance-recede --levels 2 3 --jobs 2 --out"


def started(out):
    """The command in a process group of its own, forked so that nothing is imported again."""
    process = multiprocessing.get_context("fork").Process(target=command, args=(out,))
    process.start()
    return process


def command(out):
    """``study run`` without figures and without the proofs of the cases, which write no results and take long."""
    os.setsid()
    with open(os.devnull, "w") as nowhere:
        for stream in (1, 2):
            os.dup2(nowhere.fileno(), stream)
    Plan.check = lambda *arguments: None  # type: ignore[method-assign]
    run_command.prove = lambda *arguments: []
    os._exit(study(f"{RUN} {out}"))


def written(out):
    """The data of a command that came to verdicts: levels as coarse as these do not carry every one of them."""
    assert (out / "data/claims.csv").exists()
    return {str(path.relative_to(out)): path.read_bytes() for path in out.glob("data/**/*") if path.is_file()}


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    """The files that an undisturbed run writes."""
    out = tmp_path_factory.mktemp("undisturbed")
    run = started(out)
    run.join()
    assert run.exitcode in (0, 1)
    return written(out)


def gone(process):
    return not process.is_running() or process.status() == psutil.STATUS_ZOMBIE


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_killed_workers_and_runs_change_no_byte_of_what_is_written_in_the_end(seed, undisturbed, tmp_path):
    """Nothing of the run may live on when it is killed, and what was finished is not done again."""
    total = sum("jobs" in name for name in undisturbed)
    moment = random.Random(seed)
    kept = {}
    for victim in ("worker", "run", "run"):
        run = started(tmp_path)
        # At least one job more than there are: nothing works before that but imports.
        jobs = len(kept) + 1 + moment.randrange(total // 5)
        while len(results(tmp_path)) < jobs and run.exitcode is None:
            time.sleep(0.005)
        time.sleep(moment.uniform(0, 0.05))
        leader = psutil.Process(run.pid)
        workers = [worker for worker in leader.children(recursive=True) if not gone(worker)]
        assert workers, "the run was over before its moment came"
        if victim == "worker":
            workers[0].send_signal(signal.SIGKILL)
            while len(results(tmp_path)) <= jobs and run.exitcode is None:
                time.sleep(0.005)
        leader.send_signal(signal.SIGKILL)
        run.join()
        deadline = time.monotonic() + 20
        while not all(map(gone, workers)):
            assert time.monotonic() < deadline, [worker for worker in workers if not gone(worker)]
            time.sleep(0.05)
        assert kept.items() <= results(tmp_path).items()
        kept = results(tmp_path)
    last = started(tmp_path)
    last.join()
    assert last.exitcode in (0, 1)
    assert written(tmp_path) == undisturbed
    assert kept.items() <= results(tmp_path).items()
