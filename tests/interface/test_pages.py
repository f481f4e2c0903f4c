"""Pages that repeat what the source says are held against it: stages, layers, and the lists of pages."""
import os
import pathlib
import re
import sys
import unittest

SOURCE = pathlib.Path(os.environ.get("CAROM_SOURCE_DIR", pathlib.Path(__file__).parents[2]))
DOCS = SOURCE / "docs"
sys.path.insert(0, str(SOURCE / "tools/checks"))
import check_layers  # noqa: E402

LINK = re.compile(r"\]\(([^)#]+)(?:#[^)]*)?\)")


def text_of(path):
    return (SOURCE / path).read_text()


def stages_of_source():
    """(name, reads, writes) of each stage, in the order of the steps of `impulse`, `event` and `soft`; once each."""
    stages = []
    for solver in ("impulse", "event", "soft"):
        page = text_of(f"engine/step/{solver}_step.cpp")
        lines = re.findall(r'\{"(\w+)",.*?KernelChoice::\w+,\s*"([^"]*)",\s*"([^"]*)"\}', page, re.DOTALL)
        assert len(lines) == len(re.findall(r"KernelChoice::", page)), solver
        stages += [line for line in lines if line not in stages]
    return stages


def pages():
    """Every page below docs/, relative to it, but the lists of pages themselves."""
    return sorted(path.relative_to(DOCS).as_posix() for path in DOCS.rglob("*.md") if path.name != "README.md")


class StagesTest(unittest.TestCase):
    def test_the_page_has_every_stage_in_order_with_what_it_touches(self):
        shown = re.findall(r"^### (\w+)\n.*?^- Reads: ([^\n]*)\n- Writes: ([^\n]*)\n- Cost: \S",
                           text_of("docs/how-a-step-works.md"), re.DOTALL | re.MULTILINE)
        self.assertGreater(len(shown), 5)
        self.assertEqual(shown, stages_of_source())

    def test_the_page_has_no_other_headings_of_stages(self):
        headings = re.findall(r"^### (\w+)$", text_of("docs/how-a-step-works.md"), re.MULTILINE)
        self.assertEqual(headings, [name for name, _, _ in stages_of_source()])

    def test_a_stage_of_two_solvers_touches_the_same_in_both(self):
        names = [name for name, _, _ in stages_of_source()]
        self.assertEqual(len(names), len(set(names)))


class ConstantsTest(unittest.TestCase):
    def test_constants_have_the_values_that_pages_give(self):
        sources = "".join(path.read_text() for path in (SOURCE / "engine").rglob("*.[ch]pp"))
        for page in pages():
            text = text_of("docs/" + page)
            for name, value in re.findall(r"`(k[A-Z]\w+) = ([^`]+)`", text):
                self.assertRegex(sources, rf"\b{name}\s*=\s*{re.escape(value)};", f"{page}: {name}")

    def test_constants_that_the_page_on_the_step_names_exist(self):
        sources = "".join(path.read_text() for path in (SOURCE / "engine").rglob("*.[ch]pp"))
        for name in re.findall(r"`(k[A-Z]\w+)", text_of("docs/how-a-step-works.md")):
            self.assertRegex(sources, rf"\b{name}\b", name)


class LinksTest(unittest.TestCase):
    def test_links_of_pages_lead_to_files_and_headings_that_are_there(self):
        for page in ("README.md", "docs/README.md", "docs/decisions/README.md", *("docs/" + page for page in pages())):
            for target, heading in re.findall(r"\]\(([^)#\s]*)(?:#([^)]*))?\)", text_of(page)):
                if target.startswith("http"):
                    continue
                file = (SOURCE / page).parent / target if target else SOURCE / page
                self.assertTrue(file.exists(), f"{page}: {target}")
                if heading:
                    headings = re.findall(r"^#+ (.*)$", file.read_text(), re.MULTILINE)
                    anchors = [re.sub(r"[^\w\- ]", "", text.lower()).replace(" ", "-") for text in headings]
                    self.assertIn(heading, anchors, f"{page}: {target}")


