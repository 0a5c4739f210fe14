"""How an array of the library speaks to NumPy and its like: same memory, right layout, alive as long as it is used."""

import ctypes
import gc
import unittest

import numpy as np

import mpmpbd  # registers the type of what made_up returns
import made_up

ADDRESS = 0x7F0000001000


def capsule_name(capsule):
    name = ctypes.pythonapi.PyCapsule_GetName
    name.restype, name.argtypes = ctypes.c_char_p, [ctypes.py_object]
    return name(capsule)


class OnTheHost(unittest.TestCase):
    def test_numpy_sees_the_same_memory_through_both_doors(self):
        array = made_up.on_host(False)
        by_interface = np.asarray(array)
        by_dlpack = np.from_dlpack(array)
        self.assertEqual(by_interface.ctypes.data, array.__array_interface__["data"][0])
        self.assertEqual(by_interface.ctypes.data, by_dlpack.ctypes.data)
        for seen in (by_interface, by_dlpack):
            self.assertEqual((seen.shape, seen.dtype), ((2, 3, 2), np.float64))
            # A plane per component, slot fastest: component 1 of the last slot of environment 1 is the last in memory.
            self.assertEqual(seen.strides, (24, 8, 48))
            self.assertEqual((seen[1, 2, 1], seen[1, 0, 0], seen[0, 0, 1]), (11, 3, 6))
        by_interface[0, 1, 0] = -4.5
        self.assertEqual(by_dlpack[0, 1, 0], -4.5)

    def test_memory_lives_as_long_as_a_view_of_it(self):
        before = made_up.watched()
        for look in (np.asarray, np.from_dlpack, lambda a: np.asarray(a)[1:]):
            view = look(made_up.on_host(False))
            gc.collect()
            self.assertEqual(made_up.watched(), before + 1)
            self.assertEqual(float(view.ravel()[-1]), 11)
            del view
            gc.collect()
            self.assertEqual(made_up.watched(), before)

    def test_a_capsule_that_nobody_takes_frees_what_it_holds(self):
        before = made_up.watched()
        for version in (None, (1, 0)):
            capsule = made_up.on_host(False).__dlpack__(max_version=version)
            self.assertEqual(made_up.watched(), before + 1)
            del capsule
            self.assertEqual(made_up.watched(), before)

    def test_the_consumer_chooses_the_version(self):
        array = made_up.on_host(False)
        self.assertEqual(capsule_name(array.__dlpack__()), b"dltensor")
        self.assertEqual(capsule_name(array.__dlpack__(max_version=(0, 8))), b"dltensor")
        self.assertEqual(capsule_name(array.__dlpack__(max_version=(1, 1))), b"dltensor_versioned")
        self.assertEqual(array.__dlpack_device__(), (1, 0))

    def test_read_only_is_kept_or_refused(self):
        array = made_up.on_host(True)
        self.assertFalse(np.asarray(array).flags.writeable)
        with self.assertRaisesRegex(BufferError, "cannot say read-only; use numpy.asarray, or copy"):
            array.__dlpack__()
        self.assertEqual(capsule_name(array.__dlpack__(max_version=(1, 0))), b"dltensor_versioned")
        if np.lib.NumpyVersion(np.__version__) >= "2.1.0":  # the first to ask for it
            self.assertFalse(np.from_dlpack(array).flags.writeable)
            self.assertTrue(np.from_dlpack(made_up.on_host(False)).flags.writeable)

    def test_what_would_be_a_copy_is_refused(self):
        array = made_up.on_host(False)
        with self.assertRaisesRegex(BufferError, "without copies"):
            array.__dlpack__(copy=True)
        with self.assertRaisesRegex(BufferError, r"on device \(1, 0\) and is not moved to \(2, 0\)"):
            array.__dlpack__(dl_device=(2, 0))
        with self.assertRaisesRegex(BufferError, "no stream"):
            array.__dlpack__(stream=1)
        self.assertFalse(hasattr(array, "__cuda_array_interface__"))


class OnADevice(unittest.TestCase):
    def test_the_dictionary_says_where_and_on_which_stream(self):
        said = made_up.on_device(ADDRESS, 0, 0x55AA).__cuda_array_interface__
        self.assertEqual(
            said,
            {
                "shape": (2, 3, 2),
                "typestr": "<f4",
                "strides": (12, 4, 24),
                "data": (ADDRESS, False),
                "version": 3,
                "stream": 0x55AA,
            },
        )

    def test_the_default_stream_is_number_one(self):
        self.assertEqual(made_up.on_device(ADDRESS, 0, 0).__cuda_array_interface__["stream"], 1)

    def test_it_is_no_array_of_the_host(self):
        array = made_up.on_device(ADDRESS, 3, 0)
        self.assertFalse(hasattr(array, "__array_interface__"))
        self.assertEqual(array.__dlpack_device__(), (2, 3))
        self.assertIn("CUDA device 3", repr(array))
        with self.assertRaisesRegex(TypeError, "on CUDA device 3 and is not copied; give it to torch"):
            np.asarray(array)

    def test_a_consumer_on_another_stream_has_to_say_that_it_keeps_order(self):
        on_default = made_up.on_device(ADDRESS, 0, 0)
        for stream in (None, 1, -1):
            on_default.__dlpack__(stream=stream)
        own = made_up.on_device(ADDRESS, 0, 0x55AA)
        for stream in (0x55AA, -1):
            own.__dlpack__(stream=stream)
        for stream in (None, 1, 7):
            with self.assertRaisesRegex(BufferError, "stream 21930 and asked for on stream"):
                own.__dlpack__(stream=stream)


if __name__ == "__main__":
    unittest.main()
