"""carom profile and carom scaling: what they print and write, and that carom report draws it."""
import json
import re
import unittest

from program import SEED, ProgramTest, gas


class ProfileTest(ProgramTest):
    def profile(self, scene, *arguments):
        path = self.write_scene(scene)
        self.carom("profile", path, "--threads", "1", "--out", "profile.json", *arguments)
        return json.loads((self.folder / "profile.json").read_text())

    def test_stages_add_up_to_the_step_and_say_what_limits_them(self):
        # So many bodies that all steps are timed: of short ones a sample stands for all, with what interrupts it.
        profile = self.profile(gas(120, steps=60))
        self.assertEqual(profile["kind"], "profile")
        self.assertEqual(profile["bodies"], 14400)
        shares = [stage["share"] for stage in profile["stages"]]
        self.assertAlmostEqual(sum(shares), 1, places=6)
        seconds = sum(stage["seconds_per_step"] for stage in profile["stages"])
        self.assertLess(seconds, 1.05 * profile["seconds_per_step"])
        for stage in profile["stages"]:
            self.assertRegex(stage["limit"], "^(memory|arithmetic|branching|too )", stage["name"])

    def test_stages_that_first_run_while_it_measures_are_told_as_all_others_are(self):
        # The discs meet the floor and each other after half a second: before that nothing holds that could gain energy.
        scene = {"carom": 1, "gravity": [0, -10], "walls": {"min": [0, 0], "max": [9, 60]},
                 "default_material": {"restitution": 0.5, "friction": 0.3}, "step": {"dt": 1 / 60, "count": 120},
                 "bodies": [{"position": [1 + 0.9 * (i % 6) + 0.01 * i, 3 + 0.9 * (i // 6)], "shape": {"disc": {"radius": 0.4}}} for i in range(12)]}
        profile = self.profile(scene)
        stages = {stage["name"]: stage for stage in profile["stages"]}
        self.assertIn("bound_energy", stages)
        self.assertLess(stages["bound_energy"]["calls_per_step"], 4)  # of four substeps
        self.assertEqual(stages["advance_bodies"]["calls_per_step"], 4)
        self.assertEqual(stages["end_substeps"]["calls_per_step"], 1)
        shares = [stage["share"] for stage in profile["stages"]]
        self.assertAlmostEqual(sum(shares), 1, places=6)
        self.assertTrue(all(0 <= share < 1 for share in shares), shares)
        self.assertTrue(0 <= profile["measuring_share"] < 1, profile["measuring_share"])

    def test_items_are_what_the_stage_works_through(self):
        stages = {stage["name"]: stage for stage in self.profile(gas(30, steps=60))["stages"]}
        self.assertEqual(stages["begin_flight"]["items"], 900)
        self.assertEqual(stages["end_flight"]["items"], 900)
        begin = stages["begin_flight"]
        self.assertAlmostEqual(begin["ns_per_item"], 1e9 * begin["seconds_per_step"] / 900, delta=1e-6 * begin["ns_per_item"])

    def test_stages_of_solver_soft_have_their_items_and_the_counters_their_values(self):
        scene = {"carom": 1, "name": "pile", "gravity": [0, -10], "walls": {"min": [0, 0], "max": [8, 20]}, "default_material": {"friction": 0.5},
                 "generate": [{"lattice": {"count": [7, 6], "origin": [0.7, 0.6], "spacing": [1.1, 1.1], "shape": {"disc": {"radius": 0.5}}}}],
                 "step": {"dt": 1 / 60, "count": 300}}
        profile = self.profile(scene)
        stages = {stage["name"]: stage for stage in profile["stages"]}
        counters = profile["counters"]
        self.assertEqual(stages["solve_contacts"]["items"], 2 * 4 * counters["contacts"])  # two sweeps in each of four substeps
        self.assertEqual(stages["find_contacts"]["items"], counters["candidate_pairs"])
        self.assertLessEqual(42, counters["touching"])  # every disc lies on something
        self.assertLessEqual(counters["touching"], counters["contacts"])
        self.assertLessEqual(counters["residual"], counters["residual_max"])
        self.assertLess(counters["residual_max"], 10 / 240)  # what gravity adds in a substep
        self.assertGreater(counters["bytes"], 42 * 50)
        path = self.write_scene(scene)
        self.assertIn("residual_max", self.carom("profile", path, "--threads", "1").stdout)
        self.run_scene(path, "--no-report")
        summary = json.loads((self.folder / "out/summary.json").read_text())
        self.assertEqual({key: summary["counters"][key] for key in ("contacts", "touching", "colours", "residual", "residual_max")},
                         {key: counters[key] for key in ("contacts", "touching", "colours", "residual", "residual_max")})

    def test_a_large_gas_says_what_is_on_one_thread_and_what_more_cores_allow(self):
        loops = self.profile(gas(150, steps=8))["shared_loops"]
        self.assertTrue(0 < loops["share_on_one_thread"] < 1, loops)
        self.assertEqual([row["cores"] for row in loops["cores"]], [4, 16, 64])
        before = 1
        for row in loops["cores"]:  # Amdahl's law, with no more than there are cores
            self.assertLessEqual(before, row["times_at_most"])
            share = loops["share_on_one_thread"]
            self.assertLessEqual(row["times_at_most"], 1.0001 / (share + (1 - share) / row["cores"]))
            before = row["times_at_most"]

    def test_columns_of_the_table_stand_below_each_other_however_long_the_name_of_a_stage_is(self):
        text = self.carom("profile", SEED, "--steps", "50", "--threads", "1").stdout  # solve_uneven_contacts has 21 letters
        rows = re.findall(r"^  (?:stage|[a-z]+(?:_[a-z]+)+) .*$", text, re.MULTILINE)
        self.assertGreater(len(rows), 10)
        self.assertEqual(len({len(re.match(r"  \w+ +(?:us a step|[\d.e+-]+)", row).group()) for row in rows}), 1, text)

    def test_a_few_bodies_are_on_one_thread(self):
        path = self.write_scene(gas(3, steps=20))
        self.assertIn("4, 16, 64 cores take it at most 1, 1, 1 times as fast",
                      self.carom("profile", path, "--out", "profile.json").stdout)
        self.assertEqual(json.loads((self.folder / "profile.json").read_text())["shared_loops"]["share_on_one_thread"], 1)

    def test_scalar_kernels_are_not_compared_with_themselves(self):
        profile = self.profile(gas(10, steps=20), "--isa", "scalar")
        self.assertTrue(all("times_scalar" not in stage for stage in profile["stages"]))

    def test_measuring_takes_below_one_per_cent_of_a_step_of_2500_bodies(self):
        self.assertLess(self.profile(gas(50, steps=100))["measuring_share"], 0.01)

    def test_the_trace_has_every_step_with_its_stages_inside(self):
        self.profile(gas(10, steps=25), "--trace", "trace.json")
        events = json.loads((self.folder / "trace.json").read_text())["traceEvents"]
        steps = [event for event in events if event["name"] == "step"]
        self.assertEqual(len(steps), 20)  # the first five are not measured
        stages = [event for event in events if event["ph"] == "X" and event["name"] != "step"]
        for step in steps:
            inside = [e for e in stages if step["ts"] - 1e-6 <= e["ts"] and e["ts"] + e["dur"] <= step["ts"] + step["dur"] + 1e-6]
            self.assertAlmostEqual(sum(e["dur"] for e in inside), step["dur"], places=3)
        self.assertEqual(len([event for event in stages if event["name"] == "end_flight"]), 20)

    def test_the_naive_loop_is_one_stage(self):
        profile = self.profile(gas(3, solver="pairwise", steps=20))
        self.assertEqual([stage["name"] for stage in profile["stages"]], ["pairwise step"])

    def test_a_scene_without_steps_is_refused(self):
        done = self.carom("profile", self.write_scene(gas(3)), "--steps", "0", expect=2)
        self.assertIn("takes no steps", done.stderr)

    def test_json_on_standard_output_is_the_result_file(self):
        path = self.write_scene(gas(5, steps=20))
        done = self.carom("profile", path, "--json", "--threads", "1", "--out", "profile.json")
        self.assertEqual(done.stdout, (self.folder / "profile.json").read_text())

    def test_two_profiles_are_drawn_side_by_side(self):
        self.profile(gas(5, steps=20))
        self.carom("report", "profile.json", "profile.json", "--out", "page.html")
        page = (self.folder / "page.html").read_text()
        self.assertIn("end_flight (A)", page)
        self.assertIn("end_flight (B)", page)
        self.assertIn("Share on one thread", page)


class ScalingTest(ProgramTest):
    def test_sweep_writes_data_and_a_page(self):
        done = self.carom("scaling", "--max-bodies", "300", "--rounds", "3", "--out", "sweep")
        self.assertEqual(self.files_in("sweep"), {"scaling.json", "scaling.html"})
        scaling = json.loads((self.folder / "sweep/scaling.json").read_text())
        self.assertEqual(sorted({row["bodies"] for row in scaling["rows"]}), [10, 30, 100, 300])
        methods = {row["method"] for row in scaling["rows"]}
        self.assertLessEqual({"naive", "all pairs", "grid scalar"}, methods)
        naive = [row for row in scaling["rows"] if row["method"] == "naive"]
        self.assertEqual([row["pairs_per_body"] for row in naive], [(row["bodies"] - 1) / 2 for row in naive])
        self.assertIn("grid scalar is faster than naive", done.stdout)
        self.assertIn("Time against the number of bodies", (self.folder / "sweep/scaling.html").read_text())

    def test_wrong_numbers_are_refused_and_nothing_is_written(self):
        for arguments in (("--max-bodies", "5"), ("--max-bodies", "many"), ("--rounds", "0")):
            done = self.carom("scaling", *arguments, expect=2)
            self.assertIn(arguments[0], done.stderr)
        self.assertEqual(self.everything(), [])


if __name__ == "__main__":
    unittest.main()
