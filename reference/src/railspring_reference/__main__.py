"""``python -m railspring_reference FOLDER``."""

import sys

from .run import main

sys.exit(main())
