"""Checks of a script that goes on after one that fails, and whether it is to be exhaustive (tests/run --all)."""
import os
import sys

ALL = os.environ.get("RNEAGEN_ALL", "0") not in ("", "0")
failed = 0


def check(condition, what):
    global failed
    if not condition:
        failed += 1
        print("FAILED:", what)


def finish():
    print("FAILED" if failed else "passed")
    sys.exit(failed != 0)
