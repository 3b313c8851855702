#!/usr/bin/python3
"""Lists the cases of the Python tests in groups that share a process, one a line: folder/module,
name of the group, its cases as Class.method. Most of what a short case takes is to start Python and
to import numpy and h5py. A module that cannot be imported is a line without a group: run as a
whole, it fails and says why."""
import importlib.util
import sys
import unittest
from pathlib import Path

TESTS = Path(__file__).resolve().parent
MOST = 6  # cases of a group: long classes run on several processors


def groups_of(script):
    """Names of groups of a script's test methods, and these, as its own command line takes them."""
    sys.path.insert(0, str(script.parent))
    spec = importlib.util.spec_from_file_location(script.stem, script)
    module = importlib.util.module_from_spec(spec)
    sys.modules[script.stem] = module
    try:
        spec.loader.exec_module(module)
    except Exception:
        return [("", [])]
    loader = unittest.TestLoader()
    classes = [c for c in vars(module).values()
               if isinstance(c, type) and issubclass(c, unittest.TestCase)
               and c.__module__ == script.stem]
    groups = []
    for c in classes:
        cases = [f"{c.__name__}.{name}" for name in loader.getTestCaseNames(c)]
        parts = [cases[k:k + MOST] for k in range(0, len(cases), MOST)]
        groups += [(c.__name__ + (f".{k}" if len(parts) > 1 else ""), part)
                   for k, part in enumerate(parts, 1)]
    return groups


if __name__ == "__main__":
    for found in sorted([*TESTS.glob("regression/test_*.py"), *TESTS.glob("stress/test_*.py"),
                         *TESTS.glob("python/test_*.py")]):
        for group, cases in groups_of(found):
            print(found.relative_to(TESTS).with_suffix(""), group, *cases)
