"""python -m rneagen: the command `rneagen`."""
from ._commands import main

main()
