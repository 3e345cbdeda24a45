"""The page's server: who may speak with it, what it answers, what it draws, and what becomes of the file."""

import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from converter.commands import main
from converter.page.gate import is_local, is_ours
from converter.page.preview import DEEPEST, Drawn, Noted, Preview, Read, Undrawn, bounces
from converter.renderers.base import Rendering
from converter.renderers.native import NativeRenderer
from converter.scene.parser import load_scene, parse_scene
from converter.scene.settings import Settings

pytest.importorskip("starlette", reason="the extra whitted[page] is not installed")
from browser import served, write
from starlette.testclient import TestClient
from starlette.websockets import WebSocketDisconnect

from converter.page.app import make_app
from converter.page.helper import Helper, HelperError
from converter.page.session import Session

TEXT = """\
0 0 -10
0 0 0
0 1 0
40
2
0 0 0 1 1 1 1 0 0
5 5 -9 .8 .8 .8 1 0 0
1
solid 1 .5 .2
1
.2 .6 .3 20 .5 0 0
2
0 0 sphere 0 0 0 1
0 0 sphere 2 0 0 1
"""
SETTINGS = Settings(width=40, height=30, threads=1)
TOKEN = "token"
ADDRESS = "http://127.0.0.1:8000"
LIVE = "ws://127.0.0.1:8000/token/live"
SOON = 20.0
"""Seconds within which whatever is waited for happens; fewer than those after which a drawing is given up."""


@pytest.fixture
def scene(tmp_path):
    file = tmp_path / "a.in"
    file.write_text(TEXT)
    return file


@pytest.fixture
def client(scene):
    with TestClient(make_app(Session(scene, SETTINGS), TOKEN, "127.0.0.1"), base_url=ADDRESS) as client:
        yield client


class Window:
    """A browser's end of the WebSocket."""

    def __init__(self, socket):
        self.socket = socket
        self.typed = 0
        self._receiver = ThreadPoolExecutor(1)

    def say(self, kind, **told):
        self.socket.send_json({"type": kind, **told})

    def type(self, text):
        self.typed += 1
        self.say("text", text=text, number=self.typed)

    def until(self, kind, wanted=lambda message: True):
        """The next message of a kind, and as wanted; a picture's levels are an array."""
        while True:
            message = self._receiver.submit(self.socket.receive).result(SOON)
            if message["type"] == "websocket.close":
                raise WebSocketDisconnect(message["code"])
            told = json.loads(message["text"]) if message.get("text") else _unframed(message["bytes"])
            if told["type"] == kind and wanted(told):
                return told


def _unframed(data):
    length = int.from_bytes(data[:4], "little")
    told = json.loads(data[4 : 4 + length])
    levels = np.frombuffer(data[4 + length :], np.uint8).reshape(told["height"], told["width"], 3)
    return told | {"levels": levels}


@contextmanager
def window(client):
    with client.websocket_connect(LIVE) as socket:
        yield Window(socket)


# ---- Who may speak with it ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "path", ["/", "/live", "/static/page.js", "/wrong/", "/wrong/static/page.js", "/toke/", "//token/"]
)
def test_without_the_token_nothing_is_told(client, path):
    answer = client.get(path)
    assert answer.status_code == 403
    assert "whitted serve" in answer.text
    with pytest.raises(WebSocketDisconnect), client.websocket_connect(LIVE.replace(TOKEN, "wrong")):
        pass


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({}, 200),
        ({"host": "localhost:8000"}, 200),
        ({"host": "[::1]:8000"}, 200),
        ({"origin": ADDRESS}, 200),
        ({"host": "attacker.example:8000"}, 403),
        ({"host": ""}, 403),
        ({"origin": "http://attacker.example"}, 403),
        ({"origin": "null"}, 403),
        ({"host": "localhost:8000", "origin": "http://localhost:9999"}, 403),
    ],
)
def test_only_our_names_and_our_own_pages_pass(client, headers, status):
    assert client.get(f"/{TOKEN}/", headers=headers).status_code == status
    try:
        with client.websocket_connect(LIVE, headers=dict(headers)):
            assert status == 200
    except WebSocketDisconnect:
        assert status == 403


