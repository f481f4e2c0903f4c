#!/usr/bin/env python3
"""Every file of engine/ includes what it names, itself or by way of project headers: a precompiled header brings more, so the
compiler does not say what is missing. Of std:: each name of a table has to come by one of its headers; each type, constant
or function that a project header declares has to come by such a header. The public headers include only each other, so they
stand by themselves in the same sense.

usage: check_includes.py [ROOT]
"""
import collections
import functools
import pathlib
import re
import sys

from check_layers import INCLUDE, resolve
from sources import ROOT, project_files, report, without_comments

# Names of std:: that the sources use, by header; a name may be in several. `a::` stands for all of that namespace.
NAMES_OF_HEADER = {
    "algorithm": "all_of any_of binary_search clamp copy copy_if copy_n count count_if equal fill fill_n find find_if for_each"
                 " inplace_merge is_sorted lower_bound make_heap max max_element merge min min_element minmax_element none_of"
                 " nth_element partial_sort partition_point pop_heap push_heap ranges:: remove_if reverse sort stable_partition"
                 " stable_sort transform unique upper_bound",
    "array": "array get size",
    "atomic": "atomic memory_order_acquire memory_order_relaxed memory_order_release",
    "bit": "bit_cast bit_ceil bit_width countr_one countr_zero popcount",
    "bitset": "bitset",
    "charconv": "to_chars",
    "chrono": "chrono::",
    "cmath": "abs ceil copysign fabs floor fmax fmin isfinite isnan ldexp nextafter round sqrt",
    "concepts": "integral",
    "cstddef": "byte ptrdiff_t size_t",
    "cstdint": "int32_t int64_t uint16_t uint32_t uint64_t uint8_t uintptr_t",
    "cstdio": "fprintf snprintf",
    "cstdlib": "abs getenv",
    "cstring": "memchr memcpy memset",
    "exception": "current_exception exception_ptr rethrow_exception",
    "functional": "function greater hash",
    "iterator": "back_inserter size",
    "limits": "numeric_limits",
    "memory": "make_unique unique_ptr",
    "mutex": "mutex scoped_lock",
    "new": "align_val_t bad_alloc",
    "numbers": "numbers::",
    "numeric": "accumulate iota partial_sum",
    "optional": "nullopt optional",
    "span": "as_bytes size span",
    "sstream": "ostringstream",
    "stdexcept": "invalid_argument",
    "string": "erase erase_if hash string string_view to_string",
    "string_view": "hash string_view",
    "thread": "this_thread::",
    "tuple": "get tie tuple",
    "type_traits": "conditional_t integral_constant is_const_v is_pointer_v is_same_v is_trivially_copyable_v"
                   " is_trivially_destructible_v remove_const_t remove_cvref_t remove_reference_t",
    "utility": "exchange get index_sequence make_index_sequence move pair swap",
    "variant": "get get_if holds_alternative variant variant_size_v visit",
    "vector": "erase erase_if size vector",
}
# What sizes and distances are is in the interface of each of these.
for container in ("algorithm", "array", "bitset", "memory", "span", "string", "string_view", "vector"):
    NAMES_OF_HEADER[container] += " size_t ptrdiff_t"
HEADERS_OF_NAME = collections.defaultdict(set)
for header, names in NAMES_OF_HEADER.items():
    for name in names.split():
        HEADERS_OF_NAME[name].add(header)

STD_NAME = re.compile(r"\bstd::(\w+)(::)?")
# What a header declares at the start of a line, which is in a namespace; members are indented.
DECLARATION = re.compile(r"""
    ^(?:template\ <[^\n]*>\ )?(?:class|struct|enum\ class|enum|concept)\ (?:alignas\(\w+\)\ )?(?P<type>\w+)
    |^using\ (?P<alias>\w+)\ =
    |^(?:inline\ |static\ |extern\ )*const(?:expr|init)?\ [\w:<>,\ ]+?\b(?P<constant>k[A-Z]\w*)\b
    |^(?!using|return|namespace|template|friend|else|case|typedef)[A-Za-z_][\w:<>,*&\ ]*[\s*&](?P<function>[a-z]\w*)\(
    """, re.MULTILINE | re.VERBOSE)
