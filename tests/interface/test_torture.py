"""carom torture: what it measures, prints and writes, and when it fails."""
import json
import unittest

from program import ProgramTest, scaled

SCENES = scaled(20, 4)  # random scenes
SEED = 1
TIMES = {"median ms", "worst ms", "worst/median", "stall"}


def numbers_of(row):
    """What a row measured, but for times."""
    return {measure["name"]: measure["value"] for measure in row["measures"] if measure["name"] not in TIMES}


class TortureTest(ProgramTest):
    def torture(self, *arguments, expect=0):
        done = self.carom("torture", *arguments, "--json", "--out", "out", expect=expect)
        self.assertEqual(done.stdout, (self.folder / "out/torture.json").read_text())
        return json.loads(done.stdout)

    def test_random_passive_scenes_gain_no_energy(self):
        found = self.torture("passive", "--scenes", SCENES, "--bodies", 200, "--seed", SEED, "--solver", "auto,soft,impulse")
        self.assertGreaterEqual(len(found["rows"]), SCENES)
        self.assert_passed(found)
        rises = [numbers_of(row)["energy rise"] for row in found["rows"]]
        self.assertTrue(any(rise < 0 for rise in rises) and all(abs(rise) < 1 for rise in rises), rises)

    def assert_passed(self, found):
        for row in found["rows"]:
            self.assertTrue(row["passed"], row)
            self.assertEqual([measure["mark"] for measure in row["measures"][:3]], [1e-3, 0, 0])

    def test_a_random_scene_alone_gives_the_numbers_it_gives_among_others(self):
        arguments = ("passive", "--bodies", 60, "--steps", 60, "--solver", "auto")
        rows = self.torture(*arguments, "--seed", 3, "--scenes", 5)["rows"]
        self.assertEqual(len({json.dumps(numbers_of(row)) for row in rows}), 5)
        alone = self.torture(*arguments, "--seed", 3, "--only", 3)["rows"]
        self.assertEqual([(row["scene"], numbers_of(row)) for row in alone], [(rows[3]["scene"], numbers_of(rows[3]))])
        other = self.torture(*arguments, "--only", 3, "--seed", 4)["rows"]
        self.assertNotEqual(other[0]["scene"], rows[3]["scene"])

    def test_a_random_world_alone_gives_the_numbers_it_gives_among_others(self):
        def worlds(*which):  # some may fail: what it finds is not asked here
            done = self.carom("torture", "random", "--bodies", 12, "--steps", 40, "--solver", "auto", "--seed", 3, *which,
                              "--json", "--out", "out", expect=None)
            return json.loads(done.stdout)["rows"]
        rows = worlds("--scenes", 6)
        self.assertEqual(len({json.dumps(numbers_of(row)) for row in rows}), 6)
        self.assertEqual([measure["name"] for measure in rows[0]["measures"][:6]],
                         ["energy rise", "quarantined", "outside", "not finite", "other bits", "stall"])
        self.assertTrue(all("mark" in measure for row in rows for measure in row["measures"][:6]))
        for index in range(6):
            alone, = worlds("--only", index)
            self.assertEqual((alone["scene"], numbers_of(alone)), (rows[index]["scene"], numbers_of(rows[index])))

    def test_a_solver_with_known_faults_fails_and_the_number_is_shown(self):
        # The naive loop moves discs apart without a look at what lies above them: a heap of them is pumped.
        done = self.carom("torture", "drop", "--bodies", 60, "--steps", 200, "--solver", "pairwise", "--out", "out", expect=1)
        self.assertRegex(done.stdout, r"FAIL +e 0 friction 0 +pairwise +double +\S+ +[\d.]+!")
        self.assertNotIn("friction 0.3", done.stdout)  # it has none, and refuses
        found = json.loads((self.folder / "out/torture.json").read_text())
        failing = [measure for row in found["rows"] for measure in row["measures"] if not measure.get("passed", True)]
        self.assertTrue(failing)
        self.assertTrue(all(measure["value"] > measure["mark"] for measure in failing))
        self.assertEqual(found["cases"][0]["failed"], sum(not row["passed"] for row in found["rows"]))

    def test_a_run_that_takes_too_long_is_given_up_and_fails(self):
        row, = self.torture("passive", "--only", 0, "--bodies", 100, "--steps", 1000000, "--limit", "0.05", "--solver", "auto",
                            expect=1)["rows"]
        self.assertIn("given up after", row["failure"])
        self.assertFalse(row["passed"])

    def test_the_list_names_the_cases_and_writes_nothing(self):
        lines = self.carom("torture", "--list").stdout.splitlines()
        self.assertEqual([line.split()[0] for line in lines], ["passive", "random", "drop", "rest", "impacts"])
        self.assertEqual(self.everything(), [])

    def test_wrong_cases_and_numbers_are_refused_and_nothing_is_written(self):
        for argument, arguments in (("passsive", ("passsive",)), ("--scenes", ("passive", "--scenes", "0")),
                                    ("--bodies", ("passive", "--bodies", "many")), ("--only", ("passive", "--only", "-1")),
                                    ("--limit", ("drop", "--limit", "nan")), ("--limit", ("drop", "--limit", "0")),
                                    ("--solver", ("drop", "--solver", "soft,hard")), ("--precision", ("drop", "--precision", "half")),
                                    ("--jobs", ("drop", "--jobs", "0")), ("--steps", ("drop", "--steps", "1e3"))):
            done = self.carom("torture", *arguments, expect=2)
            self.assertIn(argument, done.stderr)
        self.assertIn('"passive"', self.carom("torture", "passsive", expect=2).stderr)
        self.assertEqual(self.everything(), [])


if __name__ == "__main__":
    unittest.main()
