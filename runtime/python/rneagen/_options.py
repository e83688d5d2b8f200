"""Keywords as the options of the command line: the same words, with underscores for dashes."""
from __future__ import annotations

import difflib
import os
import re
from typing import Any, Iterable, NamedTuple

from . import _core
from ._errors import translated

SCENE = _core.scene_words()  # word: (takes a value: 0 no, 1 yes, 2 may; kind)
MODEL = ("precision", "trig", "base", "gravity", "mimic", "order", "strict")  # beside the scene: what is computed
COUNTED = {"parts": ("auto",), "segments": ("auto", "whole"), "limbs": ("auto", "none")}  # numbers, and words that are 0 and 1
TEXT = ("target", "layout", "name", "bounded", "only", *COUNTED)  # what kind of text
OPEN = ("backend", "device", "threads", "block", "cache")  # where it runs
ASKED = ("want", "jvp", "vjp", "by")  # what is computed: robots with other outputs have others
STANDING = ("contact", "weld")  # of accelerations alone
FOUND = ("qdd", "qdd_bound", "Minv", "dqdd_", "contact.", "weld.")  # words, or how they begin, of outputs that find qdd
NEEDED = {"want": "output", "tip": "link", "lock_all_but": "joint", "order": "joint"}  # of which a list of nothing is refused


class SceneFile(NamedTuple):
    """A file of scene=, as it was when the robot was loaded."""
    path: str
    text: str

    def without(self, words: Iterable[str]) -> "SceneFile":
        """Empty lines in place of these: messages tell of lines by their numbers."""
        words = set(words)
        kept = ["" if line.split()[:1] and line.split()[0] in words else line for line in self.text.split("\n")]
        return self._replace(text="\n".join(kept))

    def __repr__(self) -> str:
        return repr(self.path)


def read(urdf: str | os.PathLike | bytes) -> tuple[bytes, str]:
    """The text of a URDF and its file, from either. Every text has a "<", in UTF-16 too."""
    if isinstance(urdf, str) and ("<robot" in urdf or urdf.lstrip("\ufeff \t\r\n").startswith("<")):
        return urdf.encode(), "<urdf>"
    if isinstance(urdf, bytes) and (b"<" in urdf or not urdf):
        return urdf, "<urdf>"
    if not isinstance(urdf, (str, bytes, os.PathLike)):
        raise TypeError(f"the URDF is a path, or its text, not {urdf!r}")
    with open(urdf, "rb") as file:
        return file.read(), os.fsdecode(urdf)


def scene_keywords() -> list[str]:
    return [word.replace("-", "_") for word in SCENE] + ["scene"]


def check(options: Iterable[str], known: Iterable[str], function: str) -> None:
    """An unknown keyword is a TypeError that names the nearest."""
    known = list(known)
    for name in options:
        if name not in known:
            near = difflib.get_close_matches(name, known, 1)
            raise TypeError(f"{function}() has no keyword '{name}'" + (f"; did you mean '{near[0]}'?" if near else ""))


def ordered(keyword: str, x: Any) -> Any:
    """Names of a set would come in another order in the next process, and with them rows and outputs."""
    if isinstance(x, (set, frozenset)):
        raise TypeError(f"{keyword} takes what has an order, a list for one, not a {type(x).__name__}")
    return x


def number(keyword: str, x: Any) -> str:
    if isinstance(x, str):
        return x
    if isinstance(x, bool) or not hasattr(x, "__float__"):
        raise TypeError(f"{keyword} takes a number, not {x!r}")
    return str(x) if isinstance(x, int) else repr(float(x))


def numbers(keyword: str, x: Any) -> str:
    if isinstance(x, str) or hasattr(x, "__float__") and not getattr(x, "ndim", 0):
        return number(keyword, x)
    try:
        return ",".join(number(keyword, one) for one in x)
    except TypeError:
        raise TypeError(f"{keyword} takes numbers, not {x!r}") from None


def flag(keyword: str, x: Any) -> bool:
    if not isinstance(x, bool):
        raise TypeError(f"{keyword} takes True or False, not {x!r}")
    return x


def names(keyword: str, x: Any) -> list[str]:
    x = [x] if isinstance(x, str) else list(ordered(keyword, x)) if isinstance(x, Iterable) else [x]
    for name in x:
        if not isinstance(name, str):
            raise TypeError(f"{keyword} takes names, not {name!r}")
    return x


def pairs(keyword: str, x: Any) -> list[str]:
    if hasattr(x, "items"):
        return [f"{name}={numbers(keyword, value)}" for name, value in x.items()]
    if not isinstance(x, Iterable) or hasattr(x, "__len__") and not all(isinstance(one, str) for one in x):
        raise TypeError(f'{keyword} takes {{"NAME": VALUE}}, not {x!r}')
    return names(keyword, x)


def armature_of(path: str) -> list[str]:
    """A file of rotor inertias, as pairs."""
    with open(path, encoding="utf-8") as file:
        text = translated(_core.armature, path, file.read())
    pairs = (line.partition('"')[2][:-1] for line in text.split("\n")[1:] if line)  # armature "JOINT=KG_M2"
    return [re.sub(r"\\(.)", lambda found: found[1].replace("n", "\n"), pair) for pair in pairs]


