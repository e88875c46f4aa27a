#include "fem/factor/kept_factor.h"

#include <bit>
#include <cstring>

#include "fem/factor/factorization.h"
#include "host/parallel.h"

namespace chladni::fem {
namespace {

// A hash of the bytes, eight at a time (multiplication and rotation as in FxHash, with the final
// mixing of MurmurHash3).
std::uint64_t hash_on(std::uint64_t hash, const void* data, std::size_t bytes) {
  constexpr std::uint64_t kOdd = 0x9e3779b97f4a7c15U;
  const auto* from = static_cast<const unsigned char*>(data);
  for (std::size_t i = 0; i < bytes; i += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, from + i, std::min<std::size_t>(8, bytes - i));
    hash = std::rotl(hash ^ word, 23) * kOdd;
  }
  hash ^= bytes;
  hash = (hash ^ (hash >> 33U)) * 0xff51afd7ed558ccdU;
  hash = (hash ^ (hash >> 33U)) * 0xc4ceb9fe1a85ec53U;
  return hash ^ (hash >> 33U);
}

std::uint64_t hash_of_pattern(std::uint64_t hash, const SparseMatrix& a) {
  const auto entries = static_cast<std::size_t>(a.nonZeros());
  hash = hash_on(hash, a.outerIndexPtr(), sizeof(int) * static_cast<std::size_t>(a.cols() + 1));
  return hash_on(hash, a.innerIndexPtr(), sizeof(int) * entries);
}

std::uint64_t hash_of_values(std::uint64_t hash, const SparseMatrix& a) {
  return hash_on(hash, a.valuePtr(), sizeof(double) * static_cast<std::size_t>(a.nonZeros()));
}

std::uint64_t pattern_of(const SparseMatrix& stiffness, const SparseMatrix& mass) {
  return hash_of_pattern(hash_of_pattern(1, stiffness), mass);
}

std::uint64_t matrices_of(const SparseMatrix& stiffness, const SparseMatrix& mass) {
  return hash_of_values(hash_of_values(pattern_of(stiffness, mass), stiffness), mass);
}

}  // namespace

std::shared_ptr<const Symbolic> KeptFactor::symbolic(const SparseMatrix& stiffness,
                                                     const SparseMatrix& mass) {
  const auto pattern = pattern_of(stiffness, mass);
  {
    const std::lock_guard lock(mutex_);
    if (symbolic_ && pattern == pattern_ && threads_ == thread_count()) return symbolic_;
  }
  auto found = std::make_shared<const Symbolic>(stiffness, mass);
  const std::lock_guard lock(mutex_);
  symbolic_ = found;
  pattern_ = pattern;
  threads_ = found->threads();
  shifted_ = {};
  return found;
}

std::shared_ptr<const Factorization> KeptFactor::factor(const SparseMatrix& stiffness, double s,
                                                        const SparseMatrix& mass,
                                                        double keep_bytes) {
  if (auto earlier = kept(stiffness, mass, s, s); earlier.factor) return earlier.factor;
  const auto analysis = symbolic(stiffness, mass);
  {
    const std::lock_guard lock(mutex_);
    shifted_ = {};  // two factors at once may not fit
  }
  auto found = std::make_shared<const Factorization>(analysis, stiffness, s, mass);
  if (analysis->forecast().factor_bytes > keep_bytes) return found;
  const auto matrices = matrices_of(stiffness, mass);
  const std::lock_guard lock(mutex_);
  if (symbolic_ != analysis) return found;
  matrices_ = matrices;
  shifted_ = {found, s};
  return found;
}

KeptFactor::Shifted KeptFactor::kept(const SparseMatrix& stiffness, const SparseMatrix& mass,
                                     double least, double most) {
  Shifted there;
  std::uint64_t matrices = 0;
  {
    const std::lock_guard lock(mutex_);
    if (!shifted_.factor || threads_ != thread_count()) return {};
    there = shifted_;
    matrices = matrices_;
  }
  if (there.s < least || there.s > most || matrices != matrices_of(stiffness, mass)) return {};
  return there;
}

}  // namespace chladni::fem