def test_an_address_for_programs_to_start_with_leads_to_the_page_once(scene):
    app = make_app(Session(scene, SETTINGS), TOKEN, "127.0.0.1")
    with TestClient(app, base_url=ADDRESS) as client:
        path = app.once()
        assert TOKEN not in path
        assert client.get(path, follow_redirects=False).headers["location"] == f"/{TOKEN}/"
        assert client.get(path).status_code == 403


def test_names_that_are_ours():
    assert is_ours("box.local:80", "box.local")
    assert is_ours("192.168.0.7:80", "0.0.0.0")
    assert not is_ours("rebound.example", "0.0.0.0")
    assert not is_ours("", "")
    assert is_local("127.0.0.1") and is_local("::1") and is_local("localhost")
    assert not is_local("0.0.0.0") and not is_local("box.local")


def test_answers_forbid_what_the_page_does_not_need(client):
    headers = client.get(f"/{TOKEN}/").headers
    assert "default-src 'none'" in headers["content-security-policy"]
    assert headers["referrer-policy"] == "no-referrer"
    assert client.get(f"/{TOKEN}/editor/index.js").status_code == 200


@pytest.mark.parametrize(
    "path", ["/static/../app.py", "/static/%2e%2e/app.py", "/editor/..%2f..%2f..%2fpage.py", "/a.in"]
)
def test_no_other_file_is_served(client, path):
    assert client.get(f"/{TOKEN}{path}").status_code in (403, 404)


def test_files_name_nothing_on_the_net():
    folder = Path(main.__file__).parents[1] / "page" / "static"
    for file in folder.iterdir():
        assert set(re.findall(r"\w+://[^\s\"']*|[\"'(]//\S*", file.read_text())) <= {"http://www.w3.org/2000/svg"}


# ---- Text and pictures ----------------------------------------------------------------------------------------------


def test_a_text_is_drawn_as_render_draws_it(client):
    with window(client) as page:
        assert page.until("text")["text"] == TEXT
        text = TEXT.replace("2 0 0 1", "-2 1 0 1.25")
        page.type(text)
        assert page.until("state", lambda m: m["heard"] == 1)["saved"] is False
        drawn = page.until("native", lambda m: m["version"] == 2 and m["whole"])
    expected = NativeRenderer().render(parse_scene(text), SETTINGS).pixels
    levels = np.rint(np.clip(np.asarray(expected).reshape(30, 40, 3), 0, 1) * 255)
    assert np.abs(drawn["levels"] - levels).max() <= 1
    assert drawn["levels"].std() > 10


def test_mistakes_are_told_and_the_last_picture_stays(client):
    with window(client) as page:
        page.type(TEXT.replace("solid", "solod"))
        (mark,) = page.until("reading", lambda m: m["version"] == 2)["marks"]
        assert (mark["line"], mark["column"], mark["end"] - mark["start"]) == (9, 1, 5)
        assert "did you mean 'solid'" in mark["message"]
        page.type(TEXT)
        assert page.until("reading", lambda m: m["version"] == 3)["marks"] == []
        page.until("native", lambda m: m["version"] == 3)


def test_what_is_odd_in_a_scene_is_told_with_its_line(client):
    with window(client) as page:
        page.type(TEXT.replace("solid 1", "solid 255"))
        (note,) = page.until("notes", lambda m: m["version"] == 2)["notes"]
        assert note.startswith("9: pigment 0 has the colour 255")


def test_two_pages_show_the_same_text_and_the_later_change_wins(client):
    with window(client) as one, window(client) as other:
        one.until("text")
        other.until("text")
        one.type(TEXT + "# one\n")
        told = other.until("text")
        assert (told["text"], told["mine"], told["heard"]) == (TEXT + "# one\n", False, 0)
        other.type(TEXT + "# other\n")
        assert one.until("text")["text"] == TEXT + "# other\n"
        other.until("native", lambda m: m["version"] == 3 and m["whole"])


def test_who_comes_later_sees_what_there_is(client):
    with window(client) as one:
        one.until("native")  # else it may be given up for the text that comes
        one.type(TEXT.replace("solid", "solod"))
        one.until("reading", lambda m: m["version"] == 2)
        with window(client) as other:
            assert "solod" in other.until("text")["text"]
            assert other.until("reading")["marks"]
            assert other.until("native")["version"] == 1


