#!/usr/bin/env python3
"""Names that would clash in another build than the one at hand:

A constant that a header of engine/ defines has no namesake in another file: the second makes a use ambiguous as soon as
a file includes both, which a precompiled header does and another build does not.

A file of tests is a namespace of its own name, test_joints.cpp of test_joints: a dozen of them are compiled as one, and which ones
depends on what other files there are.

usage: check_names.py [ROOT]
"""
import collections
import pathlib
import re
import sys

from sources import ROOT, project_files, report, without_comments

# At the start of a line: the constants of a namespace, none of a class or a function.
CONSTANT = re.compile(r"^(?:inline |static )?const(?:expr|init) [\w:<>, ]+?\b(k[A-Z]\w*)\b", re.MULTILINE)


def check(root):
    places = collections.defaultdict(list)
    for file in project_files(root, {".hpp", ".cpp"}, "engine"):
        code = without_comments(file.read_text())
        for found in CONSTANT.finditer(code):
            places[found.group(1)].append((file, code.count("\n", 0, found.start()) + 1))
    findings = []
    for name, found in sorted(places.items()):
        if len({file for file, _ in found}) > 1 and any(file.suffix == ".hpp" for file, _ in found):
            findings.append(f"{name}: " + ", ".join(f"{file.relative_to(root)}:{line}" for file, line in found))
    for file in project_files(root, {".cpp"}, "tests"):
        if file.name.startswith("test_") and f"\nnamespace {file.stem} {{\n" not in file.read_text():
            findings.append(f"{file.relative_to(root)}: has no namespace {file.stem}")
    return findings


if __name__ == "__main__":
    root = pathlib.Path(sys.argv[1]).resolve() if len(sys.argv) > 1 else ROOT
    report("check_names", check(root), "Say in the name what each of the constants is of; put what a file of tests has into its namespace")
