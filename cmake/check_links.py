#!/usr/bin/env python3
"""Fails when a page links to a file or a heading that is not there, or when nothing leads to a page.

check_links.py ROOT
Looks at every .md file of the tree. A heading's anchor is what GitHub and docs/build make of it.
Pages of docs/ must be reached from docs/index.md and stand in docs/mkdocs.yml.
"""
import collections
import pathlib
import re
import sys
import urllib.parse

NOT_OURS = {"build", "out", ".git"}
FENCE = re.compile(r"^ *(```+|~~~+)[^\n]*\n.*?^ *\1 *$", re.MULTILINE | re.DOTALL)
CODE = re.compile(r"(`+)(?!`).*?(?<!`)\1(?!`)", re.DOTALL)
LINK = re.compile(r"!?\[(?:[^\[\]]|\[[^\]]*\])*\]\(\s*<?([^)\s>]+)>?(?:\s+\"[^\"]*\")?\s*\)")
DEFINITION = re.compile(r"^ {0,3}\[[^\]]+\]:\s+<?([^\s>]+)", re.MULTILINE)
HEADING = re.compile(r"^#{1,6} +(.*?) *#*$", re.MULTILINE)


def pages(root):
    for path in sorted(root.rglob("*.md")):
        if path.relative_to(root).parts[0] not in NOT_OURS:
            yield path


def prose(text):
    """The page without its code."""
    return FENCE.sub("", text)


def links(text):
    """Targets of the links that lead into the tree, in their order."""
    plain = CODE.sub("", prose(text))
    for target in [m[1] for m in LINK.finditer(plain)] + DEFINITION.findall(plain):
        if not re.match(r"[a-z][a-z0-9+.-]*:", target):
            yield urllib.parse.unquote(target)


def anchors(text):
    """Anchors of the headings: lower case, marks left out, spaces as hyphens, repeats numbered."""
    counted = collections.Counter()
    for heading in HEADING.findall(prose(text)):
        words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
        name = re.sub(r"[^\w\- ]", "", words.lower()).replace(" ", "-")
        counted[name] += 1
        yield name if counted[name] == 1 else f"{name}-{counted[name] - 1}"


def broken(page, root):
    text = page.read_text()
    for target in links(text):
        path, _, anchor = target.partition("#")
        file = (page.parent / path).resolve() if path else page.resolve()
        where = f"{page.relative_to(root)}: {target}"
        if not file.is_relative_to(root):
            yield f"{where} leads out of the tree"
        elif not file.exists():
            yield f"{where} is not there"
        elif anchor and file.suffix == ".md" and anchor not in set(anchors(file.read_text())):
            yield f"{where}: {file.relative_to(root)} has no such heading"


def reached(start):
    """Pages that links lead to from `start`."""
    seen, waiting = set(), [start.resolve()]
    while waiting:
        page = waiting.pop()
        if page in seen or not page.exists():
            continue
        seen.add(page)
        for target in links(page.read_text()):
            file = (page.parent / target.partition("#")[0]).resolve()
            if file.suffix == ".md":
                waiting.append(file)
    return seen


def faults_of(root):
    for page in pages(root):
        yield from broken(page, root)
    known = reached(root / "docs/index.md")
    in_site = (root / "docs/mkdocs.yml").read_text()
    for page in sorted((root / "docs").rglob("*.md")):
        name = page.relative_to(root)
        if page.resolve() not in known:
            yield f"no link leads from docs/index.md to {name}"
        if f"{name}\n" not in in_site:
            yield f"docs/mkdocs.yml does not name {name}"


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    faults = list(faults_of(root))
    print("\n".join(faults) or f"{len(list(pages(root)))} pages: every link leads somewhere")
    return bool(faults)


if __name__ == "__main__":
    sys.exit(main())
