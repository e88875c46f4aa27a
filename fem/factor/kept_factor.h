// The analysis and the factor of a system, kept from one call to the next.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>

#include "base/arrays.h"

namespace chladni::fem {

class Symbolic;
class Factorization;

/// Keeps the last analysis and the last factor. They are given again only for a pattern, and for
/// matrices, that are the same to the last bit (by a hash of 64 bits; 30 ms per 100 MB), and for
/// the same number of threads. Safe to share between threads.
class KeptFactor {
 public:
  /// The analysis of the pattern of K and M. @throws as Symbolic
  [[nodiscard]] std::shared_ptr<const Symbolic> symbolic(const SparseMatrix& stiffness,
                                                         const SparseMatrix& mass);
  /// The factor of K + s M. It is kept where it takes at most `keep_bytes`.
  /// @throws as Factorization
  [[nodiscard]] std::shared_ptr<const Factorization> factor(const SparseMatrix& stiffness, double s,
                                                            const SparseMatrix& mass,
                                                            double keep_bytes);
  struct Shifted {
    std::shared_ptr<const Factorization> factor;  ///< null: none is kept
    double s = 0.0;
  };
  /// The factor that is kept of these K and M where its s is between `least` and `most`.
  [[nodiscard]] Shifted kept(const SparseMatrix& stiffness, const SparseMatrix& mass, double least,
                             double most);

 private:
  std::mutex mutex_;
  std::uint64_t pattern_ = 0, matrices_ = 0;
  int threads_ = 0;
  std::shared_ptr<const Symbolic> symbolic_;
  Shifted shifted_;
};

}  // namespace chladni::fem
