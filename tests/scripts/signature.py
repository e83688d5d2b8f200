"""Functions of texts for target C, as scripts call them: what they take, and the functions themselves."""
import ctypes
import os
import re
import shutil
import subprocess
from pathlib import Path
from typing import NamedTuple

CC = shutil.which(os.environ.get("CC", "cc"))
QUICK_CC = Path(__file__).resolve().parents[1] / "target" / "quick_cc"


class Signature(NamedTuple):
    name: str
    parameters: str  # as they are declared
    arrays: list  # their names, the inputs first
    inputs: int


def signature(text, name):
    """Of the function of one sample with this name, a pattern, out of a text or its header."""
    name, parameters = re.search(rf"\nvoid ({name})\(([^;]*?)\)", text).groups()
    return Signature(name, parameters, re.findall(r"(\w+)\[", parameters), parameters.count("const "))


def call_defines(f, number, size):
    """For a program that calls the function as CALL, on arrays `T a[ARRAYS][SIZE]`, the first INPUTS of which are inputs."""
    calls = ", ".join(f"a[{k}]" for k in range(len(f.arrays)))
    return [f"-DT={number}", f"-DARRAYS={len(f.arrays)}", f"-DINPUTS={f.inputs}", f"-DSIZE={size}", f"-DCALL={f.name}({calls})"]


def loaded(text, name):
    """The function of the text at this path, compiled without optimisation, and the names of its arrays."""
    library = text.with_suffix(".so")
    subprocess.run([QUICK_CC, "-std=c11", "-shared", "-fPIC", "-o", library, text, "-lm"], check=True)
    found = signature(text.with_suffix(".h").read_text(), name)
    return getattr(ctypes.CDLL(str(library)), found.name), found.arrays
