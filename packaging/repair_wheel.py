"""Makes a wheel that other machines can use of the one in a folder: on Linux by auditwheel, elsewhere as it is.

python packaging/repair_wheel.py FROM TO
"""

import subprocess
import sys
from pathlib import Path
from shutil import copy


def main() -> None:
    """Leave the wheel in the second folder."""
    source, target = map(Path, sys.argv[1:3])
    target.mkdir(parents=True, exist_ok=True)
    (wheel,) = source.glob("*.whl")
    if sys.platform == "linux":
        subprocess.run([sys.executable, "-m", "auditwheel", "repair", "--wheel-dir", target, wheel], check=True)
    else:
        copy(wheel, target)


if __name__ == "__main__":
    main()
