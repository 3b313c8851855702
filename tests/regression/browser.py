"""Chromium without a window, driven by its DevTools protocol: opens a page, runs scripts in it,
clicks and drags, takes pictures, and hears what the page complains of."""
import base64
import json
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

try:
    import websocket
except ImportError:
    websocket = None

PROGRAM = shutil.which("chromium")
MISSING = ("" if PROGRAM and websocket else
           "needs chromium and python3-websocket: tools/setup --pictures")
PATIENCE = 600  # [s] that a page has on the slowest of machines


class Browser:
    """A browser with one page. complaints: errors and warnings of the page's console, exceptions,
    and every address that it asked for but its own."""

    def __init__(self):
        self.folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        self.process = subprocess.Popen(
            [PROGRAM, "--headless=new", "--no-sandbox", "--no-first-run", "--disable-gpu-sandbox",
             "--disable-dev-shm-usage", "--use-angle=swiftshader",
             "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--hide-scrollbars",
             "--disable-background-networking", "--disable-component-update",
             "--remote-debugging-port=0", "--remote-allow-origins=*",
             f"--user-data-dir={self.folder.name}", "about:blank"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.number, self.complaints, self.address, self.loaded = 0, [], None, False
        port = self.wait(self.port, "the browser to start")
        self.socket = websocket.create_connection(self.page(port), timeout=PATIENCE,
                                                  suppress_origin=True)
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.send(f"{domain}.enable")

    def port(self):
        if self.process.poll() is not None:
            raise RuntimeError(f"chromium ended with exit code {self.process.returncode}")
        path = Path(self.folder.name) / "DevToolsActivePort"
        lines = path.read_text().split("\n") if path.exists() else []
        return lines[0] if len(lines) > 1 else None

    def page(self, port):
        import urllib.request

        def found():
            with urllib.request.urlopen(f"http://127.0.0.1:{port}/json", timeout=60) as answer:
                pages = [p for p in json.load(answer) if p["type"] == "page"]
            return pages[0]["webSocketDebuggerUrl"] if pages else None
        return self.wait(found, "a page")

    @staticmethod
    def wait(condition, what):
        until = time.monotonic() + PATIENCE
        while time.monotonic() < until:
            found = condition()
            if found:
                return found
            time.sleep(0.05)
        raise TimeoutError(f"waited {PATIENCE} s for {what}")

    def hear(self, message):
        """What the page did by itself."""
        method, params = message.get("method"), message.get("params", {})
        if method == "Runtime.exceptionThrown":
            details = params["exceptionDetails"]
            self.complaints.append(details.get("exception", {}).get("description",
                                                                    details["text"]))
        elif method == "Runtime.consoleAPICalled" and params["type"] in ("error", "warning",
                                                                         "assert"):
            self.complaints.append(" ".join(str(a.get("value", a)) for a in params["args"]))
        elif method == "Log.entryAdded" and params["entry"]["level"] == "error":
            self.complaints.append(params["entry"]["text"])
        elif method == "Network.requestWillBeSent":
            asked = params["request"]["url"]
            if asked != self.address and not asked.startswith(("data:", "blob:")):
                self.complaints.append(f"asked for {asked}")
        elif method == "Page.loadEventFired":
            self.loaded = True

    def send(self, method, **params):
        self.number += 1
        self.socket.send(json.dumps({"id": self.number, "method": method, "params": params}))
        while True:
            message = json.loads(self.socket.recv())
            if message.get("id") == self.number:
                if "error" in message:
                    raise RuntimeError(f"{method}: {message['error']}")
                return message["result"]
            self.hear(message)

    def open(self, path, width=1280, height=900, touch=False):
        self.send("Emulation.setDeviceMetricsOverride", width=width, height=height,
                  deviceScaleFactor=1, mobile=touch)
        self.address, self.loaded = Path(path).resolve().as_uri(), False
        self.send("Page.navigate", url=self.address)
        self.wait(lambda: self.run("document.readyState") == "complete", "the page")
        return self

    def run(self, script):
        """Value of a script in the page, as JSON knows it; promises are waited for."""
        result = self.send("Runtime.evaluate", expression=script, returnByValue=True,
                           awaitPromise=True)
        if "exceptionDetails" in result:
            details = result["exceptionDetails"]
            raise RuntimeError(details.get("exception", {}).get("description", details["text"]))
        return result["result"].get("value")

    def until(self, script):
        """Waits until a script says yes."""
        return self.wait(lambda: self.run(script), script)

    def mouse(self, kind, x, y, buttons=1):
        self.send("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=buttons,
                  clickCount=1)

    def click(self, x, y):
        self.mouse("mouseMoved", x, y, 0)
        self.mouse("mousePressed", x, y)
        self.mouse("mouseReleased", x, y, 0)

    def drag(self, x, y, across, down, steps=8):
        self.mouse("mouseMoved", x, y, 0)
        self.mouse("mousePressed", x, y)
        for k in range(1, steps + 1):
            self.mouse("mouseMoved", x + across * k / steps, y + down * k / steps)
        self.mouse("mouseReleased", x + across, y + down, 0)

    def picture(self, path, whole=False):
        """A picture of the window, or of the whole page."""
        params = {"format": "png"}
        if whole:
            size = self.send("Page.getLayoutMetrics")["cssContentSize"]
            params |= {"captureBeyondViewport": True, "clip": {
                "x": 0, "y": 0, "width": size["width"], "height": size["height"], "scale": 1}}
        Path(path).write_bytes(base64.b64decode(
            self.send("Page.captureScreenshot", **params)["data"]))

    def close(self):
        try:
            self.socket.close()
        finally:
            self.process.terminate()
            self.process.wait()
            self.folder.cleanup()
