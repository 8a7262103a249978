"""The application: its token, its own page only, limits, and workers that may end."""

import asyncio
import json
import sys
from pathlib import Path

import pytest

from rtamt.play import worker_pool as pool_module
from rtamt.play.server import Given, Place, application
from rtamt.play.worker_pool import WorkerPool

HOST, ORIGIN = "127.0.0.1:8000", "http://127.0.0.1:8000"
MESSAGE = {
    "text": "always(x >= 3)",
    "time": "discrete",
    "duration": 2,
    "signals": {"x": {"points": [[0, 5], [1, 2]], "hold": True}},
}


class Client:
    """One event loop, one server without a socket."""

    def __init__(self, folder, **given):
        for name in ("empty", "uploads"):
            (folder / name).mkdir()
        self.loop = asyncio.new_event_loop()
        self.place = Place(
            "secret", (HOST,), str(folder / "uploads"), WorkerPool(str(folder / "empty")), Given(**given)
        )
        self.app = application(self.place)

    def close(self):
        self.run(self.place.workers.close())
        self.loop.close()

    def run(self, awaitable):
        return self.loop.run_until_complete(awaitable)

    def send(self, method, path, body=b"", **headers):
        return self.run(self.sending(method, path, body, **headers))

    async def sending(self, method, path, body=b"", *, leaves=False, **headers):
        """Send a request; a client that ``leaves`` does so before its end."""
        found = []
        names = {"host": HOST, **({"origin": ORIGIN} if method == "POST" else {}), **headers}
        scope = {
            "type": "http",
            "method": method,
            "path": path,
            "raw_path": path.encode(),
            "root_path": "",
            "scheme": "http",
            "query_string": b"",
            "server": ("127.0.0.1", 8000),
            "headers": [
                (k.replace("_", "-").encode(), v.encode()) for k, v in names.items() if v is not None
            ],
        }
        parts = [body[i : i + 65536] for i in range(0, len(body), 65536)] or [b""]

        async def receive():
            if not parts:
                return {"type": "http.disconnect"}
            part = parts.pop(0)
            return {"type": "http.request", "body": part, "more_body": leaves or bool(parts)}

        async def send(message):
            found.append(message)

        await self.app(scope, receive, send)
        start, *rest = found
        return start["status"], dict(start["headers"]), b"".join(each.get("body", b"") for each in rest)

    def ask(self, kind, message, **headers):
        status, _, body = self.send("POST", f"/secret/ask/{kind}", json.dumps(message).encode(), **headers)
        return status, json.loads(body)


@pytest.fixture(scope="module")
def client(tmp_path_factory):
    client = Client(tmp_path_factory.mktemp("play"))
    yield client
    client.close()


def test_the_page_and_its_files_are_served_with_a_strict_policy(client):
    for path, kind in (("/secret/", b"text/html"), ("/secret/page/app.js", b"text/javascript")):
        status, headers, body = client.send("GET", path)
        assert (status, headers[b"content-type"].partition(b";")[0]) == (200, kind)
        assert body
        policy = headers[b"content-security-policy"].decode()
        assert policy.startswith(
            "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'"
        )
        assert "unsafe" not in policy
        assert headers[b"referrer-policy"] == b"no-referrer"
        assert headers[b"x-content-type-options"] == b"nosniff"


@pytest.mark.parametrize(
    ("method", "path", "headers", "sentence"),
    [
        ("GET", "/", {}, "the address lacks the token: open the address that 'rtamt play' has printed"),
        ("GET", "/secre/", {}, "the address lacks the token: open the address that 'rtamt play' has printed"),
        (
            "POST",
            "/sécret/start",
            {},
            "the address lacks the token: open the address that 'rtamt play' has printed",
        ),
        ("GET", "/secret/", {"host": "evil.example:8000"}, "this server answers under its own address only"),
        ("GET", "/secret/", {"host": "127.0.0.1"}, "this server answers under its own address only"),
        ("GET", "/secret/", {"host": None}, "this server answers under its own address only"),
        ("POST", "/secret/start", {"origin": "http://evil.example"}, "this server answers its own page only"),
        ("POST", "/secret/start", {"origin": None}, "this server answers its own page only"),
        ("POST", "/secret/start", {"sec_fetch_site": "cross-site"}, "this server answers its own page only"),
        (
            "GET",
            "/secret/page/app.js",
            {"sec_fetch_site": "same-site"},
            "this server answers its own page only",
        ),
    ],
)
def test_strangers_are_refused(client, method, path, headers, sentence):
    status, answered, body = client.send(method, path, **headers)
    assert (status, body.decode()) == (403, f"{sentence}\n")
    assert b"content-security-policy" in answered


def test_a_websocket_is_closed(client):
    sent = []

    async def send(message):
        sent.append(message)

    client.run(client.app({"type": "websocket", "path": "/secret/", "headers": []}, None, send))
    assert sent == [{"type": "websocket.close", "code": 1008}]


@pytest.mark.parametrize(
    "path", ["/secret/page/..", "/secret/page/server.py", "/secret/page/%2e%2e%2fserver.py", "/secret/file/1"]
)
def test_nothing_else_is_served(client, path):
    assert client.send("GET", path)[0] == 404


