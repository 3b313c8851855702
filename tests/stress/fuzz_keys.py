"""The keys of a scene, read from `floe -help_markdown`, and values for them: allowed ones and
hostile ones."""
import math
import re
import subprocess

import launch

ROW = re.compile(r"^\| `([^`]+)` \| (.*?)(?<!\\) \| (.*?)(?<!\\) \|")
NUMBER = r"[-+]?\d[\d.]*(?:e[-+]?\d+)?"

# What no key allows, and what looks like a number and is none; YAML's own signs among them.
ODD = ("nan", "-nan", "inf", "-inf", ".nan", ".inf", "1e400", "-1e400", "1e308", "1e-320", "-0",
       "0x10", "1e", "e5", "--5", "1,2", "1 2", "", "~", "null", "[]", "[[]]", "{}", "[1, 2",
       "{a: 1", "'open", '"open', "true", "yes", "abc", "é", "日本", "%s%n%d", "../..", "/",
       "*missing", "&anchor 3", "!!int 3", "!!python/object:os.system x", "1_000", "0.1.2", "- 1",
       "? x", "@x", "`x`", "9223372036854775807", "9223372036854775808", "-9223372036854775809",
       "1e18", "1e-300", "0", "-1", "1", "2", "1e9", "1e-9", "a" * 500, "7" * 400, "1 " * 200,
       "[1, 2, 3, 4, 5, 6, 7]", "[nan, 0, 0]", "[0, inf, 0]", "[1e300, 1e300, 1e300]", "[a, b]",
       "\"\\x07\"", "\"\\0\"", "'a b'", "a: b", "a #b", "#", "|", ">", "<<", "x y", "-", "--", "=",
       "\\", "$HOME", "0 0 0", "1 1 1")


class Key:
    """One row: `path` is a tuple of words, of which NAME stands for a name; `kind` says what its
    values are."""

    def __init__(self, path, must_be, default):
        self.path = tuple(path.split(": "))
        self.default = default
        self.choices, self.count = [], 1
        must_be = must_be.replace("\\|", "|")
        self.low, self.high, self.open_ends = -math.inf, math.inf, []
        for sign, bound in re.findall(rf"([<>]=?) ({NUMBER})", must_be):
            if len(sign) == 1:
                self.open_ends.append(float(bound))
            if sign[0] == ">":
                self.low = float(bound)
            else:
                self.high = float(bound)
        if must_be.startswith(("one of ", "a list of ")) and "|" in must_be:
            self.kind = "choice" if must_be.startswith("one") else "list"
            self.choices = must_be.removeprefix("one of ").removeprefix("a list of ").removesuffix(
                ", none twice").split(" | ")
        elif "names" in must_be:
            self.kind = "names"
        elif must_be.startswith("a number") or re.match(r"\d+ numbers", must_be):
            self.kind = "number"
            self.count = int(must_be.split()[0]) if must_be[0].isdigit() else 1
        elif must_be.startswith("an integer"):
            self.kind = "integer"
        elif must_be == "true or false":
            self.kind, self.choices = "choice", ["true", "false"]
        else:
            self.kind = "text"

    def usual(self):
        """The default as a number, or a number of the range that is not extreme."""
        try:
            return float(self.default.split()[0])
        except (ValueError, IndexError):
            low, high = max(self.low, 1e-6), min(self.high, 1e6)
            return math.sqrt(low * high) if low < high else self.low

    def number(self, chance):
        """One allowed number: mostly near the default, at times an end of the range or anywhere in
        it."""
        usual, way = self.usual(), chance.random()
        if way < 0.75:
            if usual == 0:
                return chance.choice([0, 10**chance.uniform(-3, 2), -(10**chance.uniform(-3, 2))])
            return usual * 10**chance.uniform(-0.5, 0.5)
        if way < 0.87:
            extreme = self.kind == "integer" or abs(self.high) >= 1 and self.low >= 0
            return chance.choice([self.low, self.high]) if extreme else usual
        top = math.log10(max(abs(self.low), abs(self.high)))
        bottom = math.log10(self.low) if self.low > 0 else -12
        return 10**chance.uniform(bottom, top) * (chance.choice([1, -1]) if self.low < 0 else 1)

    def one(self, chance):
        value = min(max(self.number(chance), self.low), self.high)
        return self.usual() if value in self.open_ends else value

    def allowed(self, chance):
        """A value that the table allows, as text."""
        if self.kind == "choice":
            return chance.choice(self.choices)
        if self.kind == "list":
            return "[" + ", ".join(chance.sample(self.choices,
                                                 chance.randint(1, len(self.choices)))) + "]"
        if self.kind == "integer":
            value = self.one(chance)
            return str(int(value) if chance.random() < 0.8 else chance.randint(0, 9))
        if self.kind == "number":
            values = [repr(self.one(chance)) for _ in range(self.count)]
            return values[0] if self.count == 1 else "[" + ", ".join(values) + "]"
        return "a"

    def hostile(self, chance):
        """A value that is odd, beyond a bound, or of another key's kind."""
        if self.kind in ("number", "integer") and chance.random() < 0.4:
            ends = [self.low, self.high]
            beyond = [x * f for x in ends for f in (2, 0.5, -1, 1 + 1e-15,
                                                    1 - 1e-15)] + ends + [0.0, -1.0]
            values = [repr(chance.choice(beyond)) for _ in range(self.count)]
            return values[0] if self.count == 1 else "[" + ", ".join(values) + "]"
        if self.kind == "list" and chance.random() < 0.4:
            return "[" + ", ".join(chance.choices([*self.choices, "odd", "1"],
                                                  k=chance.randint(1, 8))) + "]"
        return chance.choice(ODD)


def read_keys():
    """All keys of this program."""
    page = subprocess.run([launch.FLOE, "-help_markdown"], capture_output=True, text=True,
                          env=launch.ENVIRONMENT, check=True)
    rows = [ROW.match(line) for line in page.stdout.splitlines()]
    return [Key(row[1], row[2], row[3].strip("()")) for row in rows if row]
