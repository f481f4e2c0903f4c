"""Invocations, right and wrong: exit codes, messages, and that a wrong one writes nothing."""
import json
import math
import os
import re
import subprocess
import unittest

import numpy

from program import ALL_FILES, PROGRAM, SEED, SOURCE, ProgramTest, gas


class WrongInputTest(ProgramTest):
    def check_refused(self, *arguments, says=None):
        with self.subTest(arguments=arguments):
            before = self.everything()
            done = self.carom(*arguments, expect=2)
            self.assertEqual(done.stdout, "")
            self.assertGreater(len(done.stderr), 10)
            self.assertNotIn("internal", done.stderr)
            if says:
                self.assertIn(says, done.stderr)
            self.assertEqual(self.everything(), before)

    def test_command_lines_that_make_no_sense_are_refused(self):
        for arguments in ([], ["fly"], ["run"], ["check"], ["explain"], ["run", SEED, SEED], ["--bogus"],
                          ["run", SEED, "--bogus"], ["run", "--out"], [""], ["run", ""], ["check", SEED, "--steps", "3"],
                          ["prices"], ["report"], ["torture", "B99x"], ["accuracy", "A99"], ["accuracy", "--out"]):
            self.check_refused(*arguments)

    def test_values_out_of_range_are_refused(self):
        for option, values in {
            "--steps": ["-1", "1.5", "x", "", "1e30", "nan", "9223372036854775808"],
            "--dt": ["0", "-1", "nan", "inf", "-inf", "x", "", "1e9", "1e400"],
            "--substeps": ["0", "-1", "1000000", "x", "1.5", "99999999999"],
            "--iterations": ["0", "-1", "1000000", "x"],
            "--precision": ["half", "", "FLOAT", "long double"],
            "--threads": ["-1", "x", "1.5", "100000", "99999999999999"],
            "--isa": ["", "bogus", "AVX2", "avx3", "neon"],
            "--solver": ["", "bogus", "Impulse", "rigid", "rattle"],
            "--effects": ["", "sleep", "+", "-", "+bogus", "++ledger", "+ledger,-ledger", "-ledger,+ledger",
                          "+ledger,,", "-gravity", "-restitution", "-drag", "-continuous", "+frictoin"],
        }.items():
            for value in values:
                self.check_refused("run", SEED, option, value)

    def test_messages_name_what_was_wrong_and_what_there_is(self):
        self.check_refused("run", SEED, "--effects", "+slepp", says='nearest known one is "sleep"')
        self.check_refused("run", SEED, "--solver", "impuls", says="impulse")
        self.check_refused("run", SEED, "--isa", "avx9", says="scalar")
        self.check_refused("run", SEED, "--precision", "half", says="double")
        self.check_refused("rnu", SEED, says='"rnu" is no command; the nearest known one is "run"')
        self.check_refused("--bogus", says='there is no option "--bogus"')
        self.check_refused(says="one of run, explain, check")

    def test_scenes_that_cannot_be_read_are_refused(self):
        (self.folder / "folder.json").mkdir()
        (self.folder / "broken.json").write_text('{"carom": 1, "bodies": [')
        (self.folder / "empty.json").write_text("")
        (self.folder / "binary.json").write_bytes(bytes(range(256)) * 10)
        for command in ("run", "explain", "check"):
            for name in ("missing.json", "folder.json", "broken.json", "empty.json", "binary.json", "/dev/null"):
                self.check_refused(command, name, says=name)

    def test_values_of_the_scene_that_are_wrong_are_refused(self):
        scene = gas(2)
        scene["bodies"][3]["shape"]["disc"]["radius"] = -1
        path = self.write_scene(scene)
        for command in ("run", "explain", "check"):
            self.check_refused(command, path, says="/bodies/3/shape/disc/radius")

    def test_a_wrong_environment_is_refused(self):
        for command in (["run", SEED], ["explain", SEED], ["--version"]):
            done = self.carom(*command, expect=2, env={**os.environ, "CAROM_ISA": "avx9"})
            self.assertIn("CAROM_ISA", done.stderr)
        self.assertEqual(self.everything(), [])

    def test_the_naive_engine_refuses_what_it_cannot_do(self):
        scene = gas(3, solver="pairwise")
        self.run_scene(scene)

        def check(says, change):
            changed = json.loads(json.dumps(scene))
            change(changed)
            path = self.write_scene(changed, "changed.json")
            for command in ("run", "explain"):
                self.check_refused(command, path, says=says)

        check("body 4 is static", lambda s: s["bodies"][4].update(type="static", velocity=[0, 0]))
        check("body 4 is kinematic", lambda s: s["bodies"][4].update(type="kinematic"))
        check("restitution", lambda s: s["bodies"][4].update(material={"restitution": 0.5}))
        check("iterations", lambda s: s["accuracy"].update(iterations=4))
        self.check_refused("run", self.folder / "scene.json", "--isa", "avx2", says="scalar")
        self.check_refused("run", self.folder / "scene.json", "--precision", "float", says="double")


