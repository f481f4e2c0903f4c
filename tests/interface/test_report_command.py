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

    def test_a_trajectory_that_was_changed_is_refused_whatever_the_byte(self):
        self.run_scene(SEED, "--steps", 3)
        path = self.folder / "out/trajectory.h5"
        whole = path.read_bytes()
        for place in range(0, len(whole), max(1, len(whole) // 40)):
            changed = bytearray(whole)
            changed[place] ^= 0x10
            path.write_bytes(changed)
            self.assertIn("out/trajectory.h5: is not the file that the run wrote", self.carom("report", "out", expect=2).stderr)
        path.write_bytes(whole)
        self.carom("report", "out")

    def test_a_trajectory_of_another_making_is_refused_where_it_is_no_trajectory(self):
        def without_sizes(file):
            del file["radius"]
            file["radius"] = [0.5]

        def of_one_number_a_body(file):
            del file["position"]
            file["position"] = [[[1.0]] * 5] * 4

        def of_four_dimensions(file):
            del file["velocity"]
            file["velocity"] = [[[[1.0] * 2] * 5] * 4]

        def beyond_all_memory(file):
            del file["position"]
            file.create_dataset("position", (2**40, 2**20, 2), "f4", chunks=(1, 1024, 2))

        def shapes_without_vertices(file):
            file["shape"] = [0.0] * 5
            file.attrs["settings"] = json.dumps({"shapes": [{"radius": 1}]})

        def edges_of_words(file):
            file.attrs["settings"] = json.dumps({"edges": [{"body": "x", "points": [], "loop": True}]})

        def joints_of_nothing(file):
            file.attrs["settings"] = json.dumps({"joints": [[]]})

        for change in (without_sizes, of_one_number_a_body, of_four_dimensions, beyond_all_memory, shapes_without_vertices,
                       edges_of_words, joints_of_nothing):
            with self.subTest(change.__name__):
                self.run_scene(SEED, "--steps", 3)
                summary = json.loads((self.folder / "out/summary.json").read_text())
                self.assertEqual(summary.pop("checksums")["trajectory.h5"]["bytes"], (self.folder / "out/trajectory.h5").stat().st_size)
                (self.folder / "out/summary.json").write_text(json.dumps(summary))
                with h5py.File(self.folder / "out/trajectory.h5", "r+") as file:
                    change(file)
                self.assertIn("out/trajectory.h5: ", self.carom("report", "out", expect=2).stderr)

    def test_a_ledger_without_times_and_json_that_is_too_deep_are_refused(self):
        self.run_scene(SEED, "--steps", 3)
        (self.folder / "out/ledger.csv").write_text("kinetic,gravity\n1,2\n")
        self.assertIn('out/ledger.csv: has no column "time"', self.carom("report", "out", expect=2).stderr)
        (self.folder / "deep.json").write_text('{"kind": "run", "bodies": ' + "[" * 100000 + "]" * 100000 + "}")
        self.assertIn("nested more than 64 deep", self.carom("report", "deep.json", "--out", "page.html", expect=2).stderr)

    def test_a_page_that_cannot_be_written_is_an_error_with_its_reason(self):
        self.run_scene(SEED, "--steps", 2)
        done = self.carom("report", "out", "--out", "missing/page.html", expect=3)
        self.assertIn("missing/page.html", done.stderr)
        self.assertIn("No such file", done.stderr)
        self.assertNotIn("removed", done.stderr)


if __name__ == "__main__":
    unittest.main()
