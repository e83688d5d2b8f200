"""The keywords of load, for editors and type checkers."""
from __future__ import annotations

import os
from typing import Any, Iterable, Literal, Mapping, SupportsFloat, TypedDict

Names = str | Iterable[str]
Numbers = SupportsFloat | Iterable[SupportsFloat]
Pairs = Mapping[str, Numbers] | Names  # or "NAME=VALUE"


class Keywords(TypedDict, total=False):
    """None: as if it were not given."""
    # links and joints
    root: str | None
    tip: Names | None
    beside: Literal["lock", "drop"] | None
    lock: Pairs | None
    lock_all_but: Names | None
    base: Literal["fixed", "floating"] | None
    mimic: Literal["honour", "independent"] | None
    order: Names | None
    # inputs
    fold: Pairs | None
    free: Names | None
    fext: Names | None
    fext_frame: str | None
    contact: Names | None
    weld: Names | None
    gravity: Iterable[SupportsFloat] | None
    armature: Pairs | os.PathLike | None
    damping: bool | None
    friction: bool | SupportsFloat | None
    range: Mapping[str, Any] | Names | None
    # outputs
    want: Names | None
    jvp: Names | None
    vjp: Names | None
    by: Names | None
    dense: bool | None
    sparse: bool | None
    pose: str | None
    frame: str | None
    add_frame: Mapping[str, Any] | Names | None
    # how they are computed
    precision: Literal["f32", "f64", "mixed", "f32x2"] | None
    trig: Literal["accurate", "bounded", "fast"] | None
    strict: bool | None
    params: str | None
    derivatives: str | None
    dynamics: str | None
    refine: str | int | None
    snap_angle: SupportsFloat | None
    round_constants: SupportsFloat | None
    drop_below: str | SupportsFloat | None
    parts: int | Literal["auto"] | None
    segments: int | Literal["auto", "whole"] | None
    limbs: int | Literal["auto", "none"] | None
    # all of it in a file
    scene: str | os.PathLike | None
    # the call
    backend: Literal["any", "cpu", "cuda", "evaluator"] | None
    device: int | None
    threads: int | None
    block: int | None
    cache: str | os.PathLike | None
    convention: Literal["pinocchio", "mujoco"] | None
