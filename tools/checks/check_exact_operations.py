#!/usr/bin/env python3
"""The same bits everywhere: engine/ uses no fused, approximate or library-dependent arithmetic and no sum across
lanes, and no build file asks the compiler for them. With object files, their instructions are read as well.

A line that has to do it says why, on the line or in the comment right above:  // inexact: <reason>

usage: check_exact_operations.py [ROOT] [--objects FILE ...]
"""
import argparse
import pathlib
import re
import subprocess

from sources import ROOT, project_files, report, without_comments

LIBM = "sin|cos|tan|asin|acos|atan|atan2|sinh|cosh|tanh|exp|exp2|expm1|log|log2|log10|log1p|pow|hypot|cbrt"
BANNED_IN_SOURCES = {
    r"\bfm[as][fl]?\s*\(|\bfnm[as]\s*\(|_mm\d*_\w*fn?m(add|sub)|\bvfm[as]q?_|__builtin_fma":
        "fused multiply-add rounds once, other machines twice",
    r"\brsqrt|\brcp\b|_mm\d*_\w*(rcp|rsqrt)|\breciprocal\s*\(|\bvrecpe|\bvrsqrte|\w+_approx\s*\(":
        "an estimate differs between processors",
    rf"(std|xsimd)::({LIBM})\b|\b({LIBM})[fl]\s*\(|__builtin_({LIBM})|(?:[-=(*/+<>?!&|,]|\breturn)\s*(::)?({LIBM})\s*\(":
        "libm results differ between its versions; use the functions in engine/math",
    r"\bhadd\b|_mm\d*_hadd|\breduce_add\b|_mm\d*_reduce_(add|mul)|_mm\w*_dp_p|std::(transform_)?reduce\b|xsimd::reduce\b":
        "a sum across lanes or in no stated order depends on the batch width",
    r"\breduction\s*\(": "OpenMP adds in no stated order",
    r"#\s*pragma\s+(GCC\s+optimize|STDC\s+FP_CONTRACT|clang\s+fp\b|float_control)|\boptimize\s*\(\s*\"":
        "changes the rules of arithmetic for a part of a file",
}
BANNED_IN_BUILD_FILES = {
    r"-Ofast|-ffast-math|-funsafe-math|-fassociative-math|-freciprocal-math|-ffinite-math|-fno-signed-zeros"
    r"|-mrecip|-ffp-contract=(fast|on)|-ffp-model|-mfma|-march=native": "lets the compiler change results",
}
BANNED_INSTRUCTIONS = (r"\t(v?fn?m(add|sub)\w*|v?rcp(ss|ps|14\w+|28\w+)|v?rsqrt\w+|v?hadd[ps]\w|v?dpp[sd]"
                       r"|fn?m(add|sub)|fml[as]|frecpe|frsqrte|faddp)\b")
REASON = re.compile(r"//.*\binexact: \S")


def is_excused(lines, number):
    """lines[number] gives a reason, or the comment lines right above it do."""
    first = number
    while first > 0 and lines[first - 1].lstrip().startswith("//"):
        first -= 1
    return any(REASON.search(line) for line in lines[first:number + 1])


def findings_in_text(name, text, banned, code=None):
    lines = text.splitlines()
    for number, line in enumerate((code or text).splitlines()):
        for pattern, why in banned.items():
            found = re.search(pattern, line)
            if found and not is_excused(lines, number):
                yield f"{name}:{number + 1}: {found.group().strip()}: {why}"


def findings_in_object(file):
    listing = subprocess.run(["objdump", "--disassemble", "--demangle", "--no-show-raw-insn", file],
                             capture_output=True, text=True, check=True).stdout
    function = "?"
    for line in listing.splitlines():
        if line.endswith(">:"):
            function = line.split("<", 1)[1][:-2]
        elif found := re.search(BANNED_INSTRUCTIONS, line):
            yield f"{file}: instruction {found.group(1)} in {function}"


def check(root, objects=()):
    findings = []
    for file in project_files(root, {".cpp", ".hpp"}, "engine"):
        text = file.read_text()
        findings += findings_in_text(file.relative_to(root), text, BANNED_IN_SOURCES, without_comments(text))
    for file in project_files(root, {".txt", ".cmake", ".json"}):
        if file.name in ("CMakeLists.txt", "CMakePresets.json") or file.suffix == ".cmake":
            findings += findings_in_text(file.relative_to(root), file.read_text(), BANNED_IN_BUILD_FILES)
    for file in objects:
        findings += findings_in_object(file)
    return findings


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("root", nargs="?", type=pathlib.Path, default=ROOT)
    parser.add_argument("--objects", nargs="*", default=[])
    arguments = parser.parse_args()
    report("check_exact_operations", check(arguments.root.resolve(), arguments.objects),
           "If it has to be, say why in a comment: // inexact: <reason>")
