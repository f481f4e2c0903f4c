#!/usr/bin/env python3
"""No source file has more than 500 lines, unless a comment among its first ten says why:  length: <reason>

usage: check_file_length.py [ROOT]
"""
import pathlib
import re
import sys

from sources import ROOT, project_files, report

MOST_LINES = 500
SUFFIXES = {".cpp", ".hpp", ".py", ".sh", ".cmake", ".txt", ".js", ".css", ""}


def check(root):
    findings = []
    for file in project_files(root, SUFFIXES):
        try:
            lines = file.read_text().splitlines()
        except UnicodeDecodeError:
            continue  # no text: a corpus file
        excused = any(re.search(r"(//|#|\*).*\blength: \S", line) for line in lines[:10])
        if len(lines) > MOST_LINES and not excused:
            findings.append(f"{file.relative_to(root)}: {len(lines)} lines")
    return findings


if __name__ == "__main__":
    root = pathlib.Path(sys.argv[1]).resolve() if len(sys.argv) > 1 else ROOT
    report("check_file_length", check(root), f"Split at {MOST_LINES} lines; look again at 300")
