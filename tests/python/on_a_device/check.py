"""PyTorch and CuPy read an array of the library where it lies on a GPU. By hand, where both and a GPU are:

    g++ -std=c++20 -O2 -fPIC -shared -fvisibility=hidden $(python3 -m pybind11 --includes) -Iinclude -Ipython/src \\
        python/src/array.cpp tests/python/on_a_device/arrays.cpp -o tests/python/on_a_device/arrays.so
    python3 tests/python/on_a_device/check.py
"""
import arrays
import cupy
import numpy
import torch


def expect(holds, what):
    print("pass:" if holds else "FAIL:", what)
    assert holds, what


def is_refused(look, error, words=""):
    try:
        look()
    except error as e:
        return words in str(e)
    return False


def main():
    numbers = torch.arange(12, dtype=torch.float32, device="cuda")
    torch.cuda.synchronize()
    shown = arrays.pairs(numbers.data_ptr(), 0, 0, False)
    wanted = torch.tensor([[[0, 6], [1, 7], [2, 8]], [[3, 9], [4, 10], [5, 11]]], dtype=torch.float32)

    for name, look in (("from_dlpack", torch.from_dlpack), ("as_tensor", lambda a: torch.as_tensor(a, device="cuda"))):
        seen = look(shown)
        expect(seen.data_ptr() == numbers.data_ptr() and torch.equal(seen.cpu(), wanted), f"torch.{name} copies nothing")
    for name, look in (("asarray", cupy.asarray), ("from_dlpack", cupy.from_dlpack)):
        seen = look(shown)
        expect(seen.data.ptr == numbers.data_ptr() and (cupy.asnumpy(seen) == wanted.numpy()).all(), f"cupy.{name} copies nothing")
    numbers[0] = -4.5
    torch.cuda.synchronize()
    expect(float(torch.from_dlpack(shown)[0, 0, 0]) == -4.5, "a change is seen")

    stream = torch.cuda.Stream()
    on_stream = arrays.pairs(numbers.data_ptr(), 0, stream.cuda_stream, False)
    with torch.cuda.stream(stream):
        expect(torch.from_dlpack(on_stream).data_ptr() == numbers.data_ptr(), "it is read on its own stream")
    expect(is_refused(lambda: torch.from_dlpack(on_stream), BufferError, "asked for on stream"), "and on no other")
    expect(cupy.asarray(on_stream).data.ptr == numbers.data_ptr(), "cupy waits for the stream that the dictionary names")
    expect(is_refused(lambda: numpy.asarray(shown), TypeError), "numpy, which reads the host's memory, is refused")


if __name__ == "__main__":
    main()
