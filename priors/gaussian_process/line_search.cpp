#include "priors/gaussian_process/line_search.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/search.h"
#include "priors/constants.h"

namespace chladni::priors {
namespace {

using Table = std::map<double, Eigen::VectorXd>;

struct Triple {
  std::map<double, Eigen::VectorXd>::const_iterator left, best, right;
  bool inside = false;  // there are neighbours on both sides
};

Triple around_the_best(const Table& table, Eigen::Index function) {
  Triple triple{table.begin(), table.begin(), table.begin()};
  for (auto it = table.begin(); it != table.end(); ++it) {
    if (it->second(function) > triple.best->second(function)) triple.best = it;
  }
  triple.inside = triple.best != table.begin() && std::next(triple.best) != table.end();
  if (triple.inside) {
    triple.left = std::prev(triple.best);
    triple.right = std::next(triple.best);
  }
  return triple;
}

// The polynomial through the values at some points, by Neville's scheme.
double interpolated(const std::vector<double>& places, std::vector<double> values, double at) {
  const std::size_t n = places.size();
  for (std::size_t k = 1; k < n; ++k) {
    for (std::size_t i = 0; i + k < n; ++i) {
      values[i] = ((at - places[i + k]) * values[i] + (places[i] - at) * values[i + 1]) /
                  (places[i] - places[i + k]);
    }
  }
  return values[0];
}

// Maximum, between the nearest neighbours, of the polynomial through the best point
// and two on each side.
double summit(const Table& table, const Triple& t, Eigen::Index function) {
  const auto first = t.left == table.begin() ? t.left : std::prev(t.left);
  const auto last = std::next(t.right) == table.end() ? t.right : std::next(t.right);
  std::vector<double> places;
  std::vector<double> values;
  for (auto it = first; it != std::next(last); ++it) {
    places.push_back(it->first);
    values.push_back(it->second(function) - t.best->second(function));
  }
  const auto depth = [&](double at) { return -interpolated(places, values, at); };
  return minimum_in(depth, t.left->first, t.right->first).at;
}

// The next point to evaluate for a function; NaN if its maximum is found.
double next_place(const Table& table, Eigen::Index function, double tolerance, double width) {
  const auto t = around_the_best(table, function);
  if (!t.inside) {  // at an end of the range: move closer to it
    const auto next = t.best == table.begin() ? std::next(t.best) : std::prev(t.best);
    const double gap = next->first - t.best->first;
    return std::abs(gap) > 0.01 * width ? t.best->first + 0.3 * gap : std::nan("");
  }
  const double x = t.best->first;
  const double left = x - t.left->first;
  const double right = t.right->first - x;
  if (std::max(left, right) < 2.0 * tolerance) return std::nan("");
  const double at = summit(table, t, function);
  if (std::abs(at - x) > 0.5 * tolerance) return at;
  // The summit is the present point. A close neighbour makes the polynomial reliable.
  constexpr double kNear = 50.0;
  if (std::min(left, right) < kNear * tolerance) return std::nan("");
  return right > left ? x + 0.1 * right : x - 0.1 * left;
}

}  // namespace

LineMaxima maxima_on_a_line(const ValuesOnLine& values, double low, double high, int grid,
                            double tolerance) {
  Table table;
  for (int k = 0; k < grid; ++k) {
    const double at = low + (high - low) * k / (grid - 1);
    table.emplace(at, values(at));
  }
  const Eigen::Index count = table.begin()->second.size();
  for (Eigen::Index f = 0; f < count; ++f) {
    for (int step = 0; step < Constants::line_steps; ++step) {
      const double at = next_place(table, f, tolerance, high - low);
      if (std::isnan(at)) break;
      table.emplace(at, values(at));
    }
  }
  LineMaxima result;
  result.evaluations = static_cast<int>(table.size());
  for (Eigen::Index f = 0; f < count; ++f) {
    const auto best = around_the_best(table, f).best;
    result.maxima.push_back({best->first, best->second(f)});
  }
  return result;
}

}  // namespace chladni::priors
