#include "mesh/remesh/feature_lines.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

namespace chladni::mesh {
namespace {

constexpr double corner_turn = 50.0 * std::numbers::pi / 180.0;

using Line = std::vector<int>;  // points in order; the first one again at the end of a loop

class Lines {
 public:
  Lines(const Points& points, const std::vector<EdgeUse>& kept) : points_(points) {
    for (const EdgeUse& edge : kept) {
      neighbours_[edge.low].push_back(edge.high);
      neighbours_[edge.high].push_back(edge.low);
    }
  }

  std::vector<Line> all() {
    std::vector<Line> lines;
    for (auto& [point, neighbours] : neighbours_) {
      if (!ends_at(point)) continue;
      for (const int next : neighbours) {
        Line line = line_from(point, next);
        if (line.front() < line.back() ||
            (line.front() == line.back() && line[1] <= line.end()[-2]))
          lines.push_back(std::move(line));
      }
    }
    for (const auto& [point, neighbours] : neighbours_) {
      if (!done_.contains(point)) lines.push_back(line_from(point, neighbours[0]));
    }
    return lines;
  }

 private:
  [[nodiscard]] bool ends_at(int point) {
    const std::vector<int>& n = neighbours_.at(point);
    if (n.size() != 2) return true;
    const Eigen::Vector3d in = (points_.row(point) - points_.row(n[0])).normalized();
    const Eigen::Vector3d out = (points_.row(n[1]) - points_.row(point)).normalized();
    return in.dot(out) < std::cos(corner_turn);
  }

  Line line_from(int start, int next) {
    Line line{start, next};
    done_[start] = true;
    while (line.back() != start && !ends_at(line.back())) {
      done_[line.back()] = true;
      const std::vector<int>& n = neighbours_.at(line.back());
      line.push_back(n[0] == line[line.size() - 2] ? n[1] : n[0]);
    }
    return line;
  }

  const Points& points_;
  std::map<int, std::vector<int>> neighbours_;
  std::map<int, bool> done_;
};

// Whether one chord may replace the line from i to j.
bool fits(const Points& points, const Line& line, std::size_t i, std::size_t j,
          const Sampling& sampling) {
  const Eigen::Vector3d a = points.row(line[i]);
  const Eigen::Vector3d along = points.row(line[j]).transpose() - a;
  const double length = along.norm();
  if (length > sampling.longest || length <= 0.0) return false;
  double turned = 0.0;
  for (std::size_t k = i + 1; k < j; ++k) {
    const Eigen::Vector3d p = points.row(line[k]);
    const Eigen::Vector3d in = p - points.row(line[k - 1]).transpose();
    const Eigen::Vector3d out = points.row(line[k + 1]).transpose() - p;
    turned += std::atan2(in.cross(out).norm(), in.dot(out));
    if (turned > sampling.turn) return false;
    if ((p - a).cross(along).norm() > sampling.deviation * length) return false;
  }
  return true;
}

// Positions of the points that remain when every chord is as long as allowed.
std::vector<std::size_t> positions(const Points& points, const Line& line,
                                   const Sampling& sampling) {
  std::vector<std::size_t> stay{0};
  while (stay.back() + 1 < line.size()) {
    std::size_t j = stay.back() + 1;
    while (j + 1 < line.size() && fits(points, line, stay.back(), j + 1, sampling)) ++j;
    stay.push_back(j);
  }
  return stay;
}

// As few positions as `positions`, found with the tightest sampling that needs no more of them.
std::vector<std::size_t> even_positions(const Points& points, const Line& line,
                                        const Sampling& sampling) {
  std::vector<std::size_t> best = positions(points, line, sampling);
  double low = 0.25;
  double high = 1.0;
  for (int step = 0; step < 8 && best.size() > 2 && best.size() < line.size(); ++step) {
    const double s = 0.5 * (low + high);
    const Sampling tighter{s * sampling.longest, s * s * sampling.deviation, s * sampling.turn};
    std::vector<std::size_t> stay = positions(points, line, tighter);
    if (stay.size() > best.size()) {
      low = s;
    } else {
      high = s;
      best = std::move(stay);
    }
  }
  return best;
}

// Leaves out points where one slightly larger chord can replace two.
std::vector<std::size_t> without_remnants(const Points& points, const Line& line,
                                          const Sampling& sampling,
                                          const std::vector<std::size_t>& stay) {
  const Sampling wider{1.3 * sampling.longest, 1.7 * sampling.deviation, 1.3 * sampling.turn};
  std::vector<std::size_t> kept{0};
  for (std::size_t i = 1; i < stay.size(); ++i) {
    const bool last = i + 1 == stay.size();
    if (last || !fits(points, line, kept.back(), stay[i + 1], wider)) kept.push_back(stay[i]);
  }
  return kept;
}

void replace_between(const Points& points, const Line& line, std::size_t i, std::size_t j,
                     std::vector<int>& stand_in) {
  const auto arc = [&](std::size_t from, std::size_t to) {
    double sum = 0.0;
    for (std::size_t k = from; k < to; ++k) {
      sum += (points.row(line[k + 1]) - points.row(line[k])).norm();
    }
    return sum;
  };
  const double whole = arc(i, j);
  for (std::size_t k = i + 1; k < j; ++k) {
    stand_in[static_cast<std::size_t>(line[k])] = 2.0 * arc(i, k) <= whole ? line[i] : line[j];
  }
}

}  // namespace

double chord_length(double radius, const Sampling& sampling) {
  return std::min(
      {sampling.longest, std::sqrt(8.0 * radius * sampling.deviation), sampling.turn * radius});
}

std::vector<int> stand_ins(const Surface& surface, const std::vector<EdgeUse>& kept,
                           const Sampling& sampling) {
  std::vector<int> stand_in(static_cast<std::size_t>(surface.points.rows()));
  std::iota(stand_in.begin(), stand_in.end(), 0);
  for (const Line& line : Lines(surface.points, kept).all()) {
    const std::vector<std::size_t> stay = without_remnants(
        surface.points, line, sampling, even_positions(surface.points, line, sampling));
    for (std::size_t i = 1; i < stay.size(); ++i) {
      replace_between(surface.points, line, stay[i - 1], stay[i], stand_in);
    }
  }
  return stand_in;
}

}  // namespace chladni::mesh