class SolversTest(unittest.TestCase):
    """What pages say of solvers that are built and of those that are not, against what a scene's check lets pass."""

    def setUp(self):
        named = dict(re.findall(r'\{Solver::(\w+), "(\w+)"\}', text_of("engine/scene/names.cpp")))
        check = re.search(r"bool is_built\(.*?\{(.*?)\}", text_of("engine/scene/validation/validate_settings.cpp"), re.DOTALL)
        built = set(re.findall(r"Solver::(\w+)", check.group(1)))
        self.built = {named[name] for name in built}
        self.missing = set(named.values()) - self.built
        self.assertGreater(len(self.built), 3)

    def test_the_table_of_solvers_has_all_and_says_which_are_not_built(self):
        section = re.search(r"^## Solvers\n(.*?)^## ", text_of("docs/how-a-step-works.md"), re.DOTALL | re.MULTILINE).group(1)
        shown = {name: meaning for names, meaning in re.findall(r"^\| (`[^|]*) \| (.*) \|$", section, re.MULTILINE)
                 for name in re.findall(r"`(\w+)`", names)}
        self.assertEqual(shown.keys(), self.built | self.missing)
        self.assertEqual({name for name, meaning in shown.items() if meaning == "not built yet"}, self.missing)

    def test_no_page_says_of_a_solver_that_is_built_that_it_is_not(self):
        for page in ("README.md", *("docs/" + page for page in pages() if "/" not in page)):
            for sentence in re.findall(r"[^.;|\n]*not built yet[^.;|\n]*", text_of(page)):
                self.assertLessEqual(set(re.findall(r"`(\w+)`", sentence)) & self.built, set(), f"{page}: {sentence}")
        marked = re.search(r"^\| `accuracy.solver` \|.*$", text_of("docs/scene-format.md"), re.MULTILINE).group(0)
        self.assertEqual(set(re.findall(r'`"(\w+)"` †', marked)), self.missing)
        self.assertEqual(set(re.findall(r'`"(\w+)"`', marked)), self.built | self.missing)


class NamesTest(unittest.TestCase):
    """What pages name exists, but for what the worked examples add."""

    ADDED = ("wind", "trapezoid")  # by docs/add-an-effect.md and docs/add-a-shape.md
    STYLES = {"PascalCase", "snake_case", "kPascalCase"}  # ways to write names

    def names(self, pattern):
        for page in pages():
            if page.startswith("decisions/"):  # records of their day
                continue
            text = re.sub(r"^```.*?^```", "", text_of("docs/" + page), flags=re.DOTALL | re.MULTILINE)
            yield from ((page, name) for name in re.findall(pattern, text)
                        if not any(word in name.lower() for word in self.ADDED) and name not in self.STYLES)

    def test_files(self):
        for page, name in self.names(r"`((?:engine|bench|tests|docs|tools)/[\w./-]+)`"):
            self.assertTrue((SOURCE / name).exists(), f"{page}: {name}")
        for page, name in self.names(r"`((?:broadphase|constraints|solvers|sleeping|stages|step|shapes|world|isa|effects|state)/[\w./-]+\.\w+)`"):
            self.assertTrue((SOURCE / "engine" / name).exists(), f"{page}: {name}")

    def test_functions_types_and_keys(self):
        roots = [SOURCE / folder for folder in ("engine", "tools", "tests", "bench")]
        files = [path for root in roots for ending in ("*.[ch]pp", "*.py", "*.js", "CMakeLists.txt") for path in root.rglob(ending)]
        files += [*SOURCE.glob("CMake*"), *DOCS.glob("*.json"), *DOCS.glob("scenes/*.json")]
        known = set(re.findall(r"\w+", "".join(path.read_text() for path in files)))
        found = list(self.names(r"`(?:\w+::)*([a-z]+(?:_[a-z]+)+|[A-Z]\w+[a-z]\w*)`"))
        self.assertGreater(len(found), 20)
        for page, name in found:
            self.assertTrue(name in known, f"{page}: {name}")


def functions_of(header, opening):
    """Names of the functions that a public header declares behind the line `opening {` and, of a class, before what is private."""
    text = re.sub(r"//[^\n]*", "", text_of(f"engine/include/carom/{header}"))
    body = text[re.search(rf"^{opening} \{{\n", text, re.MULTILINE).end():]
    indent = ""
    if not opening.startswith("namespace"):
        body, indent = re.split(r"^(?:};|  private:)", body, maxsplit=1, flags=re.MULTILINE)[0], "    "
    return set(re.findall(rf"^{indent}(?=\w)[\w:<>, &*]+ ([a-z]\w*)\(", body, re.MULTILINE))


