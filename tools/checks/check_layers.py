#!/usr/bin/env python3
"""Folders of engine/ are layers: a file includes only lower layers or its own folder, and of folders within a layer
none includes another that includes it, in turn or by way of others. Also keeps OpenMP and xsimd in their places, and everything outside of engine/ but tests and benchmarks on the public headers.

usage: check_layers.py [ROOT]
"""
import pathlib
import re
import sys

from sources import ROOT, project_files, report, without_comments

# docs/architecture.md has the same table with what each folder is for.
LAYER_OF_FOLDER = {
    "include": -1,  # the public headers: every file may include them, they include only each other
    "math": 0,
    "simd": 1, "parallel": 1, "shapes": 1, "stages": 1,
    "effects": 2,
    "narrowphase": 2.5,  # geometry of two shapes: no columns, no physics
    "kernels": 3,
    "state": 3,  # what a snapshot holds
    "isa": 4,
    "broadphase": 5,  # below the solvers: `impulse` asks it for neighbours while it works
    "scene": 5,
    "constraints": 6,  # what acts between two bodies
    "sleeping": 7,
    "solvers/shared": 8,
    "solvers/contact_sets": 8,  # contacts that are solved apart from the sweeps
    "solvers/substeps": 8.2,  # what a step is cut into, and the bodies over the substeps of a step
    "solvers/joints": 8.3,  # joints over those substeps: trees solved exactly, nets swept
    "solvers/manifolds": 8.3,  # contacts of convex shapes: what touches
    "solvers/paths": 8.4,  # their exact solve along paths
    "solvers/impulse": 8.5, "solvers/soft": 8.5, "solvers/event": 8.5,  # nothing of one is in another
    "step": 9,  # lists the stages of each solver
    "world": 10,  # the public class over all of it
    "reference": 5,  # and see SHARES_NOTHING
}
LAYER_OF_FILE = {  # patterns of paths without suffix: files that differ from their folder or have none
    r"version": 0,
    r"kernels/(\w+/)?(\w+_)?arguments": 2.9,
}
TOP_LAYER = 11  # other files directly in engine/
SHARES_NOTHING = "reference"  # the yardstick: includes the public headers and itself, nobody in engine/ includes it

MAY_USE_OPENMP = ("parallel/",)
MAY_INCLUDE_XSIMD = ("simd/", "kernels/", "isa/", "state/")  # state/: for the aligned allocator only
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)


def layer_of(path):
    """path: relative to engine/, in posix form."""
    stem = re.sub(r"\.\w+$", "", path)
    for pattern, layer in LAYER_OF_FILE.items():
        if re.fullmatch(pattern, stem):
            return layer
    folder = folder_of(path)
    return LAYER_OF_FOLDER.get(folder) if folder else TOP_LAYER


def folder_of(path):
    """The room a file is in: a folder of engine/ or, of folders that hold rooms, one below."""
    parts = path.split("/")[:-1]
    return next((room for room in ("/".join(parts[:2]), "/".join(parts[:1])) if room in LAYER_OF_FOLDER),
                "/".join(parts[:1]))


def resolve(root, includer, bracket, name):
    """Path relative to engine/ of an include that names one of our files there, else None."""
    engine = root / "engine"
    places = [engine, engine / "include"] if bracket == "<" else [includer.parent, engine, engine / "include", root]
    for place in places:
        found = (place / name).resolve()
        if found.is_file() and found.is_relative_to(engine.resolve()):
            return found.relative_to(engine.resolve()).as_posix()
    return None


def check_include(path, target):
    """What is wrong if engine/`path` includes engine/`target`, or None."""
    mine, theirs = layer_of(path), layer_of(target)
    if mine is None or theirs is None:
        return f"engine/{folder_of(path if mine is None else target)} is in no layer; add it to the table"
    if folder_of(target) == "include":
        return None
    if folder_of(path) == "include":
        return "public headers include only public headers"
    if SHARES_NOTHING in (folder_of(path), folder_of(target)):
        alone = folder_of(path) == folder_of(target) or layer_of(path) == TOP_LAYER
        return None if alone else f"engine/{SHARES_NOTHING} shares no code with the rest"
    if folder_of(path) == folder_of(target) and mine >= theirs:
        return None
    return None if theirs < mine else f"layer {mine} includes layer {theirs}"


def findings_in(root, file):
    text = without_comments(file.read_text())
    in_engine = file.is_relative_to(root / "engine")
    path = file.relative_to(root / "engine" if in_engine else root).as_posix()

    def finding(position, message):
        return f"{file.relative_to(root)}:{text.count(chr(10), 0, position) + 1}: {message}"

    for match in INCLUDE.finditer(text):
        bracket, name = match.groups()
        target = resolve(root, file, bracket, name)
        if in_engine and target and (wrong := check_include(path, target)):
            yield finding(match.start(1), f"includes {name}: {wrong}")
        if not in_engine and target and folder_of(target) != "include":
            yield finding(match.start(1), f"includes {name}: tools use the public headers only")
        if in_engine and name.startswith("xsimd/") and not path.startswith(MAY_INCLUDE_XSIMD):
            yield finding(match.start(1), "includes xsimd outside of " + ", ".join(MAY_INCLUDE_XSIMD))
    if not path.startswith(MAY_USE_OPENMP) or not in_engine:
        for match in re.finditer(r"#\s*pragma\s+omp|include\s*<omp\.h>|\bomp_\w+\s*\(", text):
            yield finding(match.start(), "uses OpenMP outside of engine/" + ", ".join(MAY_USE_OPENMP))


def folders_included(root, files):
    """{folder: {folder that one of its files includes: the first such file}}, each the innermost one."""
    included = {}
    for file in files:
        folder = file.parent.relative_to(root / "engine").as_posix()
        for bracket, name in INCLUDE.findall(without_comments(file.read_text())):
            target = resolve(root, file, bracket, name)
            theirs = pathlib.PurePosixPath(target).parent.as_posix() if target else folder
            if theirs != folder:
                included.setdefault(folder, {}).setdefault(theirs, file.relative_to(root).as_posix())
    return included


def circles_of(included):
    """One finding for each pair of folders of which one includes the other and is reached from it."""
    def reached_from(start):
        found, open_ends = set(), [start]
        while open_ends:
            new = set(included.get(open_ends.pop(), ())) - found
            found |= new
            open_ends += new
        return found

    reached = {folder: reached_from(folder) for folder in included}
    for folder in sorted(included):
        if folder in reached[folder]:
            for theirs, file in sorted(included[folder].items()):
                if folder in reached.get(theirs, ()):
                    yield f"{file}: includes {theirs}/, from which its folder is included"


def check(root):
    engine = project_files(root, {".cpp", ".hpp"}, "engine")
    files = engine + project_files(root, {".cpp", ".hpp"}, "tools")
    return [finding for file in files for finding in findings_in(root, file)] + list(circles_of(folders_included(root, engine)))


if __name__ == "__main__":
    root = pathlib.Path(sys.argv[1]).resolve() if len(sys.argv) > 1 else ROOT
    report("check_layers", check(root), "A file includes only lower layers or its own folder; see docs/architecture.md")
