"""With Gymnasium installed the environment is one of its own: spaces that fit, wrappers that work."""

import sys
import unittest

import numpy as np

import mpmpbd

try:
    import gymnasium
    from gymnasium.vector import AutoresetMode, VectorEnv
    from gymnasium.wrappers.vector import FlattenObservation, RecordEpisodeStatistics
except ImportError:
    sys.exit(77)

SCENES = ["examples/scenes/coarse.toml", "examples/scenes/suturing_task.toml"]


def make(settings=None, **options):
    return mpmpbd.SuturingVectorEnv(2, config=[*SCENES, settings or {}], seed=3, **options)


class Gymnasium(unittest.TestCase):
    def test_spaces_hold_what_is_seen_and_done(self):
        env = make()
        self.assertIsInstance(env, VectorEnv)
        observations, _ = env.reset(seed=1)
        self.assertTrue(env.observation_space.contains(observations))
        env.action_space.seed(2)
        action = env.action_space.sample()
        self.assertEqual(action.shape, (2, 3))
        observations, *_ = env.step(action)
        self.assertTrue(env.observation_space.contains(observations))
        one = {name: view[0] for name, view in observations.items()}
        self.assertTrue(env.single_observation_space.contains(one))
        env.close()

    def test_the_way_of_resetting_is_declared(self):
        for name, mode in (
            ("same_step", AutoresetMode.SAME_STEP),
            ("next_step", AutoresetMode.NEXT_STEP),
            ("disabled", AutoresetMode.DISABLED),
        ):
            self.assertEqual(make(autoreset=name).metadata["autoreset_mode"], mode)

    def test_wrappers_take_it(self):
        env = make({"episode.limit": 2}, autoreset="next_step")
        wrapped = RecordEpisodeStatistics(FlattenObservation(env))
        flat, _ = wrapped.reset(seed=3)
        self.assertEqual(flat.shape[0], 2)
        returns = np.zeros(2)
        for _ in range(2):
            _, reward, _, truncated, info = wrapped.step(np.zeros((2, 3), np.float32))
            returns += reward
        self.assertTrue(truncated.all())
        np.testing.assert_allclose(info["episode"]["r"], returns, rtol=1e-6)


if __name__ == "__main__":
    unittest.main()
