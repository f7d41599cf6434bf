"""The program `railspring`, which is a part of this package's module."""

import os
import sys
import sysconfig

from . import _native


def main() -> int:
    """Runs the program with the arguments of the process; its exit code."""
    script = os.path.join(sysconfig.get_path("scripts"), "railspring" + sysconfig.get_config_var("EXE"))
    command = script if os.path.isfile(script) else None
    return _native.run_program(["railspring", *sys.argv[1:]], _native.__file__, command)


if __name__ == "__main__":
    sys.exit(main())
