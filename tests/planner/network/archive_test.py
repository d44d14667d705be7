# SPDX-License-Identifier: AGPL-3.0-or-later
"""Objects to and from an archive: our own receiver, DCMTK's and Orthanc get and return what was sent, by C-STORE and
DICOMweb, plain and by TLS. Skipped where the other program is not installed."""
import hashlib
import json
import os
import select
import shutil
import socket
import ssl
import subprocess
import tempfile
import threading
import time
import unittest
from pathlib import Path

PROGRAM = os.environ["OCTOTOMY_PROGRAM"]
NEEDS = {"storescp": "dcmtk", "Orthanc": "orthanc", "openssl": "openssl"}
PLUGIN = Path("/usr/share/orthanc/plugins/libOrthancDicomWeb.so")
ENVIRONMENT = {**os.environ, "PATH": os.environ["PATH"] + ":/usr/sbin"}


def found(program):
    return shutil.which(program, path=ENVIRONMENT["PATH"])


def needs(*programs):
    missing = [name for name in programs if not found(name)]
    return unittest.skipIf(missing, f"not installed: apt-get install {' '.join(NEEDS.get(x, x) for x in missing)}")


def run(*words, status=0):
    answer = subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=120, env=ENVIRONMENT)
    assert answer.returncode == status, f"{words}: {answer.returncode}\n{answer.stdout}\n{answer.stderr}"
    return answer


def octotomy(*words, status=0):
    answer = run(PROGRAM, *words, "--json", status=status)
    return json.loads(answer.stdout) if status == 0 else answer.stderr


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def wait_for_port(port, process, seconds=60):
    end = time.time() + seconds
    while time.time() < end:
        assert process.poll() is None, "the server has ended"
        with socket.socket() as one:
            if one.connect_ex(("127.0.0.1", port)) == 0:
                return
        time.sleep(0.1)
    raise AssertionError("the server does not listen")


def data_set(path):
    """The bytes after the meta header, which every store may write anew."""
    data = Path(path).read_bytes()
    assert data[128:132] == b"DICM", path
    return data[144 + int.from_bytes(data[140:144], "little"):]


