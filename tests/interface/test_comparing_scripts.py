"""tools/bench_compare and tools/count_instructions: their verdicts, on programs and counts that are made up."""
import importlib.machinery
import importlib.util
import json
import random
import subprocess
import sys

import unittest

from program import SOURCE, ProgramTest


def load(name):
    loader = importlib.machinery.SourceFileLoader(name, str(SOURCE / "tools" / name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    loader.exec_module(module)
    return module


compare = load("bench_compare")
counting = load("count_instructions")

# A benchmark program whose times are drawn anew in every turn: 5 % of noise around `time`, the same in every run of
# these tests, since one draw in some dozens is far enough out to be called slower.
FAKE = """#!{python}
import json, pathlib, random, sys
turns = pathlib.Path(sys.argv[0] + ".turns")
turns.write_text((turns.read_text() if turns.exists() else "") + ".")
random.seed({name!r} + turns.read_text())
if "--benchmark_list_tests" in sys.argv:
    print({names!r}.replace(" ", "\\n"))
else:
    runs = [dict(name=name, cpu_time={time} * random.lognormvariate(0, 0.05)) for name in {names!r}.split()]
    print(json.dumps(dict(benchmarks=runs)))
"""


class BenchCompareTest(ProgramTest):
    def program(self, name, time, names="a b"):
        path = self.folder / name
        path.write_text(FAKE.format(python=sys.executable, name=name, time=time, names=names))
        path.chmod(0o755)
        return path

    def slower(self, base, head, rounds=15, limit=1.03):
        return compare.verdicts(compare.ratios_of(base, head, ".", rounds), limit)[1]

    def test_what_is_a_fifth_slower_is_found_in_noise_of_five_per_cent(self):
        self.assertEqual(self.slower(self.program("base", 100), self.program("head", 120)), ["a", "b"])

    def test_what_is_as_fast_or_faster_is_not_slower(self):
        base = self.program("base", 100)
        self.assertEqual(self.slower(base, self.program("same", 100)), [])
        self.assertEqual(self.slower(base, self.program("faster", 80)), [])

    def test_only_what_both_have_is_compared(self):
        base, head = self.program("base", 100, "a old"), self.program("head", 200, "a new")
        self.assertEqual(self.slower(base, head), ["a"])
        with self.assertRaisesRegex(compare.CannotCompare, "no benchmark in common"):
            compare.ratios_of(base, self.program("other", 1, "c"), ".", 5)

    def test_an_interval_of_95_per_cent_holds_the_true_ratio_about_so_often(self):
        draw = random.Random(7)
        held = 0
        for _ in range(200):
            middle, low, high = compare.interval([draw.lognormvariate(0, 0.2) for _ in range(15)])
            self.assertTrue(low <= middle <= high)
            held += low <= 1 <= high
        self.assertTrue(0.88 * 200 < held < 200, held)

    def test_an_unknown_commit_is_refused(self):
        done = subprocess.run([SOURCE / "tools/bench_compare", "no-such-commit"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("no-such-commit", done.stderr)

    def test_the_chosen_benchmarks_exist(self):
        program = SOURCE / "build/release/bin/carom_bench"
        if not program.exists():
            self.skipTest("no carom_bench in build/release")
        names = compare.names_of(program, compare.CHOSEN)
        self.assertTrue(any(name.startswith("scenes/gas") for name in names), names)
        self.assertTrue(any(name.startswith("kernels/find_candidates") for name in names), names)


class CountInstructionsTest(unittest.TestCase):
    KEPT = {"tolerance": 0.01, "scenes": {"a": {"steps": 10, "instructions": 100_000}, "b": {"steps": 10, "instructions": 1000}}}

    def test_more_than_the_tolerance_fails_and_less_does_not(self):
        for count, expected in ((100_900, False), (101_100, True), (90_000, False)):
            lines, is_worse = counting.compare(self.KEPT, {"a": count, "b": 1000})
            self.assertEqual(is_worse, expected, lines)
        self.assertIn("fewer than kept", counting.compare(self.KEPT, {"a": 90_000, "b": 1000})[0][0])

    def test_the_kept_file_names_scenes_that_exist_and_counts_that_were_measured(self):
        kept = json.loads((SOURCE / "bench/instruction_counts.json").read_text())
        self.assertEqual(set(kept["scenes"]), {"seed", "newtons-cradle", "gas", "pile", "tumbler"})
        for scene in kept["scenes"].values():
            self.assertTrue((SOURCE / scene["scene"]).exists())
            self.assertGreater(scene["instructions"], 1000 * scene["steps"])


if __name__ == "__main__":
    unittest.main()
