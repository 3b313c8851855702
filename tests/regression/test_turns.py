#!/usr/bin/python3
"""Ranks that wait for each other take short turns (src/session/launcher.h); a process alone does
not ask for them."""
import ctypes
import os
import platform
import struct
import unittest

from running import RunningTest

# sched_getattr(2); what it fills in: size, policy, flags, nice, priority, runtime, ...
NUMBER = {"x86_64": 315, "aarch64": 275}.get(platform.machine())
ATTRIBUTES = struct.Struct("IIQiIQQQ")
SHORTEST = 100_000  # [ns]


def turn_of(process):
    """Length of the turns of a process [ns]."""
    data = ctypes.create_string_buffer(ATTRIBUTES.size)
    if ctypes.CDLL(None, use_errno=True).syscall(NUMBER, process, data, ATTRIBUTES.size, 0):
        raise OSError(ctypes.get_errno(), "sched_getattr")
    return ATTRIBUTES.unpack(data.raw)[5]


@unittest.skipIf(NUMBER is None, "another processor")
class Turns(RunningTest):
    def test_of_ranks(self):
        ours = turn_of(os.getpid())
        if ours <= SHORTEST:
            self.skipTest("this kernel does not tell, or all turns are short here")
        for ranks in (1, 2):
            process = self.running("-output_overwrite", ranks=ranks)
            turns = {turn_of(rank) for rank in self.ranks_of(process)}
            self.assertEqual(turns, {SHORTEST if ranks > 1 else ours})
            process.terminate()
            process.communicate()


if __name__ == "__main__":
    unittest.main()
