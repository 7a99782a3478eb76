#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace steadyboom::hil::reproduction {

/// One-sided amplitude spectrum of a uniformly sampled signal, in the signal's unit.
///
/// The signal, less its mean under a periodic Hann window, is weighted with that window, transformed (Eigen's FFT) and
/// divided by the window's coherent gain 1/2: a sine of amplitude a whose frequency is a multiple of 1/T (T the
/// record's length) stands as a. In between it stands up to 1.42 dB lower (15 %), which `peaks` mostly undoes. Two
/// equal sines 4/T apart stand as two peaks with a dip below half between them; far from a sine leakage falls with 18
/// dB an octave, the highest sidelobe being 31.5 dB down.
struct Spectrum {
    double spacing_Hz = 0.0;        ///< 1/T
    std::vector<double> amplitude;  ///< at 0, spacing_Hz, ... up to half the sampling rate
};

/// Needs at least 8 samples and a positive period; throws std::invalid_argument otherwise or if a sample is not finite.
[[nodiscard]] Spectrum amplitude_spectrum(std::span<const double> signal, double period_s);

struct SpectralPeak {
    double frequency_Hz = 0.0;
    double amplitude = 0.0;  ///< in the signal's unit
};

/// Local maxima at or above `least_Hz`, the largest first, of at least `least_share` of the largest. Frequency and
/// amplitude are those of a parabola through the logarithms of a maximum and its neighbours: between bins the frequency
/// is off by at most 0.02/T and the amplitude by at most 4 % for a sine alone. Empty for a constant signal.
[[nodiscard]] std::vector<SpectralPeak> peaks(const Spectrum& spectrum, double least_Hz, double least_share);

/// Largest amplitude between two frequencies, both included.
[[nodiscard]] double largest_amplitude(const Spectrum& spectrum, double from_Hz, double to_Hz) noexcept;

}  // namespace steadyboom::hil::reproduction
