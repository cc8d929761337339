"""The page of some figures, served to the browsers of this machine, and what they may ask.

Only 127.0.0.1 is listened on. The path begins with a random token, so that neither other pages nor other users of the
machine can guess the address; another Host is refused, against names that an attacker points here, and another Origin,
against pages elsewhere that send requests. Two questions are answered: what a robot does when it is let go, and how one
with loops closes them when a joint is moved.
"""

from __future__ import annotations

import json
import secrets
import sys
from collections.abc import Callable, Sequence
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from socketserver import TCPServer
from typing import Any

import numpy as np

from crosscheck.viewing.figures import Figure, LoadedMotion
from crosscheck.viewing.motions import closed_instant, simulated_motion
from crosscheck.viewing.page import page
from crosscheck.viewing.scene import NumberStore, motion_record
from graphdyn import GraphDynError, InvalidInput, RobotModel, assemble, simulate

ADDRESS = "127.0.0.1"

MAX_QUESTION_BYTES = 1 << 16
"""Bytes."""

MAX_DURATION = 60.0
"""Duration that may be asked for [s]."""

SIMULATION_STEP = 1e-3
"""Step of the simulation, fourth order Runge-Kutta [s]."""

HEADERS = {
    "Cache-Control": "no-store",
    "Content-Security-Policy": "frame-ancestors 'none'",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
}


class PageServer(ThreadingHTTPServer):
    """Serves the page of these figures at `address`.

    port: 0 for one that is free; warnings: shown above all else

    Raises OSError where the port is taken.
    """

    daemon_threads = True

    def __init__(self, title: str, figures: Sequence[Figure], port: int = 0, warnings: Sequence[str] = ()) -> None:
        self.figures = tuple(figures)
        self.content = page(title, figures, live=True, warnings=warnings).encode()
        self.path = f"/{secrets.token_urlsafe(16)}/"
        super().__init__((ADDRESS, port), _Answers)

    def server_bind(self) -> None:
        """Bind like HTTPServer, but do not ask for the machine's name: that may take long without a network."""
        TCPServer.server_bind(self)
        self.server_name, self.server_port = ADDRESS, self.server_address[1]

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A browser that goes away in the middle of an answer is no error."""
        if not isinstance(sys.exc_info()[1], ConnectionError):
            super().handle_error(request, client_address)

    @property
    def host(self) -> str:
        return f"{ADDRESS}:{self.server_port}"

    @property
    def address(self) -> str:
        """What the browser opens, token included."""
        return f"http://{self.host}{self.path}"

    def answer(self, name: str, question: bytes) -> dict[str, Any]:
        """A motion as the player reads it.

        name: of one of the questions
        question: JSON with the number of a figure, q, and what the question takes besides

        Raises InvalidInput for a question of another form, and the errors of graphdyn.
        """
        try:
            asked = json.loads(question)
            model = self.figures[int(asked["figure"])].robot.model
            q = [float(position) for position in asked["q"]]
            motion, notes = self.questions[name](model, q, asked)
        except GraphDynError:
            raise
        except (ValueError, TypeError, LookupError, ArithmeticError, RecursionError) as error:
            raise InvalidInput(f"the question has another form than the page gives it ({error!r})") from None
        store = NumberStore()
        return {"motion": motion_record(motion, store), "numbers": store.text(), "notes": notes}

    @property
    def questions(self) -> dict[str, Callable[..., tuple[LoadedMotion, tuple[str, ...]]]]:
        """Questions by the last part of their path."""
        return {"let-go": self._let_go, "pose": self._pose}

    def _let_go(self, model: RobotModel, q: list[float], asked: dict[str, Any]) -> tuple[LoadedMotion, tuple[str, ...]]:
        """The motion from rest under gravity and the file's friction, without torques, for some seconds."""
        seconds = min(float(asked["seconds"]), MAX_DURATION)
        rest = np.zeros(model.nv)
        return simulated_motion(simulate(model, q, rest, seconds, method="rk4", step=SIMULATION_STEP, friction="model"))

    def _pose(self, model: RobotModel, q: list[float], asked: dict[str, Any]) -> tuple[LoadedMotion, tuple[str, ...]]:
        """The closed pose of a robot with loops near q, with one joint, hold, as it is."""
        return closed_instant(model, assemble(model, q, hold=[str(asked["hold"])]))


class _Answers(BaseHTTPRequestHandler):
    server: PageServer
    protocol_version = "HTTP/1.1"
    timeout = 60

    def do_GET(self) -> None:
        if self._is_welcome():
            if self.path == self.server.path:
                self._answer(200, "text/html; charset=utf-8", self.server.content)
            else:
                self._refuse(404, "nothing is here")

    def do_POST(self) -> None:
        if not self._is_welcome():
            return
        length = self.headers.get("Content-Length", "")
        name = self.path.removeprefix(self.server.path)
        if name not in self.server.questions:
            self._refuse(404, "nothing is here")
        elif self.headers.get("Origin") != f"http://{self.server.host}":
            self._refuse(403, "a page elsewhere asks")
        elif not length.isdecimal() or int(length) > MAX_QUESTION_BYTES:
            self._refuse(413, "the question is too long, or its length is not stated")
        else:
            self._reply(name, self.rfile.read(int(length)))

    def _reply(self, name: str, question: bytes) -> None:
        try:
            found = self.server.answer(name, question)
        except GraphDynError as error:
            self._refuse(400, str(error))
        else:
            self._answer(200, "application/json", json.dumps(found).encode())

    def _is_welcome(self) -> bool:
        if self.headers.get_all("Host") != [self.server.host]:
            self._refuse(403, "the page has another address")
            return False
        if self.headers.get("Origin", f"http://{self.server.host}") != f"http://{self.server.host}":
            self._refuse(403, "a page elsewhere asks")
            return False
        return True

    def _refuse(self, status: int, reason: str) -> None:
        self.close_connection = True  # what was sent is not read
        self._answer(status, "text/plain; charset=utf-8", reason.encode())

    def _answer(self, status: int, kind: str, content: bytes) -> None:
        self.send_response(status)
        for name, value in {"Content-Type": kind, "Content-Length": str(len(content)), **HEADERS}.items():
            self.send_header(name, value)
        if self.close_connection:
            self.send_header("Connection", "close")
        self.end_headers()
        self.wfile.write(content)

    def version_string(self) -> str:
        return "graphdyn"

    def log_message(self, format: str, *arguments: Any) -> None:
        """Requests are not logged."""
