# SPDX-License-Identifier: AGPL-3.0-or-later
"""Hostile peers that send raw bytes: the receiver refuses what they send, writes nothing outside its folder, keeps
its memory, and serves the next honest peer. The same for an archive that answers a fetch with harm."""
import os
import random
import resource
import socket
import struct
import subprocess
import tempfile
import threading
import time
import unittest
from pathlib import Path

PROGRAM = os.environ["OCTOTOMY_PROGRAM"]
CT = b"1.2.840.10008.5.1.4.1.1.2"
SYNTAX = b"1.2.840.10008.1.2.1"
INSTANCE = b"1.2.3.4"


def item(kind, value):
    return bytes([kind, 0]) + struct.pack(">H", len(value)) + value


def unit(kind, value, length=None):
    return bytes([kind, 0]) + struct.pack(">I", len(value) if length is None else length) + value


def request(called=b"OCTOTOMY", calling=b"HARM", abstract=CT, contexts=1, user=None):
    context = b"".join(item(0x20, bytes([2 * i + 1 & 255, 0, 0, 0]) + item(0x30, abstract) + item(0x40, SYNTAX))
                       for i in range(contexts))
    return unit(1, struct.pack(">HH", 1, 0) + called.ljust(16) + calling.ljust(16) + bytes(32) +
                item(0x10, b"1.2.840.10008.3.1.1.1") + context +
                (user if user is not None else item(0x50, item(0x51, struct.pack(">I", 16384)))))


def fragment(flags, data, context=1, length=None):
    body = struct.pack(">IBB", len(data) + 2 if length is None else length, context, flags) + data
    return unit(4, body)


def element(number, value):
    return struct.pack("<HHI", 0, number, len(value)) + value


def padded(uid):
    return uid + b"\0" * (len(uid) % 2)


def command(instance=INSTANCE, kind=1, data=1, abstract=CT):
    text = (element(2, padded(abstract)) + element(0x100, struct.pack("<H", kind)) + element(0x110, b"\1\0") +
            element(0x700, b"\0\0") + element(0x800, struct.pack("<H", data)) + element(0x1000, padded(instance)))
    return element(0, struct.pack("<I", len(text))) + text


def attribute(group, number, kind, value):
    value += (b"\0" if kind == b"UI" else b" ") * (len(value) % 2)
    return struct.pack("<HH", group, number) + kind + struct.pack("<H", len(value)) + value


def data_set(instance=INSTANCE, more=b""):
    return attribute(8, 0x16, b"UI", CT) + attribute(8, 0x18, b"UI", instance) + more


def one_unit(peer):
    """The next whole unit; what there is of it if the other side ends."""
    got = b""
    while len(got) < 6 or len(got) < 6 + struct.unpack(">I", got[2:6])[0]:
        now = peer.recv(1 if len(got) < 6 else 6 + struct.unpack(">I", got[2:6])[0] - len(got))
        if not now:
            break
        got += now
    return got


