"""The commands, and what they do as functions."""
from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

from . import _core, _options
from ._errors import Error, RobotError, translated
from ._robot import Robot

STUDY = ("backend", "precision", "trig", "layout", "samples", "seed", "qd_range", "qdd_range", "batch", "device", "threads")


def program(name: str) -> str:
    """The path of a command that the package has: beside the extension, which stands elsewhere than this file where the package
    is installed for editing."""
    return str(Path(_core.__file__).parent / "bin" / name)


def main(name: str = "rneagen") -> None:
    """Become the command."""
    path = program(name)
    if not os.path.exists(path):
        sys.exit(f"{name}: {path} is missing: install the package again")
    os.execv(path, [name, *sys.argv[1:]])


def main_rnearun() -> None:
    main("rnearun")


class Text(str):
    """A generated text, with the `name` that prefixes its functions, the `header` of target c (else None) and `warnings`."""
    name: str
    header: str | None
    warnings: list[str]


def generate(urdf: str | os.PathLike | bytes, target: str = "cuda", **options: Any) -> Text:
    """The text for a URDF, as the command `rneagen` writes it. `target`: "cuda", "c" or "header"; other keywords are
    those of load that concern the model, and layout, name, bounded, only, parts, segments, limbs."""
    known = (*_options.scene_keywords(), *_options.MODEL, *_options.TEXT)
    _options.check(options, known, "generate")
    content, file = _options.read(urdf)
    made = translated(_core.generate, content, _options.generator({"target": target, **_options.taken(options)}, file))
    text = Text(made["source"])
    text.name, text.header, text.warnings = made["name"], made["header"], made["warnings"]
    return text


def run(command: list[str]) -> str:
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        message = done.stderr.strip().split("\n")[-1]
        raise (RobotError if done.returncode == 2 else Error)(message, "USAGE" if done.returncode == 2 else "COMMAND")
    return done.stdout


def study_words(robot: str | os.PathLike | Robot, options: dict[str, Any], more: tuple[str, ...], function: str) -> list[str]:
    """The URDF and the options, as words; of a robot, those that it was loaded with."""
    options = _options.taken(options)
    if isinstance(robot, Robot):
        own = {k: v for k, v in robot._options.items() if k not in ("backend", "sparse", "convention", "block", "cache")}
        options = {**own, **options}
        robot = robot._file
        if robot == "<urdf>":
            raise ValueError(f"{function}() needs the URDF's file, and the robot was loaded from a text")
    _options.check(options, (*_options.scene_keywords(), *_options.MODEL, *STUDY, *more), function)
    return [os.fspath(robot), *_options.command_line(options)]


def report(robot: str | os.PathLike | Robot, plot: str | os.PathLike | None = None, **options: Any) -> list[dict[str, Any]]:
    """Every variant of a robot measured on this machine, as `rnearun report` does: a dictionary for each, with
    backend, precision, trig, layout, batch, ns_per_sample, error_max, bound_max, ... `plot`: an SVG that is drawn.
    Takes about half a minute."""
    words = study_words(robot, options, (), "report")
    plotted = [] if plot is None else [f"--plot={os.fspath(plot)}"]
    return json.loads(run([program("rnearun"), "report", *words, "--format=json", "--quiet", *plotted]))["rows"]


class Choice(str):
    """What `rnearun choose` prints, with the variant that it chose, and the command that generates it."""
    backend: str
    precision: str
    trig: str
    layout: str
    command: str


def choose(
        robot: str | os.PathLike | Robot, max_error: float, measured: bool = False, proved: bool = False,
        **options: Any) -> Choice:
    """The fastest variant whose error, by its bound or as measured, is at most `max_error`, relative to the torques.
    `proved`: by a bound that holds for every state within the limits of the joints and `range`."""
    words = study_words(robot, options, (), "choose")
    judged = [*(["--measured"] if measured else []), *(["--proved"] if proved else [])]
    most = f"--max-error={_options.number('max_error', max_error)}"
    text = run([program("rnearun"), "choose", *words, most, "--quiet", *judged])
    choice = Choice(text)
    lines = text.strip().split("\n")
    choice.backend, choice.precision, choice.trig, choice.layout = lines[0].split()[:4]
    choice.command = lines[-1]
    return choice
