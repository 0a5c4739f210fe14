"""The step loop on a device, which takes tensors where they lie and shows what it has as tensors.

Where PyTorch and a GPU are: PYTHON=... scripts/python.sh --cuda tests/python/on_a_device/step_loop.py.
With MPMPBD_EMULATED=1 the module is one whose device is emulated (ctest: python/on_emulated_device); memory of the host
stands in for the device's, and NumPy for PyTorch.
"""

import ctypes
import gc
import os
import sys
import threading
import types
import unittest
import weakref

import numpy as np

import mpmpbd

sys.path.insert(0, "tests/python")
import tutorial

SCENES = ["examples/scenes/coarse.toml", "examples/scenes/suturing_task.toml"]

if os.environ.get("MPMPBD_EMULATED") == "1":

    class Tensor(np.ndarray):
        """Says that it lies on a device."""

        device_number = 0
        streams = []  # on which its like were asked for

        def __dlpack_device__(self):
            return (2, self.device_number)

        def __dlpack__(self, *, stream):
            self.streams.append(stream)
            numbers = np.asarray(self)
            flags = numbers.dtype == np.bool_
            capsule = (numbers.view(np.uint8) if flags else numbers).__dlpack__()
            pointer = ctypes.pythonapi.PyCapsule_GetPointer
            pointer.restype, pointer.argtypes = ctypes.c_void_p, [ctypes.py_object, ctypes.c_char_p]
            tensor = pointer(capsule, b"dltensor")  # data, device, number of axes, type
            ctypes.cast(tensor + 8, ctypes.POINTER(ctypes.c_int32 * 2)).contents[:] = self.__dlpack_device__()
            if flags:
                ctypes.cast(tensor + 20, ctypes.POINTER(ctypes.c_uint8)).contents.value = 6
            return capsule

    class OnHost:
        def __init__(self, array):
            self.owner = array
            self.__array_interface__ = dict(array.__cuda_array_interface__)

    def tensor_of(array):
        return np.asarray(OnHost(array)).view(Tensor)

    def tensor(numbers):
        return np.array(numbers).view(Tensor)

    def numpy_of(seen):
        return np.array(seen)

    def address(seen):
        return seen.__array_interface__["data"][0]

    sys.modules["torch"] = types.SimpleNamespace(
        from_dlpack=tensor_of, zeros=lambda shape, device: tensor(np.zeros(shape, np.float32))
    )

else:
    import torch

    tensor_of = torch.from_dlpack

    def tensor(numbers):
        return torch.as_tensor(numbers, device="cuda:0")

    def numpy_of(seen):
        return seen.cpu().numpy()

    def address(seen):
        return seen.data_ptr()


SMALL = {
    "tissue.points": [16, 8, 8],
    "episode": {"decision_interval": 2, "limit": 3},
}


def make(num_envs=2, settings=None, **options):
    options = {"device": "cuda", "as_array": tensor_of, **options}
    return mpmpbd.SuturingVectorEnv(num_envs, config=[*SCENES, SMALL, settings or {}], **options)


def down(env, dtype=np.float32):
    actions = np.zeros((env.num_envs, env.action_size), dtype)
    actions[:, 1] = -np.linspace(0.5, 1.0, env.num_envs)
    return actions


class Views(unittest.TestCase):
    def test_every_step_shows_its_numbers_at_the_same_places(self):
        env = make(3, {"episode.frames": 2})
        first, info = env.reset()
        pose = first["needle_pose"]
        self.assertEqual(tuple(pose.shape), (3, 2, 7))
        self.assertEqual(env.observation_arrays["needle_pose"].__dlpack_device__(), (2, 0))
        self.assertEqual(address(pose), env.observation_arrays["needle_pose"].__cuda_array_interface__["data"][0])
        before = numpy_of(pose).copy()
        observations, reward, terminated, truncated, info = env.step(tensor(down(env)))
        self.assertIs(observations["needle_pose"], pose)
        self.assertFalse(np.array_equal(numpy_of(pose), before))
        self.assertEqual(numpy_of(terminated).dtype, np.bool_)
        self.assertEqual(list(numpy_of(info["episode_length"])), [1, 1, 1])
        np.testing.assert_allclose(
            sum(numpy_of(term) for term in info["terms"].values()), numpy_of(reward), rtol=1e-5
        )

    def test_the_state_is_seen_and_found_on_the_host(self):
        env = make()
        env.step(tensor(down(env)))
        nobody = tensor(np.zeros(2, np.bool_))
        twist = numpy_of(env.reset(options={"reset_mask": nobody})[0]["needle_twist"])
        np.testing.assert_array_equal(twist[:, 0, :3], numpy_of(env.state("needle.v"))[:, 0])
        self.assertEqual(env.live("particle"), [1024, 1024])

    def test_a_view_outlives_the_environment(self):
        pose = make().reset()[0]["needle_pose"]
        kept = numpy_of(pose).copy()
        gc.collect()
        make().step(np.ones((2, 3)))  # which would take the memory, were it free
        np.testing.assert_array_equal(numpy_of(pose), kept)


