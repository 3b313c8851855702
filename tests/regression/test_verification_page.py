#!/usr/bin/python3
"""tools/verification_page: numbers in, tables out."""
import json
import subprocess
import tempfile
import unittest
from pathlib import Path

PAGE = Path(__file__).resolve().parents[2] / "tools/verification_page"


def row(section, quantity, value, **more):
    return {"section": section, "quantity": quantity, "value": value, "reference": 1.0,
            "tolerance": 0.1,
            "unit": "", "note": "", "pass": True, **more}


class Page(unittest.TestCase):
    def make(self, *files):
        """The page's text and the finished process, for files of these lines."""
        with tempfile.TemporaryDirectory() as folder:
            page = Path(folder, "page.md")
            for k, lines in enumerate(files):
                Path(folder, f"{k}.jsonl").write_text("\n".join(lines) + "\n")
            run = subprocess.run([str(PAGE), folder, str(page)], capture_output=True, text=True)
            return page.read_text() if page.exists() else None, run

    def test_tables(self):
        rows = [row("Tension", "E/Eb, L/l = 20", 0.5),
                row("Beams", "tip", -23.5, unit="m", note="a|b"),
                row("Tension", "E/Eb, L/l = 20", 1.05),
                row("Tension", "bad", 2.0, **{"pass": False}),
                row("Beams", "reported", 3e-13, reference=None, tolerance=None)]
        lines = [json.dumps(r) for r in rows]
        text, run = self.make(lines[:3], lines[3:])
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("2 of 3 comparisons pass", text)
        self.assertIn("| E/Eb, L/l = 20 | 1.05 | 1 | 0.1 | pass |", text)
        self.assertIn("| bad | 2 | 1 | 0.1 | **fail** |", text)
        self.assertIn("| tip | -23.5 | 1 | 0.1 | m | pass | a\\|b |", text)
        self.assertIn("| reported | 3e-13 |  |  |", text)
        self.assertLess(text.index("## Tension"), text.index("## Beams"))

    def test_broken_record(self):
        text, run = self.make()
        self.assertEqual((text, run.returncode), (None, 2))
        self.assertIn("holds no numbers", run.stderr)
        text, run = self.make(['{"section": "a"'])
        self.assertEqual(text, None)
        self.assertEqual(run.returncode, 2)
        self.assertIn("line 1", run.stderr)


if __name__ == "__main__":
    unittest.main()
