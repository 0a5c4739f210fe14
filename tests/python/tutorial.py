"""The code of the tutorial runs as it stands there, block after block."""

import re
import unittest

TUTORIAL = "docs/tutorials/step_in_python.md"


class Tutorial(unittest.TestCase):
    def test_every_block_runs(self):
        with open(TUTORIAL, encoding="utf-8") as file:
            blocks = re.findall(r"^```python\n(.*?)^```$", file.read(), re.MULTILINE | re.DOTALL)
        self.assertGreater(len(blocks), 3)
        names = {}
        for number, block in enumerate(blocks, 1):
            exec(compile(block, f"{TUTORIAL}, block {number}", "exec"), names)


if __name__ == "__main__":
    unittest.main()
