"""What the tests of the command line share: starting the program, scenes, reading result files."""
import csv
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

import h5py
import numpy

SOURCE = pathlib.Path(os.environ.get("CAROM_SOURCE_DIR", pathlib.Path(__file__).parents[2]))
PROGRAM = os.environ.get("CAROM_PROGRAM", str(SOURCE / "build/release/bin/carom"))
SEED = SOURCE / "docs/scenes/seed.json"
IS_EFFORT_REDUCED = os.environ.get("CAROM_TEST_EFFORT") == "reduced"
ALL_FILES = {"summary.json", "final.csv", "ledger.csv", "trajectory.h5", "report.html"}


def scaled(full, reduced):
    """How much of something a test does: all of it, or less where the program steps at a fraction of its speed."""
    return reduced if IS_EFFORT_REDUCED else full


def gas(side, *, name="gas", steps=50, every=1, precision="float", solver="auto", speed=3.0, **more):
    """A scene of side * side discs on a lattice in a closed box, in directions that follow a fixed rule."""
    spacing = 1.4
    bodies = []
    for i in range(side * side):
        angle = 2.399963 * i  # the golden angle: no two neighbours fly alike
        bodies.append({
            "shape": {"disc": {"radius": 0.5}},
            "position": [spacing * (i % side + 0.5), spacing * (i // side + 0.5)],
            "velocity": [speed * float(numpy.cos(angle)), speed * float(numpy.sin(angle))],
        })
    return {
        "carom": 1, "name": name,
        "walls": {"min": [0, 0], "max": [spacing * side, spacing * side], "material": "elastic"},
        "materials": {"elastic": {"restitution": 1}}, "default_material": "elastic",
        "bodies": bodies,
        "step": {"dt": 1 / 60, "count": steps},
        "accuracy": {"solver": solver, "precision": precision},
        "record": {"every": every},
        **more,
    }


class Results:
    """The files of a run, read back."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.summary = json.loads((self.folder / "summary.json").read_text())
        self.final = self.rows("final.csv")

    def rows(self, name):
        with open(self.folder / name, newline="") as file:
            return list(csv.DictReader(file))

    def ledger(self):
        """Columns by name, as doubles."""
        rows = self.rows("ledger.csv")
        return {key: numpy.array([float(row[key]) for row in rows]) for key in rows[0]} if rows else {}

    def trajectory(self):
        with h5py.File(self.folder / "trajectory.h5", "r") as file:
            return {name: file[name][()] for name in file}


class ProgramTest(unittest.TestCase):
    """A test with a folder of its own, which is where the program runs."""

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="carom-test-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def write_scene(self, scene, name="scene.json"):
        path = self.folder / name
        path.write_text(scene if isinstance(scene, str) else json.dumps(scene))
        return path

    def carom(self, *arguments, expect=0, **options):
        """Runs the program; fails unless it ends with the expected exit code (None: any)."""
        done = subprocess.run([PROGRAM, *map(str, arguments)], cwd=self.folder, capture_output=True, text=True,
                              timeout=300, **options)
        if expect is not None:
            self.assertEqual(done.returncode, expect, f"{arguments}\n{done.stdout}\n{done.stderr}")
        return done

    def run_scene(self, scene, *arguments, out="out", expect=0):
        path = scene if isinstance(scene, pathlib.Path) else self.write_scene(scene)
        self.carom("run", path, "--out", out, "--quiet", *arguments, expect=expect)
        return Results(self.folder / out)

    def files_in(self, folder):
        path = self.folder / folder
        return {file.name for file in path.iterdir()} if path.is_dir() else None

    def everything(self):
        """All files and folders below the test's folder."""
        return sorted(str(path.relative_to(self.folder)) for path in self.folder.rglob("*"))
