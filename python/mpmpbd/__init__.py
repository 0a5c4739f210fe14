"""Suturing in soft tissue for learning: the step loop of mpmpbd, with Gymnasium's words and without copies."""

from mpmpbd._core import Array, __version__
from mpmpbd.vector_env import SuturingVectorEnv

__all__ = ["Array", "SuturingVectorEnv", "__version__"]
