#include "diagnosis/search/overlap.h"

#include <algorithm>

namespace chladni::diagnosis {
namespace {

bool overlap(const Structure& structure, const Supposed& a, const Supposed& b) {
  const auto here = place_of(a, structure);
  const auto there = place_of(b, structure);
  return here && there && (*here - *there).norm() < reach_of(a, structure) + reach_of(b, structure);
}

}  // namespace

bool overlaps_itself(const Structure& structure, const Fit& fit) {
  const auto& causes = fit.causes;
  for (auto one = causes.begin(); one != causes.end(); ++one) {
    const auto with = [&](const Supposed& other) { return overlap(structure, *one, other); };
    if (std::any_of(one + 1, causes.end(), with)) return true;
  }
  return false;
}

bool is_there_already(const Structure& structure, const Fit& fit, const Supposed& cause) {
  return std::ranges::any_of(fit.causes, [&](const Supposed& other) {
    if (place_of(cause, structure)) return overlap(structure, cause, other);
    return other.effect == cause.effect && other.option == cause.option;
  });
}

}  // namespace chladni::diagnosis
