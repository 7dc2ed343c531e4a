"""Random numbers that depend on named keys and on nothing else: neither on order nor on other draws."""

from zlib import crc32

import torch
from numpy.random import SeedSequence


def derived_seed(seed: int, *keys: int | str) -> int:
    """A 63-bit seed for the stream named by `keys` (such as "train", epoch) under `seed`."""
    words = [crc32(key.encode()) if isinstance(key, str) else int(key) for key in keys]
    return int(SeedSequence([int(seed), *words]).generate_state(1, dtype="uint64")[0]) >> 1


def seeded_generator(seed: int, *keys: int | str, device: torch.device | str = "cpu") -> torch.Generator:
    """A generator on `device` for the stream named by `keys` under `seed`."""
    return torch.Generator(device=device).manual_seed(derived_seed(seed, *keys))
