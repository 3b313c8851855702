#!/usr/bin/python3
"""Lists the cases of the Python tests, one a line: folder/module Class.method. A module that cannot
be imported is a line without a case: run as a whole, it fails and says why."""
import importlib.util
import sys
import unittest
from pathlib import Path

TESTS = Path(__file__).resolve().parent


def cases_of(script):
    """Names of a script's test methods, as its own command line takes them."""
    sys.path.insert(0, str(script.parent))
    spec = importlib.util.spec_from_file_location(script.stem, script)
    module = importlib.util.module_from_spec(spec)
    sys.modules[script.stem] = module
    try:
        spec.loader.exec_module(module)
    except Exception:
        return [""]
    loader = unittest.TestLoader()
    classes = [c for c in vars(module).values()
               if isinstance(c, type) and issubclass(c, unittest.TestCase)
               and c.__module__ == script.stem]
    return [f"{c.__name__}.{name}" for c in classes for name in loader.getTestCaseNames(c)]


if __name__ == "__main__":
    for found in sorted([*TESTS.glob("regression/test_*.py"), *TESTS.glob("stress/test_*.py"),
                         *TESTS.glob("python/test_*.py")]):
        for case in cases_of(found):
            print(found.relative_to(TESTS).with_suffix(""), case)
