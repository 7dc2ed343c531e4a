"""What a browser makes of the pages: width, contrast, keyboard, sorting, print."""

import base64
import re
from itertools import product
from pathlib import Path

import pytest
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from tests.pages.browser import KINDS, OUTPUTS

WIDTHS, SCHEMES = (390, 1440), ("light", "dark")
READ = 4.5  # contrast of text (WCAG 2.2, 1.4.3)
LOOK = (Path(__file__).parent / "look.js").read_text()
FOCUSABLE = "a[href], button, input, select, textarea, summary, [tabindex]:not([tabindex='-1'])"
FOCUSED = """
const one = document.activeElement, style = getComputedStyle(one);
const all = Array.from(document.querySelectorAll(arguments[0]));
return [all.indexOf(one), style.outlineStyle !== "none" && parseFloat(style.outlineWidth) >= 2,
        one.getBoundingClientRect().width > 0 && one.getBoundingClientRect().top < innerHeight
        && one.getBoundingClientRect().bottom > 0];
"""


def look(browser):
    return browser.execute_script(LOOK)


@pytest.mark.parametrize(("kind", "width", "scheme"), [*product(KINDS, WIDTHS, SCHEMES)])
def test_no_page_is_wider_than_the_screen_and_every_text_is_read(show, kind, width, scheme):
    browser = show(kind, width, scheme)
    wide = browser.execute_script("return [document.documentElement.scrollWidth, innerWidth]")
    assert wide == [width, width]
    found = look(browser)
    assert len(found) > 30
    assert [one for one in found if one[0] < READ] == []
    assert [entry["message"] for entry in browser.get_log("browser")] == []


def test_a_wide_page_and_a_faint_text_would_be_seen(show):
    browser = show("train", 390)
    browser.execute_script(
        "const one = document.createElement('p'); one.textContent = 'faint'; document.body.append(one);"
        "one.style.cssText = 'color: #999; width: 900px';"
    )
    assert browser.execute_script("return document.documentElement.scrollWidth") > 390
    assert [text for ratio, text in look(browser) if ratio < READ] == ["faint"]


@pytest.mark.parametrize("kind", KINDS)
def test_every_picture_is_there_and_lies_on_white_in_the_dark(show, kind):
    browser = show(kind, 1440, "dark")
    browser.execute_script("document.querySelectorAll('img').forEach((one) => one.loading = 'eager')")
    pictures = browser.execute_async_script("""
        const done = arguments[0], all = Array.from(document.images);
        Promise.all(all.map((one) => one.decode().catch(() => null))).then(() => done(all.map((one) => {
          const ground = getComputedStyle(one.closest(".sheet") ?? one).backgroundColor;
          return [one.naturalWidth > 0, one.alt.length, ground];
        })));""")
    assert pictures
    assert all(there and alt >= 20 and ground == "rgb(255, 255, 255)" for there, alt, ground in pictures), pictures


@pytest.mark.parametrize(("kind", "width"), [*product(KINDS, WIDTHS)])
def test_everything_is_reached_by_tab_and_shows_it(show, kind, width):
    browser = show(kind, width)
    count = len(browser.find_elements(By.CSS_SELECTOR, FOCUSABLE))
    places = []
    for _ in range(count):
        ActionChains(browser).send_keys(Keys.TAB).perform()
        place, is_framed, is_seen = browser.execute_script(FOCUSED, FOCUSABLE)
        assert is_framed, f"nothing shows that the focus is on element {place}"
        assert is_seen, f"element {place} has the focus out of sight"
        places.append(place)
    assert places == list(range(count))


@pytest.mark.parametrize("kind", KINDS)
def test_the_first_tab_leads_past_the_heading(show, kind):
    browser = show(kind)
    ActionChains(browser).send_keys(Keys.TAB, Keys.ENTER).perform()
    assert browser.execute_script("return document.activeElement.tagName") == "MAIN"


