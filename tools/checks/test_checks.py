#!/usr/bin/env python3
"""Every check can fail: each is shown files that break its rule and files that keep it."""
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

import check_exact_operations
import check_file_length
import check_format
import check_includes
import check_isa_symbols
import check_layers
import check_names
from sources import ROOT, without_comments

COMPILER = os.environ.get("CXX", "c++")


class WithFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name).resolve()

    def write(self, path, text):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
        return file

    def compile(self, text, *flags):
        source = self.write("unit.cpp", text)
        subprocess.run([COMPILER, "-std=c++20", "-c", *flags, source, "-o", source.with_suffix(".o")], check=True)
        return source.with_suffix(".o")


class WithoutComments(unittest.TestCase):
    def test_comments_and_literals_go_and_lines_stay(self):
        text = '#include "a.hpp"  // why\nint a = 1\'000; /* two\nlines */ auto b = R"x("//)x"; char c = \'"\'; // end\n'
        self.assertEqual(without_comments(text),
                         '#include "a.hpp"  \nint a = 1\'000; \n auto b = ""; char c = ""; \n')


class CheckLayers(WithFolder):
    def setUp(self):
        super().setUp()
        for path in ("math/vec2", "state/bodies", "kernels/arguments", "kernels/drag", "solvers/impulse/impulse", "sleeping/islands",
                     "reference/pairwise", "include/carom/world", "step/step"):
            self.write(f"engine/{path}.hpp", "")

    def findings(self, path, text):
        self.write(path, text)
        return check_layers.check(self.root)

    def assert_fails(self, path, text, expected):
        findings = self.findings(path, text)
        self.assertEqual(len(findings), 1, findings)
        self.assertIn(expected, findings[0])

    def test_lower_layers_and_the_own_folder_are_fine(self):
        text = '#include <carom/world.hpp>\n#include "kernels/arguments.hpp"\n#include "islands.hpp"\n#include <vector>\n'
        self.assertEqual(self.findings("engine/sleeping/rod.cpp", text), [])

    def test_a_higher_layer(self):
        self.assert_fails("engine/state/contacts.hpp", '\n#include "solvers/impulse/impulse.hpp"\n', "contacts.hpp:2")

    def test_a_neighbour_in_the_same_layer(self):
        self.assert_fails("engine/sleeping/rod.cpp", '#include "../solvers/impulse/impulse.hpp"\n', "layer 7 includes layer 8.5")

    def test_a_file_above_its_folder(self):
        self.assert_fails("engine/kernels/arguments.hpp", '#include "kernels/drag.hpp"\n', "layer 2.9 includes layer 3")

    def test_folders_of_a_layer_that_include_each_other(self):
        self.write("engine/solvers/soft/joints/held.hpp", '#include "solvers/soft/impacts/blow.hpp"\n')
        self.write("engine/solvers/soft/impacts/blow.hpp", "")
        self.assertEqual(check_layers.check(self.root), [])
        self.write("engine/solvers/soft/step_view.hpp", '#include "solvers/soft/joints/held.hpp"\n')
        findings = self.findings("engine/solvers/soft/impacts/impacts.hpp", '#include "solvers/soft/step_view.hpp"\n')
        self.assertEqual(len(findings), 3, findings)
        self.assertIn("engine/solvers/soft/impacts/impacts.hpp: includes solvers/soft/, from which", "\n".join(findings))

    def test_a_stage_that_includes_the_step(self):
        self.assert_fails("engine/solvers/soft/soft_solver.cpp", '#include "step/step.hpp"\n', "layer 8.5 includes layer 9")

    def test_a_folder_in_no_layer(self):
        self.assert_fails("engine/magic/wand.cpp", '#include "math/vec2.hpp"\n', "engine/magic is in no layer")

    def test_a_public_header_that_includes_a_private_one(self):
        self.assert_fails("engine/include/carom/scene.hpp", '#include "math/vec2.hpp"\n', "only public headers")

    def test_the_reference_shares_nothing(self):
        self.assert_fails("engine/reference/walls.cpp", '#include "math/vec2.hpp"\n', "shares no code")
        (self.root / "engine/reference/walls.cpp").unlink()
        self.assert_fails("engine/solvers/soft/soft_solver.cpp", '#include "reference/pairwise.hpp"\n', "shares no code")

    def test_a_tool_that_includes_a_private_header(self):
        self.assert_fails("tools/carom/run.cpp", '#include "state/bodies.hpp"\n', "public headers only")

    def test_xsimd_outside_of_its_places(self):
        self.assert_fails("engine/solvers/soft/soft_solver.cpp", "#include <xsimd/xsimd.hpp>\n", "includes xsimd outside")

    def test_openmp_outside_of_its_place(self):
        self.assert_fails("engine/solvers/soft/soft_solver.cpp", "void f() {\n#pragma omp parallel\n}\n", "uses OpenMP outside")
        self.assertEqual(self.findings("engine/solvers/soft/soft_solver.cpp", "// no #pragma omp here\n"), [])
        self.assertEqual(self.findings("engine/parallel/chunks.cpp", "#pragma omp parallel for\n"), [])


