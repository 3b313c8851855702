#!/usr/bin/python3
"""Comments refer to sections of docs/model.md by titles that the page has, and never by numbers."""
import re
import unittest
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
FOLDERS = ("src", "include", "tests", "bench")
TITLES = re.compile(r'model\.md((?:,(?: and)? | and )"[^"]+")+')
NUMBER = re.compile(r"model\.md,? (?:sections? )?\d+")


def texts():
    """Path and text of each source, in which comments of several lines are one line."""
    for folder in FOLDERS:
        for path in sorted((REPOSITORY / folder).rglob("*")):
            if path.suffix in (".h", ".cpp", ".py") and path != Path(__file__).resolve():
                yield path.relative_to(REPOSITORY), re.sub(r"\n\s*(?:///?<?|#)?\s*", " ",
                                                           path.read_text())


class References(unittest.TestCase):
    def test_titles_are_headings(self):
        headings = set(re.findall(r"^#+ (?:\d+\. )?(.+)$",
                                  (REPOSITORY / "docs/model.md").read_text(), re.M))
        found = [(path, title) for path, text in texts() for reference in TITLES.finditer(text)
                 for title in re.findall('"([^"]+)"', reference[0])]
        self.assertGreater(len(found), 40)
        for path, title in found:
            with self.subTest(str(path), title=title):
                self.assertIn(title, headings)

    def test_no_section_is_a_number(self):
        for path, text in texts():
            with self.subTest(str(path)):
                self.assertEqual(NUMBER.findall(text), [])


if __name__ == "__main__":
    unittest.main()
