// Sample variances averaged over neighbouring lines, whether the noise grows with the response or
// not.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace chladni::recordings {

/// The variance at one of n lines from their sample variances s. The mean, as of a sensor's noise,
/// which is alike on neighbouring lines. But noise of forces that nobody measures, and distortion,
/// grow with the response: beside a resonance that is narrower than the n lines the mean is up to n
/// times too large, and on it too small. So v = c (1 − t + t |G|² / mean |G|²), averaged over t = 0
/// and nine t > 0 (prior probability of all nine: Constants::growth_chance) by their evidence, c
/// integrated: s ν / v has a gamma distribution. Few lines tell t badly: on a peak of 1 to 3 of 11
/// lines, ν = 1, the result is a seventh to a third too small in the mean, and 1 / v, which a
/// weight is, twice too large. The lines are taken as independent; windows make neighbours alike,
/// and the evidence for t > 0 or against it then counts for too much.
/// @param sample   n, 0 or more; @param power  n: |G|²
/// @param at       the line, 0 to n − 1
/// @param freedom  ν, complex degrees of freedom of each sample
/// Cost: 10 n logarithms where |G|² differs by more than 2 among the lines.
[[nodiscard]] double averaged_variance(const Eigen::Ref<const Eigen::VectorXd>& sample,
                                       const Eigen::Ref<const Eigen::VectorXd>& power,
                                       Eigen::Index at, double freedom);

/// That of each of K lines over ±half lines; at the ends over the lines that exist. @param power  K
[[nodiscard]] Eigen::VectorXd averaged_variances(const Eigen::Ref<const Eigen::VectorXd>& sample,
                                                 const Eigen::Ref<const Eigen::VectorXd>& power,
                                                 Eigen::Index half, double freedom);

/// The same of each entry. @param sample  [k], t×f; @param value  [k], t×f: the responses
[[nodiscard]] std::vector<Eigen::MatrixXd> averaged_variances(
    const std::vector<Eigen::MatrixXd>& sample, const std::vector<Eigen::MatrixXcd>& value,
    Eigen::Index half, double freedom);

}  // namespace chladni::recordings
