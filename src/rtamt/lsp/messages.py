"""Malformed messages and errors: the client learns of each by the protocol, and the server continues. Needs pygls."""

from __future__ import annotations

import logging
import traceback
from typing import Any

from lsprotocol import types as lsp
from pygls.exceptions import (
    FeatureNotificationError,
    FeatureRequestError,
    JsonRpcException,
    JsonRpcInternalError,
    JsonRpcInvalidParams,
    JsonRpcInvalidRequest,
    JsonRpcParseError,
    JsonRpcServerNotInitialized,
)
from pygls.protocol import LanguageServerProtocol


class AnsweredError(Exception):
    """A request has its answer: its parameters were wrong."""


class Protocol(LanguageServerProtocol):
    """The protocol; requests with wrong parameters are answered, which a client would wait for."""

    def structure_message(self, data: dict[str, Any]) -> Any:
        """Return a message as an object."""
        try:
            return super().structure_message(data)
        except JsonRpcException:
            if not isinstance(data.get("id"), int | str) or not isinstance(data.get("method"), str):
                raise JsonRpcInvalidRequest("the message is no request of the protocol") from None
            wrong = f"the parameters of '{data['method']}' are not those of the protocol"
            self._send_response(data["id"], error=JsonRpcInvalidParams(wrong).to_response_error())
            raise AnsweredError from None

    def handle_message(self, message: Any) -> None:
        """Answer a request, or handle a notification."""
        if not hasattr(message, "jsonrpc"):
            raise JsonRpcInvalidRequest("a message is one object of JSON-RPC 2.0")
        refusal = self._refusal_of(message) if hasattr(message, "method") and hasattr(message, "id") else None
        if refusal is None:
            super().handle_message(message)
        else:
            self._send_response(message.id, error=refusal.to_response_error())

    def _refusal_of(self, request: Any) -> JsonRpcException | None:
        """Return why a request is refused whatever its method is; pygls leaves two of these without an answer."""
        if request.jsonrpc != self.VERSION:
            return JsonRpcInvalidRequest("a message is one object of JSON-RPC 2.0")
        if self._shutdown:
            return JsonRpcInvalidRequest("the server is shut down")
        if self._workspace is None and request.method != lsp.INITIALIZE:
            return JsonRpcServerNotInitialized(f"'{request.method}' comes before 'initialize'")
        return None

    def refuse(self, error: Exception) -> None:
        """Answer a message that could not be read: the answer has no ID, as the ID is not known."""
        if not isinstance(error, JsonRpcException):
            error = JsonRpcParseError(f"the message is not JSON: {error}")
        answer = {"code": error.code, "message": error.message}
        self._send_data({"jsonrpc": self.VERSION, "id": None, "error": answer})


def report(protocol: Protocol, error: Exception, source: Any) -> bool:
    """Answer what went wrong with a message as such; return whether it is something else."""
    if source in (FeatureNotificationError, FeatureRequestError):
        return True
    if not isinstance(error, AnsweredError):
        protocol.refuse(error)
    return False


def details_of(error: Exception) -> str | None:
    """Return an error with its traceback; None for a refusal, whose message says it all."""
    if isinstance(error, JsonRpcInternalError) and isinstance(error.data, dict):
        return "".join((*error.data.get("traceback", ()), str(error.message)))
    if isinstance(error, JsonRpcException):
        return None
    return "".join(traceback.format_exception(error)).rstrip()


def silence_logs() -> None:
    """Keep what pygls logs off stderr: a client that does not read it would block the server once the pipe is full."""
    logger = logging.getLogger("pygls")
    logger.addHandler(logging.NullHandler())
    logger.propagate = False
