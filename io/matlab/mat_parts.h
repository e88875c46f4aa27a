// Parts of a .mat file that is larger than the memory.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "io/mat.h"

namespace chladni::io {

/// As `read_mat`; real variables of more than `large_bytes` are `large`: their numbers are left in
/// the file.
[[nodiscard]] MatFile read_mat_heads(const std::filesystem::path& file, std::size_t limit_bytes,
                                     std::size_t large_bytes);

/// From `start` on `count` numbers along each dimension of a real variable, the first dimension
/// fastest. Cost: of a compressed file of version 5 all of the variable before is unpacked.
/// @throws as read_mat
[[nodiscard]] Eigen::VectorXd read_mat_part(const std::filesystem::path& file,
                                            const std::string& variable,
                                            const std::vector<Eigen::Index>& start,
                                            const std::vector<Eigen::Index>& count);

}  // namespace chladni::io
