#include "io/wav.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <string>

#include "base/error.h"
#include "host/atomic_file.h"

namespace chladni::io {
namespace {

constexpr double kLargest = 2147483647.0;  // 2³¹ − 1
constexpr double kMostBytes = 4294967295.0;
constexpr std::uint32_t kBytes = 4;  // of a sample

void add(std::string& bytes, std::uint32_t value, int count) {
  for (int i = 0; i < count; ++i) {
    bytes.push_back(static_cast<char>(static_cast<unsigned char>((value >> (8 * i)) & 0xFFU)));
  }
}

std::string head(std::uint32_t channels, std::uint32_t rate, std::uint32_t data) {
  std::string bytes = "RIFF";
  add(bytes, 36 + data, 4);
  bytes += "WAVEfmt ";
  add(bytes, 16, 4);
  add(bytes, 1, 2);  // PCM
  add(bytes, channels, 2);
  add(bytes, rate, 4);
  add(bytes, rate * channels * kBytes, 4);
  add(bytes, channels * kBytes, 2);
  add(bytes, 8 * kBytes, 2);
  bytes += "data";
  add(bytes, data, 4);
  return bytes;
}

}  // namespace

void write_wav(const std::filesystem::path& file, const Eigen::MatrixXd& samples,
               double sample_rate_hz, double full_scale) {
  const auto name = file.string();
  require(sample_rate_hz >= 1.0 && sample_rate_hz <= 1e9 &&
              sample_rate_hz == std::floor(sample_rate_hz),
          fmt::format("{}: WAV has sample rates in whole Hz, found {:.12g} Hz; expected another "
                      "rate, or CSV or MAT",
                      name, sample_rate_hz));
  require(samples.size() > 0 && samples.allFinite(),
          name + ": there are no samples, or one is not finite");
  require(
      std::isfinite(full_scale) && full_scale > 0.0 && samples.cwiseAbs().maxCoeff() <= full_scale,
      fmt::format("{}: a sample of {:.6g} exceeds the full scale of {:.6g}", name,
                  samples.cwiseAbs().maxCoeff(), full_scale));
  const double size = static_cast<double>(samples.size()) * kBytes;
  require(samples.cols() <= 65535 && size + 64.0 < kMostBytes,
          fmt::format("{}: {:.3g} bytes of samples; WAV holds less than 4 GB, expected shorter "
                      "signals, or CSV or MAT",
                      name, size));
  std::string bytes =
      head(static_cast<std::uint32_t>(samples.cols()), static_cast<std::uint32_t>(sample_rate_hz),
           static_cast<std::uint32_t>(size));
  bytes.reserve(bytes.size() + static_cast<std::size_t>(size));
  for (Eigen::Index n = 0; n < samples.rows(); ++n) {
    for (Eigen::Index c = 0; c < samples.cols(); ++c) {
      const auto whole =
          static_cast<std::int32_t>(std::lround(kLargest * (samples(n, c) / full_scale)));
      add(bytes, static_cast<std::uint32_t>(whole), 4);
    }
  }
  write_atomically(file, bytes);
}

}  // namespace chladni::io
