"""The page of results in a browser: it loads without a complaint, filters, moves, fits a phone, and needs no mouse."""

import os
import re
import shutil

import pytest
from costly_cases import slow
from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.select import Select
from selenium.webdriver.support.wait import WebDriverWait
from tables import texts
from test_report import PLANE, SOLID, report, write_data

OF_CASES = [f"case/{case}" for case in [*PLANE, SOLID]]
PAGES = ["overview", "ledger", "cases", *OF_CASES, "bounds", "defects", "provenance"]
CASE = PLANE[0]
ARGUMENTS = ["--headless=new", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking"]
ARGUMENTS += ["--disable-component-update", "--disable-sync"]


class Browser(webdriver.Chrome):
    address = ""

    def section(self, name):
        self.get(f"{self.address}#{name}")

    def one(self, selector):
        return self.find_element(By.CSS_SELECTOR, selector)

    def width(self, pixels):
        metrics = {"width": pixels, "height": 800, "deviceScaleFactor": 1, "mobile": False}
        self.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)


@pytest.fixture(scope="module")
def chromium(tmp_path_factory):
    """One browser for all tests, with a separate profile.

    Without Chromium and its driver tests are skipped, or fail where ``BROWSER_TESTS`` is "required".
    """
    browser, driver = (shutil.which(name) or "" for name in ("chromium", "chromedriver"))
    if not (browser and driver):
        reason = "chromium and chromedriver are not installed (Debian: apt-get install chromium chromium-driver)"
        if os.environ.get("BROWSER_TESTS") == "required":
            pytest.fail(reason)
        pytest.skip(reason)
    options = webdriver.ChromeOptions()
    options.binary_location = browser
    for argument in (*ARGUMENTS, f"--user-data-dir={tmp_path_factory.mktemp('profile')}"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    started = Browser(options=options, service=Service(driver))
    yield started
    started.quit()


@pytest.fixture(scope="module")
def directory(chromium, tmp_path_factory):
    """Data and page; asks for the browser first, as nothing is computed without one."""
    made = write_data(tmp_path_factory.mktemp("report"))
    report(made)
    return made


@pytest.fixture
def page(chromium, directory):
    """The page as a visitor first sees it on a desk; afterwards the console must hold no error."""
    chromium.width(1280)
    chromium.get("about:blank")
    chromium.address = (directory / "report.html").as_uri()
    chromium.section("overview")
    yield chromium
    assert [entry for entry in chromium.get_log("browser") if entry["level"] == "SEVERE"] == []


@pytest.fixture(scope="module")
def claims(directory):
    return texts(directory / "data/claims.csv")


def shown_rows(browser):
    """Case and verdict of the rows of the ledger that are seen, and the statement they belong to."""
    return browser.execute_script(
        "return [...document.querySelectorAll('#rows tr[data-case]')].filter((row) => row.offsetParent !== null)"
        ".map((row) => [row.parentElement.dataset.statement, row.cells[0].textContent, row.cells[6].textContent])"
    )


def rows_of(claims):
    return claims[["label", "case", "verdict"]].to_numpy().tolist()


FILM = f"[data-case='{CASE}'].film"


def test_every_section_is_shown_alone_under_its_address_and_nothing_is_fetched(page):
    for section in PAGES:
        page.section(section)
        assert page.execute_script(
            "return [...document.querySelectorAll('.page')].filter((one) => !one.hidden).map((one) => one.id)"
        ) == [section]
        assert page.one(".page:not([hidden]) h2").text in page.title
        if section == f"case/{SOLID}":
            assert "onerror" in page.one(".page:not([hidden])").text
            assert page.title == f"{SOLID} – Signorini study", "text of the data does not run"
    assert page.execute_script("return performance.getEntriesByType('resource').map((entry) => entry.name)") == []


SCRIPTS = "term of ‖u − Π^h u‖_V, fitted, irregular"
FILTERS = [
    ({"case": "corner", "statement": "Prop. 5.4", "verdict": "holds"}, "case == 'corner' and label == 'Prop. 5.4'"),
    ({"case": CASE, "verdict": "fails"}, f"case == '{CASE}' and verdict == 'fails'"),
    ({"text": "Pythagoras size"}, "expected.str.contains('Pythagoras') and quantity.str.contains('size')"),
    ({"text": f"{SCRIPTS} meshes"}, f"quantity.str.contains('{SCRIPTS}', regex=False)"),
]
"""Filters of the ledger, and the rows that match; words are looked for in all of a row, and scripts do not matter."""


@pytest.mark.parametrize(("wanted", "query"), FILTERS)
def test_filters_leave_exactly_the_rows_that_match_and_say_how_many(page, claims, wanted, query):
    page.section("ledger")
    for name, value in wanted.items():
        page.one(f"#filter-{name}").send_keys(value)
    matching = claims.query(query)
    assert len(matching) < len(claims)
    assert shown_rows(page) == rows_of(matching)
    said = page.one("#count").text
    assert said.startswith(f"{len(matching)} of {len(claims)} rows")
    counts = {verdict: int(count) for count, verdict in re.findall(r"(\d+) (holds|reported|missed|fails)", said)}
    assert counts == dict(matching["verdict"].value_counts())
    page.one("#filters [type=reset]").click()
    WebDriverWait(page, 5).until(lambda _: shown_rows(page) == rows_of(claims))


@pytest.mark.slow
def test_the_address_keeps_the_filters_and_a_case_leads_to_its_rows(page, claims):
    page.section(f"case/{CASE}")
    page.one(".page:not([hidden]) a[href^='#ledger?']").click()
    of_case = claims[claims["case"] == CASE]
    WebDriverWait(page, 5).until(lambda _: shown_rows(page) == rows_of(of_case))
    Select(page.one("#filter-verdict")).select_by_visible_text("holds")
    page.refresh()
    assert shown_rows(page) == rows_of(of_case[of_case["verdict"] == "holds"])
    page.back()
    assert page.title.startswith(CASE)


def test_keys_move_the_slider_and_one_image_is_shown(page):
    page.section(f"case/{CASE}")
    slider = page.one(f"{FILM} input[type=range]")
    for key, n in ((Keys.HOME, 0), (Keys.ARROW_RIGHT, 1), (Keys.ARROW_RIGHT, 2), (Keys.END, 4), (Keys.ARROW_LEFT, 3)):
        slider.send_keys(key)
        images = page.find_elements(By.CSS_SELECTOR, f"{FILM} img")
        assert [at for at, image in enumerate(images) if image.is_displayed()] == [n]
        said = images[n].get_attribute("alt")
        assert said.startswith("t = ")
        assert page.one(f"{FILM} output").text == slider.get_attribute("aria-valuetext") == said


PLAY_AND_PAUSE = """
const [film, done] = arguments, button = film.querySelector("button"), shown = film.querySelector("output");
const before = shown.textContent;
button.click();
const pressed = button.getAttribute("aria-pressed");
const watch = setInterval(() => {
    if (shown.textContent === before) return;
    clearInterval(watch);
    button.click();
    const paused = shown.textContent;
    setTimeout(() => done([before, pressed, paused, button.textContent, shown.textContent]), 600);
}, 5);
"""
"""All of it in the page: a driver on a busy machine would come back when the film is over."""


@pytest.mark.slow
def test_play_runs_through_the_times_and_pauses(page):
    page.section(f"case/{CASE}")
    before, pressed, paused, label, later = page.execute_async_script(PLAY_AND_PAUSE, page.one(FILM))
    assert pressed == "true"
    assert paused != before
    assert label == "Play"
    assert later == paused


@pytest.mark.parametrize("pixels", [360, slow(1280)])
def test_no_section_is_wider_than_the_screen(page, pixels):
    page.width(pixels)
    for section in PAGES:
        page.section(section)
        wide, inner = page.execute_script("return [document.scrollingElement.scrollWidth, innerWidth]")
        assert wide <= inner == pixels, section


@pytest.mark.slow
def test_tabs_reach_every_filter_in_order_and_show_where_they_are(page):
    page.section("ledger")
    names = ["filter-text", "filter-verdict", "filter-statement", "filter-case"]
    reached = []
    for _ in range(20):
        page.switch_to.active_element.send_keys(Keys.TAB)
        here = page.switch_to.active_element
        reached.append(here.get_attribute("id"))
        assert here.value_of_css_property("outline-style") == "solid"
    assert [name for name in reached if name in names] == names
    assert all(page.find_elements(By.CSS_SELECTOR, f"label[for={name}]") for name in names)


@pytest.mark.slow
def test_the_first_tab_leads_past_the_links_to_the_content(page):
    page.get("about:blank")
    page.get(page.address)
    page.switch_to.active_element.send_keys(Keys.TAB)
    link = page.switch_to.active_element
    assert link.text == "To the content"
    link.send_keys(Keys.ENTER)
    assert page.switch_to.active_element.get_attribute("id") == "main"
    assert page.one("#overview").is_displayed()
