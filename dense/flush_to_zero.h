// Numbers too small for full precision, taken for zero.
#pragma once

namespace chladni::dense {

/// Covariances of far points underflow, and a processor takes a hundred times as long for such
/// numbers; they are zeros while one of these lives.
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
