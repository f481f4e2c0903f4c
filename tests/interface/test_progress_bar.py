"""The progress bar: on a terminal, and nowhere else."""
import os
import pty
import signal
import subprocess
import time
import unittest

from program import PROGRAM, ProgramTest, gas


class ProgressBarTest(ProgramTest):
    def errors_on_terminal(self, *arguments):
        """What the program writes to a standard error that is a terminal."""
        here, there = pty.openpty()
        program = subprocess.Popen([PROGRAM, "run", *map(str, arguments)], cwd=self.folder, stderr=there,
                                   stdout=subprocess.PIPE)
        os.close(there)
        text = b""
        while True:
            try:
                piece = os.read(here, 65536)
            except OSError:  # how Linux reports that the other end was closed
                break
            if not piece:
                break
            text += piece
        program.communicate()
        os.close(here)
        self.assertEqual(program.returncode, 0)
        return text.decode()

    def slow_scene(self):
        return self.write_scene(gas(40, steps=300, every=100))

    def test_terminal_shows_steps_a_second_and_time_left(self):
        text = self.errors_on_terminal(self.slow_scene())
        self.assertRegex(text, r"\[#*\.*\] +\d+ %  step \d+ of 300  [\d.]+ steps/s  \d+:\d\d left")
        self.assertTrue(text.endswith("\r\x1b[K"), "the bar goes when the run is over")
        self.assertNotIn("\n", text)
        for line in text.split("\r"):
            self.assertLess(len(line), 85)

    def test_pipe_gets_no_progress_bar(self):
        self.assertEqual(self.carom("run", self.slow_scene()).stderr, "")

    def test_quiet_shows_none_on_a_terminal(self):
        self.assertEqual(self.errors_on_terminal(self.slow_scene(), "--quiet"), "")

    def test_ctrl_c_takes_the_bar_away_before_its_message(self):
        here, there = pty.openpty()
        program = subprocess.Popen([PROGRAM, "run", self.write_scene(gas(10, steps=1_000_000_000, every=1_000_000))],
                                   cwd=self.folder, stderr=there, stdout=subprocess.DEVNULL)
        os.close(there)
        text = os.read(here, 65536)
        time.sleep(0.3)
        program.send_signal(signal.SIGINT)
        program.wait(timeout=60)
        try:
            while piece := os.read(here, 65536):
                text += piece
        except OSError:
            pass
        os.close(here)
        self.assertEqual(program.returncode, 0)
        self.assertRegex(text.decode(), r"left\x1b\[K\r\x1b\[Kcarom: interrupted after")


if __name__ == "__main__":
    unittest.main()
