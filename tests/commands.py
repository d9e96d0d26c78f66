"""Commands of the study as they are typed, and code in a process of its own."""

import shlex
import subprocess
import sys

from study.cli.main import main


def study(line):
    """Run a command that is given without the word ``study``; return its exit code, also where it ends the program."""
    try:
        return main(shlex.split(line))
    except SystemExit as end:
        return end.code


def python(code, *arguments, **options):
    """Run Python code in a process of its own; return what it prints and what it complains about."""
    command = [sys.executable, "-c", code, *arguments]
    done = subprocess.run(command, check=True, capture_output=True, text=True, **options)
    return done.stdout, done.stderr
