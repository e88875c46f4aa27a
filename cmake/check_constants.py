#!/usr/bin/env python3
"""Fails when a page of constants and the headers that hold them differ.

check_constants.py ROOT PAGE ROOM...
ROOM/constants.h says of each constant "/// what it decides [unit] (source)." and then its value. The page
has a heading "## ROOM" and under it rows of name, value, unit, what it decides, source, halved, doubled.
"""
import pathlib
import re
import sys

CONSTANT = re.compile(r"((?: *///[^\n]*\n)+) *static constexpr [\w:]+ (\w+)(?: = )?([^;]+);")
COMMENT = re.compile(r"(.*) \[([^\]]*)\] \((.*)\)\.$")


def of_code(header):
    """Name: value, unit, what it decides, source."""
    text = header.read_text(encoding="utf-8")
    constants = {}
    for comment, name, value in CONSTANT.findall(text):
        words = " ".join(line.strip().removeprefix("///").strip() for line in comment.splitlines())
        decides, unit, source = COMMENT.match(words).groups()
        constants[name] = [value, unit, decides, source]
    declared = text.count("static constexpr ")
    assert len(constants) == declared, f"{header}: {declared} constants, {len(constants)} understood"
    return constants


def of_page(page, room):
    section = re.search(rf"^## {room}\n(.*?)(?=^## |\Z)", page, re.M | re.S)
    rows = re.findall(r"^\| `(\w+)` \|(.*)\|$", section[1] if section else "", re.M)
    return {name: [cell.strip() for cell in rest.split("|")] for name, rest in rows}


def faults_of(room, code, page):
    for name in code.keys() - page.keys():
        yield f"{room}: the page lacks {name}"
    for name in page.keys() - code.keys():
        yield f"{room}: the code lacks {name}"
    for name in code.keys() & page.keys():
        if page[name][:4] != code[name]:
            yield f"{room}: {name} is {code[name]} in the code, {page[name][:4]} on the page"
        if len(page[name]) != 6 or not all(page[name]):
            yield f"{room}: the row of {name} lacks what was seen when it was halved and doubled"


def main():
    root = pathlib.Path(sys.argv[1])
    page = (root / sys.argv[2]).read_text(encoding="utf-8")
    faults = []
    for room in sys.argv[3:]:
        faults += faults_of(room, of_code(root / room / "constants.h"), of_page(page, room))
    print("\n".join(sorted(faults)) or "page and code agree")
    return bool(faults)


if __name__ == "__main__":
    sys.exit(main())
