"""The benchmarks are not part of the distribution: they are imported from the repository itself."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
