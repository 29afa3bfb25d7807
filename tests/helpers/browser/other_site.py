"""A page on a server of its own, so that the service is another origin for it."""

import threading
from collections.abc import Mapping
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from types import MappingProxyType


class OtherSite:
    """Answers requests with ``html`` or a script, under two origins of which the service of the tests allows one."""

    html = ""
    scripts: Mapping[str, str] = MappingProxyType({})  # by their paths

    def __enter__(self) -> "OtherSite":
        site = self

        class Handler(BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                script = site.scripts.get(self.path)
                self.send_response(200)
                self.send_header("Content-Type", f"text/{'html' if script is None else 'javascript'}; charset=utf-8")
                self.end_headers()
                self.wfile.write((site.html if script is None else script).encode())

            def log_message(self, *_: object) -> None:
                pass

        self._server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.allowed_origin = f"http://localhost:{self._server.server_port}"
        self.refused_origin = f"http://127.0.0.1:{self._server.server_port}"
        threading.Thread(target=self._server.serve_forever).start()
        return self

    def __exit__(self, *_: object) -> None:
        self._server.shutdown()
        self._server.server_close()
