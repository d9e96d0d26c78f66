"""Files that are wrong, tampered with, or made to harm: each is refused with one sentence that prints safely."""

import gzip
import json
import math
import os
import re
import subprocess
import sys
import time
import tracemalloc
from fractions import Fraction
from pathlib import Path

import pytest

from study.certify import checker

EXAMPLE = Path(__file__).parent / "square-2.json.gz"
TEXT = gzip.decompress(EXAMPLE.read_bytes()).decode()
BAD = "\x1b[2J\r\n\u202e\u2066\x9b\x7fא"
"""Clears the screen, starts a line, turns the direction of text around."""


def safe(sentence):
    """A sentence that is short and cannot harm a terminal; our own letters, as in ũ and σ̃, may be other than ASCII."""
    assert sentence.isprintable()
    assert re.search(r"[^\x20-\x7eũ_νσ̃ΦΩΓν₀≤−°·]", sentence) is None
    assert len(sentence) < 200
    return sentence


def refusal(data):
    with pytest.raises(checker.RefusedError) as caught:
        checker.verified(data)
    return safe(str(caught.value))


def checked(path, capsys):
    """Exit code and output of the program; it took less than a second."""
    began = time.process_time()
    code = checker.main([str(path)])
    assert time.process_time() - began < 1
    return code, *capsys.readouterr()


def refused(content, tmp_path, capsys):
    path = tmp_path / "hostile.json.gz"
    path.write_bytes(content)
    code, out, error = checked(path, capsys)
    head, sentence = out.removesuffix("\n").split(": REFUSED: ")
    assert code == 1
    assert error == ""
    assert head == str(path)
    return safe(sentence)


def packed(text):
    return gzip.compress(text.encode(), 1)


# Values of another type, in every place


def at(data, path):
    for key in path:
        data = data[int(key) if isinstance(data, list) else key]
    return data


def places(data, path=()):
    """The places of all values in objects, and of the last value of every list."""
    yield path
    entries = data.items() if isinstance(data, dict) else list(enumerate(data))[-1:] if isinstance(data, list) else ()
    for key, value in entries:
        yield from places(value, (*path, key))


@pytest.mark.parametrize("part", list(json.loads(TEXT)))
def test_values_of_another_type_are_refused_wherever_they_stand(part, certificate):
    for *path, key in places(certificate[part], (part,)):
        around = at(certificate, tuple(path))
        right = around[key]
        for value in (None, True, 1.5, BAD, [BAD], {BAD: 1}, -(10**200), [[[]]], "1/0", 10**200):
            if type(value) is not float or type(right) is not float:
                around[key] = value
                assert "certificate" in refusal(certificate)
        around[key] = right


def test_a_mesh_may_have_three_sides_and_not_fewer():
    sides = [[0, 1], [1, 2], [2, 0]]
    checker.conform(sides, checker.MESH["sides"], "sides")
    with pytest.raises(checker.RefusedError, match="sides"):
        checker.conform(sides[:2], checker.MESH["sides"], "sides")


FREE = {"force", "loads", "start"}


@pytest.mark.parametrize("part", [part for part in json.loads(TEXT) if part not in ("format", "level", "m")])
def test_lists_with_a_value_more_or_less_are_refused_with_a_reason(part, certificate):
    """Formulas of loads may have any number of terms, and u_h any number of times."""
    for *path, key in places(certificate[part], (part,)):
        around = at(certificate, tuple(path))
        right = around[key]
        if isinstance(right, list) and right and key != "computed" and not FREE & {*path, key}:
            for around[key] in (right[:-1], [*right, right[-1]], []):
                assert "the check ended with" not in refusal(certificate), (path, key)
        around[key] = right


def test_every_key_has_to_be_there_and_no_other(certificate):
    objects = [path for path in places(certificate) if isinstance(at(certificate, path), dict)]
    assert len(objects) == 9
    for path in objects:
        place = at(certificate, path)
        for key in ("bound", "", BAD, "x" * 10**6, "ｍ"):
            place[key] = []
            assert re.search("unknown key|must be a list of 2|does not exist", refusal(certificate))
            del place[key]
        for key in list(place) if path[-1:] != ("loads",) else ():
            value = place.pop(key)
            assert "lacks the key" in refusal(certificate)
            place[key] = value
    assert checker.verified(certificate)


# fmt: off
NO_NUMBERS = [
    "1e5", "1e-99999999", "1E400000000", "0.5", ".5", "1_000", " 1", "1 ", "1\n", "1/ 2", "+1", "--1", "1/-2", "1/0",
    "0/0", "1/2/3", "1/", "/2", "", "inf", "-inf", "nan", "0x10", "01", "1/02", "٣", "１", "²", "½",
    "9" * 101, "1/" + "9" * 101, "9" * 10**6, 1, 1.0, True, None, [], {},
]
# fmt: on


def test_only_fractions_of_at_most_100_digits_are_numbers():
    for number in ("0", "-0", "12", "-3/4", "9" * 100, "-1/" + "9" * 100, "10/20"):
        checker.conform(number, checker.FRACTION, "it")
    for number in NO_NUMBERS:
        with pytest.raises(checker.RefusedError, match="must be a fraction such as"):
            checker.conform(number, checker.FRACTION, "it")


