"""Continuous wavelet transforms of sampled records: Ricker (real) and Morlet (complex).

    W[s, n] = s^-1/2 sum_k x[k] conj(psi((k - n) / s)),      x = 0 outside the record

with the scale s in samples: the L2 convention, in which every wavelet has the energy of its mother.
The rule from scale to frequency belongs to the convention. A tone of angular frequency w (per sample)
has |W| = A/2 s^1/2 psi^(s w) (A s^1/2 psi^(s w) for the real Ricker), and its ridge over the scales is
where that is largest:

    wavelet   ridge under L2 (used here)                    spectral peak = ridge under L1 (s^-1)
    Ricker    f = sqrt(5/2) / (2 pi s) = 0.2516 / s         f = sqrt(2) / (2 pi s) = 0.2251 / s
    Morlet    f = (w0 + sqrt(w0^2 + 2)) / (4 pi s)          f = w0 / (2 pi s)

Mixing them puts a Ricker ridge 12 % off. Source of the L2 rules and of the cone of influence:
Torrence and Compo, A practical guide to wavelet analysis, Bull. Amer. Meteor. Soc. 79 (1998), table 1.
"""

from gear_damping.signals.wavelets.base import ContinuousWavelet
from gear_damping.signals.wavelets.morlet import MorletCWT
from gear_damping.signals.wavelets.ricker import RickerCWT

__all__ = ["ContinuousWavelet", "MorletCWT", "RickerCWT"]
