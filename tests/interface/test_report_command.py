"""`carom report`: what it draws, where to, and what it refuses."""
import unittest

from program import SEED, ProgramTest


class ReportCommandTest(ProgramTest):
    def test_a_run_is_drawn_into_its_own_folder_or_where_it_is_asked_for(self):
        self.run_scene(SEED, "--steps", 20)
        self.assertIn("out/report.html", self.carom("report", "out").stdout)
        self.carom("report", "out/summary.json", "--out", "page.html")
        page = (self.folder / "page.html").read_text()
        self.assertIn("<title>seed</title>", page)
        self.assertNotIn("page.html.part", self.everything())

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

    def test_a_page_that_cannot_be_written_is_an_error_with_its_reason(self):
        self.run_scene(SEED, "--steps", 2)
        done = self.carom("report", "out", "--out", "missing/page.html", expect=3)
        self.assertIn("missing/page.html", done.stderr)
        self.assertIn("No such file", done.stderr)
        self.assertNotIn("removed", done.stderr)


if __name__ == "__main__":
    unittest.main()