class CheckExactOperations(WithFolder):
    def findings(self, line, path="engine/solvers/impulse/impulse_solver.cpp"):
        self.write(path, line + "\n")
        return check_exact_operations.check(self.root)

    def test_each_banned_operation_is_found(self):
        for line in ("x = std::fma(a, b, c);", "x = xsimd::fma(a, b, c);", "_mm256_fmadd_ps(a, b, c)", "xsimd::rsqrt(x)",
                     "_mm512_rcp14_ps(x)", "xsimd::reciprocal(x)", "std::sin(x)", "using std::atan2;", "y = cosf(x);",
                     "return hypot(x, y);", "y = 2 * exp(-x);", "xsimd::hadd(x)", "_mm512_reduce_add_ps(x)",
                     "std::reduce(a, b)", "#pragma omp parallel for reduction(+ : sum)", "#pragma GCC optimize(\"fast\")"):
            self.assertEqual(len(self.findings(line)), 1, line)

    def test_exact_operations_and_comments_are_fine(self):
        for line in ("x = std::sqrt(a * a + b * b);", "// std::sin would differ", "auto sin = s.sin; rotate(cos, sin);",
                     "reduce_max(x); inverse_mass(x); std::accumulate(a, b, 0.0);", "expect(x); maximum(x);"):
            self.assertEqual(self.findings(line), [], line)

    def test_a_reason_excuses_a_line_and_no_other(self):
        self.assertEqual(self.findings("y = std::exp(x);  // inexact: once per scene, result is stored"), [])
        self.assertEqual(self.findings("// inexact: once per scene,\n// not per step\ny = std::exp(x);"), [])
        self.assertEqual(len(self.findings("y = std::exp(x);  // inexact:")), 1)
        self.assertEqual(len(self.findings("// inexact: once per scene\n\ny = std::exp(x);")), 1)
        self.assertEqual(len(self.findings("x = 1;  // inexact: not this\ny = 2;\ny = std::exp(x);")), 1)

    def test_flags_that_change_results_are_found_in_build_files(self):
        for flag in ("-ffast-math", "-Ofast", "-ffp-contract=fast", "-mfma", "-march=native"):
            self.assertEqual(len(self.findings(f"add_compile_options({flag})", "CMakeLists.txt")), 1, flag)
        self.assertEqual(self.findings("add_compile_options(-O3 -ffp-contract=off)", "CMakeLists.txt"), [])

    @unittest.skipUnless(os.uname().machine == "x86_64", "compiles for x86-64")
    def test_fused_instructions_are_found_in_object_files(self):
        text = "float f(float a, float b, float c) { return a * b + c; }"
        fused = self.compile(text, "-O2", "-mavx2", "-mfma", "-ffp-contract=fast")
        findings = check_exact_operations.check(self.root, [fused])
        self.assertEqual(len(findings), 1, findings)
        self.assertIn("in f(float, float, float)", findings[0])
        exact = self.compile(text, "-O2", "-mavx2", "-mfma", "-ffp-contract=off")
        self.assertEqual(check_exact_operations.check(self.root, [exact]), [])


class CheckIsaSymbols(WithFolder):
    def test_a_weak_symbol_is_found(self):
        weak = self.compile("__attribute__((noinline)) inline int f(int x) { return x * x; }\n"
                            "int g(int x) { return f(x); }")
        findings = check_isa_symbols.check([weak])
        self.assertEqual(len(findings), 1, findings)
        self.assertIn("W f(int)", findings[0])

    def test_internal_linkage_is_fine(self):
        local = self.compile("static __attribute__((noinline)) int f(int x) { return x * x; }\n"
                             "int g(int x) { return f(x); }")
        self.assertEqual(check_isa_symbols.check([local]), [])


class CheckFileLength(WithFolder):
    def test_a_long_file_needs_a_reason(self):
        self.write("engine/a.cpp", "int a;\n" * 501)
        self.assertEqual(check_file_length.check(self.root), ["engine/a.cpp: 501 lines"])
        self.write("engine/a.cpp", "// length: one table\n" + "int a;\n" * 501)
        self.assertEqual(check_file_length.check(self.root), [])
        self.write("engine/a.cpp", "int a;\n" * 500)
        self.assertEqual(check_file_length.check(self.root), [])


