"""carom torture: what it measures, prints and writes, and when it fails."""
import json
import re
import subprocess
import unittest

import jsonschema

from browser import Browser
from program import SOURCE, ProgramTest, scaled
from test_report_page import FLAWS

SCHEMA = json.loads((SOURCE / "docs/torture.schema.json").read_text())
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
        found = json.loads(done.stdout)
        jsonschema.validate(found, SCHEMA)
        return found

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

    def test_worlds_that_once_went_on_otherwise_from_a_saved_state_do_so_no_more(self):
        # Contacts of what sleeps were a step old (125); corrections of torn hinges had a limit by the longest arm ever seen (74).
        for index in scaled((74, 125), (125,)):
            found = self.torture("random", "--scenes", 300, "--seed", 77, "--only", index, "--solver", "auto")
            self.assertIn("restored", found["rows"][0]["scene"])
            self.assertEqual(numbers_of(found["rows"][0])["other bits"], 0)

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
        self.assertEqual([line.split()[0] for line in lines], ["passive", "random", "drop", "rest", "impacts", "hard", "envelopes"])
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


class MatrixTest(ProgramTest):
    """Cases x solvers x precisions: `hard` and `envelopes`, their file and their page."""

    def torture(self, *arguments):
        self.carom("torture", *arguments, "--out", "out", "--limit", "60", expect=None)
        found = json.loads((self.folder / "out/torture.json").read_text())
        jsonschema.validate(found, SCHEMA)
        return found

    def test_every_scene_has_a_cell_for_every_solver_and_a_refusal_says_why(self):
        found = self.torture("hard", "--rows", "B30,A30", "--quick")
        scenes = {row["scene"] for row in found["rows"]}
        cells = {(row["scene"], row["solver"], row["precision"]): row for row in found["rows"]}
        self.assertEqual(len(cells), len(found["rows"]))
        self.assertEqual(len(cells), len(scenes) * 9)  # `pairwise` has double precision alone, `rattle` has no part in it
        self.assertEqual({scene.split()[0] for scene in scenes}, {"A30", "B30"})
        post = next(scene for scene in scenes if scene.startswith("B30"))
        for solver in ("impulse", "event", "pairwise"):
            row = cells[post, solver, "double"]
            self.assertEqual(row["status"], "refused")
            self.assertIn(solver, row["failure"].lower())
            self.assertEqual(row["measures"], [])
        self.assertEqual(cells[post, "soft", "float"]["status"], "as auto")
        auto = cells[post, "auto", "float"]
        self.assertTrue(auto["passed"], auto)
        speed = auto["measures"][0]
        self.assertEqual((speed["name"], speed["mark"]), ("speed/box's", 1.05))
        self.assertLess(speed["value"], 1.05)
        self.assertAlmostEqual(speed["value"] / 1.05, speed["share"], delta=1e-9)
        falls = cells[next(scene for scene in scenes if ".100" in scene), "auto", "double"]["measures"][0]
        self.assertTrue(falls["at_least"])
        self.assertGreaterEqual(falls["value"], falls["mark"])
        self.assertAlmostEqual(falls["mark"] / falls["value"], falls["share"], delta=1e-9)

    def test_soft_alone_gives_what_auto_gives_where_auto_takes_it(self):
        own, = self.torture("hard", "--rows", "B30", "--solver", "soft", "--precision", "float")["rows"]
        auto, = self.torture("hard", "--rows", "B30", "--solver", "auto", "--precision", "float")["rows"]
        self.assertEqual(own["status"], "ran")
        self.assertEqual(numbers_of(own), numbers_of(auto))

    def test_an_envelope_brackets_where_a_solver_stops_holding(self):
        found = self.torture("envelopes", "--rows", "column-height", "--solver", "pairwise,soft", "--precision", "double")
        about, = [each for each in found["envelopes"] if each["name"] == "column-height"]
        by_solver = {row["solver"]: row["bracket"] for row in found["rows"]}
        # The naive loop does not carry: every disc sinks into the one below. `soft` carries hundreds.
        self.assertIsNone(by_solver["pairwise"]["holds"])
        self.assertEqual(by_solver["pairwise"]["fails"], about["first"])
        self.assertIn("sink/height", by_solver["pairwise"]["reason"])
        bracket = by_solver["soft"]
        self.assertGreaterEqual(bracket["holds"], 20)
        if bracket["fails"]:
            self.assertLessEqual(bracket["fails"], bracket["holds"] * about["narrow"] + 1)

    def test_a_cell_that_is_out_of_time_says_so_with_what_it_knows(self):
        self.carom("torture", "envelopes", "--rows", "tower-height", "--solver", "soft", "--precision", "float", "--limit", "0.05",
                   "--out", "out", expect=None)
        row, = json.loads((self.folder / "out/torture.json").read_text())["rows"]
        self.assertTrue(row["bracket"]["out_of_time"], row)
        self.assertEqual(row["failure"], "")
        self.assertIsNone(row["bracket"]["fails"])

    def test_rows_that_do_not_exist_are_refused(self):
        done = self.carom("torture", "hard", "--rows", "B4,hight", expect=2)
        self.assertIn("hight", done.stderr)
        self.assertEqual(self.everything(), [])


