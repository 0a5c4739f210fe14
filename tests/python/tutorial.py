"""The code of the tutorial runs as it stands there, block after block; that for a device in on_a_device/step_loop.py."""

import re
import unittest

TUTORIAL = "docs/tutorials/step_in_python.md"


def run_blocks(of_a_device):
    """Runs what comes before, or after, the heading of devices; returns how many blocks that were."""
    with open(TUTORIAL, encoding="utf-8") as file:
        parts = file.read().split("\n## 5. On a device\n")
    blocks = re.findall(r"^```python\n(.*?)^```$", parts[of_a_device], re.MULTILINE | re.DOTALL)
    names = {}
    if of_a_device:
        exec("import mpmpbd", names)
    for number, block in enumerate(blocks, 1):
        exec(compile(block, f"{TUTORIAL}, block {number}", "exec"), names)
    return len(blocks)


class Tutorial(unittest.TestCase):
    def test_every_block_runs(self):
        self.assertGreater(run_blocks(of_a_device=False), 3)


if __name__ == "__main__":
    unittest.main()