class Episodes(unittest.TestCase):
    def test_it_does_what_the_host_does(self):
        device, host = make(), make(device="cpu", as_array=None)
        for env in (device, host):
            env.reset(seed=5)
        for _ in range(4):  # over the end of an episode
            seen, reward, terminated, truncated, info = device.step(tensor(down(device)))
            there, _, ended, stopped, says = host.step(down(host))
            np.testing.assert_allclose(numpy_of(seen["needle_pose"]), there["needle_pose"], atol=1e-5)
            for one, other in ((terminated, ended), (truncated, stopped), (info["status"], says["status"])):
                np.testing.assert_array_equal(numpy_of(one), other)

    def test_actions_of_the_host_give_the_same_bits(self):
        here, there = make(seed=7), make(seed=7)
        for _ in range(2):
            seen, reward, *_ = here.step(tensor(down(here)))
            also, paid, *_ = there.step(down(there, np.float64))
            np.testing.assert_array_equal(numpy_of(reward), numpy_of(paid))
            for name in seen:
                np.testing.assert_array_equal(numpy_of(seen[name]), numpy_of(also[name]))

    def test_a_mask_resets_some(self):
        for mask in (tensor(np.array([False, True])), tensor(np.array([0, 1], np.uint8)), [False, True]):
            env = make()
            pose = env.reset()[0]["needle_pose"]
            before = numpy_of(pose).copy()
            env.reset(options={"reset_mask": mask})
            np.testing.assert_array_equal(numpy_of(pose)[0], before[0])
            self.assertFalse(np.array_equal(numpy_of(pose)[1], before[1]))

    def test_what_has_ended_begins_anew_by_its_own_flags(self):
        env = make(settings={"episode.limit": 1}, autoreset="disabled")
        observations, _, _, truncated, info = env.step(tensor(down(env)))
        self.assertNotIn("final_obs", info)
        last = numpy_of(observations["needle_pose"]).copy()
        env.reset(options={"reset_mask": truncated})
        self.assertTrue((numpy_of(observations["needle_pose"]) != last).any(axis=(1, 2)).all())

    def test_what_ended_is_told_without_looking(self):
        env = make(settings={"episode.limit": 2})
        for ends in (False, True):
            observations, _, _, truncated, info = env.step(tensor(down(env)))
            self.assertEqual(list(numpy_of(info["_final_obs"])), [ends, ends])
            self.assertEqual(list(numpy_of(truncated)), [ends, ends])
        last, new = (numpy_of(seen["needle_pose"]) for seen in (info["final_obs"], observations))
        self.assertFalse(np.array_equal(last, new))


class Tutorial(unittest.TestCase):
    def test_its_blocks_for_a_device_run(self):
        self.assertEqual(tutorial.run_blocks(of_a_device=True), 1)


