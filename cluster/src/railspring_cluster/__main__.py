"""``python -m railspring_cluster``: settings and cases on standard input, a line of JSON each; events on standard output."""

import sys

from .client import main

sys.exit(main())
