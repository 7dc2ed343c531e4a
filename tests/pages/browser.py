"""Fixtures: a headless Chromium, and the pages of the runs that `tests.pages.material` made."""

import os
import shutil
import socket
import subprocess
import time
from pathlib import Path
from urllib.request import urlopen

import pytest
from selenium import webdriver
from selenium.webdriver.chrome.service import Service

ROOT = Path(__file__).resolve().parents[2]
OUTPUTS = Path(os.environ.get("GEAR_DAMPING_PAGES", ROOT / "outputs" / "pages")) / "outputs"
MISSING = "Chromium and its driver are needed: apt-get install chromium chromium-driver"
KINDS = ("train", "evaluate", "identify", "explain", "sweep", "simulate", "plan", "paper", "inspect", "index")
OPTIONS = ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars")
STARTED_WITHIN = 120  # s, of TensorBoard


@pytest.fixture(scope="session")
def chromium():
    """The browser."""
    program, driver = shutil.which("chromium"), shutil.which("chromedriver")
    if not program or not driver:
        pytest.fail(MISSING)
    options = webdriver.ChromeOptions()
    options.binary_location = program
    for option in OPTIONS:
        options.add_argument(option)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    browser = webdriver.Chrome(options=options, service=Service(driver))
    yield browser
    browser.quit()


def path_of(kind):
    """The page of a kind."""
    if kind == "index":
        return OUTPUTS / "index.html"
    found = sorted(OUTPUTS.glob(f"{kind}/*/*/report.html"))
    assert found, f"no report of {kind}: run python -m tests.pages.material first"
    return found[0]


@pytest.fixture
def show(chromium):
    """Opens the page of a kind in a width and a scheme, as a screen or in print; returns the browser."""

    def shown(kind, width=1440, scheme="light", media="screen", script=True):
        size = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 600}
        features = [{"name": "prefers-color-scheme", "value": scheme}]
        chromium.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
        chromium.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": media, "features": features})
        chromium.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": not script})
        chromium.get_log("browser")
        chromium.get(path_of(kind).as_uri())
        return chromium

    yield shown
    chromium.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": False})


@pytest.fixture(scope="session")
def tensorboard():
    """The address of a TensorBoard over all runs."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    words = [ROOT / ".venv" / "bin" / "tensorboard", "--logdir", OUTPUTS, "--host", "127.0.0.1", "--port", str(port)]
    with subprocess.Popen(words, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL) as server:
        address, over = f"http://127.0.0.1:{port}/", time.monotonic() + STARTED_WITHIN
        while time.monotonic() < over and server.poll() is None:
            try:
                urlopen(address, timeout=5).close()
                break
            except OSError:
                time.sleep(0.5)
        assert server.poll() is None, "TensorBoard has ended"
        yield address
        server.terminate()
