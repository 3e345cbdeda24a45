"""Walls about a program: bubblewrap, where it is there, shows it nothing but the system and its own folders."""

import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from shutil import which

_SYSTEM = ("/usr", "/bin", "/sbin", "/lib", "/lib32", "/lib64", "/libx32")
_SETTINGS = ("/etc/alternatives", "/etc/ld.so.cache", "/etc/ld.so.conf", "/etc/ld.so.conf.d")
"""What compilers and programs need of /etc; nothing that tells of the machine's people."""
_TEMPORARY = ".tmp"
"""Stands for /tmp and /dev/shm, in the program's folder, so that what is written there counts, too."""


@dataclass(frozen=True, slots=True)
class Walls:
    """How a program is kept apart.

    Attributes:
        bubblewrap: the program, None if there are no walls.
        why_not: why there are none.

    """

    bubblewrap: str | None
    why_not: str = ""

    @property
    def told(self) -> str:
        """A sentence for the report."""
        if self.bubblewrap:
            return "Each program ran under bubblewrap: without network, and with nothing but its own folder to see."
        return (
            "The programs ran without walls, as any program of yours: they could use the network, read all your files, "
            f"each other's among them, and write them ({self.why_not})."
        )

    def around(self, command: Sequence[str], folder: Path, seen: Sequence[Path]) -> list[str]:
        """The command that runs `command` within the walls.

        Args:
            command: its words.
            folder: where it runs, and the only place where it may write.
            seen: files and folders that it may read, under their own names.

        """
        if self.bubblewrap is None:
            return list(command)
        temporary = folder / _TEMPORARY
        temporary.mkdir(exist_ok=True)
        words = [self.bubblewrap, "--unshare-all", "--die-with-parent", "--new-session", "--cap-drop", "ALL"]
        words += ["--hostname", "grade", "--proc", "/proc", "--dev", "/dev", "--tmpfs", "/run"]
        for shared in ("/tmp", "/dev/shm"):
            words += ["--bind", str(temporary), shared]
        for name in _SYSTEM:
            if Path(name).is_symlink():
                words += ["--symlink", str(Path(name).readlink()), name]
            elif Path(name).exists():
                words += ["--ro-bind", name, name]
        for name in _SETTINGS:
            words += ["--ro-bind-try", name, name]
        for path in sorted({*seen}):
            words += ["--ro-bind", str(path), str(path)]
        words += ["--bind", str(folder), str(folder)]
        for place in ("/dev", "/run", "/"):
            words += ["--remount-ro", place]
        return [*words, "--chdir", str(folder), "--", *command]


@cache
def find_walls() -> Walls:
    """Bubblewrap, if it is installed and works here: some systems let only root make its name spaces."""
    bubblewrap = which("bwrap")
    if bubblewrap is None:
        return Walls(None, "bubblewrap, the program bwrap, is not installed")
    words = [bubblewrap, "--unshare-all", "--die-with-parent", "--ro-bind", "/", "/", "--proc", "/proc", "true"]
    try:
        tried = subprocess.run(words, capture_output=True, timeout=20, check=False, stdin=subprocess.DEVNULL)
    except (OSError, subprocess.TimeoutExpired) as error:
        return Walls(None, f"bubblewrap does not run: {error}")
    if tried.returncode:
        told = tried.stderr.decode(errors="replace").strip().partition("\n")[0]
        return Walls(None, f"bubblewrap does not work here: {told or f'status {tried.returncode}'}")
    return Walls(bubblewrap)
