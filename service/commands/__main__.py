"""Run the command `cleave` as ``python -m service.commands``."""

import sys

from service.commands.main import main

sys.exit(main())
