"""docs/performance.md says what the kept results say, and the script that makes it reads them rightly."""
import copy
import importlib.machinery
import importlib.util
import re
import unittest

from program import SOURCE

loader = importlib.machinery.SourceFileLoader("make_performance_page", str(SOURCE / "tools/make_performance_page"))
make = importlib.util.module_from_spec(importlib.util.spec_from_loader("make_performance_page", loader))
loader.exec_module(make)

PAGE = (SOURCE / "docs/performance.md").read_text()
FOLDER = SOURCE / re.search(r"`tools/make_performance_page ([^`]+)`", PAGE).group(1)


class PerformancePageTest(unittest.TestCase):
    def setUp(self):
        self.results = make.Results(FOLDER)

    def test_the_page_is_what_the_command_on_it_makes(self):
        self.assertEqual(PAGE, make.page(self.results))
        self.assertEqual((SOURCE / "docs" / make.CHART).read_text(), make.chart(self.results))

    def test_the_folder_is_named_after_its_date_and_machine(self):
        self.assertTrue(FOLDER.name.startswith(self.results.parts["scaling"]["date"]))
        self.assertIn(f"{self.results.machine['cores']}-cores", FOLDER.name)

    def test_every_bar_can_fail(self):
        results = copy.deepcopy(self.results)
        for scene in results.parts["peers"]["scenes"]:
            for row in scene["engines"]:
                if "ratio_to_ours" in row:
                    row["ratio_to_ours"] = {"median": 1, "low": 1, "high": 1}
                    row["ns_per_body"]["median"] *= scene["bodies"]
                    row["measures"].update(overlap_mean=1, overlap_max=1)
        for row in results.parts["scaling"]["rows"]:
            row["ns_per_body"]["median"] *= row["bodies"]
        for crossover in results.parts["scaling"]["crossovers"]:
            crossover["ratio"]["median"] = 1
            crossover.update(bodies={"median": 500, "low": 400, "high": 600})
        for row in results.parts["kernels"]["rows"]:
            row["times_scalar"] = 1
        for run in results.parts["stages"]["benchmarks"]:
            run["measuring"] = 0.5
        held = {what: holds for what, _, holds in make.bars(results)}
        self.assertEqual([what for what, holds in held.items() if holds], [])
        self.assertEqual(list(held), [what for what, _, _ in make.bars(self.results)])

    def test_a_scene_that_another_machine_ran_says_which(self):
        results = copy.deepcopy(self.results)
        scene = results.parts["peers"]["scenes"][-1]
        scene["machine"] = scene["machine"] | {"processor": "Another"}
        scene["date"] = "2000-01-02"
        lines = [line for line in make.page(results).splitlines() if "Another" in line]
        place = r", on Another with a last cache of \d+ MiB, 2000-01-02"
        self.assertEqual(len(lines), 2)  # its bar and its table
        self.assertRegex(lines[0], rf"^\| {scene['scene']} .* times faster than Box2D 3 \| .*{place} \|")
        self.assertRegex(lines[1], rf"^{scene['scene']}, .* steps{place}:$")

    def test_ratios_on_the_page_are_those_of_the_rounds(self):
        for scene in self.results.parts["peers"]["scenes"]:
            ours = scene["engines"][0]
            if "rounds" not in ours:
                continue
            for row in scene["engines"]:
                if "rounds" in row:
                    ratios = sorted(a / b for a, b in zip(row["rounds"], ours["rounds"]))
                    self.assertAlmostEqual(row["ratio_to_ours"]["median"], ratios[len(ratios) // 2], places=9)

    def test_a_kernel_below_a_third_of_the_roof_has_its_reason(self):
        for row in make.l1_rows(self.results, "avx2"):
            if row["roof_share"] < make.LOW_SHARE:
                self.assertGreater(len(self.results.parts["kernels"]["reasons"][row["kernel"]]), 20, row["kernel"])

    def test_numbers_are_written_without_exponents(self):
        self.assertEqual([make.number(value) for value in (0, 2.636e-6, 0.01234, 3.14159, 123.4, 12345, 1e6)],
                         ["0", "0.00000264", "0.0123", "3.14", "123", "12,300", "1,000,000"])


if __name__ == "__main__":
    unittest.main()
