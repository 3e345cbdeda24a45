"""Files that appear whole or not at all."""

import errno
import os

import pytest

from converter.files import check_target, replacing


def test_a_file_is_replaced_whole_or_not_at_all(tmp_path):
    file = tmp_path / "a.csv"
    file.write_text("older")
    with pytest.raises(KeyboardInterrupt), replacing(file) as temporary:
        temporary.write_text("half")
        raise KeyboardInterrupt
    assert file.read_text() == "older"
    with replacing(file) as temporary:
        temporary.write_text("newer")
    assert file.read_text() == "newer"
    assert list(tmp_path.iterdir()) == [file]


def test_a_full_disk_is_told_of_the_file_that_was_meant(tmp_path):
    """Not of the other name that it has until it is whole, nor of none."""
    file = tmp_path / "a.csv"
    for name in (None, "temporary"):
        with pytest.raises(OSError, match="No space left") as full, replacing(file) as temporary:
            temporary.write_text("half")
            raise OSError(errno.ENOSPC, "No space left on device", str(temporary) if name else None)
        assert full.value.filename == str(file)
    with pytest.raises(FileNotFoundError) as other, replacing(file):
        (tmp_path / "missing").read_text()
    assert other.value.filename == str(tmp_path / "missing")
    assert list(tmp_path.iterdir()) == []


def test_a_link_stays_and_into_what_is_no_file_is_copied(tmp_path):
    (tmp_path / "link").symlink_to("file")
    with replacing(tmp_path / "link") as temporary:
        temporary.write_text("new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "file").read_text() == "new"
    os.mkfifo(tmp_path / "pipe")
    with os.fdopen(os.open(tmp_path / "pipe", os.O_RDWR), "rb", buffering=0) as reader:
        with replacing(tmp_path / "pipe", ".svg") as temporary:
            assert temporary.suffix == ".svg"
            temporary.write_text("new")
        assert reader.read(3) == b"new"
    assert (tmp_path / "pipe").is_fifo()


def test_a_target_that_cannot_be_written(tmp_path):
    check_target(tmp_path / "a")
    for path in (tmp_path, tmp_path / "nowhere" / "a"):
        with pytest.raises(OSError):
            check_target(path)
