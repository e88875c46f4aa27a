// Recordings in .mat files that are larger than the memory.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>

#include "base/error.h"
#include "base/interrupt.h"
#include "io/bytes/scratch_file.h"
#include "io/matlab/mat_names.h"
#include "io/matlab/mat_parts.h"
#include "io/matlab/testlab_mat.h"
#include "io/matlab/time_mat.h"
#include "io/matlab/time_sides.h"

namespace chladni::io {
namespace {

using Index = Eigen::Index;

constexpr double kWholeCostOfMat =
    10.0;  // memory for a file that is read as a whole, over its samples
// Bytes of samples as numbers over those of their file, at most: zlib packs to a thousandth, and a
// sample of one byte becomes eight.
constexpr double kMostPacked = 1e4;
constexpr std::size_t kBlocks = 64;  // of which one is in memory, six times
constexpr std::size_t kSmallestBlock = std::size_t{1} << 16U;

// The largest variable that is read with the heads, and the largest part of one that is not.
std::size_t block_of(const TimeOptions& options) {
  return std::max(kSmallestBlock, options.limit_bytes / kBlocks);
}

MatFile heads_of(const std::filesystem::path& file, const TimeOptions& options) {
  return read_mat_heads(file, mat_limit(options.limit_bytes), block_of(options));
}

// Whether the file states a period of the excitation.
bool has_periods(const MatFile& file) {
  const auto* period = mat_value(file.variables, {"period"});
  return period != nullptr && period->kind == MatValue::Kind::number && period->size() == 1 &&
         period->real(0) > 0.0;
}

// The size of all samples as numbers in memory.
double bytes_of_recordings(const MatFile& file) {
  double bytes = 0.0;
  for (std::size_t side = 0; side < 3; ++side) {
    const auto* value = variable_of(file.variables, side);
    if (value != nullptr) bytes += 8.0 * static_cast<double>(value->size());
  }
  return bytes;
}

/// The variables of a file, of which the large ones go to a scratch file when they are asked for.
class MatOnDisk {
 public:
  MatOnDisk(std::filesystem::path path, const TimeOptions& options)
      : path_(std::move(path)),
        file_(heads_of(path_, options)),
        block_(static_cast<Index>(block_of(options) / sizeof(double))) {
    const double bytes = bytes_of_recordings(file_);
    const auto size = static_cast<double>(std::filesystem::file_size(path_));
    require(bytes <= kMostPacked * size,
            fmt::format("{}: it has {:.4g} bytes, and says that it holds {:.4g} bytes of samples; "
                        "expected at most {:g} times as many",
                        path_.string(), size, bytes, kMostPacked));
  }

  [[nodiscard]] const MatFile& file() const { return file_; }

  Eigen::VectorXd numbers(const MatValue& value, Index first, Index count) {
    throw_if_interrupted();
    if (value.kind != MatValue::Kind::large) return value.real.segment(first, count);
    Eigen::VectorXd result(count);
    scratch_.read(begin_of(value) + sizeof(double) * static_cast<std::uint64_t>(first),
                  result.data(), static_cast<std::size_t>(count));
    return result;
  }

 private:
  std::uint64_t begin_of(const MatValue& value) {
    const auto found = begins_.find(&value);
    if (found != begins_.end()) return found->second;
    const auto is_it = [&](const auto& one) { return &one.second == &value; };
    const auto variable = std::ranges::find_if(file_.variables, is_it);
    return begins_[&value] = copied(variable->first, value.dims);
  }

  // Copies a variable in parts that are contiguous in it. @return where it begins
  std::uint64_t copied(const std::string& name, const std::vector<Index>& dims) {
    std::size_t cut = 0;  // the dimension along which parts are cut
    Index inner = 1;      // numbers of one step along it
    while (cut + 1 < dims.size() && inner * dims[cut] <= block_) inner *= dims[cut++];
    const Index steps = std::max<Index>(1, block_ / inner);
    std::vector<Index> start(dims.size(), 0);
    std::vector<Index> count(dims.size(), 1);
    std::copy_n(dims.begin(), cut, count.begin());
    std::uint64_t begin = std::numeric_limits<std::uint64_t>::max();
    for (bool more = true; more; more = advance(dims, cut, count[cut], start)) {
      throw_if_interrupted();
      count[cut] = std::min(steps, dims[cut] - start[cut]);
      const auto part = read_mat_part(path_, name, start, count);
      begin = std::min(begin, scratch_.append(part.data(), static_cast<std::size_t>(part.size())));
    }
    return begin;
  }

  // The start of the next part; false: there is none.
  static bool advance(const std::vector<Index>& dims, std::size_t cut, Index by,
                      std::vector<Index>& start) {
    start[cut] += by;
    for (std::size_t d = cut; d < dims.size(); ++d) {
      if (start[d] < dims[d]) return true;
      start[d] = 0;
      if (d + 1 < dims.size()) ++start[d + 1];
    }
    return false;
  }

  std::filesystem::path path_;
  MatFile file_;
  Index block_;
  ScratchFile scratch_;
  std::map<const MatValue*, std::uint64_t> begins_;
};

}  // namespace

bool is_mat_read_in_pieces(const std::filesystem::path& file, const TimeOptions& options) {
  const auto limit = static_cast<double>(options.limit_bytes);
  if (kMostPacked * static_cast<double>(std::filesystem::file_size(file)) < limit) return false;
  const auto heads = heads_of(file, options);
  return (options.period > 0 || options.blows_in_pieces || has_periods(heads)) &&
         !has_testlab_functions(heads.variables) &&
         kWholeCostOfMat * bytes_of_recordings(heads) > limit;
}

RecordingsFile read_mat_in_pieces(const std::filesystem::path& file, const TimeOptions& options) {
  const auto disk = std::make_shared<MatOnDisk>(file, options);
  return recordings_of_mat(disk->file(), file.string(), options,
                           [disk](const MatValue& value, Index first, Index count) {
                             return disk->numbers(value, first, count);
                           });
}

}  // namespace chladni::io
