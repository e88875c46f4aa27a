"""Which of the tests that take long have their turn (turn.h), for tests that are scripts."""
import subprocess


def has_turn(test, number):
    """Whether a test of this name runs beside the sample of this number: FNV-1a over its letters."""
    total = 2166136261
    for letter in test.encode():
        total = (total ^ letter) * 16777619 % 2**32
    return (total >> 16) % 4 == number % 4


def drawn_number(sample, source):
    """Which eighth, 0 to 7, `sample`, the program chladni_sample, draws (rest by four: the quarter); None: all."""
    number = subprocess.run([sample, source], stdout=subprocess.PIPE, text=True, check=True).stdout.strip()
    return None if number == "all" else int(number)


def why_skipped(test, sample, source):
    """Why the test is skipped; empty where it has its turn. `sample` is the program chladni_sample."""
    number = drawn_number(sample, source)
    if number is None or has_turn(test, number):
        return ""
    return f"runs at another landing than number {number}: CHLADNI_STUDIES=all runs it"
