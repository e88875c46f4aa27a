#include "study/sweep_variants.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/draw.h"
#include "base/error.h"
#include "study/extends.h"
#include "study/toml/toml_text.h"

namespace chladni::study {
namespace {

// Shares of a range: one in each of n equal parts, in random order.
std::vector<double> stratified(long long n, Draw& draw) {
  std::vector<long long> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0LL);
  for (auto i = n - 1; i > 0; --i) {
    const auto other = static_cast<long long>(draw.uniform() * static_cast<double>(i + 1));
    std::swap(order[static_cast<std::size_t>(i)], order[static_cast<std::size_t>(other)]);
  }
  std::vector<double> shares;
  for (const auto part : order) {
    shares.push_back((static_cast<double>(part) + draw.uniform()) / static_cast<double>(n));
  }
  return shares;
}

AxisPoint point_at(const SweepAxis& axis, double share) {
  if (axis.range) {
    const auto node = value_on(*axis.range, share);
    return {node.text, document_with(axis.key, node)};
  }
  const auto count = static_cast<double>(axis.points.size());
  const auto index = std::min(static_cast<std::size_t>(share * count), axis.points.size() - 1);
  return axis.points[index];
}

}  // namespace

Variants::Variants(const SweepPlan& plan) : plan_(plan) {
  if (plan.sample_count > 0) {
    size_ = plan.sample_count;
    Draw draw(plan.seed);
    for (std::size_t a = 0; a < plan.axes.size(); ++a) sample_.push_back(stratified(size_, draw));
    return;
  }
  double count = 1.0;  // no overflow
  for (const auto& axis : plan.axes) count *= static_cast<double>(axis.points.size());
  require(count <= static_cast<double>(kMostVariants),
          fmt::format("{}: its axes have {:.0f} variants; expected at most {}, or [sample] with a "
                      "count",
                      plan.file.string(), count, kMostVariants));
  size_ = static_cast<long long>(count);
}

Variant Variants::at(long long index) const {
  Variant variant;
  auto rest = index;
  std::vector<AxisPoint> points(plan_.axes.size());
  for (auto a = plan_.axes.size(); a-- > 0;) {
    const auto& axis = plan_.axes[a];
    if (!sample_.empty()) {
      points[a] = point_at(axis, sample_[a][static_cast<std::size_t>(index)]);
      continue;
    }
    const auto count = static_cast<long long>(axis.points.size());
    points[a] = axis.points[static_cast<std::size_t>(rest % count)];
    rest /= count;
  }
  for (auto& point : points) {
    merge(variant.sets, point.sets, plan_.file.string(), Removed::kept);
    variant.labels.push_back(std::move(point.label));
  }
  return variant;
}

std::string Variants::text(const Variant& variant, const std::string& base, bool title) const {
  std::string text = "extends = " + toml_text(base) + "\n";
  if (title && member(variant.sets, "title") == nullptr) {
    std::string words = plan_.title;
    for (std::size_t a = 0; a < plan_.axes.size(); ++a) {
      words += fmt::format("{} {} {}", a == 0 ? ":" : ",", plan_.axes[a].name, variant.labels[a]);
    }
    text += "title = " + toml_text(words) + "\n";
  }
  return text + toml_text(variant.sets);
}

}  // namespace chladni::study
