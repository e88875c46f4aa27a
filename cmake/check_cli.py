#!/usr/bin/env python3
"""Fails when docs/reference/cli.md and the program do not name the same verbs, options and lists.

check_cli.py ROOT CHLADNI
"""
import pathlib
import re
import subprocess
import sys


def said(chladni, *words):
    return subprocess.run([chladni, *words], capture_output=True, text=True, check=True).stdout


def verbs_of(chladni):
    listed = said(chladni, "--help").split("Subcommands:")[1]
    return set(re.findall(r"^  ([a-z]+)", listed, re.MULTILINE))


def words_of(chladni):
    return set(re.search(r"\{([a-z,]+)\}", said(chladni, "list", "--help"))[1].split(","))


def options_of(chladni, verbs):
    options = set()
    for verb in verbs:
        options |= set(re.findall(r"--[a-z][a-z-]*", said(chladni, verb, "--help")))
    return options - {"--help"}


def rows_of(page, head):
    """First and second cell of each row of the table that begins with `head`."""
    table = page.split(f"| {head} |")[1].split("\n\n")[0]
    return [tuple(cell.strip() for cell in line.split("|")[1:3]) for line in table.splitlines()[2:]]


def differences(what, documented, real):
    if missing := sorted(real - documented):
        yield f"docs/reference/cli.md does not name {what}: {', '.join(missing)}"
    if strange := sorted(documented - real):
        yield f"docs/reference/cli.md names {what} that there are none of: {', '.join(strange)}"


def faults_of_manual(root, chladni):
    manual = (root / "cmake/deb/chladni.1").read_text().replace("\\-", "-")
    verbs = verbs_of(chladni)
    for verb in sorted(verbs - set(re.findall(r"^\.B ([a-z]+)$", manual, re.MULTILINE))):
        yield f"cmake/deb/chladni.1 does not name the verb {verb}"
    named = set(re.findall(r"--[a-z][a-z-]*", manual))
    for option in sorted(options_of(chladni, verbs) ^ (named - {"--help"})):
        yield f"cmake/deb/chladni.1 and the program differ in {option}"


def faults_of_numbers(root, chladni):
    """A page need not say how many effects there are; where it does, it is right."""
    number = len(said(chladni, "list", "effects").splitlines())
    for page in sorted((root / "docs/reference").glob("*.md")):
        for told in re.findall(r"`chladni list effects`\):? (\d+)", page.read_text()):
            if int(told) != number:
                yield f"{page.relative_to(root)} says {told} effects, there are {number}"


def faults_of(root, chladni):
    yield from faults_of_manual(root, chladni)
    yield from faults_of_numbers(root, chladni)
    page = (root / "docs/reference/cli.md").read_text()
    verbs = rows_of(page, "verb")
    named = {re.match(r"`([a-z]+)", first)[1] for first, _ in verbs}
    yield from differences("verbs", named, verbs_of(chladni))
    lists = {word for first, second in verbs if first == "`list`"
             for word in re.findall(r"`([a-z]+)`", second)}
    yield from differences("words of `list`", lists, words_of(chladni))
    options = {name for first, _ in rows_of(page, "option")
               for name in re.findall(r"--[a-z][a-z-]*", first)}
    yield from differences("options", options, options_of(chladni, verbs_of(chladni)))
    for word in sorted(words_of(chladni)):
        if not said(chladni, "list", word).strip():
            yield f"chladni list {word} says nothing"


def main():
    faults = list(faults_of(pathlib.Path(sys.argv[1]), sys.argv[2]))
    print("\n".join(faults) or "docs/reference/cli.md names what there is")
    return bool(faults)


if __name__ == "__main__":
    sys.exit(main())
