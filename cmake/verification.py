"""Checks a study in models/ against what it expects and against docs/reference/verification.md.

    verification.py check CHLADNI STUDY [SAMPLE]
                                           one study: its expectations, and its numbers on the page;
                                           with the program chladni_sample one that takes long, which
                                           has its turn at every fourth landing
    verification.py write CHLADNI          computes all studies and writes their tables anew; what
                                           stands above the first of them is kept
"""
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "reference" / "verification.md"
# Frequencies repeat to 1e-9 between machines; the page rounds them to seven digits.
AGREES = 2e-6
LINE = re.compile(r"(met   |FAILED)  (\S+)\s+expected (\S+)(?: (\S+))? within (\S+)(?: \S+)?, found (\S+)")


def name_of(study):
    return study.resolve().parent.relative_to(ROOT / "models").as_posix()


def run(binary, study):
    """The program's exit code, its text and the values: key -> (reference, unit, within, found)."""
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(
            [binary, "check", "--expect", "--quiet", str(study), "-o", folder],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    values = {}
    for _, key, value, unit, within, found in LINE.findall(done.stdout):
        values[key] = (value, unit, within, found)
    return done.returncode, done.stdout, values


def rows(values):
    """Runs of equal references share a row, with the found value that is farthest off."""
    result = []
    for key, (value, unit, within, found) in values.items():
        number = int(key.split("_")[1]) if key.startswith("frequency_") else None
        off = float(found) / float(value) - 1.0 if float(value) else 0.0
        last = result[-1] if result else None
        if number and last and last["number"] and last["value"] == value and last["to"] == number - 1:
            last["to"] = number
            if abs(off) > abs(last["off"]):
                last.update(found=found, off=off)
            continue
        result.append(dict(key=key, number=number, to=number, value=value, unit=unit,
                           within=within, found=found, off=off))
    return result


def label(row):
    if not row["number"]:
        return row["key"].replace("_", " ")
    return f"{row['number']}" if row["to"] == row["number"] else f"{row['number']}-{row['to']}"


def section(study, values):
    title = re.search(r'^title\s*=\s*"(.*)"', study.read_text(encoding="utf-8"), re.M).group(1)
    lines = [f"## `{name_of(study)}`", "", title, "",
             "| mode | reference | tolerance | found | deviation |", "|---|---|---|---|---|"]
    for row in rows(values):
        unit = f" {row['unit']}" if row["unit"] else ""
        off = f"{100 * row['off']:+.4f} %" if row["number"] else ""
        lines.append(f"| {label(row)} | {row['value']}{unit} | {row['within']}{unit} "
                     f"| {row['found']}{unit} | {off} |")
    return "\n".join(lines) + "\n"


def on_page(study):
    """Found values of the study's section: label -> number."""
    text = PAGE.read_text(encoding="utf-8")
    parts = text.split(f"## `{name_of(study)}`\n")
    if len(parts) != 2:
        return None
    body = parts[1].split("\n## ")[0]
    found = {}
    for line in body.splitlines():
        cells = [c.strip() for c in line.strip("|").split("|")]
        if len(cells) == 5 and cells[0] not in ("mode", "---"):
            found[cells[0]] = float(cells[3].split()[0])
    return found


def check(binary, study):
    code, text, values = run(binary, study)
    print(text, end="")
    if code != 0:
        return code
    written = on_page(study)
    if written is None:
        print(f"{PAGE}: no section `{name_of(study)}`; write the page anew")
        return 1
    computed = {label(row): float(row["found"]) for row in rows(values)}
    wrong = [k for k in computed.keys() | written.keys()
             if k not in computed or k not in written
             or abs(computed[k] - written[k]) > AGREES * abs(written[k])]
    for key in sorted(wrong):
        print(f"{PAGE}: {name_of(study)}, {key}: the page says {written.get(key)}, "
              f"computed {computed.get(key)}")
    return 1 if wrong else 0


def skipped(study, *sample):
    """77 and a word why, where a study that takes long has not its turn."""
    if not sample:
        return 0
    sys.path.insert(0, str(ROOT / "tests" / "rotation"))
    from turn import why_skipped
    why = why_skipped(f"models.{name_of(study)}", sample[0], ROOT)
    if why:
        print(f"skipped: {why}")
    return 77 if why else 0


def write(binary):
    parts = [PAGE.read_text(encoding="utf-8").split("\n## `")[0].rstrip("\n") + "\n"]
    for study in sorted((ROOT / "models").rglob("study.toml")):
        code, text, values = run(binary, study)
        print(f"{name_of(study)}: {code}", flush=True)
        if code != 0:
            print(text)
        parts.append(section(study, values))
    PAGE.write_text("\n".join(parts), encoding="utf-8")


if __name__ == "__main__":
    if sys.argv[1] == "write":
        write(sys.argv[2])
    else:
        sys.exit(skipped(Path(sys.argv[3]), *sys.argv[4:]) or check(sys.argv[2], Path(sys.argv[3])))
