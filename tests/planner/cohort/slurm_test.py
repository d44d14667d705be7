# SPDX-License-Identifier: AGPL-3.0-or-later
"""A cohort through a real Slurm of one node on this machine's loopback, set up for the test and taken down again."""
import os
import shutil
import socket
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

import octotomy
from cohort_test import PROGRAM, SUBJECTS, assert_complete, ball, kill_at_random

SBIN = [shutil.which(name, path=os.environ["PATH"] + ":/usr/sbin") for name in ("munged", "slurmctld", "slurmd")]

CONFIGURATION = """ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
SlurmctldPort={port}
SlurmdPort={node_port}
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmdSpoolDir={folder}/spool
StateSaveLocation={folder}/state
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SchedulerType=sched/builtin
SchedulerParameters=batch_sched_delay=0
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
MpiDefault=none
SwitchType=switch/none
NodeName={host} NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=test Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


def free_ports():
    sockets = [socket.socket() for _ in range(2)]
    for each in sockets:
        each.bind(("127.0.0.1", 0))
    ports = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return ports


@unittest.skipUnless(all(SBIN) and os.geteuid() == 0, "needs root and Slurm (apt-get install munge slurm-client slurmctld slurmd)")
class Slurm(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="slurm"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        for name in ("spool", "state", "cohort"):
            (self.folder / name).mkdir()
        self.folder.chmod(0o755)
        key = self.folder / "munge.key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o600)
        self.start([SBIN[0], "--foreground", "--force", f"--key-file={key}", f"--socket={self.folder}/munge.socket",
                    f"--pid-file={self.folder}/munge.pid", f"--log-file={self.folder}/munge.log",
                    f"--seed-file={self.folder}/munge.seed"])
        port, node_port = free_ports()
        configuration = self.folder / "slurm.conf"
        host = socket.gethostname().split(".")[0]
        configuration.write_text(CONFIGURATION.format(folder=self.folder, host=host, port=port, node_port=node_port))
        (self.folder / "cgroup.conf").write_text("CgroupPlugin=cgroup/v1\n")
        self.environment = {**os.environ, "SLURM_CONF": str(configuration)}
        self.start([SBIN[1], "-D", "-i", "-f", str(configuration)])
        self.start([SBIN[2], "-D", "-N", host, "-f", str(configuration)])
        self.wait_for(lambda: "idle" in self.slurm("sinfo", "-h", "-o", "%T"), "the node is not idle")

    def start(self, command):
        process = subprocess.Popen(command, env=getattr(self, "environment", None), stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL)

        def end():
            process.terminate()
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

        self.addCleanup(end)

    def slurm(self, *command):
        return subprocess.run(command, env=self.environment, capture_output=True, text=True, check=False).stdout

    def wait_for(self, holds, what, seconds=300 + 10 * SUBJECTS):
        end = time.monotonic() + seconds
        while not holds():
            logs = "".join(path.read_text(errors="replace")[-2000:] for path in self.folder.glob("*.log"))
            self.assertLess(time.monotonic(), end, f"{what}: {logs}")
            time.sleep(0.2)

    def queue(self):
        return self.slurm("squeue", "-h", "-o", "%i %T").split()

    def test_two_submissions_leave_the_serial_table_though_workers_are_killed(self):
        place = self.folder / "cohort"
        plan = octotomy.Plan({"ct": "any.nrrd"}, name="ball")
        plan.window("ball", scan="ct", low=0)
        plan.measure("size", object="ball")
        plan.write(place / "ball.plan.json")
        table = place / "scans.csv"
        lines = ["participant_id,scan"]
        for i in range(SUBJECTS):
            ball(place / f"ball_{i}.nrrd", 4 + 5 * i / max(1, SUBJECTS - 1))
            lines.append(f"{i:04d},ball_{i}.nrrd")
        table.write_text("\n".join(lines) + "\n")
        verb = [PROGRAM, "cohort", table, place / "out", "participant", "--plan", place / "ball.plan.json"]
        submit = [*verb, "--engine", "slurm", "--slurm=--mem=0"]

        def begin():
            for _ in range(2):
                subprocess.run(submit, env=self.environment, check=True, capture_output=True)
            return self.queue

        kills = kill_at_random(place / "out", begin, 3)
        subprocess.run(submit, env=self.environment, check=True, capture_output=True)  # completes what was killed
        self.wait_for(lambda: not self.queue(), "jobs do not end")
        subprocess.run([*map(str, verb[:3]), place / "serial", *verb[4:]], check=True, capture_output=True)
        subprocess.run([PROGRAM, "cohort", table, place / "serial", "group"], check=True, capture_output=True)
        assert_complete(self, place / "out", place / "serial")
        print(f"Slurm: {SUBJECTS} subjects, {kills} workers killed")


if __name__ == "__main__":
    unittest.main()
