"""Where the tools find the package floe that belongs to them: python/ of the source tree, or the
one place in which an installation has it."""
import importlib.util
import sys
from pathlib import Path

HERE = Path(__file__).resolve()


def load():
    """Makes `import floe` that package, whatever else Python's path has."""
    source = HERE.parents[1] / "python"
    if source.is_dir():
        sys.path.insert(0, str(source))
        return
    prefix = HERE.parents[3]  # of share/floe/tools
    found = sorted(prefix.glob("lib*/python3*/*-packages/floe/program.py"))
    if found and "floe" not in sys.modules:
        # Not by the path: the packages beside it are not for all Pythons that run a tool.
        folder = found[0].parent
        spec = importlib.util.spec_from_file_location(
            "floe", folder / "__init__.py", submodule_search_locations=[str(folder)])
        sys.modules["floe"] = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(sys.modules["floe"])
