// Treats subnormal numbers (too small for full precision) as zero.
#pragma once

namespace chladni::dense {

/// While an object of this class lives, subnormal numbers are zeros. The covariances of far points
/// are such numbers, and a processor takes a hundred times as long for them.
class FlushToZero {
 public:
  FlushToZero();
  ~FlushToZero();
  FlushToZero(const FlushToZero&) = delete;
  FlushToZero& operator=(const FlushToZero&) = delete;

 private:
  unsigned before_ = 0;
};

}  // namespace chladni::dense
