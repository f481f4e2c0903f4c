"""Runs that do not reach their end: Ctrl-C, kill, full disks. No half file under a final name, ever."""
import json
import os
import random
import resource
import shutil
import signal
import subprocess
import time
import unittest

import numpy

from program import ALL_FILES, PROGRAM, SEED, ProgramTest, Results, gas, scaled

ENDLESS = 1_000_000_000


class InterruptTest(ProgramTest):
    def start(self, scene, *arguments):
        return subprocess.Popen([PROGRAM, "run", self.write_scene(scene), "--out", "out", *arguments],
                                cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_DFL))  # under nohup, too

    def wait_until_running(self, program):
        """The ledger has left its first buffer: steps are being taken."""
        part = self.folder / "out/ledger.csv.part"
        while not (part.exists() and part.stat().st_size > 0):
            self.assertIsNone(program.poll())
            time.sleep(0.01)

    def check_ended_run(self, signal_number):
        program = self.start(gas(6, steps=ENDLESS, every=7))
        self.wait_until_running(program)
        program.send_signal(signal_number)
        output, errors = program.communicate(timeout=60)
        self.assertEqual(program.returncode, 0, errors)
        self.assertIn("interrupted", output)
        self.assertIn("interrupted after", errors)
        self.assertEqual(self.files_in("out"), ALL_FILES)

        results = Results(self.folder / "out")
        summary, ledger, frames = results.summary, results.ledger(), results.trajectory()
        self.assertTrue(summary["interrupted"])
        self.assertEqual(summary["steps_asked"], ENDLESS)
        self.assertGreater(summary["steps"], 0)
        self.assertEqual(len(ledger["time"]), summary["steps"])
        self.assertEqual(len(frames["time"]), 1 + -(-summary["steps"] // 7))
        for moment in (ledger["time"][-1], frames["time"][-1]):
            self.assertEqual(moment, summary["time"])
        numpy.testing.assert_array_equal(
            numpy.array([float(row["x"]) for row in results.final], dtype=numpy.float32), frames["position"][-1, :, 0])

    def test_ctrl_c_ends_a_run_with_what_it_has_so_far(self):
        self.check_ended_run(signal.SIGINT)

    def test_sigterm_does_the_same(self):
        self.check_ended_run(signal.SIGTERM)

    def test_a_terminal_that_hangs_up_does_the_same(self):
        self.check_ended_run(signal.SIGHUP)

    def test_nohup_keeps_a_run_going(self):
        program = subprocess.Popen([PROGRAM, "run", self.write_scene(gas(6, steps=ENDLESS)), "--out", "out", "--quiet"],
                                   cwd=self.folder, stderr=subprocess.DEVNULL,
                                   preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
        self.wait_until_running(program)
        program.send_signal(signal.SIGHUP)
        time.sleep(0.3)
        self.assertIsNone(program.poll())
        program.send_signal(signal.SIGTERM)
        self.assertEqual(program.wait(timeout=60), 0)

    def test_a_run_that_is_interrupted_gives_the_state_of_a_shorter_one(self):
        program = self.start(gas(6, steps=ENDLESS, every=1000), "--quiet")
        self.wait_until_running(program)
        program.send_signal(signal.SIGINT)
        program.communicate(timeout=60)
        interrupted = Results(self.folder / "out").summary
        whole = self.run_scene(gas(6, steps=interrupted["steps"], every=1000), out="whole").summary
        self.assertEqual(whole["state_hash"], interrupted["state_hash"])
        self.assertFalse(whole["interrupted"])


class LongStepTest(ProgramTest):
    def check_last_moment(self):
        """Ledger, trajectory and final.csv end at the moment that the step came to."""
        results = Results(self.folder / "out")
        summary, ledger, frames = results.summary, results.ledger(), results.trajectory()
        self.assertTrue(summary["interrupted"])
        for moment in (ledger["time"][-1], frames["time"][-1]):
            self.assertEqual(moment, summary["time"])
        numpy.testing.assert_array_equal(
            numpy.array([float(row["x"]) for row in results.final], dtype=numpy.float32), frames["position"][-1, :, 0])
        return summary

    def test_ctrl_c_ends_a_run_within_a_step(self):
        scene = gas(60, solver="event", steps=3, speed=200.0)
        scene["step"]["dt"] = 10
        program = subprocess.Popen([PROGRAM, "run", self.write_scene(scene), "--out", "out", "--quiet"],
                                   cwd=self.folder, stderr=subprocess.PIPE, text=True)
        while not (self.folder / "out/ledger.csv.part").exists():
            time.sleep(0.01)
        time.sleep(0.5)
        self.assertIsNone(program.poll())
        program.send_signal(signal.SIGINT)
        errors = program.communicate(timeout=60)[1]
        self.assertEqual(program.returncode, 0, errors)
        self.assertIn("interrupted after 0 of 3 steps", errors)
        summary = self.check_last_moment()
        self.assertEqual(summary["steps"], 0)
        self.assertGreater(summary["time"], 0)
        self.assertLess(summary["time"], 10)

    def test_a_step_that_is_given_up_ends_the_run_with_what_it_has(self):
        scene = gas(1, solver="event", speed=0.0)
        scene["walls"]["max"] = [10, 4]
        scene["bodies"] = [
            {"type": "kinematic", "shape": {"disc": {"radius": 0.5}}, "position": [8, 2], "velocity": [1, 0]},
            {"shape": {"disc": {"radius": 0.5}}, "position": [9.2, 2]}]
        done = subprocess.run([PROGRAM, "run", self.write_scene(scene), "--out", "out", "--quiet"], cwd=self.folder,
                              capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("given up", done.stderr)
        self.assertIn("body 1 (10000) and body 0 (5000)", done.stderr)
        summary = self.check_last_moment()
        self.assertAlmostEqual(summary["time"], 0.5, places=2)


class ClosedOutputTest(ProgramTest):
    """The table is lost, the results are not."""

    def check_complete(self, redirection="", **streams):
        """Runs a scene in a shell; returns what stands on standard error."""
        scene = self.write_scene(gas(3, steps=20))
        whole = self.run_scene(scene, out="whole")
        streams = {"stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE, **streams}
        done = subprocess.run(["bash", "-c", f'"$1" run "$2" --out out {redirection}', "bash", PROGRAM, scene],
                              cwd=self.folder, text=True, timeout=60, **streams)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.files_in("out"), ALL_FILES)
        results = Results(self.folder / "out")
        self.assertEqual(results.summary["state_hash"], whole.summary["state_hash"])
        self.assertEqual(results.final, whole.final)
        self.assertEqual(len(results.trajectory()["time"]), 21)
        self.assertEqual(len(results.ledger()["time"]), 20)
        return done.stderr

    def check_told(self, errors):
        self.assertIn("standard output could not be written", errors)
        self.assertIn("the results are complete in out", errors)

    def test_a_reader_who_has_gone(self):
        read, write = os.pipe()
        os.close(read)
        try:
            self.check_told(self.check_complete(stdout=write))
        finally:
            os.close(write)

    def test_a_full_disk_for_the_table(self):
        self.check_told(self.check_complete("> /dev/full"))

    def test_a_closed_standard_output(self):
        self.check_told(self.check_complete(">&-"))

    def test_closed_standard_streams_all_of_them(self):
        self.check_complete("<&- >&- 2>&-")


class KilledTest(ProgramTest):
    def check_whole(self, steps):
        """Whatever stands under a final name can be read; and if there is a summary, all belongs together."""
        names = {name for name in self.files_in("out") or () if not name.endswith(".part")}
        self.assertLessEqual(names, ALL_FILES)
        if "summary.json" not in names:
            return False
        self.assertEqual(names, ALL_FILES)
        results = Results(self.folder / "out")
        self.assertEqual(results.summary["steps"], steps)
        self.assertEqual(len(results.ledger()["time"]), steps)
        self.assertEqual(len(results.trajectory()["time"]), steps + 1)
        return True

    def test_a_killed_run_leaves_no_half_file(self):
        steps, chance, finished = scaled(400, 200), random.Random(4), []
        scene = self.write_scene(gas(scaled(20, 10), steps=steps))
        start = time.monotonic()
        self.carom("run", scene, "--out", "out", "--quiet")
        whole_run = time.monotonic() - start

        def kill_after(seconds):
            program = subprocess.Popen([PROGRAM, "run", scene, "--out", "out", "--quiet"], cwd=self.folder)
            time.sleep(seconds)
            program.kill()
            program.wait()
            finished.append(self.check_whole(steps))

        for _ in range(25):
            if chance.random() < 0.5:
                subprocess.run(["rm", "-rf", self.folder / "out"], check=True)
            kill_after(chance.uniform(0, 1.2) * whole_run)
        # On a machine that has become slower since the whole run, none may have come to its end so far.
        patience = whole_run
        while True not in finished:
            patience *= 2
            kill_after(patience)

    def test_the_next_run_clears_what_a_killed_one_left(self):
        scene = self.write_scene(gas(3, steps=ENDLESS))
        program = subprocess.Popen([PROGRAM, "run", scene, "--out", "out", "--quiet"], cwd=self.folder)
        while not (self.folder / "out/trajectory.h5.part").exists():
            self.assertIsNone(program.poll())
        program.kill()
        program.wait()
        self.run_scene(SEED, "--no-trajectory")
        self.assertEqual(self.files_in("out"), ALL_FILES - {"trajectory.h5"})


class FullDiskTest(ProgramTest):
    def sizes(self, scene):
        """Of the result files of that scene [bytes]; their folder is gone again."""
        self.carom("run", scene, "--out", "measured", "--quiet")
        sizes = [path.stat().st_size for path in (self.folder / "measured").iterdir()]
        shutil.rmtree(self.folder / "measured")
        return sizes

    def test_a_file_that_may_not_grow_ends_the_run_and_leaves_nothing(self):
        scene = self.write_scene(gas(10, steps=300))
        largest = max(self.sizes(scene))
        # libomp cannot start if no file may have 2,000 bytes; times in the page have more digits in one run than in the next
        for limit in (2000, 3000, 10_000, largest // 8, largest // 2, largest - 1000):
            def limit_files():
                resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
            done = self.carom("run", scene, "--out", "deep/out", expect=3, preexec_fn=limit_files)
            self.assertIn("File too large", done.stderr)
            self.assertEqual(done.stdout, "")
            self.assertEqual(self.everything(), ["scene.json"], limit)

    def test_results_of_an_earlier_run_survive_one_that_fails(self):
        earlier = self.run_scene(SEED).summary
        scene = self.write_scene(gas(10, steps=300))
        self.carom("run", scene, "--out", "out", expect=3,
                   preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (50_000, 50_000)))
        self.assertEqual(self.files_in("out"), ALL_FILES)
        self.assertEqual(Results(self.folder / "out").summary, earlier)

    def run_on_mount(self, options, scene):
        """Runs on a file system of its own; returns exit code, standard error and the files left on it."""
        disk = self.folder / "disk"
        disk.mkdir(exist_ok=True)
        script = ('mount -t tmpfs -o "$1" tmpfs "$2" || exit 77; shift; cd "$1"; shift; '
                  '"$@" 2>/proc/self/fd/2; code=$?; echo "$code"; ls -A out 2>/dev/null')
        done = subprocess.run(["unshare", "-rm", "sh", "-c", script, "sh", options, disk, PROGRAM, "run", scene,
                               "--out", "out", "--quiet"], capture_output=True, text=True, timeout=120)
        if not done.stdout:
            self.skipTest(f"no file system can be mounted here: {done.stderr}")
        code, *files = done.stdout.split()
        return int(code), done.stderr, set(files)

    def test_a_full_disk_ends_the_run_and_leaves_nothing(self):
        scene = self.write_scene(gas(10, steps=300))
        needed = sum(self.sizes(scene))
        for size in (8192, 40960, needed // 3, needed * 2 // 3, needed - 8192):
            with self.subTest(size=size):
                code, errors, files = self.run_on_mount(f"size={size}", scene)
                self.assertEqual((code, files), (3, set()))
                self.assertIn("No space left on device", errors)
        self.assertEqual(self.run_on_mount("size=20m", scene), (0, "", ALL_FILES))

    def test_a_read_only_disk_is_refused_before_the_run(self):
        code, errors, files = self.run_on_mount("ro", self.write_scene(gas(2)))
        self.assertEqual((code, files), (2, set()))
        self.assertIn("Read-only file system", errors)


if __name__ == "__main__":
    unittest.main()
