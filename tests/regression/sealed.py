"""Checkpoints as tests change them: the seal of a changed one is made anew, so that what is deeper
is looked at."""
import contextlib
import zlib

import h5py

SEAL = 512  # bytes


def seal_of(rest):
    """The first bytes of a file that goes on with `rest`."""
    text = b"floe checkpoint\nsize %d\ncrc32 %08x\n" % (SEAL + len(rest), zlib.crc32(rest))
    return text.ljust(SEAL, b"\n")


def seal(path):
    rest = path.read_bytes()[SEAL:]
    path.write_bytes(seal_of(rest) + rest)


@contextlib.contextmanager
def changed(path):
    """The HDF5 file of a checkpoint, to be changed; then it is sealed again."""
    with h5py.File(path, "r+") as file:
        yield file
    seal(path)
