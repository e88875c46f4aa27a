// Signals as WAV files: what audio players and most signal generators take.
#pragma once

#include <Eigen/Core>
#include <filesystem>

namespace chladni::io {

/// Writes RIFF/WAVE with whole numbers of 32 bits (PCM), whole or not at all. A sample x is stored
/// as the nearest whole number to (2³¹ − 1) x / full_scale: the value is that number's fraction of
/// full scale, times full_scale.
/// (Microsoft and IBM, Multimedia Programming Interface 1.0, 1991.)
/// @param samples         N×channels
/// @param sample_rate_hz  a whole number: the format has no other
/// @param full_scale      above 0, at least the largest magnitude
/// @throws InvalidInput    another sample rate or full scale, a sample that is not finite, more
/// than
///                         65535 channels, a file of 4 GB or more
/// @throws OutOfResources  the file cannot be written
void write_wav(const std::filesystem::path& file, const Eigen::MatrixXd& samples,
               double sample_rate_hz, double full_scale);

}  // namespace chladni::io
