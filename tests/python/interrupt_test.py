"""Ctrl-C in a long call, with what Python was told to do then."""
import signal
import subprocess
import sys
import textwrap
import time
import unittest

START = """
import signal, sys, threading, time
import chladni, numpy as np
plate = {"geometry": {"plate": {"length": "300 mm", "width": "200 mm", "thickness": "10 mm"}},
         "material": {"youngs_modulus": "70 GPa", "poissons_ratio": 0.3, "density": "2700 kg/m^3"},
         "mesh": {"edge_length": "40 mm"}, "modes": {"count": 12, "damping_ratio": 0.005},
         "sensor": [{"name": "s1", "at": ["-140 mm", "90 mm"], "direction": "z"}],
         "actuator": [{"name": "a1", "at": ["-140 mm", "90 mm"], "direction": "z"}]}
space = chladni.modes(plate, progress=False).state_space()

def long_call(lines=60000):
    frequency_hz = np.linspace(10, 4000, lines)
    print("started", flush=True)
    return len(space.frf(frequency_hz))

heard = []

def own(number, frame):
    heard.append(threading.current_thread() is threading.main_thread())
"""


class CtrlC(unittest.TestCase):
    def said(self, program, signals=1):
        """What the program prints after its long call has begun, and Ctrl-C has come."""
        process = subprocess.Popen([sys.executable, "-c", START + textwrap.dedent(program)],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.assertEqual(process.stdout.readline(), "started\n")
        for _ in range(signals):
            time.sleep(0.2)
            process.send_signal(signal.SIGINT)
        said, errors = process.communicate(timeout=100)
        return said.split("\n")[:-1], errors, process.returncode

    def test_raises_keyboard_interrupt(self):
        said, errors, _ = self.said("""
            try:
                print(long_call())
            except KeyboardInterrupt as stop:
                print("stopped")
        """)
        self.assertEqual(said, ["stopped"], errors)

    def test_calls_the_own_handler_each_time_and_goes_on(self):
        for signals, heard in (1, "[True]"), (2, "[True, True]"):
            with self.subTest(signals=signals):
                said, errors, _ = self.said("""
                    signal.signal(signal.SIGINT, own)
                    print(long_call())
                    print(heard)
                """, signals)
                self.assertEqual(said, ["60000", heard], errors)

    def test_raises_what_the_own_handler_raises(self):
        said, errors, _ = self.said("""
            class Enough(Exception):
                pass
            def stop(number, frame):
                own(number, frame)
                raise Enough("by the user")
            signal.signal(signal.SIGINT, stop)
            begin = time.monotonic()
            try:
                print(long_call(600000))
            except Enough as why:
                print(why, time.monotonic() - begin < 15)
            print(heard)
            print(signal.getsignal(signal.SIGINT) is stop)
        """)
        self.assertEqual(said, ["by the user True", "[True]", "True"], errors)

    def test_is_ignored_where_it_is(self):
        said, errors, _ = self.said("""
            signal.signal(signal.SIGINT, signal.SIG_IGN)
            print(long_call())
        """)
        self.assertEqual(said, ["60000"], errors)

    def test_ends_the_process_where_it_does_by_default(self):
        said, errors, code = self.said("""
            signal.signal(signal.SIGINT, signal.SIG_DFL)
            print(long_call(600000))
        """)
        self.assertEqual((said, code), ([], -signal.SIGINT), errors)

    def test_calls_the_own_handler_where_the_call_fails(self):
        said, errors, _ = self.said("""
            signal.signal(signal.SIGINT, own)
            def progress(step, part):
                signal.raise_signal(signal.SIGINT)
                raise ValueError("of the progress")
            print("started", flush=True)
            time.sleep(1)
            heard.clear()
            try:
                chladni.modes(plate, progress=progress)
            except ValueError as why:
                print(why)
            print(heard)
        """)
        self.assertEqual(said, ["of the progress", "[True]"], errors)


if __name__ == "__main__":
    unittest.main()