class Receiver:
    """octotomy receive, as a process."""

    def __init__(self, folder, *words):
        self.process = subprocess.Popen([PROGRAM, "receive", "-o", folder, "--port", "0", "--json", *map(str, words)],
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        line = self.process.stderr.readline()
        assert "listening on" in line, line
        self.port = int(line.rsplit(":", 1)[1])

    def end(self):
        out, self.errors = self.process.communicate(timeout=60)
        assert self.process.returncode == 0, self.errors
        return json.loads(out)["objects"]

    def stop(self):
        self.process.terminate()
        self.process.communicate(timeout=60)


class TlsFront:
    """Ends TLS before a plain port, as hospitals' proxies do: Debian's Orthanc 1.10.1 crashes on its own https."""

    def __init__(self, both, port):
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        context.load_cert_chain(both)
        self.context, self.behind, self.requests = context, port, 0
        self.server = socket.create_server(("127.0.0.1", 0))
        self.port = self.server.getsockname()[1]
        threading.Thread(target=self.serve, daemon=True).start()

    def serve(self):
        while True:
            try:
                peer, _ = self.server.accept()
            except OSError:
                return
            threading.Thread(target=self.pass_on, args=(peer,), daemon=True).start()

    def pass_on(self, peer):
        try:
            with self.context.wrap_socket(peer, server_side=True) as outside, \
                    socket.create_connection(("127.0.0.1", self.behind)) as inside:
                other = {outside: inside, inside: outside}
                while True:
                    ready = [outside] if outside.pending() else select.select(list(other), [], [], 60)[0]
                    for one in ready or [None]:
                        data = one.recv(65536) if one else b""
                        if not data:
                            return
                        self.requests += one is outside
                        other[one].sendall(data)
        except OSError:
            pass


class Archive(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.work = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.work.name)
        scan = cls.folder / "head.nrrd"
        run(PROGRAM, "phantom", "head", "--voxel", "12", "-o", scan)
        run(PROGRAM, "convert", scan, "--dicom", "-o", cls.folder / "series")
        run(PROGRAM, "segment", cls.folder / "series", "--window", "bone", "-o", cls.folder / "bone.dcm")
        run(PROGRAM, "octree", scan, "--window", "300:", "-o", cls.folder / "skull.octree")
        run(PROGRAM, "mesh", scan, "--window", "300:", "-o", cls.folder / "skull.stl")
        source = ["--source", cls.folder / "series"]
        # An odd number of bytes, which DICOM has to pad.
        (cls.folder / "report.pdf").write_bytes(b"%PDF-1.4\n1 0 obj<</Type/Catalog>>endobj\ntrailer<</Root 1 0 R>>\n%%EOF\n")
        for name, words in {"rt": ["skull.octree", "--as", "structures"], "share": ["skull.stl", "--as", "fractions"],
                            "numbers": ["skull.octree", "--as", "labelmap"], "model": ["skull.stl"],
                            "report": ["report.pdf"]}.items():
            run(PROGRAM, "convert", cls.folder / words[0], *words[1:], "-o", cls.folder / f"{name}.dcm", *source)
        (cls.folder / "a.plan.json").write_text(json.dumps({
            "octotomy_plan": 1, "name": "A plan", "scans": {"ct": {"path": "series"}}, "universe": {"voxel_mm": 12.0},
            "steps": [{"id": "skull", "do": "window", "scan": "ct", "low": 300}]}))
        run(PROGRAM, "run", cls.folder / "a.plan.json", "--certify", "never", "-o", cls.folder / "result")
        run(PROGRAM, "convert", cls.folder / "a.plan.json", "--pictures", cls.folder / "result", *source, "-o",
            cls.folder / "objects")
        cls.files = (sorted((cls.folder / "series").iterdir()) + sorted(cls.folder.glob("*.dcm")) +
                     sorted((cls.folder / "objects").iterdir()))

    @classmethod
    def tearDownClass(cls):
        cls.work.cleanup()

    def need_same(self, folder, whole, expected=None):
        """Every object that was sent is in the folder, under the name of its hash, its data set the same."""
        wanted = {hashlib.sha256(data_set(file)).hexdigest(): file.name for file in expected or self.files}
        got = {}
        for file in Path(folder).iterdir():
            self.assertEqual(file.name, hashlib.sha256(file.read_bytes()).hexdigest() + ".dcm")
            got[hashlib.sha256(data_set(file)).hexdigest()] = file
        self.assertEqual(sorted(wanted.values()), sorted(wanted[x] for x in got if x in wanted))
        self.assertEqual(len(got), len(wanted))
        if whole:
            self.assertEqual(sorted(file.read_bytes() for file in got.values()),
                             sorted(file.read_bytes() for file in expected or self.files))

    def test_our_own_receiver_gets_what_was_sent(self):
        receiver = Receiver(self.folder / "own", "--objects", len(self.files))
        octotomy("send", "--echo", "--to", f"dicom://OCTOTOMY@127.0.0.1:{receiver.port}")
        sent = octotomy("send", *self.files, "--to", f"dicom://OCTOTOMY@127.0.0.1:{receiver.port}")
        self.assertEqual(sent["objects"], len(self.files))
        self.assertEqual(len(receiver.end()), len(self.files))
        self.need_same(self.folder / "own", False)

    def test_another_title_is_refused(self):
        receiver = Receiver(self.folder / "titles")
        said = octotomy("send", "--echo", "--to", f"dicom://OTHER@127.0.0.1:{receiver.port}", status=2)
        self.assertIn("refuses the association", said)
        receiver.stop()

    @needs("storescp")
    def test_dcmtk_gets_what_was_sent_and_sends_it(self):
        port = free_port()
        (self.folder / "dcmtk").mkdir()
        # The labels' map is newer than DCMTK's list of classes.
        files = [file for file in self.files if file.name != "numbers.dcm"]
        server = subprocess.Popen(["storescp", "-od", self.folder / "dcmtk", "+B", str(port)], env=ENVIRONMENT)
        try:
            wait_for_port(port, server)
            octotomy("send", "--echo", "--to", f"dicom://STORESCP@127.0.0.1:{port}")
            octotomy("send", *files, "--to", f"dicom://STORESCP@127.0.0.1:{port}")
        finally:
            server.terminate()
            server.wait()
        self.assertEqual(sorted(data_set(file) for file in (self.folder / "dcmtk").iterdir()),
                         sorted(data_set(file) for file in files))
        receiver = Receiver(self.folder / "from_dcmtk", "--objects", len(files))
        run("echoscu", "-aec", "OCTOTOMY", "127.0.0.1", receiver.port)
        for file in files:
            run("storescu", "-R", "-aec", "OCTOTOMY", "127.0.0.1", receiver.port, *(["-xi"] if file.name == "rt.dcm" else []),
                file)
        receiver.end()
        self.assertEqual(len(list((self.folder / "from_dcmtk").iterdir())), len(files))

    def certificate(self, name, authority=None):
        key, pem = self.folder / f"{name}.key", self.folder / f"{name}.pem"
        words = ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", f"/CN={name}",
                 "-addext", "subjectAltName=IP:127.0.0.1,DNS:localhost", "-keyout", key, "-out", pem]
        run(*words)
        return key, pem

    @needs("openssl")
    def test_tls_is_used_and_wrong_certificates_are_refused(self):
        key, pem = self.certificate("server")
        own_key, own = self.certificate("client")
        stranger_key, stranger = self.certificate("stranger")
        receiver = Receiver(self.folder / "tls", "--tls", "--certificate", pem, "--key", key, "--authorities", own,
                            "--objects", 1)
        to = ["--to", f"dicoms://OCTOTOMY@127.0.0.1:{receiver.port}", "--timeout", 5]
        file = self.folder / "model.dcm"
        # A server whose certificate no known authority signed; a client with such a certificate; one without; no TLS.
        self.assertIn("TLS", octotomy("send", file, *to, status=2))
        self.assertIn("TLS", octotomy("send", file, *to, "--authorities", stranger, status=2))
        octotomy("send", file, *to, "--authorities", pem, status=2)
        octotomy("send", file, *to, "--authorities", pem, "--certificate", stranger, "--key", stranger_key, status=2)
        octotomy("send", file, "--to", f"dicom://OCTOTOMY@127.0.0.1:{receiver.port}", "--timeout", 5, status=2)
        self.assertEqual(list((self.folder / "tls").iterdir()), [])
        octotomy("send", file, *to, "--authorities", pem, "--certificate", own, "--key", own_key)
        receiver.end()
        self.need_same(self.folder / "tls", False, [file])

    @needs("Orthanc")
    @unittest.skipUnless(PLUGIN.exists(), "not installed: apt-get install orthanc-dicomweb")
    def test_orthanc_returns_what_was_sent_by_both_protocols(self):
        web, dicom = free_port(), free_port()
        settings = {"Name": "test", "StorageDirectory": str(self.folder / "orthanc"), "Plugins": [str(PLUGIN)],
                    "IndexDirectory": str(self.folder / "orthanc"), "HttpPort": web, "DicomPort": dicom,
                    "DicomAet": "ORTHANC", "RemoteAccessAllowed": False, "DicomCheckCalledAet": True,
                    "AuthenticationEnabled": True, "RegisteredUsers": {"a": "b"}, "UnknownSopClassAccepted": True,
                    "DicomAlwaysAllowEcho": True, "DicomAlwaysAllowStore": True, "DicomWeb": {"Enable": True}}
        (self.folder / "orthanc.json").write_text(json.dumps(settings))
        log = open(self.folder / "orthanc.log", "w")
        server = subprocess.Popen([found("Orthanc"), self.folder / "orthanc.json"], stdout=log, stderr=log)
        os.environ["OCTOTOMY_ARCHIVE_USER"] = ENVIRONMENT["OCTOTOMY_ARCHIVE_USER"] = "a:b"
        url = f"http://127.0.0.1:{web}/dicom-web"
        try:
            wait_for_port(web, server)
            wait_for_port(dicom, server)
            octotomy("send", *self.files, "--to", url)
            studies = octotomy("receive", "--from", url, "--find", "PatientID=*")["studies"]
            self.assertTrue(studies)
            for each in studies:
                octotomy("receive", "-o", self.folder / "by_web", "--from", url, "--study", each["study_uid"])
            self.need_same(self.folder / "by_web", True)
            self.assertEqual(octotomy("receive", "--from", url, "--find", "PatientID=nobody")["studies"], [])
            self.assertIn("404", octotomy("receive", "-o", self.folder / "none", "--from", url, "--study", "1.2.3",
                                          status=2))
            self.delete_all(web)
            octotomy("send", "--echo", "--to", f"dicom://ORTHANC@127.0.0.1:{dicom}")
            octotomy("send", *self.files, "--to", f"dicom://ORTHANC@127.0.0.1:{dicom}")
            for each in studies:
                octotomy("receive", "-o", self.folder / "by_store", "--from", url, "--study", each["study_uid"])
            self.need_same(self.folder / "by_store", False)
            ENVIRONMENT["OCTOTOMY_ARCHIVE_USER"] = "a:wrong"
            self.assertIn("401", octotomy("send", self.files[0], "--to", url, status=2))
        finally:
            ENVIRONMENT.pop("OCTOTOMY_ARCHIVE_USER", None)
            server.terminate()
            server.wait()
            log.close()

    def authority(self, name):
        key, pem = self.folder / f"{name}.key", self.folder / f"{name}.pem"
        run("openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", f"/CN={name}", "-addext",
            "basicConstraints=critical,CA:TRUE", "-keyout", key, "-out", pem)
        return key, pem

    def signed(self, name, authority, alternative, days=2):
        """The certificate and key of a server in one file, as Orthanc wants them; valid until `days` from now."""
        key, request, pem = (self.folder / f"{name}{ending}" for ending in (".key", ".csr", ".crt"))
        more, both = self.folder / f"{name}.ext", self.folder / f"{name}_both.pem"
        more.write_text(f"subjectAltName={alternative}\nbasicConstraints=CA:FALSE\n")
        run("openssl", "req", "-newkey", "rsa:2048", "-nodes", "-subj", f"/CN={name}", "-keyout", key, "-out", request)
        run("openssl", "x509", "-req", "-in", request, "-CA", authority[1], "-CAkey", authority[0], "-CAcreateserial",
            "-days", days, "-extfile", more, "-out", pem)
        both.write_text(key.read_text() + pem.read_text())
        return both

    @needs("Orthanc", "openssl")
    @unittest.skipUnless(PLUGIN.exists(), "not installed: apt-get install orthanc-dicomweb")
    def test_dicomweb_by_tls_accepts_only_the_archive_that_its_authority_signed(self):
        authority, stranger = self.authority("authority"), self.authority("other_authority")
        cases = {"good": self.signed("good", authority, "DNS:localhost"),
                 "expired": self.signed("expired", authority, "DNS:localhost", days=-1),
                 "misnamed": self.signed("misnamed", authority, "DNS:archive.example")}
        model, web = self.folder / "model.dcm", free_port()
        settings = {"Name": "tls", "StorageDirectory": str(self.folder / "orthanc_tls"), "Plugins": [str(PLUGIN)],
                    "IndexDirectory": str(self.folder / "orthanc_tls"), "HttpPort": web, "DicomServerEnabled": False,
                    "RemoteAccessAllowed": False, "AuthenticationEnabled": False, "DicomWeb": {"Enable": True}}
        (self.folder / "tls.json").write_text(json.dumps(settings))
        with open(self.folder / "orthanc_tls.log", "w") as log:
            server = subprocess.Popen([found("Orthanc"), self.folder / "tls.json"], stdout=log, stderr=log)
        fronts = {}
        try:
            wait_for_port(web, server)
            fronts = {case: TlsFront(pem, web) for case, pem in cases.items()}
            trust = ["--authorities", authority[1]]

            def address(case, host="localhost"):
                return f"https://{host}:{fronts[case].port}/dicom-web"

            def refusal(case, *words, host="localhost"):
                said = octotomy("send", model, "--to", address(case, host), *words, status=2)
                self.assertEqual(len(said.strip().splitlines()), 1, said)
                return said
            self.assertIn("certificate", refusal("good"))
            self.assertIn("certificate", refusal("good", "--authorities", stranger[1]))
            self.assertIn("expired", refusal("expired", *trust))
            self.assertIn("localhost", refusal("misnamed", *trust))
            # By its number the same server is another host than its certificate names.
            self.assertIn("127.0.0.1", refusal("good", *trust, host="127.0.0.1"))
            self.assertIn("none.pem", refusal("good", "--authorities", self.folder / "none.pem"))
            self.assertEqual(sum(front.requests for front in fronts.values()), 0, "nothing is sent before the check")
            octotomy("send", *self.files, "--to", address("good"), *trust)
            asked = ["receive", "--from", address("good")]
            octotomy(*asked, "--find", "PatientID=*", status=2)
            studies = octotomy(*asked, *trust, "--find", "PatientID=*")["studies"]
            self.assertTrue(studies)
            for each in studies:
                octotomy(*asked, *trust, "-o", self.folder / "by_tls", "--study", each["study_uid"])
            self.need_same(self.folder / "by_tls", True)
        finally:
            for front in fronts.values():
                front.server.close()
            server.terminate()
            server.wait()

    @staticmethod
    def delete_all(port):
        import base64
        import urllib.request
        head = {"Authorization": "Basic " + base64.b64encode(b"a:b").decode()}

        def ask(path, method):
            return urllib.request.urlopen(urllib.request.Request(f"http://127.0.0.1:{port}{path}", method=method,
                                                                 headers=head), timeout=30).read()
        for patient in json.loads(ask("/patients", "GET")):
            ask(f"/patients/{patient}", "DELETE")


if __name__ == "__main__":
    unittest.main()