class Lending(unittest.TestCase):
    def test_actions_are_kept_until_the_next_ones(self):
        env = make()
        lent = tensor(down(env))
        owner = getattr(lent, "base", lent)  # of the memory, where Python knows it
        watch = weakref.ref(owner)
        known = owner is not lent
        env.step(lent)
        del lent, owner
        gc.collect()
        self.assertTrue(watch() is not None or not known)
        env.step(tensor(down(env)))
        gc.collect()
        self.assertIsNone(watch())

    def test_what_does_not_fit_is_refused_and_nothing_happens(self):
        env = make()
        pose = env.reset()[0]["needle_pose"]
        before = numpy_of(pose).copy()
        wide = tensor(np.zeros((2, 6), np.float32))
        for given, sentence in (
            (
                tensor(np.zeros((3, 2), np.float32)),
                r"actions of float32 and shape \(2, 3\) are needed; given are \(3, 2\) of float32",
            ),
            (tensor(np.zeros((2, 3))), r"given are \(2, 3\) of float64"),
            (wide[:, ::2], r"without gaps"),
            (np.zeros((3, 2), np.float32), r"given are \(3, 2\)"),
        ):
            with self.assertRaisesRegex(ValueError, sentence):
                env.step(given)
        for flags, sentence in (
            (np.zeros(3, np.bool_), r"a mask of bool or uint8 and shape \(2\) is needed; given are \(3\) of bool"),
            (np.zeros(2, np.int64), r"given are \(2\) of int64"),
        ):
            with self.assertRaisesRegex(ValueError, sentence):
                env.reset(options={"reset_mask": tensor(flags)})
        np.testing.assert_array_equal(numpy_of(pose), before)

    @unittest.skipIf("torch" in globals(), "one GPU may be all there are")
    def test_numbers_of_another_device_are_refused(self):
        env = make()
        lent = tensor(down(env))
        lent.device_number = 3
        with self.assertRaisesRegex(ValueError, "needed on CUDA device 0; given are some on CUDA device 3"):
            env.step(lent)

    @unittest.skipIf("torch" in globals(), "PyTorch does not tell what it was asked")
    def test_lenders_are_told_the_stream_of_the_environments(self):
        for stream, number in ((0, 1), (1, 1), (0x5500, 0x5500)):
            env = make(cuda_stream=stream)
            Tensor.streams.clear()
            env.step(tensor(down(env)))
            env.reset(options={"reset_mask": tensor(np.array([True, False]))})
            self.assertEqual(Tensor.streams, [number, number])

    def test_a_part_of_a_larger_tensor_is_lent(self):
        env, whole = make(seed=3), make(seed=3)
        larger = np.zeros((5, 3), np.float32)
        larger[3:] = down(env)
        paid = env.step(tensor(larger)[3:])[1]
        np.testing.assert_array_equal(numpy_of(paid), numpy_of(whole.step(tensor(down(whole)))[1]))

    def test_both_forms_of_execution_give_the_same_bits(self):
        paid = []
        for execution in ("resident", "tiled"):
            env = make(seed=3, execution=execution)
            paid.append(numpy_of(env.step(tensor(down(env)))[1]))
        np.testing.assert_array_equal(*paid)

    def test_threads_of_python_take_turns(self):
        env = make()
        threads = [threading.Thread(target=lambda: env.step(tensor(down(env)))) for _ in range(6)]
        threads += [threading.Thread(target=lambda: env.live("particle")) for _ in range(6)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(list(numpy_of(env.step(tensor(down(env)))[4]["episode_length"])), [1, 1])

    def test_settings_that_do_not_go_together_are_refused(self):
        for options, sentence in (
            ({"as_array": None}, "device = 'cuda' needs as_array"),
            ({"threads": 2}, "threads = 2 on a device"),
            ({"device": "gpu"}, "device = 'gpu'; give 'cpu', 'cuda', or 'cuda:1'"),
            ({"device": "cuda:x"}, "device = 'cuda:x'"),
            ({"device": "cpu", "cuda_stream": 5}, "cuda_stream = 5 on the host"),
            ({"device": "cpu", "execution": "tiled"}, "execution = 'tiled' on the host"),
            ({"execution": "small"}, "execution = 'small'; give 'automatic', 'resident' or 'tiled'"),
            ({"cuda_stream": 2}, "cuda_stream = 2; give a stream of PyTorch or CuPy, its number"),
        ):
            with self.assertRaisesRegex(ValueError, sentence):
                make(**options)
        with self.assertRaisesRegex(RuntimeError, "device 99 asked for"):
            make(device="cuda:99")
        with self.assertRaisesRegex(TypeError, "as_array returned a Array; it has to make an array of it"):
            make(as_array=lambda array: array)

    @unittest.skipUnless("torch" in globals(), "streams are a GPU's")
    def test_all_work_is_on_the_stream_that_is_asked_for(self):
        stream = torch.cuda.Stream()
        with torch.cuda.stream(stream):
            env = make(cuda_stream=stream)
            paid = env.step(tensor(down(env)))[1].clone()
        stream.synchronize()
        np.testing.assert_array_equal(numpy_of(paid), numpy_of(make().step(down(env))[1]))


if __name__ == "__main__":
    unittest.main()
