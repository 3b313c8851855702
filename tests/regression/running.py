"""Runs that a test looks at while they run: started in a temporary folder, waited for by what they
write."""
import json
import subprocess
import time
from pathlib import Path

from launch import ENVIRONMENT, FLOE, FolderTest, on_ranks, own_words
from small_scenes import AFLOAT

DONE, FAILED, BAD_INPUT, STOPPED = range(4)



class RunningTest(FolderTest):
    def setUp(self):
        super().setUp()
        self.write(AFLOAT)

    def write(self, scene, name="scene.yaml"):
        (self.folder / name).write_text(scene)

    def begin(self, *words, scene="scene.yaml", ranks=1, environment={}, **how):
        process = subprocess.Popen(on_ranks(ranks, [FLOE, scene, *words]), cwd=self.folder,
                                   stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True,
                                   env={**ENVIRONMENT, **environment}, **how)
        self.addCleanup(self.end, process)
        return process

    def finish(self, process, code=DONE):
        """What a process that must end with `code` said on its standard error."""
        out, err = process.communicate()
        self.assertEqual(process.returncode, code, out + err)
        return own_words(err)

    def floe(self, *words, code=DONE, **how):
        return self.finish(self.begin(*words, **how), code)

    def wait(self, process, condition):
        """Until something is there that the run writes."""
        while not condition():
            self.assertIsNone(process.poll(), "the run ended too early")
            time.sleep(0.005)

    def running(self, *words, rows=20, dir="out/scene", **how):
        """A run whose history has some rows."""
        history = self.folder / dir / "history.csv"
        history.unlink(missing_ok=True)  # an earlier run's
        process = self.begin(*words, "-output_dir", dir, **how)
        self.wait(process, lambda: history.exists() and history.read_text().count("\n") > rows)
        return process

    def ranks_of(self, process):
        """The processes of a run: mpiexec's children, or itself."""
        children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
        return [int(child) for child in children] or [process.pid]

    def stop(self, process, dir="out/scene"):
        (self.folder / dir / "STOP").touch()
        return self.finish(process, STOPPED)

    def summary(self, dir="out/scene"):
        return json.loads((self.folder / dir / "summary.json").read_text())

    def files(self, dir="."):
        """Every file below a folder and what is in it."""
        return {str(p.relative_to(self.folder)): p.read_bytes() if p.is_file() else None
                for p in sorted((self.folder / dir).rglob("*"))}

    def refused(self, *words, code=BAD_INPUT, **how):
        """The one line that a run is refused with; nothing is touched."""
        before = self.files()
        said = self.floe(*words, code=code, **how)
        self.assertEqual(said.count("\n"), 1, said)
        self.assertTrue(said.startswith("floe: "), said)
        self.assertEqual(before, self.files())
        return said


def processes_with(text):
    """Commands of running processes that contain the text."""
    found = []
    for entry in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            command = entry.read_bytes().replace(b"\0", b" ").decode(errors="replace")
        except OSError:
            continue  # it ended
        if text in command:
            found.append(command)
    return found