class Receiver(unittest.TestCase):
    def setUp(self):
        self.work = tempfile.TemporaryDirectory()
        self.around = Path(self.work.name)
        self.folder = self.around / "outer/inbox"
        self.folder.parent.mkdir()
        self.process = subprocess.Popen(
            [PROGRAM, "receive", "-o", self.folder, "--port", "0", "--timeout", "3", "--object-mb", "8", "--total-mb", "32",
             "--json"], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, cwd=self.folder.parent)
        line = self.process.stderr.readline()
        self.assertIn("listening", line)
        self.port = int(line.rsplit(":", 1)[1])
        self.said = []
        threading.Thread(target=lambda: self.said.extend(self.process.stderr), daemon=True).start()
        self.need_honest_peer_served(1)
        self.before = self.memory_mb()

    def tearDown(self):
        self.process.terminate()
        self.process.wait(60)
        self.process.stderr.close()
        self.work.cleanup()

    def memory_mb(self, field="VmRSS"):
        text = Path(f"/proc/{self.process.pid}/status").read_text()
        return int(next(x for x in text.splitlines() if x.startswith(field)).split()[1]) / 1024

    def connect(self):
        made = socket.create_connection(("127.0.0.1", self.port), timeout=10)
        return made

    def ask(self, *parts, wait=True):
        """Sends bytes; returns all that comes back until the other side ends or 5 s are over."""
        with self.connect() as peer:
            got = b""
            try:
                for part in parts:
                    peer.sendall(part)
                peer.settimeout(5)
                while wait and (now := peer.recv(4096)):
                    got += now
            except OSError:
                pass
            return got

    def store(self, instance, data, says=INSTANCE):
        """An association that stores one object; returns the last unit that comes back."""
        with self.connect() as peer:
            peer.settimeout(20)
            peer.sendall(request())
            if one_unit(peer)[:1] != b"\2":
                return b""
            try:
                peer.sendall(fragment(3, command(instance)) + fragment(2, data))
                return one_unit(peer)
            except OSError:
                return b""

    def need_honest_peer_served(self, number):
        instance = b"1.2.3." + str(number).encode()
        answer = b""
        for _ in range(100):  # rejected while too many associations are open
            answer = self.store(instance, data_set(instance))
            if answer:
                break
            time.sleep(0.1)
        self.assertEqual(answer[:1], b"\4", self.said if hasattr(self, "said") else "")
        self.assertIn(element(0x900, b"\0\0"), answer)

    def need_unharmed(self, objects):
        self.assertIsNone(self.process.poll(), "the receiver has ended")
        self.need_honest_peer_served(objects)
        everything = sorted(str(x.relative_to(self.around)) for x in self.around.rglob("*"))
        end = time.time() + 10
        while len(list(self.folder.iterdir())) != objects and time.time() < end:
            time.sleep(0.1)  # parts of an object go when their association ends
        files = sorted(self.folder.iterdir())
        self.assertEqual(len(files), objects, everything)
        for file in files:
            self.assertRegex(file.name, r"^[0-9a-f]{64}\.dcm$")
        self.assertEqual([x for x in everything if not x.startswith("outer/inbox/")], ["outer", "outer/inbox"])
        self.assertLess(self.memory_mb() - self.before, 24, "memory has to stay flat")

    def test_names_choose_no_path(self):
        for name in [b"../../evil", b"/tmp/evil", b"..\\evil", b"1.2/../../3", b"A" * 64, b"1.2\x003", b"%s%n", b"",
                     b"9" * 65, b"." * 4000]:
            self.assertNotIn(element(0x900, b"\0\0"), self.store(name, data_set(name)))
            self.assertEqual(self.ask(request(called=name[:16]))[:1], b"\3" if name[:16].strip(b" \0") != b"" else b"\3")
        # What the object itself states counts, too.
        self.assertNotIn(element(0x900, b"\0\0"), self.store(INSTANCE, data_set(b"../../evil")))
        self.need_unharmed(2)

    def test_wrong_lengths_are_refused(self):
        for parts in [[unit(1, b"", 0xffffffff), b"x" * 100000], [unit(1, b"x" * 10, 0x7fffffff)], [unit(9, b"")],
                      [b"GET / HTTP/1.1\r\nHost: x\r\n\r\n" + b"\r\n" * 100], [request()[:40]],
                      [request(user=bytes([0x50, 0, 0xff, 0xff]))], [request(contexts=200)],
                      [request(user=item(0x50, item(0x51, b"\0\0\0\1")))],
                      [request(), unit(4, b"x", 0xfffffff0)], [request(), fragment(3, command(), length=0xffffffff)],
                      [request(), fragment(3, command(), length=1)], [request(), fragment(3, command(), context=77)],
                      [request(), fragment(3, command()[:30])], [request(), fragment(2, b"data first")],
                      [request(), fragment(3, element(2, b"").replace(b"\0\0\0\0", b"\xff\xff\xff\x7f"))],
                      [request(), fragment(3, command(kind=0x20))], [request(), fragment(3, command(data=0x101))],
                      [request(), fragment(3, command()), fragment(3, command())],
                      [request(), fragment(3, command()), unit(6, bytes(4))],
                      [request(), fragment(3, command(abstract=b"1.2.840.10008.1.1"))]]:
            answer = self.ask(*parts)
            self.assertNotIn(element(0x900, b"\0\0"), answer)
        long = struct.pack("<HH", 0x10, 0x10) + b"OB\0\0" + struct.pack("<I", 0x7ffffff0) + b"x"
        for data in [data_set(more=long), b"", b"\xff" * 999, data_set()[:-3]]:
            self.assertNotIn(element(0x900, b"\0\0"), self.store(INSTANCE, data))
        self.need_unharmed(2)

    def test_endless_data_end_at_the_limit(self):
        for part in [fragment(0, b"x" * 100000), fragment(1, command() + b"x" * 100000)]:
            with self.connect() as peer:
                peer.sendall(request())
                one_unit(peer)
                sent = 0
                try:
                    if part[10] == 0 or part[11] == 0:
                        peer.sendall(fragment(3, command()))
                    while sent < 400e6:
                        peer.sendall(part)
                        sent += len(part)
                except OSError:
                    pass
                self.assertLess(sent, 40e6)
        # Objects within the limit, until their sum reaches its own.
        stored = 1
        for i in range(8):
            instance = b"1.2.9." + str(i).encode()
            more = b"".join(struct.pack("<HH", 9, 0x1000 + k) + b"UN\0\0" + struct.pack("<I", 60000) + bytes(60000)
                            for k in range(110))
            with self.connect() as peer:
                peer.settimeout(20)
                peer.sendall(request())
                one_unit(peer)
                try:
                    peer.sendall(fragment(3, command(instance)))
                    text = data_set(instance, more)
                    for at in range(0, len(text), 60000):
                        peer.sendall(fragment(2 if at + 60000 >= len(text) else 0, text[at:at + 60000]))
                    stored += element(0x900, b"\0\0") in one_unit(peer)
                except OSError:
                    pass
        self.assertEqual(stored, 6, "of 6.6 MB each, 5 fit into 32 MB beside the first")
        self.need_unharmed(stored + 1)

    def test_a_thousand_associations(self):
        soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (min(hard, 4096), hard))
        peers = []
        try:
            for i in range(1000):
                try:
                    peers.append(self.connect())
                    peers[-1].sendall(request() if i % 2 else request()[:9])
                except OSError:
                    pass
            self.assertLess(self.memory_mb("VmHWM") - self.before, 24)
            self.assertLess(len(list(Path(f"/proc/{self.process.pid}/task").iterdir())), 24)
        finally:
            for peer in peers:
                peer.close()
            resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))
        self.need_unharmed(2)

    def test_slow_peers_do_not_stay(self):
        with self.connect() as peer:
            begin = time.time()
            try:
                for byte in request():
                    peer.sendall(bytes([byte]))
                    time.sleep(0.2)
                    if time.time() - begin > 20:
                        break
            except OSError:
                pass
            self.assertLess(time.time() - begin, 10)
        self.need_unharmed(2)

    def test_random_units(self):
        draw = random.Random(7)
        for _ in range(150):
            good = request() + fragment(3, command()) + fragment(2, data_set())
            data = bytearray(good)
            for _ in range(draw.randint(1, 6)):
                data[draw.randrange(len(data))] = draw.randrange(256)
            self.ask(bytes(data[:draw.randint(1, len(data))]), wait=False)
        self.assertIsNone(self.process.poll())
        for file in self.folder.iterdir():
            self.assertTrue(file.name.endswith((".dcm", ".part")))
        self.assertLess(self.memory_mb() - self.before, 24)


