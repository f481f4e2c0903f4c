"""carom accuracy: its files, what they say, that it goes on where it was interrupted; docs/accuracy.md."""
import csv
import importlib.machinery
import importlib.util
import json
import re
import signal
import subprocess
import time
import unittest

import jsonschema

from program import PROGRAM, SOURCE, ProgramTest

SCHEMA = json.loads((SOURCE / "docs/accuracy.schema.json").read_text())
PAGE = (SOURCE / "docs/accuracy.md").read_text()

loader = importlib.machinery.SourceFileLoader("make_accuracy_page", str(SOURCE / "tools/make_accuracy_page"))
make = importlib.util.module_from_spec(importlib.util.spec_from_loader("make_accuracy_page", loader))
loader.exec_module(make)


class AccuracyCommandTest(ProgramTest):
    def measure(self, *arguments):
        self.carom("accuracy", "--quick", "--out", "results", *arguments)
        return json.loads((self.folder / "results/accuracy.json").read_text())

    def test_results_are_as_the_schema_says_and_say_what_physics_says(self):
        result = self.measure("A1", "A13-rough", "A17")
        jsonschema.validate(result, SCHEMA)
        self.assertEqual([case["id"] for case in result["cases"]], ["A1", "A13-rough", "A17"])
        fall, rough, _ = result["cases"]
        others = {engine["name"] for engine in result["engines"]}
        self.assertEqual(len(others) + len(result["missing_engines"]), 3)
        self.assertEqual({point["solver"] for point in fall["points"]}, {"event", "impulse", "soft", "pairwise"} | others)
        for point in fall["points"]:
            error = point["errors"][0]["value"]
            if point["solver"] in ("pairwise", "Chipmunk"):  # symplectic Euler: g h t / 2 over g t² / 2 is h / t
                self.assertAlmostEqual(error / (point["dt"] / 2), 1, delta=1e-6)
            elif point["solver"] in others:  # likewise, rounded to single precision substep by substep
                self.assertAlmostEqual(error, point["dt"] / point["substeps"] / 2, delta=4e-4, msg=point)
            else:
                self.assertLess(error, 1e-12 if point["precision"] == "double" else 1e-3, point)
        order = next(fit for fit in fall["orders"] if fit["solver"] == "pairwise")
        self.assertAlmostEqual(order["order"], 1, delta=1e-3)
        exact = [p for p in rough["points"] if (p["solver"], p["precision"]) == ("event", "double")]
        self.assertLess(exact[0]["errors"][0]["value"], 1e-13)  # coordinates are up to 300 radii
        self.assertEqual(self.files_in("results"), {"accuracy.json", "accuracy.csv", "report.html"})

    def test_the_csv_has_the_same_numbers(self):
        case = self.measure("A18")["cases"][0]
        with open(self.folder / "results/accuracy.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([float(row["value"]) for row in rows], [p["errors"][0]["value"] for p in case["points"]])
        self.assertEqual([float(row["seconds"]) for row in rows], [p["seconds"]["value"] for p in case["points"]])

    def test_times_to_reach_and_the_frontier_follow_from_the_points(self):
        case = self.measure("A4")["cases"][0]
        points = case["points"]
        for reach in case["time_to_reach"]:
            times = [p["seconds"]["value"] for p in points if p["failure"] is None
                     and (p["solver"], p["precision"]) == (reach["solver"], reach["precision"])
                     and p["errors"][0]["value"] <= reach["target"]]
            self.assertEqual(reach["seconds"], min(times, default=None))
        for point in points:
            better = any(q["seconds"]["value"] < point["seconds"]["value"]
                         and q["errors"][0]["value"] <= point["errors"][0]["value"] for q in points)
            self.assertEqual(point["on_frontier"], not better)

    def test_sources_of_error_are_told_apart_where_there_is_a_residual(self):
        case = self.measure("A26")["cases"][0]
        self.assertTrue({("soft", "float"), ("soft", "double")} <= {(s["solver"], s["precision"]) for s in case["sources"]})
        for source in case["sources"]:
            most = max(part["substeps"] * part["iterations"] for part in source["residual"])
            self.assertEqual({part["substeps"] * part["iterations"] for part in source["step"]}, {most})
            self.assertEqual([part["dt"] for part in source["step"]], [1 / 30, 1 / 240, 1 / 960])
            self.assertEqual({part["dt"] for part in source["residual"]}, {1 / 240})
            if source["solver"] == "soft":  # what is left is round-off: 4e-6 of a radius in float at 9.5 m height
                self.assertLess(source["step"][-1]["error"], 1e-5 if source["precision"] == "float" else 1e-11)

    def test_charts_have_one_colour_a_solver_and_a_line_a_sweep(self):
        case = self.measure("A4")["cases"][0]
        page = (self.folder / "results/report.html").read_text()
        charts = [json.loads(text) for text in re.findall(r'id="data-A4-[^"]*">(.*?)</script>', page, re.DOTALL)]
        self.assertEqual(len(charts), 5)
        colours = {}
        for series in (series for chart in charts for series in chart["series"]):
            solver = re.split("[,:]", series["name"])[0]
            self.assertEqual(colours.setdefault(solver, series["colour"]), series["colour"], solver)
        solvers = {point["solver"] for point in case["points"]}
        self.assertEqual(len({colours[solver] for solver in solvers}), len(solvers))
        by_time = next(chart for chart in charts if chart["x_label"].startswith("time"))
        soft = next(series for series in by_time["series"] if series["name"] == "soft, double")
        shown = [y for y in soft["y"] if y is not None]
        self.assertEqual(len(shown), sum((p["solver"], p["precision"]) == ("soft", "double") for p in case["points"]))
        self.assertIn(None, soft["y"])  # the step's sweep, then that of substeps: no line joins them

    def test_an_interrupted_run_goes_on_where_it_was(self):
        command = [PROGRAM, "accuracy", "--quick", "--out", "results", "A1", "A2", "A4", "A5", "A20"]
        run = subprocess.Popen(command, cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        kept = self.folder / "results/points.jsonl"
        while run.poll() is None and (not kept.exists() or kept.read_text().count("\n") < 10):
            time.sleep(0.01)
        run.send_signal(signal.SIGINT)
        self.assertEqual(run.wait(timeout=60), 0)
        self.assertEqual(self.files_in("results"), {"points.jsonl"})
        with open(kept, "a") as file:
            file.write('{"key": "half a li')  # as a killed run leaves it
        first = json.loads(kept.read_text().splitlines()[1])["point"]
        result = self.measure("A1")
        self.assertIn(first["seconds"], [point["seconds"] for point in result["cases"][0]["points"]])
        self.assertNotIn("points.jsonl", self.files_in("results"))

    def test_a_case_that_there_is_not_is_refused_with_the_nearest(self):
        self.assertIn("A13", self.carom("accuracy", "A113", expect=2).stderr)
        self.assertIsNone(self.files_in("results"))


class AccuracyPageTest(unittest.TestCase):
    def test_the_page_and_its_pictures_are_what_the_command_on_it_makes(self):
        source = re.search(r"tools/make_accuracy_page (\S+)", PAGE).group(1)
        result = json.loads((SOURCE / source).read_text())
        jsonschema.validate(result, SCHEMA)
        self.assertEqual(PAGE, make.page(result, source))
        for case in result["cases"]:
            picture = SOURCE / "docs/pictures" / make.picture_name(case)
            self.assertEqual(picture.read_text(), make.picture(case), picture.name)


if __name__ == "__main__":
    unittest.main()
