#include "hil/reproduction/spectrum.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace steadyboom::hil::reproduction {
namespace {

constexpr double period_s = 0.001;
constexpr std::size_t samples = 10'000;  // 10 s, 0.1 Hz from bin to bin

std::vector<double> sine(double frequency_Hz, double amplitude, double phase_rad = 0.3, double mean = 0.0) {
    std::vector<double> signal(samples);
    for (std::size_t i = 0; i < samples; ++i) {
        signal[i] =
            mean +
            amplitude * std::sin(2.0 * std::numbers::pi * frequency_Hz * static_cast<double>(i) * period_s + phase_rad);
    }
    return signal;
}

TEST(Spectrum, SineOnABinStandsWithItsAmplitudeWhateverTheMean) {
    const Spectrum spectrum = amplitude_spectrum(sine(7.0, 2.5, 0.3, 40.0), period_s);
    EXPECT_DOUBLE_EQ(spectrum.spacing_Hz, 0.1);
    ASSERT_EQ(spectrum.amplitude.size(), samples / 2 + 1);
    EXPECT_NEAR(spectrum.amplitude[70], 2.5, 0.025);
    const auto found = peaks(spectrum, 0.3, 0.1);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(found[0].frequency_Hz, 7.0, 1e-4);
    EXPECT_NEAR(found[0].amplitude, 2.5, 0.025);
}

TEST(Spectrum, SineBetweenBinsLosesAtMostTheHannScallopAndTheParabolaFindsItAgain) {
    double worst_bin = 1.0;
    for (int tenth = 0; tenth <= 10; ++tenth) {
        const double frequency_Hz = 11.0 + 0.01 * tenth;
        const Spectrum spectrum = amplitude_spectrum(sine(frequency_Hz, 1.0), period_s);
        worst_bin = std::min(worst_bin, largest_amplitude(spectrum, 10.5, 11.6));
        const auto found = peaks(spectrum, 0.3, 0.1);
        ASSERT_FALSE(found.empty());
        EXPECT_NEAR(found[0].frequency_Hz, frequency_Hz, 0.002) << frequency_Hz;
        EXPECT_NEAR(found[0].amplitude, 1.0, 0.04) << frequency_Hz;
    }
    const double worst_dB = 20.0 * std::log10(worst_bin);
    EXPECT_GT(worst_dB, -1.5);
    EXPECT_LT(worst_dB, -1.3);  // it is a Hann window: the textbook's 1.42 dB
}

TEST(Spectrum, EachOfSeveralSinesStandsWithItsOwnAmplitude) {
    std::vector<double> signal(samples, 0.0);
    for (const auto& [frequency_Hz, amplitude] : {std::pair{1.4, 3.0}, {3.7, 0.2}, {18.3, 0.01}}) {
        const std::vector<double> one = sine(frequency_Hz, amplitude, frequency_Hz);
        for (std::size_t i = 0; i < samples; ++i) {
            signal[i] += one[i];
        }
    }
    const Spectrum spectrum = amplitude_spectrum(signal, period_s);
    EXPECT_NEAR(largest_amplitude(spectrum, 1.0, 2.0), 3.0, 0.03);
    EXPECT_NEAR(largest_amplitude(spectrum, 3.0, 5.0), 0.2, 0.002);
    EXPECT_NEAR(largest_amplitude(spectrum, 15.0, 20.0), 0.01, 1e-4);
}

TEST(Spectrum, AmplitudeDependsNeitherOnTheRecordsLengthNorOnTheRateOrTheParityOfItsSamples) {
    for (const std::size_t count : {500U, 501U, 2'000U, 2'001U}) {
        const double T_s = 10.0;
        const double step_s = T_s / static_cast<double>(count);
        std::vector<double> signal(count);
        for (std::size_t i = 0; i < count; ++i) {
            signal[i] = 1.7 * std::cos(2.0 * std::numbers::pi * 4.0 * static_cast<double>(i) * step_s);
        }
        const Spectrum spectrum = amplitude_spectrum(signal, step_s);
        EXPECT_NEAR(spectrum.spacing_Hz, 0.1, 1e-12) << count;
        EXPECT_NEAR(spectrum.amplitude[40], 1.7, 1e-3) << count;
    }
}

TEST(Spectrum, SmallSineBesideOneAHundredTimesLargerIsSeenTwoHertzAwayAndLostInItsSkirtThreeBinsAway) {
    const auto beside = [](double apart_Hz) {
        std::vector<double> signal = sine(5.05, 1.0, 0.0);  // between bins, where leakage is worst
        const std::vector<double> small = sine(5.0 + apart_Hz, 0.01, 1.0);
        for (std::size_t i = 0; i < samples; ++i) {
            signal[i] += small[i];
        }
        return amplitude_spectrum(signal, period_s);
    };
    EXPECT_NEAR(largest_amplitude(beside(2.0), 6.5, 7.5), 0.01, 2e-4);
    const auto found = peaks(beside(2.0), 0.4, 0.005);
    ASSERT_EQ(found.size(), 2U);
    EXPECT_NEAR(found[1].frequency_Hz, 7.0, 0.01);
    EXPECT_EQ(peaks(beside(0.3), 0.4, 0.005).size(), 1U);
}

TEST(Spectrum, TwoSinesFourBinsApartAreTwoPeaksAndOneBinApartAreNot) {
    const auto both = [](double apart_Hz) {
        std::vector<double> signal = sine(5.0, 1.0, 0.0);
        const std::vector<double> second = sine(5.0 + apart_Hz, 1.0, 1.0);
        for (std::size_t i = 0; i < samples; ++i) {
            signal[i] += second[i];
        }
        return amplitude_spectrum(signal, period_s);
    };
    const Spectrum apart = both(0.4);
    const auto found = peaks(apart, 0.3, 0.5);
    ASSERT_EQ(found.size(), 2u);
    EXPECT_NEAR(found[0].amplitude, 1.0, 0.02);
    EXPECT_NEAR(found[1].amplitude, 1.0, 0.02);
    EXPECT_LT(apart.amplitude[52], 0.5);
    EXPECT_EQ(peaks(both(0.1), 0.3, 0.5).size(), 1u);
}

TEST(Spectrum, LeakageStaysBelowTheWindowsSidelobes) {
    const Spectrum spectrum = amplitude_spectrum(sine(20.05, 1.0), period_s);
    for (std::size_t i = 1; i < spectrum.amplitude.size(); ++i) {
        const double distance_bins = std::abs(static_cast<double>(i) - 200.5);
        if (distance_bins > 2.0) {
            EXPECT_LT(20.0 * std::log10(spectrum.amplitude[i] + 1e-300), -31.0) << i;
        }
        if (distance_bins > 16.0) {  // three octaves of 18 dB further out
            EXPECT_LT(20.0 * std::log10(spectrum.amplitude[i] + 1e-300), -75.0) << i;
        }
    }
}

TEST(Spectrum, ConstantSignalHasNone) {
    const Spectrum spectrum = amplitude_spectrum(std::vector<double>(samples, 0.1), period_s);
    EXPECT_EQ(largest_amplitude(spectrum, 0.0, 500.0), 0.0);
    EXPECT_TRUE(peaks(spectrum, 0.0, 0.0).empty());
}

TEST(Spectrum, LowestFrequencyAndSmallestShareAreKept) {
    std::vector<double> signal = sine(0.2, 3.0);
    const std::vector<double> second = sine(9.0, 1.0);
    const std::vector<double> third = sine(15.0, 0.05);
    for (std::size_t i = 0; i < samples; ++i) {
        signal[i] += second[i] + third[i];
    }
    const Spectrum spectrum = amplitude_spectrum(signal, period_s);
    EXPECT_NEAR(peaks(spectrum, 0.1, 0.1)[0].frequency_Hz, 0.2, 0.01);
    const auto found = peaks(spectrum, 1.0, 0.1);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(found[0].frequency_Hz, 9.0, 0.01);
    EXPECT_EQ(peaks(spectrum, 1.0, 0.04).size(), 2u);
}

TEST(Spectrum, RefusesWhatHasNoSpectrum) {
    EXPECT_THROW((void)amplitude_spectrum(std::vector<double>(7, 1.0), period_s), std::invalid_argument);
    EXPECT_THROW((void)amplitude_spectrum(std::vector<double>(8, 1.0), 0.0), std::invalid_argument);
    std::vector<double> bad(8, 1.0);
    bad[3] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW((void)amplitude_spectrum(bad, period_s), std::invalid_argument);
}

}  // namespace
}  // namespace steadyboom::hil::reproduction