def owned(keyword: str, x: Any) -> Any:
    """The same in lists, dictionaries and numbers that nobody else changes, and that can be gone through again."""
    if x is None or isinstance(x, (bool, int, float, str, bytes, os.PathLike)):
        return x
    if hasattr(x, "items"):
        return {name: owned(keyword, value) for name, value in x.items()}
    if hasattr(x, "tolist"):  # of NumPy and its like
        return x.tolist()
    return [owned(keyword, one) for one in ordered(keyword, x)] if isinstance(x, Iterable) else x


def finds_qdd(word: Any) -> bool:
    return any(str(word).startswith(name) if name[-1] in "._" else word == name for name in FOUND)


def refuse_nothing(options: dict[str, Any]) -> None:
    """Where products are asked for, there need be no other output."""
    for keyword, what in NEEDED.items():
        if options.get(keyword) in ([], {}) and not (keyword == "want" and (options.get("jvp") or options.get("vjp"))):
            raise ValueError(f"{keyword} takes one {what} or more")


def taken(options: dict[str, Any]) -> dict[str, Any]:
    """The keywords, with what files hold in place of their names; what is wrong with those of the call is said here."""
    options = {keyword: owned(keyword, x) for keyword, x in options.items()}
    refuse_nothing(options)
    path, armature = options.get("scene"), options.get("armature")
    if path is not None:
        with open(path, encoding="utf-8") as file:
            options["scene"] = SceneFile(os.fspath(path), file.read())
    if isinstance(armature, (str, os.PathLike)) and "=" not in os.fspath(armature):
        options["armature"] = armature_of(os.fspath(armature))
    if isinstance(options.get("cache"), os.PathLike):
        options["cache"] = os.fspath(options["cache"])
    if options.get("sparse") is not None:
        flag("sparse", options["sparse"])
    _core.check_open({k: options[k] for k in OPEN if options.get(k) is not None})
    return options


def values(keyword: str, x: Any) -> list[str | None]:
    """What stands after the word of a scene's option, once for each time that it is given; None: nothing."""
    takes, kind = SCENE[keyword.replace("_", "-")]
    if x is None or x is False:
        return []
    if x is True:
        if takes == 1:
            raise TypeError(f"{keyword} takes a value, not True")
        return [None]
    if takes == 0:
        flag(keyword, x)
    if kind == "pair":
        return list(pairs(keyword, x))
    if kind in ("names", "freed"):
        return list(names(keyword, x))
    return [numbers(keyword, x)]


def quoted(value: str) -> str:
    return ' "' + value.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n") + '"'


def lines(options: dict[str, Any]) -> str:
    """The scene's lines. They keep their dashes: messages then name the option."""
    text = []
    for keyword, x in options.items():
        if keyword == "scene" and x is not None:
            text += [f"--scene{quoted(x.path)}", x.text]
        elif keyword.replace("_", "-") in SCENE:
            for value in values(keyword, x):
                text.append(f"--{keyword.replace('_', '-')}{'' if value is None else quoted(value)}")
    return "".join(line + "\n" for line in text)


def generator(options: dict[str, Any], file: str) -> dict[str, Any]:
    """What _core takes: of keywords, those of the model and of the text."""
    result: dict[str, Any] = {"file": file.encode(errors="replace").decode()}  # a name of any bytes, in messages
    for keyword in (*MODEL, *TEXT):
        x = options.get(keyword)
        if x is None:
            continue
        if keyword == "bounded" and isinstance(x, str):
            if x != "running":
                raise ValueError(f"bounded takes True, False or running, not {x!r}")
            x = 2
        elif keyword in ("strict", "bounded"):
            x = int(flag(keyword, x))
        elif keyword == "order" and not isinstance(x, str):
            x = ",".join(names(keyword, x))
        elif keyword in COUNTED and isinstance(x, str):
            if x not in COUNTED[keyword]:
                raise ValueError(f"{keyword} takes {' or '.join(('a number', *COUNTED[keyword]))}, not {x!r}")
            x = COUNTED[keyword].index(x)
        result[keyword] = x
    scene = lines(options)
    if scene:
        result["scene"] = scene
    return result


def explained(error: Exception, scene: str) -> Exception:
    """The same, which tells of a name that is no link but a frame of the scene."""
    found = re.search(r"(\w+): no link '(.*?)'", str(error))
    option, name = found.groups() if found else ("", "")
    frame = re.search(rf'^\s*(?:--)?add-frame[ \t"]+{re.escape(name)}=([^",\n]*),', scene, re.M)
    if found and frame:
        moved = "; force f and moment m in it are R f and R m + p x R f of the link, where it stands at [R p]"
        error.args = (f"{error}; it is a frame of add_frame= on '{frame[1]}', and {option}= takes links"
                      f"{moved if option == 'fext' else ''}",)
    return error


def command_line(options: dict[str, Any]) -> list[str]:
    """The same as words of a command line."""
    words = []
    for keyword, x in options.items():
        word = keyword.replace("_", "-")
        if keyword != "scene" and word in SCENE:
            words += [f"--{word}" if value is None else f"--{word}={value}" for value in values(keyword, x)]
        elif isinstance(x, bool):
            words += [f"--{word}"] if x else []
        elif keyword == "gravity":
            words.append(f"--{word}={numbers(keyword, x)}")
        elif isinstance(x, (list, tuple)):
            words.append(f"--{word}={','.join(map(str, x))}")
        elif keyword == "scene" and x is not None:
            words.append(f"--scene={x.path}")
        elif x is not None:
            words.append(f"--{word}={os.fspath(x) if isinstance(x, os.PathLike) else number(keyword, x)}")
    return words