class OutputFolderTest(ProgramTest):
    def check_refused(self, out, says):
        with self.subTest(out=out):
            before = self.everything()
            done = self.carom("run", SEED, "--out", out, expect=2)
            self.assertIn(says, done.stderr)
            self.assertEqual(done.stdout, "")
            self.assertEqual(self.everything(), before)

    def test_folders_that_cannot_be_written_are_refused(self):
        (self.folder / "file").write_text("mine")
        (self.folder / "taken/final.csv").mkdir(parents=True)
        self.check_refused("", "output folder")
        self.check_refused("file", "file")
        self.check_refused("file/deeper/still", "file")
        self.check_refused("taken", "final.csv")
        self.check_refused("/proc/nothing/here", "/proc/nothing")
        self.check_refused("/dev/null", "/dev/null")
        self.check_refused("new/" + 300 * "x", "new/")
        self.assertEqual((self.folder / "file").read_text(), "mine")

    def test_folders_without_permission_are_refused(self):
        locked = self.folder / "locked"
        locked.mkdir()
        locked.chmod(0o555)
        self.folder.chmod(0o755)
        nobody = 65534

        def give_up_root():
            if os.getuid() == 0:
                os.setgid(nobody)
                os.setuid(nobody)

        try:
            subprocess.run([PROGRAM, "check", SEED], preexec_fn=give_up_root, check=True, capture_output=True)
        except (OSError, subprocess.SubprocessError):
            self.skipTest("the program cannot be started as another user here")
        for out in ("locked", "locked/deeper"):
            done = self.carom("run", SEED, "--out", out, expect=2, preexec_fn=give_up_root)
            self.assertIn("Permission denied", done.stderr)
        self.assertEqual(self.everything(), ["locked"])

    def test_folders_are_made_as_deep_as_asked(self):
        for out in ("a/b/c", "d/", "./e/../f", str(self.folder / "g" / "h")):
            self.carom("run", SEED, "--out", out, "--steps", 1, "--quiet")
            self.assertEqual(self.files_in(out), ALL_FILES)

    def test_files_of_others_in_the_folder_stay(self):
        (self.folder / "out").mkdir()
        (self.folder / "out/notes.txt").write_text("mine")
        self.run_scene(SEED, "--steps", 1)
        self.assertEqual(self.files_in("out"), ALL_FILES | {"notes.txt"})

    def test_two_runs_do_not_write_to_one_folder(self):
        scene = self.write_scene(gas(2, steps=100_000_000, every=1_000_000))
        first = subprocess.Popen([PROGRAM, "run", scene, "--out", "out", "--quiet"], cwd=self.folder,
                                 stderr=subprocess.DEVNULL)
        try:
            while not (self.folder / "out/ledger.csv.part").exists():
                self.assertIsNone(first.poll())
            done = self.carom("run", SEED, "--out", "out", expect=2)
            self.assertIn("another run", done.stderr)
        finally:
            first.terminate()
            first.wait()


