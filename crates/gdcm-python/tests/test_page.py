"""The code of docs/python.md, run in order as one program."""

import os
import re
import sys
import tempfile
import unittest
from pathlib import Path

PAGE = Path(__file__).parents[3] / "docs" / "python.md"
CODE = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)


class Page(unittest.TestCase):
    def test_the_code_of_the_page_runs_in_order(self) -> None:
        text = PAGE.read_text(encoding="utf-8")
        # The code writes files.
        original_folder = os.getcwd()
        names = {"__name__": "page"}
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            try:
                for block in CODE.finditer(text):
                    line = text.count("\n", 0, block.start(1))
                    # Empty lines before the code give a traceback the line numbers of the page.
                    code = compile("\n" * line + block.group(1), str(PAGE), "exec")
                    exec(code, names)
            finally:
                os.chdir(original_folder)
        self.assertGreater(len(CODE.findall(text)), 5, "the blocks of the page were not found")


if __name__ == "__main__":
    sys.exit(unittest.main())
