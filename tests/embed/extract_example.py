#!/usr/bin/env python3
"""Copies the embedding example out of README.md: its first ```cpp block that has a main function.

usage: extract_example.py README.md OUT.cpp
"""
import pathlib
import re
import sys

MOST_LINES = 15


def example_of(markdown):
    for block in re.findall(r"^```cpp\n(.*?)^```", markdown, re.DOTALL | re.MULTILINE):
        if "int main(" in block:
            return block
    sys.exit("README.md has no ```cpp block with a main function; the embedding example is missing")


def main():
    readme, out = map(pathlib.Path, sys.argv[1:])
    example = example_of(readme.read_text())
    lines = len(example.splitlines())
    if lines > MOST_LINES:
        sys.exit(f"the embedding example of README.md has {lines} lines; expected at most {MOST_LINES}")
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text(example)


main()
