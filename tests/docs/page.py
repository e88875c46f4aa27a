"""Blocks of code in a page, and what a page says that a program prints."""
import re

BLOCK = re.compile(r'^```(\w+)(?: title="([^"]+)")?\n(.*?)^```$', re.MULTILINE | re.DOTALL)
NUMBER = re.compile(r"[+-]?\d+(?:\.\d+)?(?:e[+-]?\d+)?")


def blocks(text):
    """Language, title or None, and content of each fenced block, in their order."""
    return [(m[1], m[2], m[3]) for m in BLOCK.finditer(text)]


def unit_of_last_digit(number):
    digits, _, exponent = number.partition("e")
    return 10.0 ** (int(exponent or 0) - len(digits.partition(".")[2]))


def is_near(promised, found):
    """Within 2 %, or two units of the last digit that the page shows."""
    allowed = max(0.02 * abs(float(promised)), 2.0 * unit_of_last_digit(promised))
    return abs(float(promised) - float(found)) <= 1.000001 * allowed


def is_as_promised(promised, found):
    """Whether a printed line has the page's words, and numbers near the page's. The page's ` ...`
    stands for the rest of a line."""
    promised, cut, _ = promised.partition(" ...")
    if cut:
        # As many numbers and words as the page has before the cut.
        found = " ".join(found.split()[: len(promised.split())])
    if NUMBER.sub("#", promised).split() != NUMBER.sub("#", found).split():
        return False
    return all(map(is_near, NUMBER.findall(promised), NUMBER.findall(found)))


def missing_line(promised, printed):
    """The first line of the page that the program did not print after the line before it; or None.
    `...` on a line of its own stands for any lines."""
    lines = iter(printed.splitlines())
    for line in promised.splitlines():
        if line.strip() in ("", "..."):
            continue
        if not any(is_as_promised(line, other) for other in lines):
            return line
    return None
