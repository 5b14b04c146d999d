#!/usr/bin/env python3
"""Each fault that docs.py is there for is found in a tree that has it, and no other."""

import pathlib
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parent))
import docs  # noqa: E402

CODE = "\n" * 9 + "void update_tile(int k);  // line 10\n" + "\n" * 10
GOOD = {
    "README.md": "# Top\n[method](docs/method.md#the-step-update) [frame](frame/README.md) <a.md>\n",
    "frame/README.md": "see `[no link](nowhere.md)`, [up](..), [here](#own)\n## Own\n",
    "frame/update.h": CODE,
    "docs/method.md": ("## The step `update`\n[`update_tile`](../frame/update.h#L10), "
                       "[`A::update_tile(k)`](../frame/update.h#L12-L14), "
                       "[`update.h`](../frame/update.h#L1), [web](https://example.org/x#L1)\n"
                       "```\n[code](gone.md)\n```\n"),
    "build/x.md": "[gone](gone.md)\n",
}


class DocsTest(unittest.TestCase):
    def faults_with(self, files):
        with tempfile.TemporaryDirectory() as directory:
            root = pathlib.Path(directory)
            for path, content in {**GOOD, **files}.items():
                (root / path).parent.mkdir(parents=True, exist_ok=True)
                (root / path).write_text(content)
            return list(docs.faults(root))

    def test_a_good_tree_has_no_faults(self):
        self.assertEqual(self.faults_with({}), [])

    def test_each_fault_is_found(self):
        top = GOOD["README.md"]
        cases = [
            ({"README.md": top + "\n" * 148}, "README.md:150: longer than 149 lines"),
            ({"README.md": top + "x" * 121 + "\n"}, "README.md:3: longer than 120 columns"),
            ({"frame/README.md": GOOD["frame/README.md"] + "\n" * 78}, "longer than 79 lines"),
            ({"README.md": top + "[a](docs/gone.md)\n"}, "README.md:3: 'docs/gone.md' does not exist"),
            ({"README.md": top + "[a\nb](docs/gone.md)\n"}, "README.md:3: 'docs/gone.md' does not exist"),
            ({"README.md": top + "![a](docs/gone.jpg)\n"}, "'docs/gone.jpg' does not exist"),
            ({"README.md": top + "[a](..)\n"}, "'..' leads out of the project"),
            ({"README.md": top + "[a](docs/method.md#gone)\n"}, "no heading #gone in docs/method.md"),
            ({"README.md": top + "[a](#gone)\n"}, "no heading #gone in README.md"),
            ({"README.md": top + "[a](frame/update.h#L21)\n"}, "#L21: update.h has 20 lines"),
            ({"README.md": top + "[a](frame/update.h#L3-L2)\n"}, "#L3-L2: update.h has 20 lines"),
            ({"README.md": top + "[`update_tile`](frame/update.h#L5)\n"}, "no `update_tile` within 4"),
            ({"README.md": top + "[`update`](frame/update.h#L10)\n"}, "no `update` within 4 lines"),
            ({"docs/orphan.md": "[self](orphan.md)\n"}, "docs/orphan.md:1: no page links here"),
        ]
        for files, message in cases:
            with self.subTest(message=message):
                found = self.faults_with(files)
                self.assertEqual(len(found), 1, found)
                self.assertIn(message, found[0])

    def test_links_are_mended(self):
        code = ("// update_tile is called below\nstruct Move;\nvoid f() {\n  update_tile(1);\n}\n" + "\n" * 20 +
                "  void update_tile(int k);\n" + "\n" * 20 + "struct Move {\n  int step = 0;\n};\n")
        page = ("[`update_tile`](frame/update.h#L{})\n[`Move::step`](frame/update.h#L{})\n"
                "[`Move`](frame/update.h#L{})\n[`gone`](frame/update.h#L7)\n[`f`](frame/update.h#L{})\n")
        with tempfile.TemporaryDirectory() as directory:
            root = pathlib.Path(directory)
            (root / "frame").mkdir()
            (root / "frame/update.h").write_text(code)
            (root / "README.md").write_text(page.format(12, 0, 0, 5))
            docs.mend(root)
            self.assertEqual((root / "README.md").read_text(), page.format(26, 48, 47, 3))
            self.assertEqual(list(docs.faults(root)),
                             ["README.md:4: #L7: no `gone` within 4 lines of it in update.h"])

    def test_lengths_of_other_pages_are_free(self):
        self.assertEqual(self.faults_with({"docs/method.md": GOOD["docs/method.md"] + "\n" * 500}), [])

    def test_a_tree_without_pages_is_a_fault(self):
        with tempfile.TemporaryDirectory() as directory:
            self.assertIn("no page found", list(docs.faults(pathlib.Path(directory)))[0])

    def test_long_rows_of_tables_are_free(self):
        self.assertEqual(self.faults_with({"README.md": GOOD["README.md"] + "| " + "x" * 200 + " |\n"}), [])


if __name__ == "__main__":
    unittest.main()
