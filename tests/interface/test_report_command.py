"""`carom report`: what it draws, where to, and what it refuses."""
import json
import unittest

import h5py

from program import SEED, ProgramTest


class ReportCommandTest(ProgramTest):
    def test_a_run_is_drawn_into_its_own_folder_or_where_it_is_asked_for(self):
        self.run_scene(SEED, "--steps", 20)
        self.assertIn("out/report.html", self.carom("report", "out").stdout)
        self.carom("report", "out/summary.json", "--out", "page.html")
        page = (self.folder / "page.html").read_text()
        self.assertIn("<title>seed</title>", page)
        self.assertNotIn("page.html.part", self.everything())
        two = self.carom("report", "out", "out/summary.json", "--out", "two.html", expect=2)
        self.assertIn("out/summary.json: is a second run", two.stderr)

    def test_what_cannot_be_drawn_is_refused_and_nothing_is_written(self):
        (self.folder / "other.json").write_text('{"kind": "soup"}')
        (self.folder / "empty").mkdir()
        before = self.everything()
        for arguments, message in ((["other.json", "--out", "page.html"], 'other.json: has the kind "soup"'),
                                   (["empty"], "empty/summary.json: cannot be read"),
                                   (["missing.json", "--out", "page.html"], "missing.json: cannot be read"),
                                   (["other.json"], "--out: say where"),
                                   ([], "files is required")):
            done = self.carom("report", *arguments, expect=2)
            self.assertIn(message, done.stderr)
            self.assertEqual(self.everything(), before)

    def test_result_files_that_were_damaged_are_refused_by_name(self):
        def damage_csv(folder):
            (folder / "final.csv").unlink()

        def damage_trajectory(folder):
            (folder / "trajectory.h5").write_bytes((folder / "trajectory.h5").read_bytes()[:3000])

        def shorten_column(folder):
            with h5py.File(folder / "trajectory.h5", "r+") as file:
                del file["radius"]
                file["radius"] = [0.5]

        def damage_summary(folder):
            summary = json.loads((folder / "summary.json").read_text())
            summary["files"] = "all"
            del summary["energy"]["final"]["kinetic"]
            (folder / "summary.json").write_text(json.dumps(summary))

        for damage, name in ((damage_csv, "final.csv"), (damage_trajectory, "trajectory.h5"), (shorten_column, "trajectory.h5"),
                             (damage_summary, "summary.json")):
            self.run_scene(SEED, "--steps", 5)
            (self.folder / "out/report.html").unlink()
            damage(self.folder / "out")
            done = self.carom("report", "out", expect=2)
            self.assertIn("out/" + name, done.stderr)
            self.assertEqual([path for path in self.everything() if "report.html" in path], [])

    def test_a_page_that_cannot_be_written_is_an_error_with_its_reason(self):
        self.run_scene(SEED, "--steps", 2)
        done = self.carom("report", "out", "--out", "missing/page.html", expect=3)
        self.assertIn("missing/page.html", done.stderr)
        self.assertIn("No such file", done.stderr)
        self.assertNotIn("removed", done.stderr)


if __name__ == "__main__":
    unittest.main()