def row_of(scene, solver, precision="float", value=None, mark=1, status="ran", failure="", **more):
    row = {"case": "hard", "scene": scene, "solver": solver, "precision": precision, "measures": [], "failure": failure,
           "status": status, **more}
    if value is not None:
        row["measures"] = [{"name": "sink", "value": value, "mark": mark, "passed": value <= mark, "share": value / mark},
                           {"name": "median ms", "value": 0.25}]
    if status == "ran":
        row["passed"] = not failure and all(m.get("passed", True) for m in row["measures"])
    return row


def result_of(rows, envelopes=()):
    failed = sum(not row.get("passed", True) for row in rows)
    return {"kind": "torture", "version": "0", "isa": "scalar", "seed": 1, "limit_s": 20, "quick": False,
            "cases": [{"id": case, "title": case, "rows": len(rows), "failed": failed}
                      for case in dict.fromkeys(row["case"] for row in rows)],
            "envelopes": list(envelopes), "rows": rows}


ENVELOPE = {"name": "mass-ratio", "title": "mass over mass", "criterion": "it sinks little", "first": 10, "last": 1e9,
            "linear": False, "narrow": 1.5, "seeds": [1, 2]}


def bracket(holds, fails, reason="", out_of_time=False):
    return {"holds": holds, "fails": fails, "reason": reason, "out_of_time": out_of_time, "runs": 7}


MIXED = [row_of("B1 tower", "auto", value=1e-5), row_of("B1 tower", "auto", "double", 0.7),
         row_of("B1 tower", "soft", status="as auto"), row_of("B1 tower", "event", status="refused", failure="knows discs <only>"),
         row_of("B2 heap", "auto", value=1.5), row_of("B2 heap", "auto", "double", 5e3),
         row_of("B2 heap", "soft", value=0.05, failure="given up after 3 steps, which took 20 s"),
         row_of("B2 heap", "event", failure="crashed in step 7: Aborted")]
BRACKETS = [row_of("mass over mass", solver, case="envelopes", bracket=own)
            for solver, own in (("auto", bracket(1e9, None)), ("soft", bracket(3e4, 5e4, "sink 2 (at most 1)")),
                                ("impulse", bracket(None, 10, "sink 9 (at most 1)")), ("event", bracket(20, None, "", True)))]


