// What chladni-slepc leaves in the folder of an exchange.
#pragma once

#include <filesystem>
#include <vector>

#include "fem/given_modes.h"

namespace chladni::cluster {

struct Reply {
  fem::GivenModes given;  ///< without its shift
  std::vector<double> peak_bytes;
  int shifts = 0;
  double seconds = 0.0;
};

/// Reads reply.txt, shapes.petsc and corrections.petsc. The text has, word by word:
///
///     chladni-slepc 1  rows N  bound B  counted C  seconds T
///     ranks R  (R peaks of memory, bytes)  shifts S  (S times: shift, eigenvalues below)
///     modes M  (M eigenvalues)  end
///
/// The other two hold M vectors of N numbers, big-endian, without headers. Every size is compared
/// with that of its file before memory is taken. The modes are sorted.
/// @throws InvalidInput  a file is missing, too short or too long; a word is not what it should be
[[nodiscard]] Reply read_reply(const std::filesystem::path& folder, Eigen::Index rows);

}  // namespace chladni::cluster
