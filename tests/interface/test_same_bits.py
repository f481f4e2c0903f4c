"""One scene, one state hash: whatever the instruction set, the threads, and what is recorded."""
import re
import time
import unittest

from program import SEED, ProgramTest, gas, scaled


class SameBitsTest(ProgramTest):
    def instruction_sets(self):
        return re.search(r"this machine runs: ([\w ]+)", self.carom("--version").stdout).group(1).split()

    def scene(self, precision):
        scene = gas(100, steps=scaled(8, 4), precision=precision, every=4, gravity=[0, -1])
        scene["bodies"] = []  # generated: reading them would take most of the time
        scene["generate"] = [{"gas": {"count": 10_000, "radius": 0.5, "velocity_rms": 3, "seed": 1}}]
        return self.write_scene(scene)

    def hash_and_files(self, scene, *arguments):
        """The summary's hash and, byte by byte, what else must not differ."""
        return self.hash_and_files_of(self.run_scene(scene, "--no-report", *arguments))

    def hash_and_files_of(self, results):
        return results.summary["state_hash"], (results.folder / "final.csv").read_text()

    def test_every_instruction_set_gives_the_same_hash_and_final_state(self):
        for precision in ("float", "double"):
            scene = self.scene(precision)
            expected = self.hash_and_files(scene, "--isa", "scalar")
            for isa in self.instruction_sets():
                with self.subTest(isa=isa, precision=precision):
                    results = self.run_scene(scene, "--isa", isa, "--no-report")
                    self.assertEqual(self.hash_and_files_of(results), expected)
                    self.assertEqual(results.summary["isa"], isa)

    def test_every_number_of_threads_gives_the_same_hash_and_final_state(self):
        for precision in ("float", "double"):
            scene = self.scene(precision)
            expected = self.hash_and_files(scene, "--threads", 1)
            for threads in scaled((2, 3, 7), (3,)):
                with self.subTest(threads=threads, precision=precision):
                    self.assertEqual(self.hash_and_files(scene, "--threads", threads), expected)

    def test_recording_changes_no_bit(self):
        scene = self.scene("float")
        expected = self.hash_and_files(scene)
        for options in (["--no-trajectory"], ["--effects", "-ledger"], ["--no-trajectory", "--effects", "-ledger"]):
            self.assertEqual(self.hash_and_files(scene, *options), expected, options)

    def test_two_runs_write_the_same_ledger_and_the_same_frames(self):
        first = self.run_scene(SEED, out="first")
        time.sleep(1.1)  # no file has the second in it at which it was written
        second = self.run_scene(SEED, out="second")
        for name in ("final.csv", "ledger.csv", "trajectory.h5"):
            self.assertEqual((first.folder / name).read_bytes(), (second.folder / name).read_bytes(), name)

    def test_ledger_is_the_same_for_every_instruction_set_and_thread_count(self):
        scene = self.scene("float")
        self.run_scene(scene, "--isa", "scalar", "--threads", 1, out="expected")
        expected = (self.folder / "expected/ledger.csv").read_text()
        for isa in self.instruction_sets():
            for threads in scaled((1, 3), (3,)):
                results = self.run_scene(scene, "--isa", isa, "--threads", threads)
                self.assertEqual((results.folder / "ledger.csv").read_text(), expected, (isa, threads))

    def test_different_scenes_have_different_hashes(self):
        hashes = {self.run_scene(SEED, "--steps", steps).summary["state_hash"] for steps in range(10)}
        self.assertEqual(len(hashes), 10)


if __name__ == "__main__":
    unittest.main()
