"""Messages that are not those of the protocol, as bytes, and errors: each is answered, and the server goes on."""

import asyncio
import json
import subprocess
import sys
from types import SimpleNamespace

import pytest
from pygls.exceptions import FeatureNotificationError, FeatureRequestError, JsonRpcInternalError

from rtamt.lsp.server import make_server

URI = "file:///project/raw.stl"
NOT_ITS_PARAMETERS = "the parameters of 'textDocument/hover' are not those of the protocol"


class Client:
    """A client that sends bytes."""

    def __init__(self, stderr):
        self.process = subprocess.Popen(
            [sys.executable, "-m", "rtamt", "lsp"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=stderr,
        )
        self.number = 0

    def send(self, content):
        self.process.stdin.write(b"Content-Length: %d\r\n\r\n" % len(content) + content)
        self.process.stdin.flush()

    def receive(self):
        length = 0
        while header := self.process.stdout.readline().strip():
            name, _, value = header.partition(b":")
            length = int(value) if name.lower() == b"content-length" else length
        return json.loads(self.process.stdout.read(length))

    def notify(self, method, params):
        self.send(json.dumps({"jsonrpc": "2.0", "method": method, "params": params}).encode())

    def ask(self, method, params):
        """Return the messages up to the answer."""
        self.number += 1
        request = {"jsonrpc": "2.0", "id": self.number, "method": method, "params": params}
        self.send(json.dumps(request).encode())
        found = [self.receive()]
        while found[-1].get("id") != self.number:
            found.append(self.receive())
        return found


@pytest.fixture(scope="module")
def stderr(tmp_path_factory):
    return tmp_path_factory.mktemp("server") / "stderr.txt"


@pytest.fixture(scope="module")
def client(stderr):
    with stderr.open("wb") as file:
        made = Client(file)
    with made.process:
        made.ask("initialize", {"processId": None, "rootUri": None, "capabilities": {}})
        made.notify("initialized", {})
        text = {"uri": URI, "languageId": "stl", "version": 1, "text": "float x\nalways(x > 3)"}
        made.notify("textDocument/didOpen", {"textDocument": text})
        made.ask("textDocument/documentSymbol", {"textDocument": {"uri": URI}})
        yield made
        made.ask("shutdown", None)
        made.notify("exit", None)
        assert made.process.wait(60) == 0


def request(params, method="textDocument/hover"):
    return json.dumps({"jsonrpc": "2.0", "id": "asked", "method": method, "params": params}).encode()


def hover(uri=URI, line=0, character=0):
    return request({"textDocument": {"uri": uri}, "position": {"line": line, "character": character}})


def command(name, *arguments):
    return request({"command": name, "arguments": arguments}, "workspace/executeCommand")


@pytest.mark.parametrize(
    ("content", "asked", "code", "message"),
    [
        (
            b"{nonsense",
            None,
            -32700,
            "the message is not JSON: Expecting property name enclosed in double quotes",
        ),
        (b'{"a": "\xff"}', None, -32700, "the message is not JSON: 'utf-8' codec can't decode byte 0xff"),
        (b"[" * 100_000, None, -32700, "the message is not JSON: maximum recursion depth exceeded"),
        (b"[]", None, -32600, "a message is one object of JSON-RPC 2.0"),
        (b"null", None, -32600, "a message is one object of JSON-RPC 2.0"),
        (b'{"id": 3}', None, -32600, "a message is one object of JSON-RPC 2.0"),
        (b'{"jsonrpc": "2.0", "id": 3}', None, -32600, "the message is no request of the protocol"),
        (request({"textDocument": 3}), "asked", -32602, NOT_ITS_PARAMETERS),
        (request([1, 2]), "asked", -32602, NOT_ITS_PARAMETERS),
        (request(None), "asked", -32602, NOT_ITS_PARAMETERS),
        (hover(line=-1), "asked", -32602, NOT_ITS_PARAMETERS),
        (hover(character="x"), "asked", -32602, NOT_ITS_PARAMETERS),
        (
            hover("file:///project/closed.stl"),
            "asked",
            -32602,
            "the text 'file:///project/closed.stl' is not open",
        ),
        (hover("::"), "asked", -32602, "the text '::' is not open"),
        (request({}, "no/such"), "asked", -32601, "Method Not Found: no/such"),
        (command("rm"), "asked", -32602, "Invalid Params: Command name 'rm' is not defined"),
        (command("rtamt.check"), "asked", -32602, "rtamt.check takes the address of a text"),
        (command("rtamt.check", {"a": 3}), "asked", -32602, "rtamt.check takes the address of a text"),
    ],
)
def test_a_message_that_is_wrong_has_an_answer(client, content, asked, code, message):
    client.send(content)
    error, answer = client.ask("textDocument/documentSymbol", {"textDocument": {"uri": URI}})
    assert (error["id"], error["error"]["code"]) == (asked, code)
    assert error["error"]["message"].startswith(message)
    assert [each["name"] for each in answer["result"]] == ["x"]


def test_positions_beyond_the_text_and_unknown_answers_do_no_harm(client):
    client.send(hover(line=10**9, character=10**9))
    client.send(b'{"jsonrpc": "2.0", "id": "unknown", "result": null}')
    client.notify("$/cancelRequest", {"id": 12345})
    client.notify(
        "workspace/didChangeConfiguration", {"settings": {"rtamt": {"recording": "\0", "period": 7}}}
    )
    found = client.ask("textDocument/documentSymbol", {"textDocument": {"uri": URI}})
    assert [each.get("error") for each in found] == [None] * len(found)
    assert next(each for each in found if each.get("id") == "asked")["result"] is None


def test_refusals_leave_stderr_empty(client, stderr):
    # A client that does not read stderr would block the server once the pipe is full.
    place = {"textDocument": {"uri": URI}, "position": {"line": 1, "character": 0}}
    refused = client.ask("textDocument/prepareRename", place)
    assert [each["error"]["message"] for each in refused] == ["there is no name here that can be renamed"]
    client.ask("no/such", {})
    client.ask("textDocument/hover", 3)
    client.notify("no/such", {})
    client.notify("$/cancelRequest", {"id": 12345})
    client.send(b"{nonsense")
    client.ask("textDocument/documentSymbol", {"textDocument": {"uri": URI}})
    assert stderr.read_text(encoding="utf-8") == ""


def test_requests_of_another_version_before_initialize_and_after_shutdown_have_an_answer():
    def refusal(messages):
        return [(each["error"]["code"], each["error"]["message"]) for each in messages]

    place = {"textDocument": {"uri": URI}, "position": {"line": 0, "character": 0}}
    made = Client(subprocess.DEVNULL)
    with made.process:
        early = made.ask("textDocument/hover", place)
        assert refusal(early) == [(-32002, "'textDocument/hover' comes before 'initialize'")]
        made.ask("initialize", {"processId": None, "rootUri": None, "capabilities": {}})
        made.send(hover().replace(b'"2.0"', b'"1.0"'))
        # With a version that it ignores, the server would answer the next request only.
        other, _answer = made.ask("shutdown", None)
        assert refusal([other]) == [(-32600, "a message is one object of JSON-RPC 2.0")]
        assert other["id"] == "asked"
        made.send(hover())
        made.notify("exit", None)
        late = made.receive()
        assert refusal([late]) == [(-32600, "the server is shut down")]
        assert made.process.wait(60) == 0


class Sent(list):
    """The messages of a server in this process."""

    def write(self, data):
        self.append(json.loads(data))

    def close(self):
        pass


@pytest.fixture
def server():
    made = make_server()
    made.protocol.set_writer(Sent(), include_headers=False)
    yield made
    made.shutdown()


def logged(server):
    return [
        each["params"]["message"]
        for each in server.protocol.writer
        if each["method"] == "window/logMessage" and each["params"]["type"] == 1
    ]


def shown(server):
    return [
        each["params"]["message"] for each in server.protocol.writer if each["method"] == "window/showMessage"
    ]


def test_an_error_of_the_server_is_logged_with_its_traceback(server):
    try:
        raise ValueError("wrong")
    except ValueError as error:
        server.report_server_error(JsonRpcInternalError.of(sys.exc_info()), FeatureRequestError)
        server.report_server_error(error, FeatureNotificationError)
    answered, unasked = logged(server)
    for each in (answered, unasked):
        assert 'raise ValueError("wrong")' in each
        assert each.endswith("ValueError: wrong")
    assert shown(server) == ["Error in server: wrong"]


def test_an_error_of_a_check_in_the_background_is_shown(server, monkeypatch):
    async def check(uri):
        raise OSError(f"no check of {uri}")

    async def open_text():
        server.check_later(URI)
        (task,) = server.state.tasks
        await asyncio.wait([task])

    monkeypatch.setattr(server, "check", check)
    monkeypatch.setattr(server, "checking", lambda uri: (uri,))
    monkeypatch.setattr(server, "analysis", lambda uri: SimpleNamespace(spec=uri))
    asyncio.run(open_text())
    (found,) = logged(server)
    assert found.endswith(f"OSError: no check of {URI}")
    assert shown(server) == [f"Error in server: no check of {URI}"]
    assert server.state.tasks == set()
