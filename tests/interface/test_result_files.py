"""Every result file of `carom run`, read back and held against the others."""
import json
import struct
import unittest

import h5py
import numpy

from program import ALL_FILES, SEED, ProgramTest, gas, scaled

SUMMARY_KEYS = {
    "scene", "version", "bodies", "joints", "steps", "dt", "time", "solver", "substeps", "iterations", "precision",
    "isa", "threads", "effects", "stages", "wall", "energy", "momentum", "angular_momentum", "contacts",
    "joints_error", "quarantined", "state_hash",
}
LEDGER_COLUMNS = [
    "time", "kinetic", "rotational", "potential", "total", "px", "py", "L",
    "gravity", "drag", "restitution", "friction", "correction", "joints", "drive", "unexplained",
]
CAUSES = LEDGER_COLUMNS[8:] + ["sleep", "outside"]


def final_column(results, name, dtype=numpy.float64):
    return numpy.array([float(row[name]) for row in results.final], dtype=dtype)


class SummaryTest(ProgramTest):
    def test_summary_has_every_key_of_the_format_and_its_types(self):
        summary = self.run_scene(SEED).summary
        self.assertEqual(SUMMARY_KEYS - set(summary), set())
        self.assertEqual((summary["scene"], summary["bodies"], summary["joints"]), ("seed", 5, 0))
        self.assertEqual((summary["steps"], summary["dt"]), (500, 0.016))
        self.assertAlmostEqual(summary["time"], 8, places=9)
        self.assertEqual(set(summary["wall"]) & {"total_s", "ms_per_step", "ns_per_body_step"},
                         {"total_s", "ms_per_step", "ns_per_body_step"})
        for moment in ("initial", "final"):
            energy = summary["energy"][moment]
            self.assertEqual(set(energy), {"kinetic", "rotational", "potential", "total"})
            self.assertAlmostEqual(energy["total"], energy["kinetic"] + energy["rotational"] + energy["potential"])
            self.assertEqual(len(summary["momentum"][moment]), 2)
            self.assertIsInstance(summary["angular_momentum"][moment], float)
        self.assertEqual(set(summary["contacts"]), {"count", "touching", "overlap_mean", "overlap_max"})
        self.assertEqual(summary["joints_error"], {"mean": 0, "max": 0})
        self.assertEqual(summary["quarantined"], [])
        self.assertRegex(summary["state_hash"], "^[0-9a-f]{16}$")
        self.assertEqual(summary["interrupted"], False)
        self.assertIn("ledger", summary["effects"])
        for stage in summary["stages"]:
            self.assertEqual(set(stage), {"name", "calls", "seconds"})

    def test_options_override_the_scene_and_the_summary_says_so(self):
        summary = self.run_scene(SEED, "--steps", 7, "--dt", 0.01, "--precision", "double", "--threads", 1,
                                 "--isa", "scalar", "--solver", "impulse", "--substeps", 2).summary
        wanted = {"steps": 7, "dt": 0.01, "precision": "double", "threads": 1, "isa": "scalar",
                  "solver": "impulse", "substeps": 2}
        self.assertEqual({key: summary[key] for key in wanted}, wanted)
        self.assertAlmostEqual(summary["time"], 0.07)

    def test_files_written_are_those_the_summary_names(self):
        for options, left_out in (([], set()), (["--no-trajectory"], {"trajectory.h5"}),
                                  (["--effects", "-ledger"], {"ledger.csv"}), (["--no-report"], {"report.html"})):
            results = self.run_scene(SEED, *options, "--steps", 3)  # the same folder: earlier files must go
            self.assertEqual(self.files_in("out"), ALL_FILES - left_out)
            self.assertEqual(set(results.summary["files"]), ALL_FILES - left_out)

    def test_run_without_out_writes_to_a_folder_of_the_scenes_name(self):
        self.carom("run", SEED, "--steps", 1)
        self.assertEqual(self.files_in("out/seed"), ALL_FILES)
        self.carom("run", self.write_scene(gas(2, name="../../a b/ü", steps=1)))
        self.assertEqual(sorted(path for path in self.everything() if path.count("/") == 1),
                         ["out/_.._.._a b___", "out/seed"])

    def test_scene_without_a_name_is_called_after_its_file(self):
        scene = gas(2, steps=1)
        del scene["name"]
        self.carom("run", self.write_scene(scene, "some gas.json"))
        self.assertEqual(self.files_in("out/some gas"), ALL_FILES)


