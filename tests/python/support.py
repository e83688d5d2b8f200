"""What the tests of the Python package share. PYTHONPATH names the package: of the build tree, or installed."""
import os
import sys
from pathlib import Path

sys.dont_write_bytecode = True
ROBOTS = Path(__file__).resolve().parent.parent / "robots"
SEED = 5


def skip(why):
    print(f"skipped: {why}")
    sys.exit(77)


def need(*names):
    """These modules; where one is missing the test is skipped."""
    found = []
    for name in names:
        try:
            found.append(__import__(name))
        except ImportError as error:
            skip(str(error))
    return found


def package():
    """rneagen, and NumPy."""
    numpy, = need("numpy")
    if sys.version_info < (3, 11):
        skip("the package needs Python 3.11")
    import rneagen
    return rneagen, numpy


def robot_file(name):
    return str(ROBOTS / f"{name}.urdf")


def error_of(numpy, computed, right):
    """||computed - right|| / ||right||, of all samples the largest."""
    axis = tuple(range(1, right.ndim))
    size = numpy.sqrt((right.astype(float) ** 2).sum(axis))
    off = numpy.sqrt(((computed.astype(float) - right) ** 2).sum(axis))
    return float((off / numpy.where(size == 0, 1, size)).max()) if computed.shape == right.shape else float("inf")


def refused(kind, words, function, *args, **kwargs):
    """The call raises `kind`, and the message has all of `words`."""
    try:
        function(*args, **kwargs)
    except kind as error:
        missing = [word for word in words if word not in str(error)]
        assert not missing, f"{error!r} says nothing of {missing}"
        return
    raise AssertionError(f"{kind.__name__} about {words} was not raised")


def run_all(cases):
    """Functions named test_..., each of which raises if it fails; exit status 1 if any did."""
    import traceback
    failed = []
    for name, case in list(cases.items()):
        if name.startswith("test_") and (len(sys.argv) < 2 or name in sys.argv[1:]):
            try:
                case()
            except Exception:
                traceback.print_exc()
                failed.append(name)
    print(f"failed: {', '.join(failed)}" if failed else "passed")
    sys.exit(bool(failed))


def exhaustive():
    return bool(os.environ.get("RNEAGEN_ALL"))
