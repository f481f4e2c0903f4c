#!/usr/bin/env python3
"""Every C++ file is as clang-format would write it.

usage: check_format.py [--fix] [ROOT]
"""
import pathlib
import subprocess
import sys

from sources import ROOT, project_files, report


def check(root, fix=False):
    files = project_files(root, {".cpp", ".hpp"})
    if not files:
        return []
    how = ["-i"] if fix else ["--dry-run", "-Werror"]
    run = subprocess.run(["clang-format", "--style=file", *how, *files], cwd=root, stderr=subprocess.PIPE, text=True)
    findings = [line for line in run.stderr.splitlines() if "error:" in line]
    return findings or (["clang-format failed: " + run.stderr] if run.returncode else [])


if __name__ == "__main__":
    arguments = sys.argv[1:]
    fix = "--fix" in arguments
    roots = [argument for argument in arguments if argument != "--fix"]
    report("check_format", check(pathlib.Path(roots[0]).resolve() if roots else ROOT, fix),
           "Run tools/checks/check_format.py --fix")
