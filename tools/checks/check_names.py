#!/usr/bin/env python3
"""A constant that a header of engine/ defines has no namesake in another file: the second makes a use ambiguous as soon as
a file includes both, which a precompiled header does and another build does not.

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
    return findings


if __name__ == "__main__":
    root = pathlib.Path(sys.argv[1]).resolve() if len(sys.argv) > 1 else ROOT
    report("check_names", check(root), "Say in the name what each of the constants is of")
