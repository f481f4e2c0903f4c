#!/usr/bin/env python3
"""Makes a copy of the engine with the effect in it that docs/add-an-effect.md adds, and compares the page with it.

usage: apply_example.py SOURCE COPY

docs/add-an-effect.patch is that effect, whole. Every line of C++ that the page shows has to be one that it adds.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys

COPIED = ("CMakeLists.txt", "engine", "tests/physics", "tests/support", "tools", "docs/scene.schema.json")


def added_by(patch):
    return {line[1:].strip() for line in patch.splitlines() if line.startswith("+") and not line.startswith("+++")}


def shown_by(page):
    """The lines of the page's blocks of C++; `...` stands for what is left out."""
    lines = [line.strip() for block in re.findall(r"^```cpp\n(.*?)^```", page, re.DOTALL | re.MULTILINE)
             for line in block.splitlines()]
    return [line for line in lines if line not in ("", "...")]


def main():
    source, copy = map(pathlib.Path, sys.argv[1:])
    patch = source / "docs/add-an-effect.patch"
    added = added_by(patch.read_text())
    missing = [line for line in shown_by((source / "docs/add-an-effect.md").read_text()) if line not in added]
    if missing:
        sys.exit("docs/add-an-effect.md shows lines that docs/add-an-effect.patch does not add:\n" + "\n".join(missing))

    shutil.rmtree(copy, ignore_errors=True)
    for name in COPIED:
        if (source / name).is_dir():
            shutil.copytree(source / name, copy / name)
        elif (source / name).exists():
            (copy / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(source / name, copy / name)
    # The copy may lie within the project's own repository, whose paths git would take the patch to mean.
    outside = {**os.environ, "GIT_CEILING_DIRECTORIES": str(copy.resolve().parent)}
    done = subprocess.run(["git", "apply", "-C1", patch.resolve()], cwd=copy, env=outside, capture_output=True, text=True)
    if done.returncode != 0 or not (copy / "engine/effects/wind.hpp").exists():
        sys.exit("docs/add-an-effect.patch no longer fits the engine. In a clean clone `git apply --reject docs/add-an-effect.patch`, "
                 "make by hand what it rejects, and write down what `git add -A && git diff --cached -U1` says, behind its "
                 f"first line.\n{done.stderr}")


main()