# Certificates of which one entry is wrong


def edit(pointer, to=None, by=None):
    """Replace the value at a JSON pointer without its first slash."""
    *path, last_key = pointer.split("/")

    def change(data):
        place = at(data, path)
        key = int(last_key) if isinstance(place, list) else last_key
        place[key] = by(place[key]) if by else to

    return change


def last(rows):
    return rows[:-1]


def twice(number):
    return str(2 * Fraction(number))


def plus(changes):
    return lambda column: [x + changes.get(n, 0) for n, x in enumerate(column)]


def squeezed(column):
    """A stress of the element that is 0 on its sides, and not in balance: X Y (1 − X − Y) in the third component."""
    bubble = {(1, 1, 0): 1, (2, 1, 0): -1, (1, 2, 0): -1}
    return [0] * 60 + [bubble.get(key, 0) for key in checker.CUBIC] * 3


TAMPERED = {
    edit("mesh/cells", by=last): "a boundary inside or outside|does not fit side",
    edit("mesh/cells", by=lambda x: [*x, x[0]]): "two cells lie on the same side",
    edit("mesh/cells/0", by=lambda x: x[::-1]): "not counter-clockwise",
    edit("mesh/points/1/1", by=lambda y: y - 1): "does not fit|boundary inside",
    edit("problem/kinds/2", to="loaded"): "no part is clamped",
    edit("problem/A/0/1", to="1/3"): "A is not symmetric and positive definite",
    edit("problem/G/2/2", to="-1"): "G is not symmetric and positive semidefinite",
    edit("constants/volume", by=twice): "constant of forces",
    edit("constants/volume", to="0"): "a constant of the body is not positive",
    edit("constants/field/3/0", by=lambda x: x + 2**28): "the tensor field does not",
    edit("stress/tractions/3/20", to=math.nan): "is nan, but must be an integer",
    edit("element/columns/7", by=plus({31: 1})): "tractions of the ref",
    # A constant stress t ⊗ t on one third, t along its outer side: no traction outside, no divergence.
    edit("element/columns/40", by=plus({0: 1, 30: 1, 60: -1})): "ent jump",
    # A constant stress times a hat function of the centre: tractions are right, divergences differ on thirds.
    edit("element/columns/40", by=plus({0: 1, 1: -1, 4: -1, 14: 1, 21: 1})): "the reference element does not balance",
    edit("element/columns/40", by=squeezed): "does not balance",
    edit("computed", by=lambda u: [*u, u[-1]]): "u_h has a node inside",
    edit("problem/force/1/0/2", to=1): "f_0 with kinks",
    edit("problem/loads", by=lambda x: {"0": x["1"]}): "which is not of Γ2",
    edit("problem/loads/7", to=[[], []]): "a side that does not exist",
    edit("problem/T", to="0"): "T is not positive",
    # Sizes.
    edit("stress/bits", to=0): "integer from 1 to 512",
    edit("refinements", to=9): "integer from 0 to 8",
    edit("refinements", to=8): "ũ has another size",
    edit("problem/force/1/0/0/0/1", to=11): "integer from 0 to 10",
    edit("problem/loads/1/0/0", to=[[], [["1", 6, 0, 0]], 2]): "degree above 10",
    edit("problem/start/0", to=[["1", 7, 4]]): "u_0 has a degree above 10",
    edit("problem/force/1/0/0/0/1", to=-1): "integer from 0 to 10",
    edit("problem/start/0", to=[["0", 0, 0]] * 301): "301 values, but must have 0 to 300",
    edit("problem/vertices", to=[["0", "0"]] * 101): "101 values, but must have 3 to 100",
    edit("mesh/cells/0/0", to=9): "a vertex does not exist",
    edit("mesh/cells/0/0", to=-1): "a vertex does not exist",
    edit("mesh/denominator", to=0): "a positive integer",
    edit("element/over", to=0): "a positive integer",
}


@pytest.mark.parametrize(("change", "message"), TAMPERED.items())
def test_what_is_tampered_with_is_refused(change, message, certificate):
    change(certificate)
    assert re.search(message, refusal(certificate))


@pytest.mark.parametrize(
    "claim",
    [
        edit("problem/loads/1/0/0/0/0/0", to="-3"),
        edit("problem/force/1/0/0/0/0", by=twice),
        edit("problem/start/1", to=[["1/10", 0, 0], ["-1/10", 0, 1]]),
        edit("stress/tractions/3/40", by=lambda x: x + 2**34),
        edit("stress/inner/3/40", by=lambda x: x + 2**12),
        edit("displacement/nodes/1/8", by=lambda x: x + 2**36),
    ],
)
def test_witnesses_of_something_else_prove_less(claim, certificate, plain):
    """They stay true: an interval is wider, by what they do not fit."""
    claim(certificate)
    assert checker.verified(certificate).last > plain.last


# Files that are no certificates