class InterfaceTest(unittest.TestCase):
    """docs/embedding.md has every call of the C++ interface, and no page names one that there is not."""

    CLASSES = {"World": ("world.hpp", "class BasicWorld"), "Scene": ("scene.hpp", "struct Scene")}

    def setUp(self):
        self.functions = {name: functions_of(*place) for name, place in self.CLASSES.items()}
        options = re.search(r"^struct WorldOptions \{\n(.*?)^};", text_of("engine/include/carom/world.hpp"), re.DOTALL | re.MULTILINE)
        options = re.sub(r"//[^\n]*", "", options.group(1))
        self.options = set(re.findall(r"\b(\w+)\s*(?:=[^;]*|\{\});", options))
        self.assertGreater(len(self.functions["World"]), 35)
        self.assertGreater(len(self.options), 7)

    def test_the_page_has_every_function_of_worlds_and_scenes_and_every_option(self):
        page = text_of("docs/embedding.md")
        for name, functions in {**self.functions, "WorldOptions": self.options}.items():
            shown = set(re.findall(rf"`{name}::(\w+)`", page))
            self.assertEqual(functions - shown, set(), name)

    def test_the_page_has_every_other_function(self):
        page = set(re.findall(r"`(\w+)`", text_of("docs/embedding.md")))
        headers = [path for path in (SOURCE / "engine/include/carom").glob("*.hpp") if path.name != "pairwise.hpp"]
        found = {name for path in headers if "\nnamespace carom {\n" in path.read_text()
                 for name in functions_of(path.name, "namespace carom")}
        self.assertLess({"add_net", "recentred", "build_info"}, found)
        self.assertEqual(found - page - {"find_problem"}, set())  # which Scene has, too

    def test_pages_name_no_function_that_there_is_not(self):
        fields = {name: set(re.findall(r"\b(\w+)\s*(?:=[^;(]*|\{\}|\{[^;(]*\})?;", text_of(f"engine/include/carom/{place[0]}")))
                  for name, place in self.CLASSES.items()}
        for page in ("README.md", *("docs/" + page for page in pages() if "/" not in page)):
            for name, function in re.findall(r"`(World|Scene)::(\w+)", text_of(page)):
                self.assertIn(function, self.functions[name] | fields[name], f"{page}: {name}::{function}")


CODE = re.compile(r"\b[AB]\d{1,2}\b")
LISTS_OF_CASES = ("hard-cases.md", "exact-cases.md")


def names_of_tests(source):
    """Of a C++ text, with the pieces of a name joined."""
    found = re.findall(r'TEST_CASE(?:_TEMPLATE)?\(\s*((?:"(?:[^"\\]|\\.)*"\s*)+)', source)
    return ["".join(re.findall(r'"((?:[^"\\]|\\.)*)"', pieces)) for pieces in found]


class CasesTest(unittest.TestCase):
    """docs/hard-cases.md and docs/exact-cases.md against tests, benchmarks and `carom accuracy`, both ways."""

    @classmethod
    def setUpClass(cls):
        rows = [(page, row) for page in LISTS_OF_CASES
                for row in re.findall(r"^\| [AB]\d.*\|$", text_of("docs/" + page), re.MULTILINE)]
        cls.rows = {row.split(" | ")[0].strip("| "): (page, row) for page, row in rows}
        cls.repeated = len(rows) - len(cls.rows)
        files = [path for folder in ("engine", "tests", "bench", "tools") for path in sorted((SOURCE / folder).rglob("*"))
                 if path.is_file() and path.suffix in ("", ".cpp", ".hpp", ".js", ".py")]
        cls.codes = {path.relative_to(SOURCE).as_posix(): set(CODE.findall(path.read_text())) for path in files}
        cls.codes["tests/interface/test_command_line.py"].discard("A" "99")  # which it asks for as there is none

    def links(self, code):
        """(file from the top of the project, names in quotes behind it) of a row."""
        page, row = self.rows[code]
        for piece in re.split(r"(?=\[[^\]]*\]\()", row)[1:]:
            target = (DOCS / page).parent / LINK.search(piece).group(1)
            yield os.path.relpath(target.resolve(), SOURCE.resolve()), re.findall(r'"([^"]+)"', piece)

    def test_every_code_that_is_named_has_one_row(self):
        self.assertEqual(self.repeated, 0)
        self.assertGreater(sum(map(bool, self.codes.values())), 30)
        for file, codes in self.codes.items():
            self.assertLessEqual(codes, self.rows.keys(), file)
        for page in pages():
            self.assertLessEqual(set(CODE.findall(text_of("docs/" + page))), self.rows.keys(), page)

    def test_rows_name_files_that_name_the_code_and_tests_that_are_in_them(self):
        for code in self.rows:
            for file, names in self.links(code):
                if file.startswith("docs/"):
                    continue
                self.assertIn(code, self.codes.get(file, ()), f"{code}: {file}")
                tests = names_of_tests(text_of(file)) if names else []
                for name in names:
                    self.assertTrue(any(test.endswith(name) for test in tests), f"{code}: {file}: {name}")

    def test_what_has_no_test_is_said_to_have_none_and_nothing_else_is(self):
        for code, (_, row) in self.rows.items():
            tested = {file for file, codes in self.codes.items() if code in codes and file.startswith("tests/")}
            listed = {file for file, _ in self.links(code) if file.startswith("tests/")}
            is_tested = any(path.endswith(".cpp") for path in tested)
            self.assertEqual(is_tested, bool(listed), f"{code}: {tested or 'no test'}")
            cell = re.search(r"\| (not (?:built|tested) yet[^|]*|`carom accuracy` alone) \|", row)
            self.assertEqual(bool(cell), not is_tested, row)

    def test_the_row_of_an_exact_case_has_the_names_it_has_in_carom_accuracy(self):
        measured = set()
        for file in self.codes:
            if file.startswith("tools/accuracy/cases/"):
                measured |= set(re.findall(r'"(A\d+(?:-\w+)?)"', text_of(file)))
        self.assertGreater(len(measured), 15)
        shown = [name for _, row in self.rows.values() for name in re.findall(r"`(A\d+(?:-\w+)?)`", row.split(" | ")[-1])]
        self.assertEqual(sorted(shown), sorted(measured))

    def test_ranges_of_codes_end_with_the_last_one(self):
        last = {letter: max(int(code[1:]) for code in self.rows if code[0] == letter) for letter in "AB"}
        found = [(page, code) for page in ("README.md", "docs/README.md", *("docs/" + page for page in pages() if "/" not in page))
                 for code in re.findall(r"\b[AB]1 to ([AB]\d+)", text_of(page))]
        self.assertGreater(len(found), 3)
        for page, code in found:
            self.assertEqual(int(code[1:]), last[code[0]], f"{page}: {code}")