class EventsTest(ProgramTest):
    def test_a_joint_that_breaks_is_told_by_every_file_and_drawn_until_then(self):
        bodies = [{"shape": {"disc": {"radius": 0.1}}, "position": [x, -1], "mass": 1} for x in (0, 1)]
        joints = [{"distance": {"a": None, "anchor_a": [x, 0], "b": body, "break_force": limit}}
                  for body, (x, limit) in enumerate(((0, 1000), (1, 9)))]
        scene = {"carom": 1, "name": "break", "gravity": [0, -10], "bodies": bodies, "joints": joints,
                 "step": {"dt": 0.01, "count": 5}}
        results = self.run_scene(self.write_scene(scene), "--events")
        (broken,) = results.summary["joints_broken"]
        self.assertEqual((broken["joint"], broken["time"]), (1, 0.01))
        self.assertAlmostEqual(broken["force"][1], 10, places=3)
        lines = (self.folder / "out/events.csv").read_text().splitlines()
        self.assertEqual(lines[0], "time,kind,a,b,x,y,nx,ny,speed,impulse,joint")
        (row,) = [line.split(",") for line in lines[1:]]
        self.assertEqual(row[:4] + row[10:], ["0.01", "break", "", "1", "1"])
        self.assertAlmostEqual(float(row[9]), 0.1, places=4)
        with h5py.File(self.folder / "out/trajectory.h5") as trajectory:
            self.assertEqual(json.loads(trajectory.attrs["breaks"]), [[1, 0.01]])
        page = (self.folder / "out/report.html").read_text()
        data = json.loads(page.split('id="player-data">')[1].split("</script>")[0])
        self.assertEqual([joint[6:] for joint in data["joints"]], [[], [0.01]])
        self.run_scene(self.write_scene(scene))
        self.assertFalse((self.folder / "out/events.csv").exists())


class FinalTest(ProgramTest):
    def check_final_against_trajectory(self, results, dtype):
        frames = results.trajectory()
        for axis, position, velocity in ((0, "x", "vx"), (1, "y", "vy")):
            numpy.testing.assert_array_equal(final_column(results, position, dtype), frames["position"][-1, :, axis])
            numpy.testing.assert_array_equal(final_column(results, velocity, dtype), frames["velocity"][-1, :, axis])
        numpy.testing.assert_array_equal(final_column(results, "angle", dtype), frames["angle"][-1])

    def test_final_state_has_the_bits_of_the_last_frame(self):
        for solver, precision, dtype in (("impulse", "float", numpy.float32), ("impulse", "double", numpy.float64),
                                         ("pairwise", "double", numpy.float64)):
            with self.subTest(solver=solver, precision=precision):
                results = self.run_scene(gas(5, solver=solver, precision=precision))
                self.assertEqual(results.summary["precision"], precision)
                self.assertEqual(results.trajectory()["position"].dtype, dtype)
                self.check_final_against_trajectory(results, dtype)

    def test_single_precision_state_is_written_exactly(self):
        for row in self.run_scene(gas(5), "--precision", "float").final:
            for column in ("x", "y", "vx", "vy", "angle", "omega"):
                value = float(row[column])
                self.assertEqual(struct.unpack("f", struct.pack("f", value))[0], value)

    def test_bodies_come_in_scene_order_with_their_names(self):
        scene = gas(3)
        names = ["plain", 'a "quoted" one', "with, comma", "two\nlines", "ü", "", "=1+1", "'", " "]
        for body, name in zip(scene["bodies"], names):
            if name:
                body["name"] = name
        results = self.run_scene(scene, "--steps", 0)
        self.assertEqual([row["id"] for row in results.final], [str(i) for i in range(9)])
        self.assertEqual([row["name"] for row in results.final], names)
        self.assertEqual(list(results.final[0]), ["id", "name", "x", "y", "angle", "vx", "vy", "omega"])
        numpy.testing.assert_array_equal(
            final_column(results, "x", numpy.float32),
            numpy.array([body["position"][0] for body in scene["bodies"]], dtype=numpy.float32))


