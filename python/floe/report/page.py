"""One HTML file of a report: data, styles and scripts of web/ in one page that loads
nothing. Its Content-Security-Policy forbids that too."""
import html
import json
from pathlib import Path

FOLDER = Path(__file__).resolve().parent / "web"
SCRIPTS = ("three.min.js", "codec.js", "charts.js", "scene.js", "view.js", "page.js")
POLICY = ("default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
          "img-src data: blob:; base-uri 'none'; form-action 'none'")
MEGABYTE = 1e6


def text_of(name):
    return (FOLDER / name).read_text()


def data_of(report):
    """JSON that may stand in a page: no end of a script is in it."""
    return json.dumps(report, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")


def page(report):
    """The page of a report, a text."""
    scripts = [name for name in SCRIPTS if report["kind"] == "run" or name not in
               ("three.min.js", "scene.js", "view.js")]
    licence = text_of("three.LICENSE").replace("--", "- -")
    title = html.escape(f"floe: {report['title']}")
    return "\n".join([
        "<!doctype html>", '<html lang="en">', "<head>", '<meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">',
        f"<title>{title}</title>", f"<style>\n{text_of('style.css')}</style>", "</head>", "<body>",
        '<main id="page"></main>', "<noscript><p>This report is drawn by its own scripts; "
        "the browser runs none.</p></noscript>",
        f'<script type="application/json" id="data">{data_of(report)}</script>',
        f"<!-- three.js is part of this page, under its licence:\n{licence}-->",
        *(f"<script>\n{text_of(name)}</script>" for name in scripts), "</body>", "</html>", ""])


def data_in(text):
    """The report in the text of a page."""
    start = text.index('id="data">') + len('id="data">')
    return json.loads(text[start:text.index("</script>", start)])