class PageTest(ProgramTest):
    """The heat map of results that are known, in a browser."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.browser = Browser()

    @classmethod
    def tearDownClass(cls):
        cls.browser.close()
        super().tearDownClass()

    def page_of(self, result):
        jsonschema.validate(result, SCHEMA)
        (self.folder / "torture.json").write_text(json.dumps(result))
        self.carom("report", "torture.json", "--out", "page.html")
        self.browser.open(self.folder / "page.html")
        self.assertEqual(self.browser.console(), [])
        self.assertEqual(self.browser.run(FLAWS), [])

    def cells(self):
        """(text, class, hover) of every cell, line by line, of the first map."""
        return self.browser.run("""
            return [...document.querySelector("table.heat-map").tBodies[0].rows].map((row) =>
                [...row.querySelectorAll("td")].map((cell) => [cell.innerText.replace(/\\s+/g, " "),
                    [...cell.classList].filter((name) => /heat|struck/.test(name)).join(" "), cell.title]));
        """)

    def test_cells_have_number_mark_and_a_colour_by_their_ratio(self):
        self.page_of(result_of(MIXED))
        tower, heap = self.cells()
        head = self.browser.run("return [...document.querySelectorAll('table.heat-map thead th')].map((cell) => cell.innerText)")
        self.assertEqual(head, ["scene", "auto", "soft", "event", "float", "double", "float", "float"])
        self.assertEqual([cell[0] for cell in tower], ["1e-05 sink ≤ 1", "0.7 sink ≤ 1", "=", "–"])
        self.assertEqual([cell[1] for cell in tower], ["heat heat-0", "heat heat-4", "heat struck", "heat struck"])
        self.assertIn("knows discs <only>", tower[3][2])
        self.assertIn("median ms 0.25", tower[0][2])
        self.assertEqual([cell[0] for cell in heap][:2], ["✗ 1.5 sink ≤ 1", "✗ 5e+03 sink ≤ 1"])
        self.assertEqual([cell[1] for cell in heap], ["heat heat-5", "heat heat-8", "heat heat-8", "heat heat-8"])
        self.assertEqual(heap[2][0], "✗ 0.05 given up after 3 steps, which took 20 s")
        self.assertEqual(heap[3][0], "✗ no number crashed in step 7: Aborted")

    def test_what_fails_is_listed_below_with_its_reason_and_counted_above(self):
        self.page_of(result_of(MIXED))
        text = self.browser.run("return document.body.innerText")
        self.assertIn("4 runs fail", text)
        rows = self.browser.run("""return [...document.querySelectorAll("table.sortable")].at(-1).innerText""")
        self.assertIn("sink 1.5, ≤ 1", rows)
        self.assertIn("crashed in step 7: Aborted", rows)
        self.assertNotIn("B1 tower", rows)

    def test_a_page_without_failures_says_so(self):
        self.page_of(result_of(MIXED[:4]))
        text = self.browser.run("return document.body.innerText")
        self.assertIn("Nothing fails.", text)
        self.assertNotIn("✗ 1", text)

    def test_envelopes_show_their_brackets(self):
        self.page_of(result_of(BRACKETS, [ENVELOPE]))
        line, = self.cells()
        self.assertEqual([cell[0] for cell in line],
                         ["1e+09 as far as asked", "3e+04 not at 5e+04", "✗ none not at 10", "20 out of time"])
        self.assertEqual(line[0][1], "heat heat-0")
        self.assertEqual(line[2][1], "heat heat-8")
        self.assertIn("at 5e+04: sink 2", line[1][2])
        self.assertIn("it sinks little", self.browser.run("return document.querySelector('table.heat-map tbody th').innerText"))

    def test_maps_fit_a_phone_and_the_dark(self):
        for dark in (False, True):
            browser = Browser(width=390, height=800, dark=dark)
            try:
                (self.folder / "torture.json").write_text(json.dumps(result_of([*MIXED, *BRACKETS], [ENVELOPE])))
                self.carom("report", "torture.json", "--out", "page.html")
                browser.open(self.folder / "page.html")
                self.assertEqual(browser.console(), [])
                self.assertEqual(browser.run(FLAWS), [])
            finally:
                browser.close()


class MeasuredPageTest(ProgramTest):
    """tools/make_torture_page, and that docs/hard-cases-measured.md is what it makes of the result that is kept."""

    def test_the_page_is_made_of_the_result_that_it_names(self):
        page = (SOURCE / "docs/hard-cases-measured.md").read_text()
        source = re.search(r"tools/make_torture_page (\S+)", page).group(1)
        jsonschema.validate(json.loads((SOURCE / source).read_text()), SCHEMA)
        subprocess.run([SOURCE / "tools/make_torture_page", SOURCE / source, "--out", self.folder / "page.md"], check=True)
        self.assertEqual((self.folder / "page.md").read_text(), page)

    def test_cells_say_what_the_result_says(self):
        (self.folder / "torture.json").write_text(json.dumps(result_of([*MIXED, *BRACKETS], [ENVELOPE])))
        subprocess.run([SOURCE / "tools/make_torture_page", self.folder / "torture.json", "--out", self.folder / "page.md"], check=True)
        page = (self.folder / "page.md").read_text()
        self.assertIn("| B1 tower | 1e-05 ≤ 1 | 0.7 ≤ 1 | = | – |", page)
        self.assertIn("**✗ 5e+03 ≤ 1**", page)
        self.assertIn("| B2 heap | event | float | crashed in step 7: Aborted |", page)
        self.assertIn("3e+04, not at 5e+04", page)
        self.assertIn("1e+09, as far as asked", page)
        self.assertIn("**✗ not at 10**", page)
        self.assertIn("20, out of time", page)

    def test_quick_results_are_refused(self):
        (self.folder / "torture.json").write_text(json.dumps({**result_of(MIXED), "quick": True}))
        done = subprocess.run([SOURCE / "tools/make_torture_page", self.folder / "torture.json"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("quick", done.stderr)


if __name__ == "__main__":
    unittest.main()
