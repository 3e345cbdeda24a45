"""`whitted serve` in a real browser: typing, mistakes, pixels, the camera, two windows, and the server's end."""

import re
import shutil
import signal
from pathlib import Path

import pytest

pytest.importorskip("starlette", reason="the extra whitted[page] is not installed")
pytest.importorskip("playwright", reason="Playwright is not installed")
from browser import CHROMIUM, PATIENCE, chromium, open_page, served, settle, wait_until, write

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="there is no Chromium (Debian: apt install chromium)")
SCENES = Path(__file__).resolve().parents[1] / "scenes"
CANVAS = "#native canvas"


@pytest.fixture(scope="module")
def browser():
    with chromium() as started:
        yield started


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    """Serves a copy of Figure 1, which each test finds as it was."""
    folder = tmp_path_factory.mktemp("scene")
    for name in ("figure1.in", "rainbow1.ppm"):
        shutil.copy(SCENES / name, folder)
    with served(folder / "figure1.in", "160", "120") as server:
        yield server


@pytest.fixture
def page(browser, server):
    """A window, in which nothing has gone wrong at the end."""
    original = (SCENES / "figure1.in").read_text()
    page = open_page(browser, server.address)
    if text_of(page) != original:
        page.locator(".cm-content").fill(original)
    settle(page)  # before the file is as the text, for what was told before may be that it is
    write(server.scene, original)
    wait_until(page, "document.body.dataset.saved === 'true'")
    yield page
    assert page.errors == []
    page.context.close()


def text_of(page):
    return page.evaluate("[...document.querySelectorAll('.cm-line')].map((line) => line.textContent).join('\\n')")


def pixels(page):
    return page.evaluate("document.querySelector('#native canvas').toDataURL()")


def type_after(page, words, keys):
    """Type at the end of the line with these words, and wait for nothing."""
    page.locator(".cm-line", has_text=words).click()
    page.keyboard.press("End")
    page.keyboard.type(keys)


def test_typing_draws(page):
    picture = pixels(page)
    type_after(page, "sphere 0 32.7 0 20", "0")
    settle(page)
    assert pixels(page) != picture
    page.keyboard.press("Control+z")
    wait_until(page, f"document.querySelector('{CANVAS}').toDataURL() === '{picture}'")


def test_a_mistake_is_underlined_told_and_gone_when_mended(page):
    type_after(page, "sphere 0 32.7 0 20", " x")
    page.wait_for_selector(".mistake")
    assert page.text_content(".mistake") == "x"
    line = text_of(page).split("\n").index("2 2 sphere 0 32.7 0 20 x") + 1
    told = f"{line}:24: unexpected 'x' after the last number of the object"
    assert page.locator("#mistakes li").all_text_contents() == [told]
    page.hover(".mistake")
    assert page.text_content(".told") == told.split(": ", 1)[1]
    assert "old" in page.get_attribute("#native", "class")
    page.keyboard.press("Backspace")
    page.keyboard.press("Backspace")
    page.wait_for_selector("#mistakes li", state="detached")
    assert page.locator(".mistake").count() == 0
    assert "old" not in page.get_attribute("#native", "class")


def test_a_picture_that_comes_after_a_mistake_is_shown_as_old(browser, server, page):
    """It is of a text before."""
    frames = []

    def through(socket):
        def told(message):
            socket.send(message)
            if isinstance(message, bytes):
                frames.append(message)
            elif '"marks": [{' in message:
                socket.send(frames[-1])
                socket.send('{"type": "said", "message": "late"}')

        socket.connect_to_server().on_message(told)

    other = browser.new_context(viewport={"width": 1400, "height": 900}).new_page()
    other.route_web_socket(re.compile("/live$"), through)
    other.goto(server.address)
    settle(other)
    type_after(other, "sphere 0 32.7 0 20", "x")
    wait_until(other, "document.querySelector('#said').textContent === 'late'")
    assert "old" in other.get_attribute("#native", "class")
    other.keyboard.press("Backspace")
    settle(other)
    other.context.close()


def test_a_click_shows_the_rays_of_both_renderers_and_their_path(page):
    box = page.locator(CANVAS).first.bounding_box()
    page.mouse.click(box["x"] + 83.5, box["y"] + 50.5)  # the middle ball
    page.wait_for_selector("svg line.reflected", state="attached")
    assert page.text_content("#pixel") == "Pixel (83, 50)"
    wait_until(page, "document.querySelector('#same').textContent.endsWith('The trees are the same.')")
    same = page.text_content("#same")
    assert "native" in same
    assert "mitsuba" in same
    assert "sphere" in page.text_content("#tree")
    first = page.locator("svg line").first
    place = [float(first.get_attribute(name)) for name in ("x1", "y1")]
    assert place == pytest.approx([83, 50], abs=1e-6)
    page.keyboard.press("Escape")
    page.wait_for_selector("svg line", state="detached")
    assert page.is_hidden("#rays")


