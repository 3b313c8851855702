"""What pip asks for (PEP 517): floe built by CMake, as a wheel for the Python that runs pip and for
this machine. Standard library only, so that `pip install .` works without a network."""
import base64
import hashlib
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import tempfile
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
BUILD = ROOT / "build/pip"
NEEDS = ["numpy"]
EXTRA = {"results": ["dask", "h5py", "matplotlib", "pandas", "pyyaml", "scipy", "xarray"],
         "mpi": ["mpi4py"]}
# Of what is installed: what Python's wheels have no place for.
LEFT_OUT = ("share/doc", "share/man")


def version():
    """That of CMakeLists.txt."""
    return re.search(r"^project\(floe VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text(),
                     re.M)[1]


def metadata():
    lines = ["Metadata-Version: 2.1", "Name: floe", f"Version: {version()}",
             "Summary: floating sea ice as rigid bodies joined by beams",
             "Requires-Python: >=3.9", *(f"Requires-Dist: {name}" for name in NEEDS)]
    for extra, names in EXTRA.items():
        lines += [f"Provides-Extra: {extra}",
                  *(f'Requires-Dist: {name}; extra == "{extra}"' for name in names)]
    return "\n".join(lines) + "\n"


def tag():
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{python}-{python}-{re.sub('[-.]', '_', sysconfig.get_platform())}"


def build(options):
    """Builds floe. options: further ones of CMake's configuration."""
    for program in ("cmake", "ninja"):
        if not shutil.which(program):
            sys.exit(f"floe needs {program}: tools/setup installs all that it is built with")
    configure = ["cmake", "--preset", "release", "-B", BUILD,
                 f"-DPython_EXECUTABLE={sys.executable}", "-DFLOE_TESTS=OFF",
                 "-DFLOE_PYTHON=ON", "-DCMAKE_INSTALL_LIBDIR=lib", *options]
    said = subprocess.run(configure, cwd=ROOT, stdout=subprocess.PIPE, text=True)
    print(said.stdout, flush=True)
    if said.returncode != 0:
        sys.exit("floe: CMake failed; tools/setup installs all that floe is built with")
    if "floe for Python: left out" in said.stdout:
        sys.exit("floe: its module needs Python's headers and pybind11 (python3-dev, pybind11-dev)")
    subprocess.run(["cmake", "--build", BUILD, "--target", "manual", "floe_python"], check=True)


def install(stage):
    """Installs what was built into an empty folder."""
    for component in ("program", "python"):
        subprocess.run(["cmake", "--install", BUILD, "--prefix", stage, "--component", component],
                       check=True, stdout=subprocess.DEVNULL)


def contents(stage):
    """[(place in the wheel, file)]: the package, then the prefix with programs and libraries. A
    wheel has no links: a library has the name by which programs ask for it."""
    packages = stage / "lib/python3/dist-packages"
    linked = {path.resolve() for path in stage.rglob("*.so*") if path.is_symlink()}
    found = []
    for path in sorted(stage.rglob("*")):
        name = path.relative_to(stage).as_posix()
        if path.is_dir() or path in linked or name.startswith(LEFT_OUT):
            continue
        place = (path.relative_to(packages).as_posix() if path.is_relative_to(packages)
                 else f"floe-{version()}.data/data/{name}")
        found.append((place, path))
    return found


def about():
    """[(name, text)] of the files that describe the wheel, without the list of all files."""
    return [("METADATA", metadata()),
            ("WHEEL", "Wheel-Version: 1.0\nGenerator: floe\nRoot-Is-Purelib: false\n"
                      f"Tag: {tag()}\n")]


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    """What pip wants to know before anything is built."""
    information = Path(metadata_directory) / f"floe-{version()}.dist-info"
    information.mkdir()
    for name, text in about():
        (information / name).write_text(text)
    return information.name


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """config_settings: "cmake": further options of CMake's configuration, one or a list."""
    options = (config_settings or {}).get("cmake", [])
    build([options] if isinstance(options, str) else list(options))
    information = f"floe-{version()}.dist-info"
    record = []
    name = f"floe-{version()}-{tag()}.whl"
    with (tempfile.TemporaryDirectory() as stage,
          zipfile.ZipFile(Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel):
        def add(place, data, executable=False):
            entry = zipfile.ZipInfo(place)
            entry.external_attr = (0o100755 if executable else 0o100644) << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            wheel.writestr(entry, data)
            digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
            record.append(f"{place},sha256={digest},{len(data)}")

        install(stage)
        for place, path in contents(Path(stage).resolve()):
            add(place, path.read_bytes(), bool(path.stat().st_mode & 0o100))
        for file, text in about():
            add(f"{information}/{file}", text.encode())
        record.append(f"{information}/RECORD,,\n")
        wheel.writestr(f"{information}/RECORD", "\n".join(record))
    return name


def build_sdist(sdist_directory, config_settings=None):
    """All files that git knows."""
    names = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True,
                           text=True).stdout.split("\0")[:-1]
    base = f"floe-{version()}"
    with tarfile.open(Path(sdist_directory) / f"{base}.tar.gz", "w:gz") as archive:
        for name in names:
            archive.add(ROOT / name, f"{base}/{name}", recursive=False)
        text = BUILD / "PKG-INFO"
        text.parent.mkdir(parents=True, exist_ok=True)
        text.write_text(metadata())
        archive.add(text, f"{base}/PKG-INFO")
    return f"{base}.tar.gz"
