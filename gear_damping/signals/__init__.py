"""Wavelet transforms, spectra, orders, envelopes and band-limited interpolation of sampled records."""