def test_mitsuba_s_picture_and_the_difference_at_a_key(page):
    page.keyboard.press("Alt+m")
    page.wait_for_selector("#difference canvas[data-version]")
    assert page.text_content("#difference figcaption") == "0 of 19,200 pixels differ by more than 1/255"
    mitsuba = page.evaluate("document.querySelector('#by-mitsuba canvas').toDataURL()")
    assert mitsuba == pixels(page)
    page.keyboard.press("Alt+m")
    assert page.is_hidden("#by-mitsuba")


def test_dragging_turns_the_camera_and_the_text_follows(page):
    before = text_of(page)
    box = page.locator(CANVAS).first.bounding_box()
    x, y = box["x"] + 60, box["y"] + 60
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 40, y)  # a quarter of the picture, so 45 degrees
    page.mouse.up()
    expected = before.replace("0 30 -200", "70.71 30 -170.71")  # to the left, so that the scene goes with the mouse
    wait_until(page, f"document.querySelectorAll('.cm-line')[3].textContent === '{expected.splitlines()[3]}'")
    assert text_of(page) == expected
    settle(page)
    assert page.is_hidden("#rays")  # it was no click


def test_a_slider_moves_the_number_under_the_cursor(page):
    picture = pixels(page)
    type_after(page, "sphere 0 32.7 0 20", "")
    wait_until(page, "document.querySelector('#number-name').textContent === 'sphere: radius'")
    assert page.is_visible("#number")
    page.locator("#slider").fill("35")
    settle(page)
    assert "2 2 sphere 0 32.7 0 35.0" in text_of(page)
    assert pixels(page) != picture


def test_two_windows_show_the_same(browser, server, page):
    other = open_page(browser, server.address)
    type_after(page, "sphere 0 32.7 0 20", ".5")
    wait_until(other, "document.querySelector('.cm-content').textContent.includes('32.7 0 20.5')")
    type_after(other, "sphere 0 32.7 0 20.5", "1")
    wait_until(page, "document.querySelector('.cm-content').textContent.includes('32.7 0 20.51')")
    assert text_of(page) == text_of(other)
    settle(page)
    settle(other)
    assert pixels(page) == pixels(other)
    assert other.errors == []
    other.context.close()


def test_saving_and_following_the_file(server, page):
    type_after(page, "sphere 0 32.7 0 20", "  # mine")
    page.keyboard.press("Control+s")
    wait_until(page, "document.body.dataset.saved === 'true'")
    assert server.scene.read_text() == text_of(page)
    write(server.scene, text_of(page).replace("# mine", "# theirs"))
    wait_until(page, "document.querySelector('.cm-content').textContent.includes('# theirs')")


def test_a_picture_laid_over_and_why(server, page, tmp_path):
    from converter.commands import main

    mine = tmp_path / "mine.png"
    scene = SCENES / "figure1.in"
    assert main.main(["render", str(scene), str(mine), "80", "60", "--method", "native", "--specular", "blinn"]) == 0
    page.set_input_files("#theirs", mine)
    page.wait_for_selector("#over", state="visible")
    assert page.text_content("#laid-name") == "mine.png, 80 x 60"
    assert (
        page.evaluate("new Set(document.querySelector('#over').getContext('2d').getImageData(0,0,160,120).data).size")
        > 50
    )
    page.click("#why")
    wait_until(page, "document.querySelector('#verdict').textContent.includes('with it')")
    assert "half vector" in page.text_content("#verdict")
    page.click("#take-off")
    assert page.is_hidden("#over")


def test_when_the_server_stops_the_page_says_so_and_keeps_the_text(browser, tmp_path):
    shutil.copy(SCENES / "highlights.in", tmp_path)
    with served(tmp_path / "highlights.in", "80", "60") as server:
        page = open_page(browser, server.address)
        server.process.send_signal(signal.SIGKILL)
        server.process.wait(PATIENCE)
        page.wait_for_selector("#gone", state="visible")
    page.locator(".cm-line").first.click()
    page.keyboard.press("Home")
    page.keyboard.type("# still here\n")
    assert text_of(page).startswith("# still here\n")
    with page.expect_download() as download:
        page.click("#download")
    assert download.value.suggested_filename == "highlights.in"
    assert Path(download.value.path()).read_text() == text_of(page)
    page.context.close()


def test_what_is_typed_while_the_connection_is_lost_is_there_when_it_is_back(browser, server, page):
    sockets = []

    def through(socket):
        sockets.append(socket)
        socket.connect_to_server()

    other = browser.new_context(viewport={"width": 1400, "height": 900}).new_page()
    other.route_web_socket(re.compile("/live$"), through)
    other.goto(server.address)
    settle(other)
    sockets[0].close()
    other.wait_for_selector("#gone", state="visible")
    type_after(other, "sphere 0 32.7 0 20", ".25")
    wait_until(page, "document.querySelector('.cm-content').textContent.includes('32.7 0 20.25')")
    assert other.is_hidden("#gone")
    assert len(sockets) == 2
    settle(other)
    assert text_of(page) == text_of(other)
    other.context.close()
