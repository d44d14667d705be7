# SPDX-License-Identifier: AGPL-3.0-or-later
"""A page's side of the wire, over sockets: what the tests of the server speak with."""
import base64
import json
import os
import re
import socket
import struct
import subprocess
import urllib.parse


class Server:
    """A running `octotomy serve`; `url` as it printed it."""

    def __init__(self, program, folder, *arguments):
        self.process = subprocess.Popen([program, "serve", "--json", *map(str, arguments)], cwd=folder,
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        line = self.process.stdout.readline()
        if not line:
            raise RuntimeError(self.process.stderr.read())
        said = json.loads(line)
        self.url = said["url"]
        self.view_token = said["view_url"].partition("token=")[2] if "view_url" in said else None
        parts = urllib.parse.urlsplit(self.url)
        self.host, self.port = parts.hostname, parts.port
        self.token = urllib.parse.parse_qs(parts.query)["token"][0]

    def resident_mb(self):
        with open(f"/proc/{self.process.pid}/status", encoding="utf-8") as file:
            status = file.read()
        return int(re.search(r"VmRSS:\s+(\d+)", status)[1]) / 1024

    def http(self, target, method="GET", body=b"", **headers):
        """Status, headers and body of one request."""
        fields = {"Host": f"{self.host}:{self.port}", "Content-Length": str(len(body)), **headers}
        if method == "GET":
            del fields["Content-Length"]
        with socket.create_connection((self.host, self.port), timeout=60) as stream:
            head = f"{method} {target} HTTP/1.1\r\n" + "".join(f"{k}: {v}\r\n" for k, v in fields.items())
            stream.sendall(head.encode() + b"\r\n" + body)
            answer = b""
            while part := stream.recv(1 << 16):
                answer += part
        head, _, body = answer.partition(b"\r\n\r\n")
        lines = head.decode("latin-1").split("\r\n")
        return int(lines[0].split()[1]), dict(line.split(": ", 1) for line in lines[1:]), body

    def kill(self):
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()
        self.process.stderr.close()


class Window:
    """A WebSocket to the server."""

    def __init__(self, server, token=None, origin=None, host=None):
        self.stream = socket.create_connection((server.host, server.port), timeout=60)
        self.stream.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.buffer = b""
        self.events = []
        self.last = 0
        host = host or f"{server.host}:{server.port}"
        fields = {"Host": host, "Upgrade": "websocket", "Connection": "Upgrade", "Sec-WebSocket-Version": "13",
                  "Sec-WebSocket-Key": base64.b64encode(os.urandom(16)).decode(),
                  "Origin": f"http://{host}" if origin is None else origin}
        if not fields["Origin"]:
            del fields["Origin"]
        token = server.token if token is None else token
        self.stream.sendall((f"GET /socket?token={token} HTTP/1.1\r\n" +
                             "".join(f"{k}: {v}\r\n" for k, v in fields.items()) + "\r\n").encode())
        head = b""
        while not head.endswith(b"\r\n\r\n"):
            byte = self.stream.recv(1)
            if not byte:
                break
            head += byte
        self.status = int(head.split()[1])

    def close(self):
        self.stream.close()

    def send_bytes(self, payload, opcode=1):
        size = len(payload)
        head = bytes([0x80 | opcode])
        head += (bytes([0x80 | size]) if size < 126 else bytes([0xFE]) + struct.pack(">H", size)
                 if size < 65536 else bytes([0xFF]) + struct.pack(">Q", size))
        mask = b"\0\0\0\0"  # allowed, and leaves the bytes as they are
        self.stream.sendall(head + mask + payload)

    def _take(self, count):
        while len(self.buffer) < count:
            part = self.stream.recv(1 << 18)
            if not part:
                raise ConnectionError("the server closed the socket")
            self.buffer += part
        taken, self.buffer = self.buffer[:count], self.buffer[count:]
        return taken

    def receive(self):
        """The next message: a dictionary, or (header, {kind: bytes}) of a frame."""
        payload = b""
        while True:
            first, size = self._take(2)
            if size == 126:
                size, = struct.unpack(">H", self._take(2))
            elif size == 127:
                size, = struct.unpack(">Q", self._take(8))
            part = self._take(size)
            if first & 0x0F == 8:
                raise ConnectionError("the server closed the socket: " + part[2:].decode())
            if first & 0x0F == 9:
                self.send_bytes(part, 10)
                continue
            if first & 0x0F == 10:  # nobody asked: random bytes can be a ping
                continue
            if first & 0x0F:
                binary = first & 0x0F == 2
            payload += part
            if first & 0x80:
                break
        if not binary:
            return json.loads(payload)
        length, = struct.unpack("<I", payload[:4])
        header = json.loads(payload[4:4 + length])
        parts, at = {}, 4 + length
        for part in header["parts"]:
            parts[part["kind"]] = payload[at:at + part["bytes"]]
            at += part["bytes"]
        return header, parts

    def post(self, do, **said):
        """Sends a request; its number."""
        self.last += 1
        self.send_bytes(json.dumps({"id": self.last, "do": do, **said}).encode())
        return self.last

    def wait(self, number):
        """What answers a request: its "ok", or a frame. Raises RuntimeError with the code and message."""
        while True:
            message = self.receive()
            if isinstance(message, tuple):
                if message[0]["id"] == number:
                    return message
                continue
            if "event" in message:
                self.events.append(message)
            elif message.get("id") == number:
                if "error" in message:
                    raise RuntimeError(f"{message['error']['code']}: {message['error']['message']}")
                return message["ok"]

    def ask(self, do, **said):
        return self.wait(self.post(do, **said))