class LedgerTest(ProgramTest):
    def test_ledger_has_one_row_a_step_and_the_columns_in_order(self):
        results = self.run_scene(SEED)
        with open(results.folder / "ledger.csv") as file:
            header = file.readline().strip().split(",")
        self.assertEqual(header[:len(LEDGER_COLUMNS)], LEDGER_COLUMNS)
        ledger = results.ledger()
        self.assertEqual(len(ledger["time"]), 500)
        numpy.testing.assert_allclose(ledger["time"], 0.016 * numpy.arange(1, 501), rtol=1e-12)

    def test_causes_add_up_to_the_change_of_kinetic_energy(self):
        for solver, precision in (("impulse", "float"), ("impulse", "double"), ("pairwise", "double")):
            with self.subTest(solver=solver, precision=precision):
                results = self.run_scene(SEED, "--solver", solver,
                                         *([] if solver == "pairwise" else ["--precision", precision]))
                ledger, start = results.ledger(), results.summary["energy"]["initial"]
                moving = ledger["kinetic"] + ledger["rotational"] - start["kinetic"] - start["rotational"]
                scale = start["kinetic"] + abs(start["potential"])
                numpy.testing.assert_allclose(sum(ledger[cause] for cause in CAUSES), moving, atol=1e-12 * scale)
                numpy.testing.assert_allclose(ledger["gravity"], start["potential"] - ledger["potential"],
                                              atol=(1e-5 if precision == "float" else 1e-12) * scale)
                numpy.testing.assert_allclose(
                    ledger["total"], ledger["kinetic"] + ledger["rotational"] + ledger["potential"], rtol=1e-14)

    def test_what_the_engine_cannot_explain_is_small(self):
        for precision, bound in (("float", 1e-5), ("double", 1e-12)):
            results = self.run_scene(SEED, "--precision", precision)
            scale = results.summary["energy"]["initial"]["total"]
            self.assertLess(abs(results.ledger()["unexplained"]).max(), bound * scale, precision)

    def test_momentum_by_cause_adds_up(self):
        results = self.run_scene(SEED, "--precision", "double")
        ledger, start = results.ledger(), results.summary["momentum"]["initial"]
        for axis in (0, 1):
            name = "px" if axis == 0 else "py"
            causes = sum(ledger[f"{name}_{cause}"] for cause in ("gravity", "drag", "walls", "immovable", "sleep", "outside", "unexplained"))
            numpy.testing.assert_allclose(causes, ledger[name] - start[axis], atol=1e-10)

    def test_last_row_is_what_the_summary_says(self):
        results = self.run_scene(SEED)
        ledger, summary = results.ledger(), results.summary
        for column in ("kinetic", "rotational", "potential", "total"):
            self.assertEqual(ledger[column][-1], summary["energy"]["final"][column])
            self.assertEqual(ledger[column][0], summary["energy"]["after_first_step"][column])
        self.assertEqual([ledger["px"][-1], ledger["py"][-1]], summary["momentum"]["final"])
        self.assertEqual(ledger["L"][-1], summary["angular_momentum"]["final"])
        for cause in CAUSES:
            self.assertEqual(ledger[cause][-1], summary["energy_by_cause"][cause])

    def test_energy_that_no_law_gives_is_told(self):
        # A rod of 1 m that begins 1.5 m long draws 2 kg up by .5 m, by displacement alone, where nothing overlaps: 10 J.
        scene = {"carom": 1, "gravity": [0, -10], "step": {"dt": 1 / 60, "count": 120},
                 "bodies": [{"name": "bob", "shape": {"disc": {"radius": 0.1}}, "mass": 2, "position": [0, -1.5]}],
                 "joints": [{"distance": {"b": "bob", "anchor_a": [0, 0], "anchor_b": [0, 0], "length": 1}}]}
        excess = self.run_scene(scene).summary["energy_excess"]
        self.assertAlmostEqual(excess["correction"], 10, delta=0.01)
        self.assertAlmostEqual(excess["passive"], 10, delta=0.01)
        self.assertEqual(excess["restitution"], 0)
        line = "energy beyond its laws and rounding, at most: 10 J by correction in a step, 10 J above what nothing drives began with"
        self.assertIn(line, self.carom("run", self.write_scene(scene), "--out", "again").stdout)
        scene["bodies"][0]["position"] = [0, -1]
        self.assertEqual(set(self.run_scene(scene).summary["energy_excess"].values()), {0})
        self.assertNotIn("beyond", self.carom("run", self.write_scene(scene), "--out", "again").stdout)
        self.assertNotIn("energy_excess", self.run_scene(SEED, "--solver", "pairwise").summary)

    def test_energy_and_momentum_are_those_of_the_final_state(self):
        for solver in ("impulse", "pairwise"):
            results = self.run_scene(SEED, "--solver", solver)
            mass, summary = results.trajectory()["mass"], results.summary
            vx, vy = final_column(results, "vx"), final_column(results, "vy")
            kinetic = 0.5 * numpy.sum(mass * (vx * vx + vy * vy))
            potential = 4 * numpy.sum(mass * final_column(results, "y"))
            self.assertAlmostEqual(kinetic, summary["energy"]["final"]["kinetic"], delta=1e-6 * (1 + kinetic))
            self.assertAlmostEqual(potential, summary["energy"]["final"]["potential"], delta=1e-6 * potential)
            numpy.testing.assert_allclose([numpy.sum(mass * vx), numpy.sum(mass * vy)],
                                          summary["momentum"]["final"], atol=1e-5)


