"""The suturing task as a vector environment: Gymnasium's words, arrays that are views of the library's memory."""

import operator
from functools import cached_property

import numpy as np

from mpmpbd import _core
from mpmpbd.config import documents

try:  # with Gymnasium its wrappers take this environment; without, nothing but spaces is missing
    from gymnasium.vector import VectorEnv as _VectorEnv
except ImportError:

    class _VectorEnv:
        def close(self):
            pass


def _gymnasium():
    try:
        import gymnasium
    except ImportError as error:
        raise ImportError(
            "mpmpbd: spaces are those of gymnasium, which is not installed; install it, or use the "
            "shapes of observations and action_size"
        ) from error
    return gymnasium


_CUDA_OF_DLPACK = (2, 13)  # its own memory, and managed memory


def _device_number(device):
    """The number of a CUDA device, None for the host."""
    name, colon, number = str(device).partition(":")
    if name == "cpu" and not colon:
        return None
    if name == "cuda" and (number.isdecimal() or not colon):
        return int(number or 0)
    raise ValueError(f"mpmpbd: device = '{device}'; give 'cpu', 'cuda', or 'cuda:1' and so on")


def _stream_number(stream):
    """Of a stream of PyTorch or CuPy, or what is a number already."""
    number = operator.index(getattr(stream, "cuda_stream", getattr(stream, "ptr", stream)))
    if number < 0 or number == 2:  # 2 is another stream for every thread
        raise ValueError(
            f"mpmpbd: cuda_stream = {number}; give a stream of PyTorch or CuPy, its number, or 0 for the default stream"
        )
    return number


def _loop_on_host(config, options, threads, cuda_stream, execution):
    if cuda_stream:
        raise ValueError(f"mpmpbd: cuda_stream = {cuda_stream} on the host; streams are a device's")
    if execution != "automatic":
        raise ValueError(f"mpmpbd: execution = '{execution}' on the host; forms of execution are a device's")
    return _core.SuturingLoop(documents(config), **options, threads=operator.index(threads))


def _loop_on_device(config, options, threads, cuda_stream, execution, device, as_array):
    if as_array is None:
        raise ValueError(
            f"mpmpbd: device = '{device}' needs as_array, which makes arrays of your library from memory of the "
            "device: torch.from_dlpack, cupy.asarray or the like"
        )
    if threads:
        raise ValueError(f"mpmpbd: threads = {threads} on a device; threads are the host's")
    if not hasattr(_core, "SuturingLoopOnDevice"):
        raise RuntimeError(
            f"mpmpbd: device = '{device}', and this module was built without CUDA: build it with "
            "scripts/python.sh --cuda, or with -DMPMPBD_CUDA=ON"
        )
    return _core.SuturingLoopOnDevice(
        documents(config),
        **options,
        device=_device_number(device),
        stream=_stream_number(cuda_stream),
        execution=execution,
    )