def test_turning_the_camera_changes_the_eye_in_the_text(client):
    with window(client) as page:
        page.until("native")
        page.say("turn", x=0.5, y=0, first=True)
        assert page.until("text", lambda m: m["version"] == 2)["text"] == TEXT.replace("0 0 -10", "10 0 0", 1)
        page.say("turn", x=0.25, y=0, first=False)  # from where it began, not from where it is
        turned = page.until("text", lambda m: m["version"] == 3)
        assert turned["text"].splitlines()[0] == "7.071 0 -7.071"
        assert turned["mine"]
        page.type("0 0")
        page.until("reading", lambda m: m["version"] == 4)
        page.say("turn", x=0.25, y=0, first=True)
        assert "when the text is a scene" in page.until("said")["message"]


def test_the_number_under_the_cursor(client):
    with window(client) as page:
        page.say("cursor", at=TEXT.index(".6"))
        assert page.until("number")["found"]["name"] == "a finish: kd"
        page.say("cursor", at=TEXT.index("solid"))
        assert page.until("number")["found"] is None


def test_a_pixel_s_rays_and_their_path(client, monkeypatch):
    async def call(self, function, scene, settings, x, y, wanted):
        return NativeRenderer().trace_pixel(scene, settings, x, y)

    monkeypatch.setattr(Helper, "call", call)
    with window(client) as page:
        page.until("native", lambda m: m["whole"])
        page.say("pixel", x=19, y=15)
        found = page.until("rays", lambda m: m["found"]["verdict"])["found"]
        assert found["verdict"] == "The trees are the same."
        assert [line["kind"] for line in found["path"]] == ["reflected"]
        assert found["colors"].keys() == {"native", "mitsuba"}
        assert "#0 sphere (13)" in found["lines"][1]["text"]
        page.type(TEXT.replace(".5 0 0\n2", "0 0 0\n2"))  # the rays follow the text
        assert page.until("rays", lambda m: m["found"]["version"] == 2)["found"]["path"] == []
        page.say("pixel", x=40, y=0)
        assert page.until("rays", lambda m: not m["found"])


@pytest.mark.parametrize(
    "message",
    ["", "[]", "1", "nonsense", "{" * 100_000, '{"type": "text"}', '{"type": "text", "text": 1, "number": 1}',
     '{"type": "turn", "x": NaN, "y": 1e999, "first": true}', '{"type": "pixel", "x": 1e3, "y": 0}',
     '{"type": "cursor", "at": -1}', '{"type": "turn", "x": ' + 400 * "9" + ', "y": 0, "first": true}'],
)  # fmt: skip
def test_strange_messages_do_no_harm(client, message):
    with window(client) as page:
        page.until("text")
        page.socket.send_text(message)
        page.type(TEXT + "# well\n")
        page.until("state", lambda m: m["heard"] == 1)


def test_a_text_that_is_too_long_is_not_taken(client):
    with window(client) as page:
        page.type("#" * ((1 << 20) + 1))
        assert "1,048,576 characters" in page.until("said")["message"]


# ---- The file -------------------------------------------------------------------------------------------------------


def test_saving_is_asked_for(client, scene):
    with window(client) as page:
        page.type(TEXT + "# saved\n")
        page.until("native", lambda m: m["version"] == 2)
        assert scene.read_text() == TEXT
        page.say("save", over=False)
        assert page.until("said")["message"] == "Saved."
        assert page.until("state", lambda m: m["saved"])
    assert scene.read_text() == TEXT + "# saved\n"
    assert list(scene.parent.iterdir()) == [scene]


def test_the_file_is_followed_and_not_written_over(client, scene):
    with window(client) as page:
        page.until("text")
        write(scene, TEXT + "# by an editor\n")
        assert page.until("text", lambda m: m["version"] == 2)["text"] == TEXT + "# by an editor\n"
        page.type(TEXT + "# here\n")
        page.until("state", lambda m: m["heard"] == 1)
        write(scene, TEXT + "# elsewhere\n")
        page.until("state", lambda m: m["elsewhere"])
        page.say("save", over=False)
        assert "changed elsewhere" in page.until("said")["message"]
        assert scene.read_text() == TEXT + "# elsewhere\n"
        page.say("load")
        assert page.until("text")["text"] == TEXT + "# elsewhere\n"
        page.until("state", lambda m: m["saved"] and not m["elsewhere"])


