// Removal of a start from all periods at once, by what lies between the excited lines.
#pragma once

#include <functional>
#include <vector>

#include "recordings/spectra.h"
#include "recordings/time_data.h"

namespace chladni::recordings {

/// Spectra without the transient of the start; no period is dropped.
///
/// The transform over all P periods has P − 1 lines between two lines of the period. A steady
/// state, distorted or not, has nothing there: they hold noise and the transient, which is smooth
/// in frequency. A polynomial of second degree through the 16 nearest of them, over a first-order
/// denominator where that halves what is left (a resonance), gives the transient on the line of the
/// period; it is taken off (local rational method: McKelvey and Guérin 2012; Pintelon and Schoukens
/// 2012, chapter 7).
///
/// Each record gets 14 "periods": the mean, with deviations that have the covariance between
/// channels of the noise that the fits leave. Estimates and variances of transfer.h hold for them
/// as for true periods, with `drop` 0. The noise of neighbouring lines comes from common data.
/// In a loop inputs are treated as outputs are.
/// @throws InvalidInput  as spectra(); fewer than two periods in a record, or fewer than 16 lines
///                       between those of the period
/// Cost: one transform of each record, and two small least-squares fits per channel and line.
[[nodiscard]] Spectra without_start(const TimeData& data, double low_hz = 0.0,
                                    double high_hz = 0.0);
/// The number of "periods" of each record.
[[nodiscard]] Eigen::Index periods_without_start();

/// So many lines with noise of their own are these worth, for the degrees of freedom of the mean of
/// their variances: neighbours take some of theirs from the same lines between. By the mean square
/// of that mean (Satterthwaite, Biometrics Bulletin 2 (1946) 110).
/// @param line  of the transform of one period, one or more
[[nodiscard]] double lines_apart(const std::vector<Eigen::Index>& line, Eigen::Index periods,
                                 Eigen::Index period);

struct Recordings;  // recordings/recordings.h

/// The same of one record: its spectra on the wanted sides. The other sides have no columns.
using RecordWithoutStart =
    std::function<Spectra::Record(std::size_t record, const std::vector<Side>& sides)>;

/// The same, record by record, on given lines of the transform of one period.
/// Memory: about 40 periods of one channel. A call throws InvalidInput as without_start().
/// @param recordings  outlive the result
[[nodiscard]] RecordWithoutStart record_without_start(const Recordings& recordings,
                                                      std::vector<Eigen::Index> line);

}  // namespace chladni::recordings