class LayersTest(unittest.TestCase):
    """The table of docs/architecture.md against tools/checks/check_layers.py, both ways."""

    def setUp(self):
        rows = re.findall(r"^\| (-?[\d.]+) \| (.*?) \| (.*?) \|$", text_of("docs/architecture.md"), re.MULTILINE)
        self.folders, self.files, self.meaning, self.other = {}, {}, {}, None
        for layer, where, meaning in rows:
            if where.startswith("other files"):
                self.other = float(layer)
                continue
            for name in re.findall(r"`([^`]+)`", where):
                (self.folders if name.endswith("/") else self.files)[name.rstrip("/")] = float(layer)
                self.meaning[name.rstrip("/")] = meaning

    def test_folders_are_in_the_layers_that_the_check_has(self):
        self.assertEqual(self.folders, check_layers.LAYER_OF_FOLDER)
        self.assertEqual(self.other, check_layers.TOP_LAYER)

    def test_files_are_in_the_layers_that_the_check_has(self):
        for name, layer in self.files.items():
            self.assertEqual(check_layers.layer_of(name.replace("*", "words_")), layer, name)

    def test_the_page_has_every_file_that_the_check_has(self):
        for pattern in check_layers.LAYER_OF_FILE:
            self.assertTrue(any(re.fullmatch(pattern, name.replace("*", "words_")) for name in self.files), pattern)

    def test_folders_exist_or_are_said_to_be_missing(self):
        for folder in self.folders:
            is_there = any((SOURCE / "engine" / folder).glob("**/*.[ch]pp"))
            self.assertEqual(is_there, not self.meaning[folder].startswith("not built yet"), folder)


class ListsOfPagesTest(unittest.TestCase):
    def linked(self, document):
        folder = (SOURCE / document).parent
        targets = (folder / target for target in LINK.findall(text_of(document)) if not target.startswith("http"))
        return {os.path.relpath(target.resolve(), DOCS.resolve()) for target in targets}

    def test_the_list_of_pages_has_every_page(self):
        named = self.linked("docs/README.md") | self.linked("docs/decisions/README.md")
        self.assertEqual([page for page in pages() if page not in named], [])

    def test_readme_and_getting_started_lead_to_every_page(self):
        own = {page for page in pages() if "/" not in page}
        self.assertLessEqual(own | {"README.md", "decisions/README.md"}, self.linked("README.md"))
        self.assertIn("README.md", self.linked("docs/getting-started.md"))


if __name__ == "__main__":
    unittest.main()
