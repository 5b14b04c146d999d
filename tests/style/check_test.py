#!/usr/bin/env python3
"""Each fault that check.py is there for is found in a tree that has it, and no other."""

import pathlib
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parent))
import check  # noqa: E402

GOOD = {
    "frame/plane.h": "#pragma once\n",
    "temporal/mean.cpp": '#include "frame/plane.h"\n#include "temporal/mean.h"\n#include <vector>\n',
    "temporal/mean.h": "#pragma once\nclass Mean {\n};\n",
    "spatial/blur_simd.cpp": '#include "spatial/blur_kernel.h"\n#include <hwy/highway.h>\nHWY_EXPORT(Blur);\n',
    "tests/spatial/blur_test.cpp": '#include "spatial/blur.h"\nEL_KERNEL_TEST(Blur, MatchesTheReference) {}\n',
    "spatial/blur-inl.h": "#include <hwy/highway.h>\n",
    "CMakeLists.txt": "# never -ffast-math\n",
}


class CheckTest(unittest.TestCase):
    def faults_with(self, name, text):
        with tempfile.TemporaryDirectory() as directory:
            root = pathlib.Path(directory)
            for path, content in {**GOOD, name: text}.items():
                (root / path).parent.mkdir(parents=True, exist_ok=True)
                (root / path).write_text(content)
            return [f for f in check.faults(root) if "not formatted" not in f]

    def test_a_good_tree_has_no_faults(self):
        self.assertEqual(self.faults_with("frame/plane.cpp", '#include "frame/plane.h"\n'), [])

    def test_each_fault_is_found(self):
        cases = [
            ("temporal/x.cpp", '#include "render/scene/scene.h"\n', "temporal/ must not include render/"),
            ("temporal/bases/x.cpp", '#include "temporal/change/edges.h"\n',
             "temporal/bases/ must not include temporal/change/"),
            ("temporal/samples/x.h", '#pragma once\n#include "temporal/methods.h"\n',
             "temporal/samples/ must not include temporal/"),
            ("spatial/x.cpp", '#include "spatial/rivals/pyramid.h"\n',
             "spatial/ must not include spatial/rivals/"),
            ("frame/x.cpp", '#include "spatial/blur.h"\n', "frame/ must not include spatial/"),
            ("spatial/x.cpp", '#include "temporal/mean.h"\n', "spatial/ must not include temporal/"),
            ("frame/x.cpp", '#include "plane.h"\n', "does not start at the root"),
            ("spatial/x.cpp", "#include <tbb/parallel_for.h>\n", "belongs in frame/tiles.cpp only"),
            ("render/x.cpp", "#include <embree3/rtcore.h>\n", "belongs in render/rays/embree_*"),
            ("render/x.cpp", "#include <nlohmann/json.hpp>\n", "belongs in sequences/*"),
            ("spatial/x.cpp", "#include <hwy/highway.h>\n", "belongs in *_simd.cpp, *-inl.h only"),
            ("sequences/x.cpp", "#include <OpenImageIO/imageio.h>\n", "belongs in"),
            ("frame/x.cpp", "\n" * 301, "longer than 300 lines"),
            ("frame/x.h", "\n", "no #pragma once"),
            ("temporal/x.h", "#pragma once\nstruct Mean final : Base {\n};\n", "Mean is defined in temporal/mean.h"),
            ("spatial/sharpen_simd.cpp", '#include "spatial/sharpen.h"\nHWY_EXPORT(Sharpen);\n',
             "no EL_KERNEL_TEST in tests/spatial/ includes its header"),
            ("frame/CMakeLists.txt", "add_compile_options(-march=native)\n", "changes floating"),
        ]
        for name, text, message in cases:
            with self.subTest(name=name, message=message):
                found = self.faults_with(name, text)
                self.assertEqual(len(found), 1, found)
                self.assertIn(message, found[0])

    def test_a_long_function_is_a_fault(self):
        def body(count, indent="  "):
            return "".join(f"{indent}int v{i} = {i};\n" for i in range(count))
        long_body = body(check.MAX_FUNCTION - 1)
        cases = [
            ("frame/x.cpp", "void F(int a) {\n" + long_body + "}\n", "frame/x.cpp:1: 41 lines"),
            ("frame/x.cpp", "int A::f(int a,\n         int b) {\n" + body(39) + "}\n",
             "frame/x.cpp:1: 42 lines in one function, at most 40: int A::f(int a,"),
            ("frame/x.h", "#pragma once\nclass A {\n public:\n  void f() {\n" + body(39, "    ")
             + "  }\n};\n", "frame/x.h:4: 41 lines"),
            ("tests/frame/x.cpp", "TEST(A, B) {\n#if X\n" + body(38) + "#endif\n}\n",
             "tests/frame/x.cpp:1: 42 lines"),
        ]
        for name, text, message in cases:
            with self.subTest(message=message):
                found = self.faults_with(name, text)
                self.assertEqual(len(found), 1, found)
                self.assertIn(message, found[0])
        shorter = "void F() {\n" + body(check.MAX_FUNCTION - 2) + "}\n"
        not_functions = ("const int kTable[] = {\n" + "  1,\n" * 50 + "};\n"
                         "struct A {\n" + body(50) + "};\n"
                         "namespace a {\n" + "\n" * 50 + "}  // namespace a\n")
        self.assertEqual(self.faults_with("frame/x.cpp", shorter + not_functions), [])

    def test_a_crowded_folder_is_a_fault(self):
        with tempfile.TemporaryDirectory() as directory:
            root = pathlib.Path(directory)
            (root / "frame").mkdir()
            for number in range(check.MAX_SOURCES + 1):
                (root / "frame" / f"{number}.cpp").write_text("\n")
            found = [f for f in check.faults(root) if "not formatted" not in f]
            self.assertEqual(found, ["frame:1: 41 sources in one folder, at most 40"])


if __name__ == "__main__":
    unittest.main()
