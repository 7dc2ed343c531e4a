"""What TensorBoard shows of a training: curves, the table of hyperparameters, figures."""

import time

from selenium.webdriver.common.by import By

WITHIN = 90  # s, until the server has read all and the page has drawn
ASK_AGAIN = 15  # s
TEXT = r"""
const words = [];
const walk = (node) => {
  if (node.shadowRoot) walk(node.shadowRoot);
  for (const one of node.childNodes) {
    if (one.nodeType === Node.TEXT_NODE) words.push(one.textContent);
    else if (!["STYLE", "SCRIPT", "TEMPLATE"].includes(one.nodeName)) walk(one);
  }
};
walk(document.body);
return words.join(" ").replace(/\s+/g, " ");
"""
PICTURES = """
const found = [];
const walk = (node) => {
  if (node.shadowRoot) walk(node.shadowRoot);
  if (node.nodeName === "IMG" && node.naturalWidth > 200) found.push(node.naturalWidth);
  node.childNodes.forEach(walk);
};
walk(document.body);
return found;
"""


def wait_for(browser, look, is_there):
    """What the page shows as soon as it is there; else what it showed last. It does not ask the server by itself."""
    begun = asked = time.monotonic()
    while not is_there(found := look()) and time.monotonic() < begun + WITHIN:
        time.sleep(0.5)
        if time.monotonic() > asked + ASK_AGAIN:
            asked = time.monotonic()
            browser.refresh()
    return found


def seen(browser, *words):
    """Text of the page, with that inside of frames, once all the words stand in it."""

    def text():
        browser.switch_to.default_content()
        found = browser.execute_script(TEXT)
        for frame in browser.find_elements(By.TAG_NAME, "iframe"):
            browser.switch_to.frame(frame)
            found += browser.execute_script(TEXT)
            browser.switch_to.default_content()
        return found

    return wait_for(browser, text, lambda found: all(word in found for word in words))


def opened(browser, address, dashboard):
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                            {"width": 1600, "height": 1200, "deviceScaleFactor": 1, "mobile": False})  # fmt: skip
    browser.get("about:blank")
    browser.get(f"{address}#{dashboard}")


def test_curves_of_every_network(chromium, tensorboard):
    opened(chromium, tensorboard, "timeseries")
    wanted = ("val_rmse_percent", "train_loss", "learning_rate", "raw_lstm/seed_0", "cwt_lstm/seed_0")
    found = seen(chromium, *wanted)
    assert [word for word in wanted if word not in found] == []


def test_the_table_of_hyperparameters_has_a_row_for_each_fit(chromium, tensorboard):
    opened(chromium, tensorboard, "hparams")
    fits = 9  # raw_lstm, cwt_lstm and white_noise of a training and of two jobs of a sweep
    wanted = ("Hyperparameters", "load_noise.snr_db", "20.000", "by_run", "bench", "hp/val_rmse_percent", "white_noise")
    wanted += (f"Number of matching session groups: {fits}",)
    found = seen(chromium, *wanted)
    assert [word for word in wanted if word not in found] == []


def test_the_figures_of_the_training(chromium, tensorboard):
    opened(chromium, tensorboard, "images")
    wanted = ("predicted_against_true", "scalogram", "response")
    found = seen(chromium, *wanted)
    assert [word for word in wanted if word not in found] == []
    assert len(wait_for(chromium, lambda: chromium.execute_script(PICTURES), lambda found: len(found) >= 3)) >= 3
