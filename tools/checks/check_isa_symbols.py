#!/usr/bin/env python3
"""Object files built for one instruction set emit no symbol that the linker could use for another: of equal weak
symbols it keeps any one, and a program on an old processor would run into AVX-512 code.

usage: check_isa_symbols.py OBJECT ...
"""
import subprocess
import sys

from sources import report

SHARED_KINDS = set("WVu")  # weak function, weak object, unique global
HARMLESS = "DW.ref."  # a pointer to the unwinder that gcc adds to every object that may unwind: no code


def check(objects):
    findings = []
    for file in objects:
        listing = subprocess.run(["nm", "--demangle", "--defined-only", file], capture_output=True, text=True, check=True)
        for line in listing.stdout.splitlines():
            kind, symbol = line.split(maxsplit=2)[1:]
            if kind in SHARED_KINDS and not symbol.startswith(HARMLESS):
                findings.append(f"{file}: {kind} {symbol}")
    return findings


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit("check_isa_symbols: no object files given")
    report("check_isa_symbols", check(sys.argv[1:]),
           "Give it internal linkage (an unnamed namespace), or do without it in engine/isa and engine/kernels")