class OtherCommandsTest(ProgramTest):
    def test_check_says_ok_with_counts_and_writes_nothing(self):
        done = self.carom("check", SEED)
        self.assertRegex(done.stdout, r"^ok: .*seed\.json: 5 bodies .*500 steps of 0\.016 s\n$")
        self.assertEqual(done.stderr, "")
        self.assertEqual(self.everything(), [])

    def test_version_names_instruction_sets_threads_and_xsimd(self):
        text = self.carom("--version").stdout
        self.assertRegex(text, r"^carom \d+\.\d+\.\d+\n")
        self.assertRegex(text, r"built: scalar .*chosen: \w+\n")
        self.assertRegex(text, r"threads +[1-9]")
        self.assertRegex(text, r"xsimd +\d+\.\d+\.\d+\n")
        forced = self.carom("--version", env={**os.environ, "CAROM_ISA": "scalar"}).stdout
        self.assertIn("chosen: scalar", forced)

    def test_help_lists_the_commands_there_are(self):
        text = self.carom("--help").stdout
        for command in ("run", "explain", "check", "report", "torture", "--version"):
            self.assertIn(command, text)
        text = self.carom("run", "--help").stdout
        for option in ("--out", "--steps", "--dt", "--solver", "--substeps", "--iterations", "--precision", "--threads",
                       "--isa", "--effects", "--no-report", "--no-trajectory", "--quiet"):
            self.assertIn(option, text)

    def test_help_and_messages_name_every_solver_that_takes_an_empty_scene_and_no_other(self):
        scene = self.folder / "empty.json"
        scene.write_text('{"carom": 1}')
        known = json.loads((SOURCE / "docs/scene.schema.json").read_text())["properties"]["accuracy"]["properties"]["solver"]["enum"]
        taken = {solver for solver in known
                 if self.carom("explain", scene, "--solver", solver, expect=None).returncode == 0}
        self.assertLess(taken, set(known))  # some are not built yet
        described = re.search(r"--solver NAME +(.*)", self.carom("run", "--help").stdout).group(1)
        self.assertEqual(set(re.findall(r"\w+", described)) - {"or"}, taken)
        (missing,) = set(known) - taken
        refused = self.carom("explain", scene, "--solver", missing, expect=2).stderr
        self.assertEqual(set(re.findall(r'"(\w+)"', refused)) - {missing}, taken)

    def test_the_page_on_scenes_has_the_limit_of_bodies_that_messages_name(self):
        many = self.write_scene({"carom": 1, "generate": [{"gas": {"count": 67108864, "radius": 1e-5}}],
                                 "walls": {"min": [0, 0], "max": [1, 1]}})
        most = int(re.search(r"expected at most (\d+) bodies", self.carom("check", many, expect=2).stderr).group(1))
        size, millions = re.search(r"4 GiB of bodies while reading \((\d+) bytes each, so about (\d+) million\)",
                                   (SOURCE / "docs/scene-format.md").read_text()).groups()
        self.assertEqual((most, int(millions)), ((4 << 30) // int(size), most // 1_000_000))

    def test_explain_says_what_a_scene_calls_for_and_why(self):
        for solver in ("auto", "pairwise"):
            text = self.carom("explain", SEED, "--solver", solver).stdout
            plan = json.loads(self.carom("explain", SEED, "--solver", solver, "--json").stdout)
            on = {effect["name"] for effect in plan["effects"] if effect["on"]}
            self.assertLessEqual({"gravity", "drag", "walls", "restitution"}, on)
            self.assertEqual((plan["scene"], plan["bodies"]), ("seed", 5))
            self.assertEqual(plan["bytes_per_body"], sum(column["bytes_per_body"] for column in plan["columns"]))
            for part in (*plan["effects"], *plan["stages"], *plan["columns"]):
                self.assertIn(part["name"], text)
            stages = re.findall(r"^(  \w+ +)\S.* -> .*$", text, re.MULTILINE)
            self.assertEqual(len(stages), len(plan["stages"]))
            self.assertEqual(len({len(stage) for stage in stages}), 1, text)  # one column, however long a name is
            for effect in plan["effects"]:
                self.assertGreater(len(effect["reason"]), 3)
                self.assertIn(effect["reason"], text)
        self.assertEqual(self.everything(), [])

    def test_coordinates_that_are_too_coarse_are_said_with_the_remedy(self):
        scene = gas(2, steps=2)
        del scene["walls"]
        scene["bodies"][1]["position"] = [2e6, 0]
        file = self.write_scene(scene)
        limit, = json.loads(self.carom("explain", file, "--json").stdout)["limits"]
        self.assertRegex(limit, "^body 1 is 2e[+]06 m from the origin.*single precision.*Use double precision")
        self.assertIn(f"limit: {limit}", self.carom("explain", file).stdout)
        done = self.carom("run", file, "--out", "out", "--quiet")
        self.assertIn(limit, done.stderr)
        self.assertIn(limit, json.loads((self.folder / "out/summary.json").read_text())["messages"])
        self.assertEqual(self.carom("run", file, "--out", "out", "--quiet", "--precision", "double").stderr, "")

    def test_what_a_scene_does_not_call_for_is_off(self):
        scene = gas(3)
        del scene["walls"]
        plan = json.loads(self.carom("explain", self.write_scene(scene), "--json", "--effects", "-ledger").stdout)
        on = {effect["name"] for effect in plan["effects"] if effect["on"]}
        self.assertEqual(on & {"gravity", "drag", "walls", "rotation", "ledger"}, set())
        self.assertFalse([stage for stage in plan["stages"] if "gravity" in stage["name"] or "wall" in stage["name"]])

    def test_run_uses_what_explain_says(self):
        for solver in ("auto", "pairwise"):
            plan = json.loads(self.carom("explain", SEED, "--solver", solver, "--json").stdout)
            summary = self.run_scene(SEED, "--solver", solver).summary
            self.assertEqual(summary["solver"], plan["solver"]["name"])
            self.assertEqual(summary["effects"], [effect["name"] for effect in plan["effects"] if effect["on"]])
            for key in ("substeps", "precision", "isa", "threads"):
                self.assertEqual(summary[key], plan[key])


class QuarantineTest(ProgramTest):
    def test_a_body_that_leaves_the_limits_is_named_and_the_exit_code_is_1(self):
        scene = gas(2, steps=20)
        del scene["walls"]
        scene["bodies"][2].update(position=[9.99e7, 0], velocity=[1e6, 0])
        results = self.run_scene(scene, expect=1)
        self.assertEqual(results.summary["quarantined"], [2])
        masses = [math.pi * body["shape"]["disc"]["radius"] ** 2 for body in scene["bodies"]]
        start = [0.5 * mass * numpy.dot(body["velocity"], body["velocity"]) for mass, body in zip(masses, scene["bodies"])]
        self.assertAlmostEqual(results.summary["energy"]["initial"]["kinetic"] / sum(start), 1, places=6)
        self.assertAlmostEqual(results.summary["energy_by_cause"]["outside"] / -start[2], 1, places=6)
        self.assertEqual(self.files_in("out"), ALL_FILES)
        done = self.carom("run", self.folder / "scene.json", "--quiet", expect=1)
        self.assertIn("body 2", done.stderr)
        self.assertEqual(done.stdout, "")


class TableTest(ProgramTest):
    def test_run_prints_energy_momentum_contacts_ledger_time_bodies_and_where_the_results_are(self):
        text = self.carom("run", SEED, "--solver", "pairwise", "--out", "there").stdout
        for part in ("kinetic energy            35.0550        33.3359         0.1038  J",
                     "x 0.0031, momentum changed by 8.3566", "momentum x", "angular momentum", "energy by cause",
                     "contacts:", "overlap", "a step", "a body a step", "Results in there:", *ALL_FILES):
            self.assertIn(part, text)

    def test_final_bodies_are_those_of_the_seed(self):
        text = self.carom("run", SEED, "--solver", "pairwise").stdout
        table = [re.sub("[(),]", " ", row).split() for row in re.findall(r"^ +[0-4]  (\(.*)$", text, re.MULTILINE)]
        self.assertEqual([row[:5] for row in table], [
            ["2.75", "0.41", "0.00", "-0.03", "0.001"],
            ["5.82", "0.36", "0.00", "-0.03", "0.001"],
            ["6.94", "0.30", "0.00", "-0.26", "0.035"],
            ["4.86", "0.51", "0.00", "0.14", "0.030"],
            ["7.69", "0.25", "0.01", "0.30", "0.037"],
        ])

    def test_ten_bodies_are_shown_and_the_rest_counted(self):
        text = self.carom("run", self.write_scene(gas(5, steps=1))).stdout
        self.assertIn("... and 15 more", text)

    def test_quiet_prints_nothing(self):
        done = self.carom("run", SEED, "--quiet")
        self.assertEqual((done.stdout, done.stderr), ("", ""))

    def test_answers_that_cannot_be_printed_are_an_error(self):
        with open("/dev/full", "w") as full:
            for arguments in (["explain", SEED], ["check", SEED]):
                done = subprocess.run([PROGRAM, *arguments], stdout=full, stderr=subprocess.PIPE, cwd=self.folder)
                self.assertEqual(done.returncode, 3)
                self.assertIn(b"standard output", done.stderr)


if __name__ == "__main__":
    unittest.main()