class TrajectoryTest(ProgramTest):
    def test_datasets_have_the_shapes_and_units_of_the_format(self):
        results = self.run_scene(gas(3, steps=20))
        with h5py.File(results.folder / "trajectory.h5", "r") as file:
            shapes = {"time": (21,), "position": (21, 9, 2), "velocity": (21, 9, 2), "angle": (21, 9)}
            units = {"time": "s", "position": "m", "velocity": "m/s", "angle": "rad", "radius": "m", "mass": "kg"}
            self.assertEqual({name: file[name].shape for name in shapes}, shapes)
            self.assertEqual({name: file[name].attrs["units"] for name in units}, units)
            for name in shapes:
                self.assertIsNotNone(file[name].chunks)
                self.assertEqual((file[name].compression, file[name].shuffle), ("gzip", True))

    def test_root_carries_scene_text_and_settings(self):
        results = self.run_scene(SEED, "--steps", 3, "--solver", "pairwise")
        with h5py.File(results.folder / "trajectory.h5", "r") as file:
            self.assertEqual(file.attrs["scene"], SEED.read_text())
            settings = json.loads(file.attrs["settings"])
        self.assertEqual((settings["solver"], settings["steps"], settings["dt"]), ("pairwise", 3, 0.016))

    def test_settings_have_the_points_of_segments_and_chains(self):
        scene = {"carom": 1, "bodies": [
            {"shape": {"disc": {"radius": 0.5}}},
            {"type": "static", "position": [0, -1], "shape": {"segment": {"a": [-1, 0], "b": [1, 0.5]}}},
            {"type": "static", "shape": {"chain": {"points": [[-9, -9], [9, -9], [0, 9]], "loop": True}}}]}
        results = self.run_scene(scene, "--steps", 1)
        with h5py.File(results.folder / "trajectory.h5", "r") as file:
            edges = json.loads(file.attrs["settings"])["edges"]
            self.assertEqual(list(file["radius"][:]), [0.5, 0, 0])
        self.assertEqual(edges, [{"body": 1, "points": [[-1, 0], [1, 0.5]], "loop": False},
                                 {"body": 2, "points": [[-9, -9], [9, -9], [0, 9]], "loop": True}])

    def test_long_scene_text_is_kept_whole(self):
        path = self.write_scene(json.dumps(gas(scaled(40, 8), steps=1)) + " " * 3_000_000)
        results = self.run_scene(path)
        with h5py.File(results.folder / "trajectory.h5", "r") as file:
            self.assertEqual(file.attrs["scene"], path.read_text())

    def test_first_frame_is_the_start_and_times_are_those_of_the_steps(self):
        scene = gas(4, steps=30)
        frames = self.run_scene(scene, "--precision", "double").trajectory()
        numpy.testing.assert_array_equal(frames["position"][0], [body["position"] for body in scene["bodies"]])
        numpy.testing.assert_array_equal(frames["velocity"][0], [body["velocity"] for body in scene["bodies"]])
        numpy.testing.assert_allclose(frames["time"], numpy.arange(31) / 60, rtol=1e-12)

    def test_every_nth_step_is_a_frame_and_the_last_step_always(self):
        for every, steps, frames in ((1, 10, 11), (3, 10, [0, 3, 6, 9, 10]), (5, 10, [0, 5, 10]), (99, 10, [0, 10]),
                                     (7, 0, [0])):
            expected = numpy.arange(11) if frames == 11 else numpy.array(frames)
            results = self.run_scene(gas(2, steps=steps, every=every))
            numpy.testing.assert_allclose(results.trajectory()["time"] * 60, expected, atol=1e-9)

    def test_frames_survive_blocks_and_chunks_of_every_shape(self):
        # Frames of a run of n steps are the first n + 1 of a longer one: whatever the blocks, the same numbers.
        for side in (1, 7, 70):
            long = self.run_scene(gas(side, steps=40), "--no-report", out="long").trajectory()
            for steps in (0, 1, 13):
                short = self.run_scene(gas(side, steps=steps), "--no-report", out="short").trajectory()
                for name in ("time", "position", "velocity", "angle"):
                    numpy.testing.assert_array_equal(short[name], long[name][:steps + 1])

    def test_more_bodies_than_a_chunk_holds_are_recorded_whole(self):
        scene = gas(2, steps=2)
        scene["bodies"] = []
        scene["walls"] = {"min": [0, 0], "max": [700, 700]}
        scene["generate"] = [{"lattice": {"count": [300, 300], "origin": [1, 1], "spacing": [2, 2], "velocity_rms": 1,
                                          "seed": 1, "shape": {"disc": {"radius": 0.5}}}}]
        results = self.run_scene(scene)
        frames = results.trajectory()
        self.assertEqual(frames["position"].shape, (3, 90000, 2))
        numpy.testing.assert_array_equal(frames["position"][0, :301:300], [[1, 1], [1, 3]])
        numpy.testing.assert_array_equal(frames["position"][0, -1], [599, 599])
        numpy.testing.assert_array_equal(final_column(results, "x", numpy.float32), frames["position"][-1, :, 0])
        numpy.testing.assert_allclose(frames["position"][1], frames["position"][0] + frames["velocity"][0] / 60,
                                      atol=1e-3)

    def test_empty_world_has_empty_frames(self):
        scene = gas(1, steps=4)
        scene["bodies"] = []
        frames = self.run_scene(scene).trajectory()
        self.assertEqual(frames["position"].shape, (5, 0, 2))
        self.assertEqual(len(frames["time"]), 5)


if __name__ == "__main__":
    unittest.main()
