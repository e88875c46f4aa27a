// Tests of .mat files: their program, and files of chosen bytes.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/io/measured/frf_samples.h"

namespace chladni::io {

inline constexpr std::size_t kLimit = std::size_t{64} << 20U;

class Mat : public testing::Test {
 protected:
  static void SetUpTestSuite() { setenv("CHLADNI_LIBEXEC", CHLADNI_BINARY_DIR "/bin", 1); }
};

inline void put(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<long>(bytes.size()));
}

/// Responses with names, nodes, directions, places and units.
inline modal::FrfSet described_set() {
  auto set = random_set(3, 2, 25, 13);
  set.averages = 8.0;
  set.outputs[1].name = "Größe, \"links\"";
  set.outputs[1].node = 101;
  set.outputs[2].direction = Eigen::Vector3d(0.6, 0.0, -0.8);
  set.outputs[0].position = Eigen::Vector3d(0.1, 1.0 / 3.0, 0.0);
  for (auto& output : set.outputs) {
    output.unit = "m/s";
    output.kind = modal::FrfKind::mobility;
  }
  set.inputs[0].unit = "N";
  return set;
}

}  // namespace chladni::io
