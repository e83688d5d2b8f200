"""Where the URDF of a robot is."""
from pathlib import Path

OWN = Path(__file__).resolve().parents[1] / "robots"


def find(robot, folder=None):
    """The path among the repository's own, else in this folder; None: it is not there."""
    return next((p for p in (f / f"{robot}.urdf" for f in (OWN, folder) if f) if p.exists()), None)
