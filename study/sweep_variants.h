// The variants of a plan: each point of its grid, or of a sample.
#pragma once

#include <string>
#include <vector>

#include "study/sweep_plan.h"

namespace chladni::study {

struct Variant {
  std::vector<std::string> labels;  ///< one per axis: "20 mm", "corners"
  TomlNode sets;                    ///< the keys in which it differs from the base
};

/// Makes a plan's variants when they are asked for. The last axis of a grid changes fastest. A
/// sample is a Latin hypercube (McKay et al. 1979): each range is cut into as many parts as there
/// are variants, and each part is taken once, anywhere in it; values and choices come equally
/// often.
class Variants {
 public:
  /// @throws InvalidInput  more than kMostVariants
  explicit Variants(const SweepPlan& plan);

  [[nodiscard]] long long size() const { return size_; }
  /// @param index  from 0 to size() − 1
  [[nodiscard]] Variant at(long long index) const;
  /// The text of its study: it extends `base`, as seen from the folder of the variant.
  /// @param title  whether it names the points of the axes
  [[nodiscard]] std::string text(const Variant& variant, const std::string& base, bool title) const;

 private:
  const SweepPlan& plan_;
  long long size_ = 1;
  std::vector<std::vector<double>> sample_;  ///< [axis][variant], 0 to 1; empty for a grid
};

}  // namespace chladni::study
