"""What report.html costs: time and memory of making it, time to open it and to draw a frame in a real browser."""
import subprocess
import time
import unittest

from browser import Browser
from program import PROGRAM, SEED, ProgramTest

TRIES = 3  # of which the best counts: other programs may run beside
ONE_FRAME_EACH = """
const done = arguments[arguments.length - 1], count = carom.frames.count, wanted = 90;
let drawn = 0, start = 0;
const next = () => {
    if (drawn === 0) start = performance.now();
    carom.player.seekFrame(drawn % count);
    if (drawn++ < wanted) requestAnimationFrame(next); else done(wanted * 1000 / (performance.now() - start));
};
next();
"""


def gas(count, steps):
    side = (count * 2) ** 0.5
    return {"carom": 1, "name": "gas", "walls": {"min": [0, 0], "max": [side, side]}, "default_material": {"restitution": 1},
            "generate": [{"gas": {"count": count, "radius": 0.5, "velocity_rms": 3, "seed": 1}}],
            "step": {"dt": 1 / 60, "count": steps}}


class ReportSpeedTest(ProgramTest):
    def seconds(self, *arguments):
        best = float("inf")
        for _ in range(TRIES):
            start = time.monotonic()
            self.carom(*arguments)
            best = min(best, time.monotonic() - start)
        return best

    def test_the_report_of_a_small_scene_costs_a_fifth_of_the_run_and_a_second_at_most(self):
        without = self.seconds("run", SEED, "--out", "out", "--quiet", "--no-report")
        both = self.seconds("run", SEED, "--out", "out", "--quiet")
        print(f"seed: run {without:.3f} s, report {both - without:.3f} s")
        self.assertLess(both - without, 0.2 * without + 1)

    def test_ten_thousand_bodies_and_300_frames(self):
        self.check_large(gas(10_000, 299), 300, most_seconds=3, fewest_frames_a_second=30)

    def test_hundred_thousand_bodies_and_60_frames(self):
        self.check_large(gas(100_000, 59), 60, most_seconds=8, fewest_frames_a_second=0)

    def check_large(self, scene, frames, most_seconds, fewest_frames_a_second):
        self.carom("run", self.write_scene(scene), "--out", "out", "--quiet")
        page = self.folder / "out/report.html"
        trajectory = (self.folder / "out/trajectory.h5").stat().st_size
        self.assertLess(page.stat().st_size, 50e6)
        memory = self.memory_of("report", "out")
        opening, rate = float("inf"), 0
        for _ in range(TRIES):
            browser = Browser()
            try:
                start = time.monotonic()
                browser.open(page)
                browser.settle(2)
                opening = min(opening, time.monotonic() - start)
                self.assertEqual(browser.run("return carom.frames.count"), frames)
                rate = max(rate, browser.driver.execute_async_script(ONE_FRAME_EACH))
                self.assertEqual(browser.console(), [])
            finally:
                browser.close()
            if opening < most_seconds and rate >= fewest_frames_a_second:
                break
        print(f"{scene['generate'][0]['gas']['count']} bodies x {frames} frames: page {page.stat().st_size / 1e6:.1f} MB, "
              f"opens in {opening:.2f} s, {rate:.0f} frames a second, made with {memory / 1e6:.0f} MB, "
              f"trajectory {trajectory / 1e6:.1f} MB")
        self.assertLess(opening, most_seconds)
        self.assertGreaterEqual(rate, fewest_frames_a_second)
        self.assertLess(memory, 1.5 * trajectory)

    def memory_of(self, *arguments):
        """The most the program held [bytes]. Asked while it runs: what the system tells afterwards counts this one's too."""
        program = subprocess.Popen([PROGRAM, *arguments], cwd=self.folder, stdout=subprocess.DEVNULL)
        most = 0
        while program.poll() is None:
            with open(f"/proc/{program.pid}/status") as status:
                most = max([most, *(int(line.split()[1]) for line in status if line.startswith("VmHWM"))])
            time.sleep(0.002)
        self.assertEqual(program.returncode, 0)
        self.assertGreater(most, 0)
        return most * 1024


if __name__ == "__main__":
    unittest.main()
