#!/usr/bin/env python3
"""Runs a sweep's job array on a real SLURM of one node, which it starts itself on the loopback.

slurm_test.py CHLADNI SAMPLE: twenty variants; one fails, and one is killed while it is solved. The table
has what is done, and the array that is submitted again does what is missing. It has its turn where the
number that the program SAMPLE prints is a multiple of four (tests/rotation). Exit code 77 out of turn,
without SLURM or without the rights to start it."""
import json
import os
import pathlib
import shutil
import socket
import subprocess
import sys
import tempfile
import time

PROGRAMS = ["munged", "slurmctld", "slurmd", "sbatch", "squeue", "scancel", "sinfo"]
FAILS, KILLED, VARIANTS = 7, 13, 20

BASE = """title = "small plate"
geometry = { plate = { length = "100 mm", width = "60 mm", thickness = "5 mm" } }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
mesh = { edge_length = "10 mm" }
modes = { count = 3 }

[[sensor]]
name = "s1"
at = ["-40 mm", "20 mm"]
direction = "z"
"""


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def plan():
    text = 'base = "base.toml"\n[[result]]\nname = "first"\nfile = "modes.json"\nat = "frequency_hz.6"\n' \
           '[[axis]]\nname = "plate"\n'
    for i in range(1, VARIANTS + 1):
        text += f'[[axis.choice]]\nname = "p{i}"\n[axis.choice.study]\n'
        if i == FAILS:
            text += 'sensor = [{ name = "s1", at = ["90 mm", "0 mm"] }]\n'
        elif i == KILLED:
            text += 'mesh = { edge_length = "2.2 mm" }\nmodes = { count = 30 }\n'
        else:
            text += f'geometry.plate.thickness = "{4 + 0.1 * i:.1f} mm"\n'
    return text


def configuration(folder, host):
    return f"""ClusterName=chladni
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={free_port()}
SlurmdPort={free_port()}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.sock
CredType=cred/munge
SlurmUser=root
SlurmdUser=root
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
ReturnToService=2
SchedulerType=sched/builtin
SchedulerParameters=sched_interval=1,batch_sched_delay=0,sched_min_interval=100000
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
KillWait=2
NodeName={host} NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


class Slurm:
    """munged, slurmctld and slurmd in a folder; they end with the scope."""

    def __init__(self, folder):
        self.folder, self.running = folder, []
        host = socket.gethostname().split(".")[0]
        for name in ["state", "spool"]:
            (folder / name).mkdir()
        (folder / "slurm.conf").write_text(configuration(folder, host))
        key = folder / "munge.key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o600)
        os.environ["SLURM_CONF"] = str(folder / "slurm.conf")
        self.start("munged", "--foreground", "--force", f"--key-file={key}",
                   f"--socket={folder}/munge.sock", f"--pid-file={folder}/munge.pid",
                   f"--log-file={folder}/munge.log", f"--seed-file={folder}/munge.seed")
        self.wait(lambda: (folder / "munge.sock").exists(), "munged")
        self.start("slurmctld", "-D")
        self.start("slurmd", "-D", "-N", host)
        self.wait(lambda: "idle" in said("sinfo", "-h", "-o", "%T", fails=True), "slurmd")

    def start(self, *words):
        log = (self.folder / f"{words[0]}.out").open("w")
        self.running.append(subprocess.Popen(words, stdout=log, stderr=log))

    def wait(self, ready, what):
        for _ in range(300):
            if ready():
                return
            time.sleep(0.1)
        logs = "".join(f.read_text(errors="replace")[-600:] for f in self.folder.glob("*.log"))
        skip(f"{what} does not start here: {logs}")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for one in reversed(self.running):
            one.terminate()
        for one in self.running:
            one.wait(20)


def skip(why):
    print("skipped:", why)
    sys.exit(77)


def said(*words, fails=False, folder=None):
    done = subprocess.run(words, capture_output=True, text=True, cwd=folder, check=False)
    if done.returncode != 0 and not fails:
        raise SystemExit(f"{' '.join(words)} ended with {done.returncode}: {done.stdout}{done.stderr}")
    return done.stdout


def submit(sweep):
    return said("sbatch", "--parsable", "sweep.sbatch", folder=sweep).strip()


def wait_for_end(job, seconds=300):
    for _ in range(5 * seconds):
        if not said("squeue", "-h", "-j", job, fails=True).strip():
            return
        time.sleep(0.2)
    raise SystemExit("the job array does not end: " + said("squeue"))


def text_of(file):
    """Its text; none of a variant that ended meanwhile and has its own folder now."""
    try:
        return file.read_text()
    except FileNotFoundError:
        return ""


def kill_one(job, variants):
    """Kills the task of the slow variant once it is being solved."""
    for _ in range(1500):
        if any(f"plate p{KILLED}\"" in text_of(p) for p in variants.glob("*.part/study.toml")):
            said("scancel", "--signal=KILL", "--full", f"{job}_{KILLED}")
            return
        time.sleep(0.02)
    raise SystemExit("the slow variant never ran")


def states(chladni, plan_file, sweep):
    said(chladni, "gather", str(plan_file), "-o", str(sweep), "--no-pictures")
    result = json.loads((sweep / "sweep.json").read_text())
    return [variant["state"] for variant in result["variants"]]


def check(condition, what):
    if not condition:
        raise SystemExit("FAILED: " + what)


def main(chladni, sample):
    number = said(sample, str(pathlib.Path(__file__).resolve().parents[2])).strip()
    if number != "all" and int(number) % 4 != 0:
        skip(f"it has its turn at every fourth landing; CHLADNI_STUDIES=all runs it (sample {number})")
    missing = [p for p in PROGRAMS if shutil.which(p) is None]
    if missing or os.geteuid() != 0:
        skip(f"there is no {missing[0]} (package slurm-wlm)" if missing else "only root starts a SLURM")
    with tempfile.TemporaryDirectory(prefix="chladni_slurm_") as name:
        folder = pathlib.Path(name)
        plan_file, sweep = folder / "plan.toml", folder / "out"
        (folder / "base.toml").write_text(BASE)
        plan_file.write_text(plan())
        said(chladni, "sweep", str(plan_file), "-o", str(sweep), "--scripts")
        with Slurm(folder):
            job = submit(sweep)
            kill_one(job, sweep / "variants")
            wait_for_end(job)
            first = states(chladni, plan_file, sweep)
            check(first[FAILS - 1] == "failed", f"the variant that fails is {first[FAILS - 1]}")
            check(first[KILLED - 1] == "open", f"the variant that was killed is {first[KILLED - 1]}")
            check(first.count("done") == VARIANTS - 2, f"{first.count('done')} variants are done")
            kept = {f: f.stat().st_mtime_ns for f in sweep.glob("variants/*/variant.json")}
            wait_for_end(submit(sweep))
            second = states(chladni, plan_file, sweep)
            check(second.count("done") == VARIANTS - 1, f"{second.count('done')} are done at last")
            check(all(f.stat().st_mtime_ns == at for f, at in kept.items()), "some ran twice")
    print(f"{VARIANTS} variants in a SLURM job array: one failed, one was killed and resumed")


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
