#include "hil/reproduction/spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#include <unsupported/Eigen/FFT>
#pragma GCC diagnostic pop

namespace steadyboom::hil::reproduction {

namespace {

constexpr double coherent_gain = 0.5;  // mean of the Hann window

/// Below this share of the signal's size the transform holds rounding alone.
constexpr double rounding_share = 1e-12;

}  // namespace

Spectrum amplitude_spectrum(std::span<const double> signal, double period_s) {
    if (signal.size() < 8) {
        throw std::invalid_argument("a spectrum needs at least 8 samples");
    }
    if (!(period_s > 0.0) || !std::isfinite(period_s)) {
        throw std::invalid_argument("a spectrum needs a positive sampling period, in s");
    }
    if (!std::ranges::all_of(signal, [](double value) { return std::isfinite(value); })) {
        throw std::invalid_argument("a spectrum needs finite samples");
    }
    const auto count = static_cast<double>(signal.size());
    const double size = std::abs(*std::ranges::max_element(signal, {}, [](double value) { return std::abs(value); }));
    const auto window = [&](std::size_t i) {
        return 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(i) / count);
    };
    double mean = 0.0;
    for (std::size_t i = 0; i < signal.size(); ++i) {
        mean += window(i) * signal[i] / (count * coherent_gain);
    }
    std::vector<double> weighted(signal.size());
    for (std::size_t i = 0; i < signal.size(); ++i) {
        weighted[i] = window(i) * (signal[i] - mean);
    }
    std::vector<std::complex<double>> transform;
    Eigen::FFT<double> fft;
    fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
    fft.fwd(transform, weighted);

    Spectrum spectrum{.spacing_Hz = 1.0 / (count * period_s), .amplitude = {}};
    const std::size_t bins = signal.size() / 2 + 1;
    spectrum.amplitude.reserve(bins);
    for (std::size_t i = 0; i < bins; ++i) {
        const bool single = i == 0 || 2 * i == signal.size();  // has no mirror image
        const double amplitude = (single ? 1.0 : 2.0) * std::abs(transform[i]) / (count * coherent_gain);
        spectrum.amplitude.push_back(amplitude > rounding_share * size ? amplitude : 0.0);
    }
    return spectrum;
}

std::vector<SpectralPeak> peaks(const Spectrum& spectrum, double least_Hz, double least_share) {
    const std::vector<double>& a = spectrum.amplitude;
    std::vector<SpectralPeak> found;
    for (std::size_t i = 1; i + 1 < a.size(); ++i) {
        if (static_cast<double>(i) * spectrum.spacing_Hz < least_Hz || !(a[i] > a[i - 1]) || a[i] < a[i + 1]) {
            continue;
        }
        SpectralPeak peak{static_cast<double>(i) * spectrum.spacing_Hz, a[i]};
        if (a[i - 1] > 0.0 && a[i + 1] > 0.0) {
            const double left = std::log(a[i - 1]);
            const double middle = std::log(a[i]);
            const double right = std::log(a[i + 1]);
            const double offset = 0.5 * (left - right) / (left - 2.0 * middle + right);
            peak.frequency_Hz += offset * spectrum.spacing_Hz;
            peak.amplitude = std::exp(middle - 0.25 * (left - right) * offset);
        }
        found.push_back(peak);
    }
    std::ranges::stable_sort(found, std::ranges::greater{}, &SpectralPeak::amplitude);
    if (!found.empty()) {
        const double least = least_share * found.front().amplitude;
        std::erase_if(found, [&](const SpectralPeak& peak) { return peak.amplitude < least; });
    }
    return found;
}

double largest_amplitude(const Spectrum& spectrum, double from_Hz, double to_Hz) noexcept {
    double largest = 0.0;
    for (std::size_t i = 0; i < spectrum.amplitude.size(); ++i) {
        const double frequency_Hz = static_cast<double>(i) * spectrum.spacing_Hz;
        if (frequency_Hz >= from_Hz && frequency_Hz <= to_Hz) {
            largest = std::max(largest, spectrum.amplitude[i]);
        }
    }
    return largest;
}

}  // namespace steadyboom::hil::reproduction
