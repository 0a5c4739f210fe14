"""The suturing task in Python: views instead of copies, episodes, settings, refusals, threads."""

import sys
import threading
import time
import unittest

import numpy as np

import mpmpbd

SCENES = ["examples/scenes/coarse.toml", "examples/scenes/suturing_task.toml"]


def make(num_envs=2, settings=None, **options):
    return mpmpbd.SuturingVectorEnv(num_envs, config=[*SCENES, settings or {}], **options)


def still(env):
    return np.zeros((env.num_envs, env.action_size), np.float32)


def address(array):
    return array.__array_interface__["data"][0]


class Views(unittest.TestCase):
    def test_shapes_and_types(self):
        env = make(3, {"episode.frames": 2})
        observations, info = env.reset()
        self.assertEqual(observations["needle_pose"].shape, (3, 2, 7))
        self.assertEqual(observations["needle_pose"].dtype, np.float32)
        observations, reward, terminated, truncated, info = env.step(still(env))
        self.assertEqual((reward.shape, reward.dtype), ((3,), np.float32))
        for flags in (terminated, truncated, info["diverged"]):
            self.assertEqual((flags.shape, flags.dtype), ((3,), np.bool_))
        self.assertEqual(info["status"].dtype, np.uint32)
        self.assertEqual(info["metrics"]["success"].shape, (3,))
        np.testing.assert_allclose(sum(info["terms"].values()), reward, rtol=1e-6)

    def test_every_step_shows_its_numbers_at_the_same_addresses(self):
        env = make()
        first, _ = env.reset()
        position = env.state("needle.x")
        was = {name: (address(view), view.copy()) for name, view in first.items()}
        started = position.copy()
        action = still(env)
        action[:, 1] = -1.0
        one, reward, *_ = env.step(action)
        self.assertIs(one["needle_pose"], first["needle_pose"])
        paid, earlier = address(reward), reward.copy()
        _, reward, *_ = env.step(action)
        self.assertEqual(address(reward), paid)
        self.assertTrue((reward != earlier).all())
        for name, (where, _) in was.items():
            self.assertEqual(address(one[name]), where)
        self.assertFalse(np.array_equal(one["needle_pose"], was["needle_pose"][1]))
        self.assertTrue((position[:, 0, 2] < started[:, 0, 2]).all())  # the state's view follows, too

    def test_what_is_seen_is_the_state(self):
        env = make()
        env.reset()
        observations, *_ = env.step(still(env))
        np.testing.assert_array_equal(
            observations["needle_twist"][:, 0, :3], env.state("needle.v")[:, 0]
        )

    def test_state_fields_are_read_only_views_of_planes(self):
        env = make()
        x = env.state("particle.x")
        self.assertEqual(x.shape, (2, 2000, 3))
        self.assertEqual(x.strides, (2000 * 4, 4, 2 * 2000 * 4))
        self.assertFalse(x.flags.writeable)
        self.assertFalse(x.flags.owndata)
        self.assertEqual(env.fields["particle.x"], "m")
        self.assertEqual(env.live("particle"), [2000, 2000])

    def test_other_libraries_take_the_arrays_themselves(self):
        env = make()
        observations, _ = env.reset()
        seen = np.from_dlpack(env.observation_arrays["tip_and_markers"])
        self.assertEqual(address(seen), address(observations["tip_and_markers"]))
        paid = np.from_dlpack(env.outcome_arrays["reward"])
        _, reward, *_ = env.step(still(env))
        self.assertEqual(address(paid), address(reward))
        self.assertEqual(paid.tobytes(), reward.tobytes())

    def test_a_view_outlives_the_environment(self):
        observations, _ = make().reset()
        view = observations["needle_pose"]
        kept = view.copy()
        del observations
        np.testing.assert_array_equal(view, kept)


class Episodes(unittest.TestCase):
    def test_bits_do_not_depend_on_neighbours_and_threads(self):
        def play(env, column):
            random = np.random.default_rng(5)
            env.reset()
            paid = []
            for action in random.uniform(-1, 1, (3, 3)):
                _, reward, *_ = env.step(np.tile(action, (env.num_envs, 1)))
                paid.append(reward[column].tobytes())
            return paid

        several = play(make(3, seed=9, threads=2), 2)
        alone = play(make(1, seed=9, threads=1, first_environment=2), 0)
        self.assertEqual(several, alone)
        self.assertNotEqual(several, play(make(3, seed=10, threads=2), 2))

    def test_a_seed_begins_from_the_first_episode(self):
        env = make(seed=4)
        pose = env.reset()[0]["needle_pose"]
        first = pose.copy()
        env.step(still(env))
        env.reset()
        self.assertFalse(np.array_equal(pose, first))
        env.reset(seed=4)
        np.testing.assert_array_equal(pose, first)

    def test_without_a_seed_it_is_that_of_the_settings(self):
        def first(settings, **options):
            return make(2, settings, **options).reset()[0]["tip_and_markers"].tobytes()

        other = first({"seed": 4})
        self.assertEqual(other, first({}, seed=4))
        self.assertNotEqual(other, first({}))
        self.assertEqual(first({"seed": 4}, seed=1), first({}))
        env = make(settings={"seed": 4}, seed=9)
        self.assertIn("\nseed = 9 ", env.config)
        env.reset(seed=11)
        self.assertIn("\nseed = 11 ", env.config)

    def test_a_mask_resets_some(self):
        env = make()
        pose = env.reset()[0]["needle_pose"]
        before = pose.copy()
        env.reset(options={"reset_mask": np.array([False, True])})
        np.testing.assert_array_equal(pose[0], before[0])
        self.assertFalse(np.array_equal(pose[1], before[1]))

    def test_the_last_observation_of_an_episode_is_kept(self):
        env = make(settings={"episode": {"limit": 1}})
        observations, _ = env.reset()
        _, _, terminated, truncated, info = env.step(still(env))
        self.assertTrue(truncated.all())
        self.assertFalse(terminated.any())
        self.assertTrue(info["_final_obs"].all())
        last = info["final_obs"]["needle_pose"]
        self.assertFalse(np.array_equal(last, observations["needle_pose"]))
        self.assertEqual(list(info["episode_length"]), [1, 1])

        env = make(settings={"episode": {"limit": 1}}, autoreset="next_step")
        env.reset()
        _, _, _, truncated, info = env.step(still(env))
        self.assertTrue(truncated.all())
        self.assertNotIn("final_obs", info)
        _, reward, _, truncated, info = env.step(still(env))
        self.assertTrue(info["restarted"].all())
        self.assertFalse(truncated.any())
        self.assertEqual(list(reward), [0, 0])