TEXTS = {
    "not a gzip file .*incorrect header": lambda: TEXT.encode(),
    "ends too early": lambda: packed(TEXT)[:-9],
    "not a gzip file .*incorrect data": lambda: packed(TEXT)[:-8] + b"\0" * 8,
    "data after its certificate": lambda: packed(TEXT) + packed(TEXT),
    "the file has data after its certificate": lambda: packed(TEXT) + b"\0",
    "not a gzip file with JSON .*Expecting value": lambda: packed("certificate"),
    "not a gzip file with JSON in ASCII": lambda: packed(TEXT.replace("contact", "kontakt\u202e")),
    "certificate is a list, but must be an object": lambda: packed("[]"),
    "a number is 'NaN'": lambda: packed(TEXT.replace('"m":', '"m":NaN,"n":')),
    "is inf": lambda: packed(re.sub(r'"computed":\[\[0.0', '"computed":[[1e999', TEXT)),
    "a key twice": lambda: packed(TEXT.replace('"m":', '"level":2,"m":')),
    "4300 digits": lambda: packed(TEXT.replace('"level":2', f'"level":{"9" * 10**6}')),
    "is 9999": lambda: packed(TEXT.replace('"level":2', f'"level":{"9" * 4000}')),
    "too deeply": lambda: packed("[" * 10**5 + "]" * 10**5),
    "more than 1048576 lists": lambda: packed(f"[{','.join(['[]'] * 1_100_000)}]"),
}


@pytest.mark.parametrize(("message", "content"), TEXTS.items())
def test_other_files_are_refused(content, message, tmp_path, capsys):
    assert re.search(message, refused(content(), tmp_path, capsys))


def test_a_bomb_takes_little_memory(tmp_path):
    path = tmp_path / "bomb.json.gz"
    path.write_bytes(gzip.compress(b"0" * 80_000_000, 1))
    tracemalloc.start()
    with pytest.raises(checker.RefusedError, match="unpacks to more"):
        checker.load(path)
    assert tracemalloc.get_traced_memory()[1] < 64 << 20
    tracemalloc.stop()


def test_texts_are_limited_by_their_files_and_at_all(monkeypatch, made):
    monkeypatch.setattr(checker, "SMALL", 10)
    assert checker.load(EXAMPLE) == made
    for name, value in (("PACKING", 2), ("UNPACKED", len(TEXT) - 1), ("LISTS", TEXT.count("[") - 1)):
        with monkeypatch.context() as patch:
            patch.setattr(checker, name, value)
            with pytest.raises(checker.RefusedError, match="more than"):
                checker.load(EXAMPLE)


def test_a_big_file_is_not_read(tmp_path, capsys):
    path = tmp_path / "big.json.gz"
    with path.open("wb") as file:
        file.truncate(checker.PACKED + 1)
    code, out, _ = checked(path, capsys)
    assert code == 1
    assert f"the file has more than {checker.PACKED} bytes" in out


def test_what_is_no_file_is_named(tmp_path, capsys):
    fifo = tmp_path / "pipe"
    os.mkfifo(fifo)
    for path in (tmp_path, tmp_path / "absent", fifo, Path("/dev/zero"), tmp_path / ("x" * 300), Path(f"{BAD}.gz")):
        code, out, error = checked(path, capsys)
        assert code == 2
        assert out == ""
        assert re.fullmatch(r"[\x20-\x7e]+ is not a file\nusage: [\x20-\x7e]+\n", error)
    assert checker.main([str(EXAMPLE), "\0"]) == 2
    assert "'\\x00' is not a file" in capsys.readouterr().err
    assert checker.main([]) == 2
    assert capsys.readouterr().err.startswith("no file was given\nusage: python checker.py")


def test_a_file_that_cannot_be_read_is_named(tmp_path, capsys, monkeypatch):
    def load(path):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(checker, "load", load)
    assert checker.main([str(EXAMPLE)]) == 2
    assert capsys.readouterr().err == f"{EXAMPLE} cannot be read: Permission denied\n"


def test_a_reader_who_ends_early_does_not_make_a_certificate_refused():
    command = [sys.executable, checker.__file__, str(EXAMPLE)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as check:
        assert check.stdout and check.stderr  # noqa: PT018
        check.stdout.close()
        assert check.stderr.read() == ""
    assert check.returncode == 141


def test_names_of_files_do_not_reach_the_screen_as_they_are(tmp_path, capsys):
    for name in (f"{BAD}: REFUSED.gz", "א", "\x7f"):
        path = tmp_path / name
        path.write_bytes(b"")
        assert checker.main([str(path)]) == 1
        assert capsys.readouterr().out.startswith(ascii(str(path)) + ": REFUSED: ")


def test_a_defect_of_the_checker_proves_nothing(tmp_path, capsys, monkeypatch):
    for error in (KeyError(BAD), RecursionError(BAD), MemoryError(BAD), OverflowError(BAD), AssertionError(BAD)):
        monkeypatch.setattr(checker, "conform", lambda *_, error=error: (_ for _ in ()).throw(error))
        assert refused(EXAMPLE.read_bytes(), tmp_path, capsys) == f"the check ended with {type(error).__name__}"
