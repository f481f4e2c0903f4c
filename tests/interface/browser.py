"""A real browser for the tests of pages: headless Chromium, opened on files, with its console read."""
import base64
import os
import pathlib
import shutil
import tempfile
import unittest

from selenium import webdriver
from selenium.webdriver.chrome.service import Service

DRIVER = shutil.which("chromedriver") or "/usr/bin/chromedriver"


class Browser:
    """One window. `scale` is device pixels a CSS pixel."""

    def __init__(self, width=1280, height=900, dark=False, scale=1):
        self.home = tempfile.mkdtemp(prefix="carom-browser-")
        options = webdriver.ChromeOptions()
        for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars",
                         f"--user-data-dir={self.home}", f"--window-size={width},{height}"):
            options.add_argument(argument)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        self.driver = webdriver.Chrome(service=Service(DRIVER, log_path=os.devnull), options=options)
        self.driver.set_script_timeout(120)
        self.width, self.height, self.scale = width, height, scale
        self.resize(width, height)
        self.set_dark(dark)

    def close(self):
        self.driver.quit()
        shutil.rmtree(self.home, ignore_errors=True)

    def command(self, name, **parameters):
        return self.driver.execute_cdp_cmd(name, parameters)

    def resize(self, width, height):
        self.command("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=self.scale,
                     mobile=width < 500)

    def set_dark(self, dark):
        self.command("Emulation.setEmulatedMedia",
                     features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])

    def open(self, path):
        self.driver.get(pathlib.Path(path).resolve().as_uri())

    def run(self, script, *arguments):
        return self.driver.execute_script(script, *arguments)

    def console(self):
        """What the page said since the last call."""
        return [entry["message"] for entry in self.driver.get_log("browser")]

    def screenshot(self, path):
        """The whole page, not only what the window shows."""
        height = self.run("return document.documentElement.scrollHeight")
        self.resize(self.width, height)
        self.settle()
        picture = self.command("Page.captureScreenshot")
        pathlib.Path(path).write_bytes(base64.b64decode(picture["data"]))
        self.resize(self.width, self.height)

    def settle(self, frames=3):
        """Waits until the page has drawn what it was asked to."""
        self.driver.execute_async_script(
            "const done = arguments[arguments.length - 1]; let left = arguments[0];"
            "const next = () => left-- > 0 ? requestAnimationFrame(next) : done(); next();", frames)


class BrowserTest(unittest.TestCase):
    """Tests that share one window of the standard size; others are opened as needed."""

    def open_browser(self, **options):
        browser = Browser(**options)
        self.addCleanup(browser.close)
        return browser