class Settings(unittest.TestCase):
    def test_later_ones_win_and_numpy_is_understood(self):
        env = make(settings={"hand.speed_m_s": np.float64(0.25), "episode": {"limit": np.int64(7)}})
        self.assertIn("speed_m_s = 0.25 ", env.config)
        self.assertIn("limit = 7 ", env.config)
        self.assertIn("points = [20, 10, 10]", env.config)  # of coarse.toml
        self.assertAlmostEqual(env.decision_time, 0.08)

    def test_wrong_ones_are_refused_with_the_sentences_of_the_library(self):
        for settings, sentence in (
            ({"episode.limt": 3}, "key episode.limt is not known; did you mean episode.limit?"),
            ({"tissue": {"points": [1, 2]}}, "tissue.points = .* is a list of 2; give 3 whole"),
            ({"tissue.poisson_ratio": 0.5}, "tissue.poisson_ratio = 0.5"),
        ):
            with self.assertRaisesRegex(ValueError, sentence):
                make(settings=settings)
        with self.assertRaisesRegex(TypeError, "config is a int; give a path, a dictionary"):
            mpmpbd.SuturingVectorEnv(1, config=7)
        with self.assertRaisesRegex(TypeError, "episode.limit is a NoneType; give a number"):
            make(settings={"episode.limit": None})
        with self.assertRaises(FileNotFoundError):
            mpmpbd.SuturingVectorEnv(1, config="no/such.toml")


class Refusals(unittest.TestCase):
    def test_each_says_what_is_wrong(self):
        env = make()
        for what, sentence in (
            (lambda: env.step(np.zeros((3, 2))), r"shape \(2, 3\) are needed; given are \(3, 2\) of float32"),
            (lambda: env.state("particle.q"), "no field 'particle.q' is stored; there are .*particle.x"),
            (lambda: env.live("atom"), "no domain 'atom'; there are environment, particle"),
            (lambda: env.start(5, 1), r"start\(5, 1, 5\); there are environments 0 to 1"),
            (lambda: env.reset(options={"reset_mask": [True]}), r"a mask of bool or uint8 and shape \(2\) is needed; given are \(1\)"),
            (lambda: env.reset(options={"reset_mask": [0, 1]}), r"a mask of bool or uint8 and shape \(2\) is needed"),
            (lambda: env.reset(seed=1, options={"reset_mask": [True, False]}), "seed or reset_mask"),
            (lambda: make(0), "num_envs = 0; give at least 1"),
            (lambda: make(threads=-1), "threads = -1; give 0 for as many"),
            (lambda: make(autoreset="never"), "autoreset = 'never'; give 'same_step'"),
        ):
            with self.assertRaisesRegex(ValueError, sentence):
                what()

    def test_a_device_that_is_not_there_is_refused(self):
        with self.assertRaisesRegex(RuntimeError, "built without CUDA|device 99 asked for"):
            make(device="cuda:99", as_array=lambda array: array)

    def test_an_invalid_action_ends_its_own_episode(self):
        env = make()
        env.reset()
        action = still(env)
        action[1, 0] = np.nan
        _, _, _, truncated, info = env.step(action)
        self.assertEqual(list(truncated), [False, True])
        self.assertEqual(list(info["invalid_action"]), [False, True])

    def test_without_gymnasium_only_spaces_are_missing(self):
        hidden = {name: sys.modules.get(name) for name in list(sys.modules) if name.startswith("gymnasium")}
        for name in (*hidden, "gymnasium"):
            sys.modules[name] = None  # as if it were not installed
        try:
            env = make()
            with self.assertRaisesRegex(ImportError, "gymnasium, which is not installed"):
                env.single_action_space
            self.assertEqual(env.metadata["autoreset_mode"], "same_step")
        finally:
            del sys.modules["gymnasium"]
            sys.modules.update({name: module for name, module in hidden.items() if module})


class Threads(unittest.TestCase):
    def test_python_goes_on_while_environments_step(self):
        env = make(8, threads=1)
        env.reset()
        done = threading.Event()

        def work():
            env.step(still(env))
            done.set()

        worker = threading.Thread(target=work)
        worker.start()
        ticks = 0
        while not done.is_set():
            time.sleep(0.002)
            ticks += 1
        worker.join()
        self.assertGreater(ticks, 10)  # two or three if the step kept the interpreter's lock


if __name__ == "__main__":
    unittest.main()