@pytest.mark.parametrize("kind", KINDS)
def test_a_screen_reader_is_told_all(show, kind):
    """By the tree that Chromium gives to it: regions, tables and pictures all have names."""
    nodes = show(kind).execute_cdp_cmd("Accessibility.getFullAXTree", {})["nodes"]
    named = {}
    for node in nodes:
        if not node.get("ignored"):
            name = node.get("name", {}).get("value", "")
            named.setdefault(node["role"]["value"], []).append(name)
    for role in ("table", "region", "image", "button", "link"):
        assert all(named.get(role, ["-"])), (role, named[role])
    assert len(named["main"]) == 1
    assert named["image"]
    assert {"columnheader", "rowheader"} <= set(named)


def column(browser, number):
    return browser.execute_script(
        "return Array.from(document.querySelectorAll('tbody tr')).map((row) => {"
        "const cell = row.cells[arguments[0]]; return cell.dataset.key ?? cell.textContent.trim(); })", number
    )  # fmt: skip


def sorts(browser):
    found = browser.find_elements(By.CSS_SELECTOR, "thead th")
    return {one.text: one.get_attribute("aria-sort") for one in found if one.get_attribute("aria-sort")}


@pytest.mark.parametrize("key", [Keys.ENTER, Keys.SPACE])
def test_the_index_sorts_by_keyboard(show, key):
    browser = show("index")
    assert sorts(browser) == {"begun": "descending"}
    assert column(browser, 0) == sorted(column(browser, 0), reverse=True)
    for _ in range(4):  # the link to the content, the table, `begun`, `task`
        ActionChains(browser).send_keys(Keys.TAB).perform()
    before = column(browser, 1)
    ActionChains(browser).send_keys(key).perform()
    assert sorts(browser) == {"task": "ascending"}
    assert column(browser, 1) == sorted(before)
    assert browser.find_element(By.CSS_SELECTOR, "[role=status]").text == "Sorted by task, ascending."
    ActionChains(browser).send_keys(key).perform()
    assert sorts(browser) == {"task": "descending"}
    assert column(browser, 1) == sorted(before, reverse=True)


def test_the_index_sorts_by_mouse_and_numbers_by_their_size(show):
    browser = show("index", 390)
    browser.find_element(By.XPATH, "//button[text()='took']").click()
    took = [float(one) for one in column(browser, 4)]
    assert sorts(browser) == {"took": "ascending"}
    assert took == sorted(took)
    assert len(took) > 5


def test_the_index_is_a_plain_table_without_a_script(show):
    browser = show("index", script=False)
    assert browser.find_elements(By.TAG_NAME, "button") == []
    assert len(browser.find_elements(By.CSS_SELECTOR, "tbody tr")) > 5
    assert "begun" in browser.find_element(By.TAG_NAME, "thead").text


def test_every_link_of_the_index_leads_to_a_file(show):
    browser = show("index")
    links = {one.get_attribute("href") for one in browser.find_elements(By.CSS_SELECTOR, "main a")}
    assert len(links) > 10
    for link in links:
        assert Path(link.removeprefix("file://")).exists(), link
    assert all(OUTPUTS.as_posix() in link for link in links)
    said = browser.find_element(By.TAG_NAME, "tbody").text
    assert "failed" in said
    assert "broken.npz" in said


@pytest.mark.parametrize("kind", KINDS)
def test_print_is_dark_on_white_and_nothing_is_cut_off(show, kind):
    browser = show(kind, 794, "dark", media="print")  # A4 at 96 dots an inch
    assert [one for one in look(browser) if one[0] < READ] == []
    assert browser.execute_script("return getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    cut = browser.execute_script(
        "return Array.from(document.querySelectorAll('.scroll, .sheet')).filter((one) =>"
        "getComputedStyle(one).overflowX !== 'visible').length"
    )
    assert cut == 0
    assert not browser.find_element(By.CSS_SELECTOR, ".skip").is_displayed()
    printed = base64.b64decode(browser.execute_cdp_cmd("Page.printToPDF", {"preferCSSPageSize": True})["data"])
    assert len(re.findall(rb"/Type\s*/Page\b", printed)) >= 1
