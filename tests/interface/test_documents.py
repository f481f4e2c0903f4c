"""Runs what README.md and pages of docs/ tell readers to run, on the files they show, and compares the output
they show. What sets up and builds the project itself is left to those scripts; installing and embedding run in release."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

from program import PROGRAM, SOURCE, ProgramTest

BUILD = pathlib.Path(PROGRAM).parents[1]
IS_RELEASE = BUILD.name == "release"
BUILDING = ("cmake --preset", "cmake --build --preset")  # done before tests run
EMBEDDING = ("cmake --install", "cmake -G Ninja -S hello", "cmake --build hello", "hello/")
SCRIPTS = ("tools/demo", "tools/test")


def blocks_of(document):
    """(file name or None, language, text) of every fenced block; a block shows a file if `name`: stands above it."""
    text = (SOURCE / document).read_text()
    return re.findall(r"(?:^`([\w./-]+)`:\n\n)?^```(\w+)\n(.*?)^```", text, re.DOTALL | re.MULTILINE)


def without_machine(text):
    """The output of a run without what differs from one machine, or one run, to the next."""
    text = re.sub(r"^  time: .*$", "  time: ...", text, flags=re.MULTILINE)
    return re.sub(r"precision, \w+, \d+ threads?", "precision, ...", text)


class DocumentsTest(ProgramTest):
    def setUp(self):
        super().setUp()
        (self.folder / "docs").symlink_to(SOURCE / "docs")
        (self.folder / "build").mkdir()
        (self.folder / "build/release").symlink_to(BUILD)
        (self.folder / "bin").mkdir()
        (self.folder / "bin/python3").symlink_to(sys.executable)
        for name in ("gmake", "make"):  # CMake's own choice, where it is installed: tools/setup does not install it
            (self.folder / "bin" / name).write_text("#!/bin/sh\necho 'tools/setup installs no make' >&2\nexit 1\n")
            (self.folder / "bin" / name).chmod(0o755)

    def shell(self, command):
        path = f"{self.folder / 'bin'}:{os.environ['PATH']}"
        done = subprocess.run(["bash", "-c", "set -o pipefail; " + command], cwd=self.folder, capture_output=True, text=True,
                              env={**os.environ, "PATH": path}, timeout=600)
        self.assertEqual(done.returncode, 0, f"{command}\n{done.stdout}\n{done.stderr}")
        return done.stdout

    def run_command(self, command):
        """The output of a documented command, or None if it is not run here."""
        if command in SCRIPTS:
            script = SOURCE / command
            self.assertTrue(os.access(script, os.X_OK), command)
            self.shell(f"bash -n {script}")
            return self.shell("build/release/bin/carom run docs/scenes/seed.json --out out/seed") \
                if command == "tools/demo" else None
        if command.startswith(BUILDING) or (command.startswith(EMBEDDING) and not IS_RELEASE):
            return None
        return self.shell(command)

    def run_document(self, document):
        """Writes its files and runs its commands in order; returns pairs of shown and actual output."""
        output, pairs = None, []
        for name, language, text in blocks_of(document):
            if name:
                path = self.folder / name
                path.parent.mkdir(exist_ok=True)
                path.write_text(text)
            elif language == "sh":
                output = [self.run_command(command) for command in text.splitlines()]
            elif language == "text" and output:
                pairs.append((text, output[-1]))
            if language != "sh":
                output = None
        return pairs

    def test_readme_shows_what_its_commands_print(self):
        pairs = self.run_document("README.md")
        self.assertEqual(len(pairs), 2)
        for shown, actual in pairs:
            self.assertEqual(without_machine(shown), without_machine(actual))

    def test_commands_of_getting_started_work(self):
        self.run_document("docs/getting-started.md")
        results = {path.name for path in (self.folder / "out").iterdir()}
        self.assertEqual(results, {"pyramid", "rain", "rain.png", "rain-double", "rain-fine", "rain-naive", "rain-scalar", "seed"})
        seen = self.shell("python3 look.py")
        self.assertRegex(seen, r"the ball rose to [\d.]+ m\n")

    @unittest.skipUnless(IS_RELEASE, "they run a large scene")
    def test_commands_of_the_pages_on_the_engine_work(self):
        for document in ("docs/how-a-step-works.md", "docs/architecture.md", "docs/gallery.md", "docs/benchmarks.md", "docs/torture.md"):
            self.run_document(document)
        scalar, best = ((self.folder / "out" / run / "summary.json").read_text() for run in ("scalar", "best"))
        self.assertEqual(*(re.search(r'"state_hash": "\w+"', summary).group() for summary in (scalar, best)))

    @unittest.skipUnless(IS_RELEASE, "the example is linked against the release build")
    def test_embedding_examples_print_what_their_pages_show(self):
        compiler = shutil.which("g++") or self.skipTest("no g++")
        for document in ("README.md", "docs/joints.md", "docs/embedding.md"):
            blocks = blocks_of(document)
            index = next(i for i, block in enumerate(blocks) if block[1] == "cpp")
            (self.folder / "example.cpp").write_text(blocks[index][2])
            self.shell(f"{compiler} -std=c++20 -I {SOURCE}/engine/include example.cpp build/release/engine/libcarom.a -fopenmp "
                       "-o example")
            self.assertEqual(self.shell("./example"), blocks[index + 1][2], document)

    def test_links_lead_somewhere(self):
        for document in (SOURCE / "README.md", *sorted((SOURCE / "docs").rglob("*.md"))):
            for target in re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", document.read_text()):
                if not target.startswith("http"):
                    self.assertTrue((document.parent / target).exists(), f"{document.name}: {target}")


if __name__ == "__main__":
    unittest.main()