class WebServer:
    """Answers each request with the bytes of a function."""

    def __init__(self, parts):
        self.server = socket.create_server(("127.0.0.1", 0))
        self.port, self.parts, self.sent = self.server.getsockname()[1], parts, 0
        threading.Thread(target=self.serve, daemon=True).start()

    def serve(self):
        while True:
            try:
                peer, _ = self.server.accept()
            except OSError:
                return
            with peer:
                try:
                    peer.recv(65536)
                    for part in self.parts():
                        peer.sendall(part)
                        self.sent += len(part)
                except OSError:
                    pass


class Fetcher(unittest.TestCase):
    HEAD = b"HTTP/1.1 200 OK\r\nContent-Type: multipart/related; type=\"application/dicom\"; boundary=b\r\n\r\n"
    PART = b"--b\r\nContent-Type: application/dicom\r\nContent-Location: ../../evil\r\n\r\n"

    def fetch(self, parts):
        server = WebServer(parts)
        with tempfile.TemporaryDirectory() as work:
            folder = Path(work) / "outer/inbox"
            folder.parent.mkdir()
            usage = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
            answer = subprocess.run(
                [PROGRAM, "receive", "-o", folder, "--from", f"http://127.0.0.1:{server.port}/x", "--study", "1.2.3",
                 "--object-mb", "4", "--total-mb", "8", "--timeout", "3"], capture_output=True, text=True, timeout=60)
            self.assertIn(answer.returncode, (0, 2), answer.stderr)
            everything = sorted(str(x.relative_to(work)) for x in Path(work).rglob("*"))
            server.server.close()
            self.assertEqual([x for x in everything if x.count("/") < 2], ["outer", "outer/inbox"])
            self.assertLess(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss - usage, 1 << 18, "kB")
            return answer, len(everything) - 2, server.sent

    def test_hostile_answers_are_refused(self):
        file = bytes(128) + b"DICM" + attribute(2, 0x10, b"UI", SYNTAX) + data_set()
        whole = [self.HEAD, self.PART + file + b"\r\n", self.PART + file + b"\r\n--b--\r\n"]
        answer, files, _ = self.fetch(lambda: whole)
        self.assertEqual((answer.returncode, files), (0, 1), answer.stderr)  # equal objects are one file

        def endless(part):
            def made():
                yield self.HEAD
                while True:
                    yield part
            return made
        def header_lines():
            yield b"HTTP/1.1 200 OK\r\n"
            while True:
                yield b"x: " + b"y" * 10000 + b"\r\n"
        for name, parts in {
                "no boundary": lambda: [b"HTTP/1.1 200 OK\r\nContent-Type: text/html\r\n\r\nhello"],
                "no object": lambda: [self.HEAD, self.PART + b"hello\r\n--b--\r\n"],
                "cut": lambda: [self.HEAD, self.PART + file[:-4]],
                "redirection": lambda: [b"HTTP/1.1 302 Found\r\nLocation: file:///etc/passwd\r\nContent-Length: 0\r\n\r\n"],
                "lengths": lambda: [b"HTTP/1.1 200 OK\r\nContent-Length: -5\r\n\r\n"],
                "header lines without end": header_lines,
                "header without end": endless(b"--b\r\n" + b"x: " + b"y" * 100000),
                "object without end": endless(self.PART + b"\0" * 100000),
                "nothing but an end": lambda: [self.HEAD, b"--b--\r\n"] + [b"z" * 100000] * 300,
                "no boundary ever": endless(b"z" * 100000)}.items():
            if name == "object without end":
                def parts():
                    yield self.HEAD + self.PART
                    while True:
                        yield b"\0" * 100000
            answer, files, sent = self.fetch(parts)
            self.assertEqual((answer.returncode, files), (2, 0), f"{name}: {answer.stderr}")
            self.assertLess(sent, 30e6, name)


if __name__ == "__main__":
    unittest.main()
