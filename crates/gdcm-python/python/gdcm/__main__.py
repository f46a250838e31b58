"""`python -m gdcm` is the program `gdcm`."""

import sys

from . import main

sys.exit(main())