def test_a_change_elsewhere_is_saved_over_when_that_is_asked_for(client, scene):
    with window(client) as page:
        page.type(TEXT + "# here\n")
        page.until("state", lambda m: m["heard"] == 1)
        write(scene, "# elsewhere\n")
        page.say("save", over=False)  # at once, before the file has been looked at
        assert "changed elsewhere" in page.until("said")["message"]
        page.say("save", over=True)
        page.until("state", lambda m: m["saved"] and not m["elsewhere"])
    assert scene.read_text() == TEXT + "# here\n"


# ---- A picture laid over --------------------------------------------------------------------------------------------


def test_a_picture_is_read_whatever_its_name_says(client):
    with window(client) as page:
        name = page.until("scene")["page"]
        data = b"P6\n2 1\n255\n\x01\x02\x03\x04\x05\x06"
        answer = client.post(f"/{TOKEN}/picture", params={"page": name, "name": "../../mine.PNG"}, content=data)
        told = _unframed(answer.content)
        assert (told["name"], told["levels"].tolist()) == ("mine.PNG", [[[1, 2, 3], [4, 5, 6]]])
        for content, expected in ((b"nonsense", "no image"), (b"P6\n90000 90000\n255\n", "cut off")):
            refused = client.post(f"/{TOKEN}/picture", params={"page": name, "name": "a.ppm"}, content=content)
            assert refused.status_code == 422
            assert expected in refused.text
            assert "/tmp" not in refused.text
    assert client.post(f"/{TOKEN}/picture", params={"page": name}, content=data).status_code == 404


def test_why_needs_a_picture(client):
    with window(client) as page:
        page.say("why")
        assert "needs a picture" in page.until("said")["message"]


# ---- Drawing --------------------------------------------------------------------------------------------------------


class Slow:
    """A renderer that takes as long as it is let."""

    def __init__(self):
        self.sizes = []
        self.free = threading.Event()

    def render(self, scene, settings, watch):
        self.sizes.append((settings.width, settings.height))
        while not self.free.wait(0.005):
            watch(0.5)
        size = settings.width, settings.height
        pixels = np.zeros((size[1], size[0], 3), np.float32)
        return Rendering(pixels, *size, {"render": 0.0}, {"pixels_too_deep": 0})


@pytest.fixture
def preview(scene):
    """A preview with a slow renderer, and its events."""
    events: list[object] = []
    preview = Preview(scene, SETTINGS, events.append)
    preview._renderer = Slow()
    preview.start()
    yield preview, events
    preview.end()
    assert not preview.is_alive()


def _wait(condition):
    deadline = time.monotonic() + SOON
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.005)


def test_a_picture_is_drawn_small_first_and_whole_then(preview, monkeypatch):
    monkeypatch.setattr("converter.page.preview.AT_ONCE", SOON)
    drawing, events = preview
    drawing._renderer.free.set()
    drawing.want(1, TEXT)
    _wait(lambda: any(isinstance(event, Noted) for event in events))
    assert [type(event) for event in events] == [Read, Drawn, Drawn, Noted]
    assert [event.whole for event in events[1:3]] == [False, True]
    assert drawing._renderer.sizes == [(10, 7), (40, 30)]
    drawing.want(2, TEXT)  # after a fast one the whole picture at once
    _wait(lambda: len(events) == 7)
    assert [event.whole for event in events if isinstance(event, Drawn) and event.version == 2] == [True]


def test_the_newest_text_is_drawn_and_older_ones_are_given_up(preview):
    drawing, events = preview
    drawing.want(1, TEXT)
    _wait(lambda: drawing._renderer.sizes)
    with drawing._changed:  # so that it does not begin with the second
        drawing.want(2, TEXT)
        drawing.want(3, TEXT)
    _wait(lambda: len(drawing._renderer.sizes) == 2)
    drawing._renderer.free.set()
    _wait(lambda: any(isinstance(event, Noted) for event in events))
    assert [event.version for event in events if isinstance(event, Read)] == [1, 3]
    assert {event.version for event in events if isinstance(event, Drawn)} == {3}