@pytest.mark.parametrize(
    ("body", "status", "sentence"),
    [
        (b"", 400, "the request must be a JSON object"),
        (b"[1]", 400, "the request must be a JSON object"),
        (b"\xff{", 400, "the request must be a JSON object"),
        (b"[" * 100_000, 400, "the request must be a JSON object"),
        (b"{}", 400, "'text' must be a text"),
        (
            b'{"text": "x > 0", "time": "discrete", "duration": 1e999}',
            400,
            "'duration' must be a finite number",
        ),
        (b'{"text": "' + b"x" * 4_000_000 + b'"}', 413, "the request has more than 4000000 bytes"),
    ],
)
def test_malformed_messages_get_a_sentence_and_the_server_survives(client, body, status, sentence):
    answered, _, data = client.send("POST", "/secret/ask/evaluate", body)
    assert (answered, json.loads(data)) == (status, {"sentence": sentence})
    assert client.ask("evaluate", MESSAGE)[1]["verdict"] == "violated"


def test_unknown_requests_and_methods_are_refused(client):
    assert client.ask("execute", MESSAGE) == (404, {"sentence": "there is no request 'execute'"})
    assert client.send("GET", "/secret/start")[0] == 405


def test_a_recording_is_uploaded_evaluated_and_given_back(client):
    data = b"time,x\n0,5\n1,2\n"
    status, _, body = client.send("POST", "/secret/upload", data, x_name="..%2f..%2fmy%20drive.csv")
    found = json.loads(body)
    assert (status, found["name"], found["samples"]) == (200, "my drive.csv", 2)
    answer = client.ask("evaluate", {**MESSAGE, "recording": found["number"]})[1]
    assert (answer["verdict"], answer["interval"]) == ("violated", [-1, -1])
    assert client.send("GET", f"/secret/file/{found['number']}")[2] == data
    assert client.place.folder not in json.dumps([found, answer])


def test_a_client_that_leaves_during_its_request_leaves_nothing_behind(client):
    for path in ("upload", "ask/evaluate"):
        client.send("POST", f"/secret/{path}", b"time,x\n0,5\n", x_name="half.csv", leaves=True)
    kept = {each["path"] for each in client.place.files.values() if each["ours"]}
    assert {str(path) for path in Path(client.place.folder).iterdir()} == kept
    assert client.ask("evaluate", MESSAGE)[1]["verdict"] == "violated"


def test_what_is_no_recording_is_refused_by_its_name(client):
    status, _, body = client.send("POST", "/secret/upload", b"import os", x_name="evil.pkl")
    assert status == 400
    assert json.loads(body)["sentence"].startswith(
        "'evil.pkl' is no recording: its name ends in none of .csv, "
    )
    assert json.loads(client.send("POST", "/secret/upload", b"\0\1", x_name="bad.parquet")[2])["error"][
        "message"
    ]


def test_of_several_requests_of_a_page_only_the_newest_is_answered(client):
    async def burst():
        bodies = [json.dumps({**MESSAGE, "page": "p", "number": n}).encode() for n in range(1, 6)]
        sent = [client.sending("POST", "/secret/ask/evaluate", body) for body in bodies]
        return [json.loads(answer[2]) for answer in await asyncio.gather(*sent)]

    answers = client.run(burst())
    assert answers[-1]["verdict"] == "violated"
    assert [answer.get("late") for answer in answers[1:-1]] == [True] * 3


def test_a_request_that_takes_too_long_is_ended_and_the_next_one_is_answered(client, monkeypatch):
    monkeypatch.setitem(pool_module.SECONDS, "evaluate", 0.0)
    assert client.ask("evaluate", MESSAGE)[1]["error"]["message"] == (
        "the request took more than 0 s and was ended; use fewer samples"
    )
    monkeypatch.undo()
    assert client.ask("evaluate", MESSAGE)[1]["verdict"] == "violated"


def test_a_question_can_be_cancelled(client):
    hard = {**MESSAGE, "text": "always(x >= 3)", "wanted": "witness"}

    async def cancelled():
        asked = asyncio.create_task(
            client.sending("POST", "/secret/ask/find_trace", json.dumps(hard).encode())
        )
        while client.place.workers._thorough._process is None:
            await asyncio.sleep(0)
        await client.sending("POST", "/secret/cancel")
        return json.loads((await asked)[2])

    assert client.run(cancelled())["error"]["message"] == "the request was ended"


def test_the_page_starts_with_what_the_command_line_gives(tmp_path):
    path = tmp_path / "drive.csv"
    path.write_text("time,x\n0,5\n1,2\n")
    client = Client(tmp_path, text="always(x >= 3)", name="limits.stl", recording=str(path))
    try:
        client.place.add(str(path), "drive.csv", ours=False)
        found = json.loads(client.send("POST", "/secret/start")[2])
        assert (found["text"], found["name"]) == ("always(x >= 3)", "limits.stl")
        assert found["recording"]["signals"] == [{"name": "x", "unit": ""}]
        assert str(tmp_path) not in json.dumps(found)
        path.write_text("")
        again = Client(tmp_path / "uploads", recording=str(path))
        again.place.add(str(path), "drive.csv", ours=False)
        found = json.loads(again.send("POST", "/secret/start")[2])
        again.close()
        assert found["recording"] is None
        assert "drive.csv" in found["complaint"]
    finally:
        client.close()


def test_old_uploads_are_deleted(client):
    for number in range(20):
        client.send("POST", "/secret/upload", b"time,x\n0,5\n1,2\n", x_name=f"{number}.csv")
    own = [each for each in client.place.files.values() if each["ours"]]
    assert len(own) == 16


def test_modules_in_the_current_folder_are_not_imported(tmp_path, monkeypatch):
    (tmp_path / "numpy.py").write_text("raise SystemExit('imported')")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", ["", *sys.path])
    client = Client(tmp_path)
    try:
        assert client.ask("evaluate", MESSAGE)[1]["verdict"] == "violated"
    finally:
        client.close()
