"""Files that were made to harm: each is refused with one sentence, in little time and memory, and prints ASCII only."""

from __future__ import annotations

import gzip
import json
import os
import re
import time
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from study.certify import checker

EXAMPLE = Path(__file__).parent / "square-2.json.gz"
TEXT = gzip.decompress(EXAMPLE.read_bytes()).decode()
BAD = "\x1b[2J\r\n\u202e\u2066\x9b\x7fא"
"""Clears the screen, starts a line, turns the direction of text around."""


def checked(path: Path, capsys: pytest.CaptureFixture[str]) -> tuple[int, str, str]:
    """Exit code and output; it took less than a second, and 64 MB."""
    began = time.process_time()
    code = checker.main([str(path)])
    assert time.process_time() - began < 1
    out, error = capsys.readouterr()
    return code, out, error


def refused(content: bytes, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> str:
    """The sentence with which a file is refused."""
    path = tmp_path / "hostile.json.gz"
    path.write_bytes(content)
    code, out, error = checked(path, capsys)
    head, sentence = out.removesuffix("\n").split(": REFUSED: ")
    assert (code, error, head) == (1, "", str(path))
    # Our own letters, such as those of ũ and σ̃, are all that is not ASCII.
    assert sentence.isprintable()
    assert re.search(r"[^\x20-\x7eũ_νσ̃ΦΩΓν₀≤−°·]", sentence) is None
    assert len(sentence) < 200
    return sentence


def certificate() -> Any:
    return json.loads(TEXT)


def packed(data: Any) -> bytes:
    return gzip.compress((data if isinstance(data, str) else json.dumps(data)).encode(), 1)


def objects(data: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """The places of all objects."""
    found = [path] if isinstance(data, dict) else []
    entries = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, value in entries:
        if isinstance(value, dict | list) and len(found) < 50 and key not in ("columns", "tractions", "inner", "nodes"):
            found += objects(value, (*path, key))
    return found


def at(data: Any, path: tuple[Any, ...]) -> Any:
    for key in path:
        data = data[key]
    return data


PLACES = objects(certificate())


def test_all_objects_of_a_certificate_are_tried() -> None:
    names = {".".join(map(str, place)) for place in PLACES}
    others = "problem problem.loads constants constants.mesh mesh element displacement stress"
    assert names == {"", *others.split()}


@pytest.mark.parametrize("place", PLACES, ids=str)
def test_unknown_keys_are_refused(place: tuple[Any, ...], tmp_path, capsys) -> None:
    for key in ("bound", "", BAD, "x" * 10**6, "ｍ"):
        data = certificate()
        at(data, place)[key] = []
        assert re.search("unknown key|must be a list of 2|does not exist", refused(packed(data), tmp_path, capsys))


def keys() -> list[tuple[Any, ...]]:
    return [(*place, key) for place in PLACES for key in at(certificate(), place) if place != ("problem", "loads")]


@pytest.mark.parametrize("place", keys(), ids=str)
def test_every_key_has_to_be_there_once_and_of_its_type(place: tuple[Any, ...], tmp_path, capsys) -> None:
    *path, key = place
    data = certificate()
    del at(data, tuple(path))[key]
    assert "lacks the key" in refused(packed(data), tmp_path, capsys)
    for value in (None, True, 1.5, BAD, [BAD], {BAD: 1}, -1, [[[]]], "1/0", 10**200):
        data = certificate()
        at(data, tuple(path))[key] = value
        assert "certificate" in refused(packed(data), tmp_path, capsys)


def edit(*keys: Any, to: Any) -> Callable[[Any], None]:
    def change(data: Any) -> None:
        at(data, keys[:-1])[keys[-1]] = to

    return change


# fmt: off
NUMBERS = [
    "1e5", "1e-99999999", "1E400000000", "0.5", ".5", "1_000", " 1", "1 ", "1\n", "1/ 2", "+1", "--1", "1/-2", "1/0",
    "0/0", "1/2/3", "1/", "/2", "", "inf", "-inf", "nan", "0x10", "01", "1/02", "٣", "１", "²", "½",
    "9" * 101, "1/" + "9" * 101, "9" * 10**6, 1, 1.0, True, None, [], {},
]
# fmt: on
PLACES_OF_FRACTIONS: list[tuple[Any, ...]] = [
    ("problem", "T"),
    ("problem", "vertices", 1, 0),
    ("problem", "A", 0, 0),
    ("problem", "G", 2, 1),
    ("problem", "force", 1, 0, 0, 0, 0),
    ("constants", "volume"),
    ("m",),
]


@pytest.mark.parametrize("place", PLACES_OF_FRACTIONS, ids=str)
def test_only_short_fractions_are_numbers(place: tuple[Any, ...], tmp_path, capsys) -> None:
    for number in NUMBERS:
        data = certificate()
        at(data, place[:-1])[place[-1]] = number
        with pytest.raises(checker.RefusedError, match="must be a fraction such as"):
            checker.verified(data)
        if place == ("m",):
            assert "must be a fraction" in refused(packed(data), tmp_path, capsys)


def test_fractions_of_any_sign_and_of_as_many_digits_as_are_allowed_are_numbers() -> None:
    for number in ("0", "-0", "12", "-3/4", "9" * 100, "-1/" + "9" * 100, "10/20"):
        checker.conform(number, checker.FRACTION, "it")


NOTHING: list[Any] = []
STRUCTURES: dict[str, tuple[Callable[[Any], None], str]] = {
    "a long integer": (edit("stress", "tractions", 3, 20, to=10**100), "integer of at most 100"),
    "a long negative integer": (edit("displacement", "nodes", 2, 10, to=-(10**100)), "integer of at most 100"),
    "a boolean for an integer": (edit("stress", "inner", 3, 20, to=True), "is True"),
    "a float for an integer": (edit("mesh", "points", 3, 0, to=2.0), r"is 2\.0"),
    "a text for an integer": (edit("mesh", "cells", 3, 0, to="2"), "is '2'"),
    "an integer for a double": (edit("computed", 1, 7, to=1), "finite number"),
    "a text for a double": (edit("computed", 1, 7, to="1e5"), "finite number"),
    "a boolean for a double": (edit("computed", 1, 7, to=False), "finite number"),
    "an object for a list": (edit("computed", 1, to={"0": 1.0}), "list"),
    "a text for a list": (edit("mesh", "points", 1, to="00"), "list"),
    "a text for a list of fractions": (edit("problem", "vertices", 1, to="10"), "list of 2"),
    "u_h at one time": (edit("computed", to=[[0.0] * 50]), "1 values, but must have 2"),
    "no u_h": (edit("computed", to=[]), "0 values"),
    "ũ at one time": (edit("displacement", "nodes", to=[[0] * 162]), "1 values"),
    "a huge unit of ũ": (edit("displacement", "bits", to=10**9), "integer from 1 to 512"),
    "a huge unit of σ̃": (edit("stress", "bits", to=513), "integer from 1 to 512"),
    "no unit of σ̃": (edit("stress", "bits", to=0), "integer from 1 to 512"),
    "a huge coarse unit": (edit("stress", "coarse", to=513), "integer from 0 to 512"),
    "a huge unit of Φ": (edit("constants", "bits", to=10**9), "integer from 1 to 512"),
    "many refinements": (edit("refinements", to=9), "integer from 0 to 8"),
    "more refinements than ũ has": (edit("refinements", to=8), "ũ has another size"),
    "a high degree": (edit("problem", "force", 1, 0, 0, 0, 1, to=11), "integer from 0 to 10"),
    "a high total degree": (edit("problem", "force", 1, 0, 0, 0, 2, to=10), "degree above 10"),
    "a high power": (edit("problem", "loads", "1", 0, 0, 2, to=11), "integer from 0 to 10"),
    "a high degree of a power": (edit("problem", "loads", "1", 0, 0, to=[[], [["1", 6, 0, 0]], 2]), "degree above 10"),
    "a high degree of u_0": (edit("problem", "start", 0, to=[["1", 7, 4]]), "u_0 has a degree above 10"),
    "a negative exponent": (edit("problem", "force", 1, 0, 0, 0, 1, to=-1), "integer from 0 to 10"),
    "an exponent that is a boolean": (edit("problem", "force", 1, 0, 0, 0, 1, to=True), "is True"),
    "many monomials": (edit("problem", "start", 0, to=[["0", 0, 0]] * 301), "301 values, but must have 0 to 300"),
    "many summands": (edit("problem", "force", 0, to=[[[], [], 0]] * 301), "301 values"),
    "many vertices": (edit("problem", "vertices", to=[["0", "0"]] * 101), "101 values, but must have 3 to 100"),
    "two vertices": (edit("problem", "vertices", to=[["0", "0"]] * 2), "2 values"),
    "a vertex in space": (edit("problem", "vertices", 0, to=["0", "0", "0"]), "list of 2 values"),
    "a kind that is not there": (edit("problem", "kinds", 0, to=BAD), "must be clamped or contact or loaded"),
    "fewer kinds than sides": (edit("problem", "kinds", to=["clamped"] * 3), "one kind for every side"),
    "more kinds than sides": (edit("problem", "kinds", to=["clamped"] * 5), "one kind for every side"),
    "a load on a part that is not there": (edit("problem", "loads", "7", to=[[], []]), "a side that does not exist"),
    "a load with one component": (edit("problem", "loads", "1", to=[[]]), "list of 2 values"),
    "a load with three components": (edit("problem", "loads", "1", to=[[], [], []]), "list of 2 values"),
    "a law in space": (edit("problem", "A", to=[["1"] * 6] * 6), "list of 3 values"),
    "a long row of a law": (edit("problem", "A", 0, to=["1"] * 4), "list of 3 values"),
    "a point in space": (edit("mesh", "points", 0, to=[0, 0, 0]), "3 values, but must have 2 to 2"),
    "a quadrangle": (edit("mesh", "cells", 0, to=[0, 1, 2, 3]), "4 values"),
    "no cells": (edit("mesh", "cells", to=[]), "0 values"),
    "a vertex that is not there": (edit("mesh", "cells", 0, 0, to=9), "a vertex does not exist"),
    "a vertex of a side that is not there": (edit("mesh", "sides", 0, 0, to=9), "a vertex does not exist"),
    "a negative vertex": (edit("mesh", "cells", 0, 0, to=-1), "a vertex does not exist"),
    "a side without vertices": (edit("mesh", "sides", 0, to=[]), "0 values, but must have 2"),
    "a side too few": (edit("mesh", "sides", to=[[0, 1]] * 3), "one line of vertices for every side"),
    "no denominator": (edit("mesh", "denominator", to=0), "a positive integer"),
    "a field of vectors": (edit("constants", "field", 0, to=[0, 0]), "2 values, but must have 4"),
    "a short field": (edit("constants", "field", to=[]), "one value for every vertex"),
    "a constant that is 0": (edit("constants", "volume", to="0"), "a constant of the body is not positive"),
    "another constant that is 0": (edit("constants", "surface", to="0"), "a constant of the body is not positive"),
    "an element without columns": (edit("element", "columns", to=[]), "0 values, but must have 45"),
    "an element with short columns": (edit("element", "columns", 44, to=[0] * 89), "89 values"),
    "an element over 0": (edit("element", "over", to=0), "a positive integer"),
    "stresses of no time": (edit("stress", "tractions", to=[]), "must be one stress for every"),
    "a level that is no number": (edit("level", to="4"), "integer from 0"),
    "another format": (edit("format", to=BAD), "must be signorini-certificate 2"),
}


@pytest.mark.parametrize("name", STRUCTURES, ids=ascii)
def test_other_structures_are_refused(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    data, (change, message) = certificate(), STRUCTURES[name]
    change(data)
    assert re.search(message, refused(packed(data), tmp_path, capsys))


BIG = 40_000_000
TEXTS: dict[str, tuple[Callable[[], bytes], str]] = {
    "nothing": (lambda: b"", "ends too early"),
    "no gzip": (lambda: TEXT.encode(), "not a gzip file"),
    "a gzip file that ends early": (lambda: packed(TEXT)[:-9], "ends too early"),
    "a gzip file with a wrong sum": (lambda: packed(TEXT)[:-8] + b"\0" * 8, "not a gzip file"),
    "two gzip members": (lambda: packed(TEXT) + packed(TEXT), "data after its certificate"),
    "bytes behind a gzip file": (lambda: packed(TEXT) + b"\0", "data after its certificate"),
    "a bomb of zeros": (lambda: gzip.compress(b"0" * BIG), "unpacks to more than"),
    "a bomb of spaces": (lambda: packed(TEXT + " " * BIG), "unpacks to more than"),
    "a bomb of members": (lambda: packed(TEXT) * 1000, "data after its certificate"),
    "no JSON": (lambda: packed("certificate"), "not a gzip file with JSON"),
    "two values": (lambda: packed(TEXT + "{}"), "not a gzip file with JSON"),
    "a comma too many": (lambda: packed(TEXT[:-1] + ",}"), "not a gzip file with JSON"),
    "text that is not ASCII": (lambda: packed(TEXT.replace("contact", "kontakt\u202e")), "not a gzip file with JSON"),
    "UTF-16": (lambda: gzip.compress(TEXT.encode("utf-16")), "not a gzip file with JSON"),
    "a list": (lambda: packed("[]"), "certificate is a list, but must be an object"),
    "a number": (lambda: packed("1"), "certificate is 1"),
    "null": (lambda: packed("null"), "certificate is None"),
    "NaN": (lambda: packed(TEXT.replace('"m":', '"m":NaN,"n":')), "a number is 'NaN'"),
    "Infinity": (lambda: packed(TEXT.replace('"m":', '"m":-Infinity,"n":')), "a number is '-Infinity'"),
    "a double that overflows": (lambda: packed(re.sub(r'"computed":\[\[0.0', '"computed":[[1e999', TEXT)), "is inf"),
    "a key twice": (lambda: packed(TEXT.replace('"m":', '"level":2,"m":')), "a key twice"),
    "a key twice deep inside": (lambda: packed(TEXT.replace('"T":', '"T":"2","T":')), "a key twice"),
    "an integer of many digits": (lambda: packed(TEXT.replace('"level":2', f'"level":{"9" * 10**6}')), "4300 digits"),
    "an integer of some digits": (lambda: packed(TEXT.replace('"level":2', f'"level":{"9" * 4000}')), "is 9999"),
    "deep lists": (lambda: packed("[" * 10**5 + "]" * 10**5), "too deeply"),
    "deep objects": (lambda: packed('{"a":' * 10**5), "too deeply"),
    "many empty lists": (lambda: packed(f"[{','.join(['[]'] * 2_000_000)}]"), "more than 1048576 lists"),
    "many empty objects": (lambda: packed(f"[{','.join(['{}'] * 2_000_000)}]"), "more than 1048576 lists"),
}


@pytest.mark.parametrize("name", TEXTS, ids=ascii)
def test_other_files_are_refused(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    content, message = TEXTS[name]
    assert re.search(message, refused(content(), tmp_path, capsys))


def test_a_bomb_takes_little_memory(tmp_path: Path) -> None:
    path = tmp_path / "bomb.json.gz"
    path.write_bytes(gzip.compress(b"0" * (4 * BIG), 1))
    tracemalloc.start()
    with pytest.raises(checker.RefusedError, match="unpacks to more"):
        checker.load(path)
    assert tracemalloc.get_traced_memory()[1] < 64 << 20
    tracemalloc.stop()


def test_texts_are_limited_by_their_files_and_at_all(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(checker, "SMALL", 10)
    assert checker.load(EXAMPLE) == certificate()
    for name, value in (("PACKING", 2), ("UNPACKED", len(TEXT) - 1), ("LISTS", TEXT.count("[") - 1)):
        with monkeypatch.context() as patch:
            patch.setattr(checker, name, value)
            with pytest.raises(checker.RefusedError, match="more than"):
                checker.load(EXAMPLE)


def test_a_big_file_is_not_read(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "big.json.gz"
    with path.open("wb") as file:
        file.truncate(checker.PACKED + 1)
    code, out, _ = checked(path, capsys)
    assert code == 1
    assert f"the file has more than {checker.PACKED} bytes" in out


def test_what_is_no_file_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    fifo = tmp_path / "pipe"
    os.mkfifo(fifo)
    for path in (tmp_path, tmp_path / "absent", fifo, Path("/dev/zero"), tmp_path / ("x" * 300), Path(f"{BAD}.gz")):
        code, out, error = checked(path, capsys)
        assert (code, out) == (2, "")
        assert re.fullmatch(r"[\x20-\x7e]+ is not a file\nusage: [\x20-\x7e]+\n", error)
    assert checker.main([str(EXAMPLE), "\0"]) == 2
    assert "'\\x00' is not a file" in capsys.readouterr().err
    assert checker.main([]) == 2
    assert capsys.readouterr().err.startswith("no file was given\nusage: python checker.py")


def test_a_file_that_cannot_be_read_is_named(tmp_path, capsys, monkeypatch) -> None:
    def load(path: Path) -> Any:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(checker, "load", load)
    assert checker.main([str(EXAMPLE)]) == 2
    assert capsys.readouterr().err == f"{EXAMPLE} cannot be read: Permission denied\n"


def test_names_of_files_do_not_reach_the_screen_as_they_are(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in (f"{BAD}: REFUSED.gz", "א", "\x7f"):
        path = tmp_path / name
        path.write_bytes(b"")
        assert checker.main([str(path)]) == 1
        assert capsys.readouterr().out.startswith(ascii(str(path)) + ": REFUSED: ")


def test_a_defect_of_the_checker_proves_nothing(tmp_path, capsys, monkeypatch) -> None:
    for error in (KeyError(BAD), RecursionError(BAD), MemoryError(BAD), OverflowError(BAD), AssertionError(BAD)):
        monkeypatch.setattr(checker, "conform", lambda *_, error=error: (_ for _ in ()).throw(error))
        assert refused(EXAMPLE.read_bytes(), tmp_path, capsys) == f"the check ended with {type(error).__name__}"