def test_what_takes_too_long_is_given_up_and_told(preview, monkeypatch):
    monkeypatch.setattr("converter.page.preview.LONGEST", 0.05)
    drawing, events = preview
    drawing.want(1, TEXT)
    _wait(lambda: any(isinstance(event, Undrawn) for event in events))
    assert "whitted render" in events[-1].message


def test_rays_are_followed_to_a_limit(scene):
    hall = parse_scene(TEXT.replace(".5 0 0\n2", "1 0 0\n2"))
    assert bounces(hall, SETTINGS, DEEPEST) == DEEPEST
    assert bounces(load_scene(scene), SETTINGS, DEEPEST) is None
    assert bounces(load_scene(scene), Settings(max_depth=3), DEEPEST) == 3


async def _call_helper():
    helper = Helper()
    try:
        yes = {"wanted": lambda: True}
        assert await helper.call(int, "7", **yes) == 7
        assert await helper.call(int, "7", wanted=lambda: False) is None
        with pytest.raises(HelperError, match="invalid literal"):
            await helper.call(int, "x", **yes)
        with pytest.raises(HelperError, match="has ended"):
            await helper.call(os._exit, 3, **yes)
        assert await helper.call(int, "8", **yes) == 8
        return helper._process
    finally:
        helper.end()


def test_a_helper_outlives_what_takes_its_process_down():
    import asyncio

    assert not asyncio.run(_call_helper()).is_alive()


# ---- The command ----------------------------------------------------------------------------------------------------


def test_ctrl_c_ends_it_quietly_whoever_is_there(scene):
    with served(scene, "40", "30") as (process, address, _):
        from websockets.sync.client import connect

        assert address.startswith("http://127.0.0.1:")
        with connect(address.replace("http", "ws") + "live") as socket:
            socket.recv(timeout=SOON)
            process.send_signal(signal.SIGINT)
            assert process.wait(SOON) == 0
        assert process.stderr.read() == ""


def test_a_browser_is_opened_that_gets_to_the_page(scene, tmp_path, monkeypatch):
    """One that says where it got to."""
    got = tmp_path / "got"
    browser = tmp_path / "browser"
    fetch = f"import sys, urllib.request as r; open({str(got)!r}, 'wb').write(r.urlopen(sys.argv[1]).read())"
    browser.write_text(f"#!{sys.executable}\n{fetch}\n")
    browser.chmod(0o755)
    monkeypatch.setenv("BROWSER", str(browser))
    with served(scene, "40", "30", "--open"):
        _wait(lambda: got.exists() and b"page.js" in got.read_bytes())


def test_other_machines_are_warned_of(scene):
    with served(scene, "40", "30", "--host", "0.0.0.0") as (process, _, _):
        process.send_signal(signal.SIGTERM)
        assert process.wait(SOON) == 0
        assert "reached from other machines" in process.stderr.read()


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["missing.in"], "missing.in: no such file"),
        (["{folder}"], "is a directory"),
        (["{scene}", "4000", "4000"], "2,097,152 pixels at most"),
        (["{scene}", "--port", "70000"], "--port: must lie between 0 and 65535"),
        (["{scene}", "--host", "203.0.113.1"], "cannot assign"),
    ],
)
def test_what_cannot_be_served_is_told(scene, arguments, told, capsys):
    words = [word.format(scene=scene, folder=scene.parent) for word in arguments]
    assert main.main(["serve", *words, "--no-open"]) == 2
    assert told in capsys.readouterr().err


def test_without_the_extra_the_command_says_what_to_install(scene):
    script = (
        "import sys\nfor name in ('starlette', 'uvicorn', 'websockets', 'nicegui'): sys.modules[name] = None\n"
        "from importlib import util\nfound = util.find_spec\n"
        "util.find_spec = lambda name: found(name) if sys.modules.get(name, name) is not None else None\n"
        "from converter.commands.main import main\nsys.exit(main(sys.argv[1:]))"
    )
    done = subprocess.run([sys.executable, "-c", script, "serve", str(scene)], capture_output=True, text=True)
    assert done.returncode == 3
    assert done.stderr == "whitted serve: starlette is missing: pip install 'whitted[page]'\n"
