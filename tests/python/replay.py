"""Episodes that the C++ program `record` has recorded go the same way in Python, bit for bit."""

import os
import sys
import unittest

import numpy as np

import mpmpbd

try:
    import h5py
except ImportError:
    sys.exit(77)

RECORDED = os.environ["MPMPBD_RECORDED"]
if not os.path.exists(f"{RECORDED}/episodes.hdf5"):
    sys.exit(77)


class Replay(unittest.TestCase):
    def test_the_same_actions_show_and_pay_the_same_bits(self):
        with h5py.File(f"{RECORDED}/episodes.hdf5") as file:
            demos = list(file["data"].values())
            self.assertGreater(len(demos), 0)
            for demo in demos:
                self.repeat(demo)

    def repeat(self, demo):
        # As the second of three environments: the recorded one had other neighbours.
        env = mpmpbd.SuturingVectorEnv(
            3, config=f"{RECORDED}/config.toml", seed=int(demo.attrs["seed"]), autoreset="disabled"
        )
        observations = env.start(1, int(demo.attrs["episode"]), int(demo.attrs["environment"]))
        actions = np.zeros((3, env.action_size), np.float32)
        for t, action in enumerate(demo["actions"][()]):
            for group, seen in demo["obs"].items():
                self.assertEqual(observations[group][1, -1].tobytes(), seen[t].tobytes())
            actions[1] = action
            _, reward, terminated, truncated, info = env.step(actions)
            self.assertEqual(reward[1].tobytes(), demo["rewards"][t].tobytes())
            terms = np.array([info["terms"][name][1] for name in info["terms"]])
            self.assertEqual(terms.tobytes(), demo["terms"][t].tobytes())
        self.assertTrue(terminated[1] or truncated[1])


if __name__ == "__main__":
    unittest.main()