class CheckNames(WithFolder):
    def test_a_constant_of_a_header_has_no_namesake(self):
        self.write("engine/a.hpp", "inline constexpr double kLittle = 1;\n")
        self.write("engine/b.cpp", "namespace {\ntemplate <class Real>\nconstexpr Real kLittle = 2;\n}\n")
        self.assertEqual(check_names.check(self.root), ["kLittle: engine/a.hpp:1, engine/b.cpp:3"])

    def test_two_source_files_and_a_constant_of_a_function_may(self):
        self.write("engine/a.hpp", "void f() {\n    constexpr int kMost = 1;\n}\n")
        self.write("engine/b.cpp", "constexpr int kMost = 2;\n")
        self.write("engine/c.cpp", "constexpr int kMost = 3;\n")
        self.assertEqual(check_names.check(self.root), [])

    def test_a_file_of_tests_is_a_namespace(self):
        self.write("tests/physics/test_falls.cpp", "#include <vector>\nnamespace test_falls {\nint f();\n}\n")
        self.assertEqual(check_names.check(self.root), [])
        self.write("tests/physics/test_falls.cpp", "#include <vector>\nnamespace {\nint f();\n}\n")
        self.assertEqual(check_names.check(self.root), ["tests/physics/test_falls.cpp: has no namespace test_falls"])


class CheckIncludes(WithFolder):
    def setUp(self):
        super().setUp()
        self.write("engine/include/carom/body.hpp", "#include <vector>\nnamespace carom {\nstruct Body {};\n}\n")
        self.write("engine/state/rows.hpp", "namespace carom {\ninline constexpr int kRows = 8;\nint rows_of(int bodies);\n"
                                            "struct alignas(64) Row {};\ntemplate <class T>\nclass Rows {};\nusing Pair = int;\n}\n")
        self.write("engine/state/all.hpp", '#include "state/rows.hpp"\n#include <carom/body.hpp>\n')

    def findings(self, text, path="engine/state/rows.cpp"):
        self.write(path, text)
        return check_includes.check(self.root)

    def test_what_comes_by_way_of_project_headers_is_fine(self):
        uses = "std::vector<Body> v;\nstd::size_t n;\nRows<Row> r[kRows];\nPair p = rows_of(3);\n"
        self.assertEqual(self.findings('#include "all.hpp"\n' + uses), [])
        self.assertEqual(self.findings('#include "state/rows.hpp"\n#include <carom/body.hpp>\n' + uses), [])

    def test_a_name_of_the_library_without_its_header(self):
        findings = self.findings("#include <algorithm>\n\nstd::vector<int> v;  // std::map\nauto x = std::min(1, 2);\n")
        self.assertEqual(findings, ["engine/state/rows.cpp:3: std::vector without <vector>"])

    def test_headers_of_the_library_bring_no_others(self):
        self.assertEqual(len(self.findings("#include <functional>\nauto x = std::move(y);\n")), 1)

    def test_a_name_of_the_library_that_the_table_has_not(self):
        self.assertIn("is not in the table", self.findings("#include <map>\nstd::map<int, int> m;\n")[0])

    def test_each_kind_of_name_of_a_project_header(self):
        for use in ("Body b;", "f(Rows<int>());", "Row r;", "Pair p;", "int a[kRows];", "return rows_of(3);", "x = rows_of(y);"):
            self.assertEqual(len(self.findings(f"void f() {{\n{use}\n}}\n")), 1, use)

    def test_own_names_and_members_need_no_header(self):
        for use in ("struct Row {};\nRow r;", "using Pair = long;\nPair p;", "constexpr int kRows = 3;\nint a[kRows];",
                    "int rows_of(int);\nint x = rows_of(3);", "x = y.rows_of(3) + z->rows_of(4) + other::rows_of(5);", "x = Kind::Body;"):
            self.assertEqual(self.findings(use + "\n"), [], use)

    def test_a_public_header(self):
        self.assertEqual(len(self.findings("struct World {\n    Body body;\n};\n", "engine/include/carom/world.hpp")), 1)


class CheckFormat(WithFolder):
    def test_a_file_that_clang_format_would_change(self):
        shutil.copy(ROOT / ".clang-format", self.root)
        self.write("engine/a.cpp", "int  a ;\n")
        self.assertNotEqual(check_format.check(self.root), [])
        check_format.check(self.root, fix=True)
        self.assertEqual(check_format.check(self.root), [])
        self.assertEqual((self.root / "engine/a.cpp").read_text(), "int a;\n")


if __name__ == "__main__":
    unittest.main()