class SuturingVectorEnv(_VectorEnv):
    """N environments of the suturing task, on the threads of this machine or on a CUDA device.

    Every array that `reset` and `step` return is a view: the same memory each time, with the numbers of the last step.
    Copy what you want to keep. Episode k of environment i is the same, bit for bit, for any `num_envs` and `threads`.

    config: a TOML file, a dictionary ({"episode.limit": 50} or nested), or a list of these, later ones over earlier ones.
    seed: of all random numbers; without one it is that of config (1 where none is named).
    autoreset: "same_step" (the last observation of an episode is in info["final_obs"]), "next_step" or "disabled".
    threads: of the host; 0 for as many as the machine has.
    device: "cpu", "cuda" (which is "cuda:0"), "cuda:1" and so on. On a device nothing is copied and nothing waits: actions and
        masks are taken where they lie, what `step` returns is there when the stream has come to it. The host's are copied,
        which waits; so does a step of the scene in tiled form where environments choose their substeps (time.substeps = 0).
    as_array: makes an array of your library from an mpmpbd.Array, without a copy: numpy.asarray (on the host, the default),
        torch.from_dlpack, cupy.asarray. A device has no default.
    cuda_stream: that of all work on a device, of PyTorch, of CuPy, or its number; 0 is the default stream. Work on that one.
    execution: on a device "resident", "tiled", or "automatic": the faster one, tiled where environments are few.

    Observations (num_envs, frames, ...) float32 by group; actions (num_envs, 3) in [-1, 1]; reward (num_envs) float32.
    """

    def __init__(
        self,
        num_envs=1,
        *,
        config=None,
        seed=None,
        autoreset="same_step",
        threads=0,
        first_environment=0,
        device="cpu",
        as_array=None,
        cuda_stream=0,
        execution="automatic",
    ):
        self.num_envs = operator.index(num_envs)
        self._on_device = _device_number(device) is not None
        self._as_array = as_array or np.asarray
        self._cuda_stream = cuda_stream  # lives as long as work is given to it
        options = {
            "num_envs": self.num_envs,
            "seed": None if seed is None else operator.index(seed),
            "autoreset": autoreset,
            "first_environment": operator.index(first_environment),
        }
        if not self._on_device:
            self._loop = _loop_on_host(config, options, threads, cuda_stream, execution)
        else:
            self._loop = _loop_on_device(config, options, threads, cuda_stream, execution, device, as_array)
        self._autoreset = autoreset
        self._at_start = True
        self.action_size = self._loop.action_size
        self.decision_time = self._loop.decision_time
        # What any library may take: torch.from_dlpack(env.observation_arrays["needle_pose"]).
        self.observation_arrays = self._loop.observations()
        self.outcome_arrays = self._loop.outcome()
        self._observations = self._views(self.observation_arrays)
        self._final = self._views(self._loop.final_observations())
        outcome = self._views(self.outcome_arrays)
        self._reward = outcome.pop("reward")
        self._terminated = outcome.pop("terminated")
        self._truncated = outcome.pop("truncated")
        for table, names in (
            ("terms", self._loop.term_names),
            ("returns", self._loop.term_names),
            ("metrics", self._loop.metric_names),
        ):
            outcome[table] = {name: outcome[table][:, k] for k, name in enumerate(names)}
        self._info = outcome

    def reset(self, *, seed=None, options=None):
        """New episodes: everywhere, from the first one of another seed, or where options["reset_mask"], (num_envs) of bool or uint8, is true.

        Before the first step nothing has to begin: all environments are at the start of their first episode.
        """
        mask = (options or {}).get("reset_mask")
        if mask is not None:
            if seed is not None:
                raise ValueError("mpmpbd: a seed is of all environments; give seed or reset_mask")
            if self._lies_here(mask):
                self._loop.reset_where_from(mask)
            else:
                given = np.ascontiguousarray(mask)  # not cast: numbers of environments are no mask
                self._loop.reset_where(given.view(np.uint8) if given.dtype == np.bool_ else given)
        elif seed is not None:
            self._loop.reset(operator.index(seed))
        elif not self._at_start:
            self._loop.reset(None)
        self._at_start = False
        return dict(self._observations), dict(self._info)

    def step(self, actions):
        """One decision everywhere: observations, reward, terminated, truncated, info."""
        if self._lies_here(actions):
            self._loop.step_from(actions)
        else:
            self._loop.step(np.ascontiguousarray(actions, dtype=np.float32))
        self._at_start = False
        info = dict(self._info)
        if self._autoreset == "same_step":
            done = self._terminated | self._truncated
            if self._on_device or done.any():  # to look at a device's would be to wait for it
                info["final_obs"] = dict(self._final)
                info["_final_obs"] = done
        return dict(self._observations), self._reward, self._terminated, self._truncated, info

    def start(self, env, episode, stream=None):
        """Begins a certain episode of one environment, counted from 1.

        With `stream` it is that of another environment, counted from 0 in the larger set that `first_environment` is of.
        """
        self._loop.start(env, episode, stream)
        self._at_start = False
        return dict(self._observations)

    def state(self, name):
        """A field of the scene, (env, slot, component): a read-only view. `fields` says which there are."""
        return self._as_array(self._loop.state(name))

    def live(self, domain):
        """How many slots of a domain ("particle", "bead", ...) each environment uses; the others are zero."""
        return self._loop.live(domain)

    @property
    def fields(self):
        """{name: unit} of the fields of the scene."""
        return dict(self._loop.fields)

    @property
    def config(self):
        """All settings as TOML, as they were understood, with the seed in use."""
        return self._loop.config()

    @property
    def metadata(self):
        mode = self._autoreset
        try:
            from gymnasium.vector import AutoresetMode

            mode = AutoresetMode[mode.upper()]
        except ImportError:
            pass
        return {"render_modes": [], "autoreset_mode": mode}

    @cached_property
    def single_observation_space(self):
        spaces = _gymnasium().spaces
        return spaces.Dict(
            {
                name: spaces.Box(-np.inf, np.inf, array.shape[1:], np.dtype(array.typestr))
                for name, array in self.observation_arrays.items()
            }
        )

    @cached_property
    def single_action_space(self):
        return _gymnasium().spaces.Box(-1.0, 1.0, (self.action_size,), np.float32)

    @cached_property
    def observation_space(self):
        _gymnasium()
        from gymnasium.vector.utils import batch_space

        return batch_space(self.single_observation_space, self.num_envs)

    @cached_property
    def action_space(self):
        _gymnasium()
        from gymnasium.vector.utils import batch_space

        return batch_space(self.single_action_space, self.num_envs)

    def _views(self, arrays):
        views = {name: self._as_array(array) for name, array in arrays.items()}
        for view in views.values():
            if not hasattr(view, "__getitem__"):
                raise TypeError(
                    f"mpmpbd: as_array returned a {type(view).__name__}; it has to make an array of it, as "
                    "torch.from_dlpack does"
                )
        return views

    def _lies_here(self, numbers):
        """Whether the environments take them from the memory of a device."""
        if not self._on_device:
            return False
        where = getattr(numbers, "__dlpack_device__", None)
        if where is None and hasattr(numbers, "__cuda_array_interface__"):
            raise TypeError(
                f"mpmpbd: a {type(numbers).__name__} on a device has no __dlpack__; make an array of it that "
                "has, by cupy.asarray or the like"
            )
        return where is not None and where()[0] in _CUDA_OF_DLPACK