# What a file calls or declares by a name alone: not as a member, and not in another namespace.
CALL = re.compile(r"(?<![\w.])(?<!->)(?<!::)([a-z]\w*)\s*(?:<[^;(){}]*>)?\(")
TYPE_OR_CONSTANT = re.compile(r"(?<![\w.])(?<!->)(?<!::)((?:k[A-Z]|[A-Z])\w*)\b")


def names_declared(text):
    return {name for found in DECLARATION.finditer(text) for name in found.groups() if name}


def is_declared_within(text, name):
    """Whether a file has a type, a member, a parameter or a variable of that name, wherever."""
    return re.search(rf"\b(?:class|struct|enum|using|concept|typename)\s+{name}\b"
                     rf"|(?<![\w:])(?!(?:return|throw|else|case|new)\b)[A-Za-z_][\w:]*(?:<[^;{{}}()]*>)?[*&]{{0,2}}\s+{name}\s*[({{\[=,;)]"
                     rf"|\bconst(?:expr)?\b[^;(]*?\b{name}\s*[={{\[]", text) is not None


class Sources:
    def __init__(self, root):
        self.root = root
        self.files = project_files(root, {".hpp", ".cpp"}, "engine")
        self.text = {file: without_comments(file.read_text()) for file in self.files}
        self.declared_in = collections.defaultdict(set)
        for file in self.files:
            if file.suffix == ".hpp":
                for name in names_declared(self.text[file]):
                    self.declared_in[name].add(file)

    @functools.cache
    def included(self, file):
        """The project's headers and the others that a file includes."""
        ours, others = set(), set()
        for bracket, name in INCLUDE.findall(self.text[file]):
            target = resolve(self.root, file, bracket, name)
            if target:
                ours.add(self.root / "engine" / target)
            else:
                others.add(name)
        return ours, others

    def closure(self, file):
        """All project files that a file comes to by way of project headers, itself among them, and all others."""
        reached, others, open_ends = {file}, set(), [file]
        while open_ends:
            ours, theirs = self.included(open_ends.pop())
            others |= theirs
            open_ends += ours - reached
            reached |= ours
        return reached, others

    def findings(self, file):
        text = self.text[file]
        reached, others = self.closure(file)
        place = file.relative_to(self.root)
        code = re.sub(r"^\s*#\s*include[^\n]*", "", text, flags=re.MULTILINE)

        def line(position):
            return f"{place}:{code.count(chr(10), 0, position) + 1}"

        seen = set()
        for found in STD_NAME.finditer(code):
            name = found[1] + (found[2] or "")
            name = name if name in HEADERS_OF_NAME else found[1]
            if name in seen:
                continue
            seen.add(name)
            headers = HEADERS_OF_NAME.get(name)
            if not headers:
                yield f"{line(found.start())}: std::{name} is not in the table of check_includes.py"
            elif not headers & others:
                yield f"{line(found.start())}: std::{name} without " + " or ".join(f"<{h}>" for h in sorted(headers))
        for pattern in (TYPE_OR_CONSTANT, CALL):
            for found in pattern.finditer(code):
                name = found[1]
                homes = self.declared_in.get(name)
                if name in seen or not homes or homes & reached:
                    continue
                seen.add(name)
                if not any(is_declared_within(self.text[each], name) for each in reached):
                    yield f"{line(found.start())}: {name} without " + " or ".join(
                        sorted(home.relative_to(self.root / "engine").as_posix() for home in homes))


def check(root):
    sources = Sources(root)
    return [finding for file in sources.files for finding in sources.findings(file)]


if __name__ == "__main__":
    root = pathlib.Path(sys.argv[1]).resolve() if len(sys.argv) > 1 else ROOT
    report("check_includes", check(root), "Include what is named; a precompiled header may not be there")
