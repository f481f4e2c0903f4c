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
    """(name, reads, writes) of each stage, in order."""
    return re.findall(r'StageInfo\{\s*"([^"]*)",\s*"([^"]*)",\s*"([^"]*)"\s*\}', text_of("engine/stage_info.hpp"))


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

    def test_the_step_runs_the_stages_in_the_order_of_the_list(self):
        run = re.findall(r"run\(StageName::(\w+), plan\.(\w+)\)", text_of("engine/step.cpp"))
        names = [name for name, _, _ in stages_of_source()]
        self.assertEqual(run, [(name, name) for name in names])
        listed = re.search(r"enum class StageName[^{]*\{([^}]*)\}", text_of("engine/stage_info.hpp")).group(1)
        self.assertEqual(re.findall(r"\w+", listed), names)

    def test_constants_the_page_names_exist(self):
        sources = "".join(path.read_text() for path in (SOURCE / "engine").rglob("*.[ch]pp"))
        for name in re.findall(r"`(k[A-Z]\w+)`", text_of("docs/how-a-step-works.md")):
            self.assertRegex(sources, rf"\b{name}(<Real>)? =", name)


if __name__ == "__main__":
    unittest.main()
