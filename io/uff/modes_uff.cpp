// Writes modes to a universal file.
#include "io/modes_uff.h"

#include <fmt/format.h>

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <set>
#include <span>

#include "base/error.h"
#include "io/uff/uff.h"
#include "io/uff/uff_fields.h"

namespace chladni::io {
namespace {

using Complex = std::complex<double>;
using Index = Eigen::Index;
using Integers = std::vector<long long>;

constexpr int kStructural = 1, kDisplacement = 8, kThreeValues = 3;
constexpr int kThinShellLinearTriangle = 91;
constexpr int kColour = 7;
constexpr std::size_t kMostOnTraceLine = 123;  // programs take 125; two nodes and a lift each

void require_sizes(const UffModes& modes) {
  const Index n = std::ssize(modes.node), m = modes.frequency_hz.size();
  require(modes.place.rows() == n && modes.shapes.rows() == 3 * n && modes.shapes.cols() == m &&
              modes.damping_ratio.size() == m && std::ssize(modes.has_scale) == m,
          fmt::format("UFF: {} nodes with {} places, {} modes with {} damping ratios and shapes of "
                      "{} x {}",
                      n, modes.place.rows(), m, modes.damping_ratio.size(), modes.shapes.rows(),
                      modes.shapes.cols()));
  require(modes.shapes.allFinite() && modes.imaginary.allFinite() && modes.place.allFinite(),
          "UFF: a shape or a place is no number");
  require(modes.imaginary.size() == 0 || (modes.imaginary.rows() == modes.shapes.rows() &&
                                          modes.imaginary.cols() == modes.shapes.cols()),
          "UFF: real and imaginary parts of the shapes differ in size");
  require(modes.known.size() == 0 || (modes.known.rows() == n && modes.known.cols() == m),
          fmt::format("UFF: {} x {} marks of what is known, for {} nodes and {} modes",
                      modes.known.rows(), modes.known.cols(), n, m));
  std::set<long long> seen;
  for (const long long node : modes.node) {
    require(node >= 1 && node <= std::numeric_limits<std::int32_t>::max(),
            fmt::format("UFF: node {}, expected 1 to 2147483647", node));
    require(seen.insert(node).second, fmt::format("UFF: node {} occurs twice", node));
  }
}

std::string triangles_2412(const UffModes& modes) {
  std::string text;
  for (Index t = 0; t < modes.triangles.rows(); ++t) {
    Integers corners;
    for (const auto row : modes.triangles.row(t)) {
      corners.push_back(modes.node.at(static_cast<std::size_t>(row)));
    }
    const Integers head{t + 1, kThinShellLinearTriangle, 1, 1, kColour, 3};
    text += lines_of_8(head) + lines_of_8(corners);
  }
  return uff_block(2412, text);
}

std::string nodes_15(const UffModes& modes) {
  std::string text;
  for (Index i = 0; i < modes.place.rows(); ++i) {
    text += fmt::format("{:10}{:10}{:10}{:10}{}{}{}\n", modes.node[static_cast<std::size_t>(i)], 0,
                        0, kColour, in_13(modes.place(i, 0)), in_13(modes.place(i, 1)),
                        in_13(modes.place(i, 2)));
  }
  return uff_block(15, text);
}

// Each trace line is pairs of nodes with a 0 between them, which lifts the pen. It has a dataset of
// its own.
std::string lines_82(const UffModes& modes) {
  std::string text;
  Integers nodes;
  int number = 0;
  const auto close = [&] {
    text += uff_block(82, fmt::format("{:10}{:10}{:10}\n", ++number, nodes.size(), kColour) +
                              line_80("lines between the channels") + lines_of_8(nodes));
    nodes.clear();
  };
  for (const auto& line : modes.lines) {
    for (const Index end : line) nodes.push_back(modes.node.at(static_cast<std::size_t>(end)));
    nodes.push_back(0);
    if (nodes.size() >= kMostOnTraceLine) close();
  }
  if (!nodes.empty()) close();
  return text;
}

std::string geometry(const UffModes& modes) {
  if (modes.triangles.rows() == 0) {
    return uff_head(modes.title, {}, modes.program) + nodes_15(modes) +
           (modes.lines.empty() ? std::string() : lines_82(modes));
  }
  std::map<long long, Eigen::Vector3d> nodes;
  for (std::size_t i = 0; i < modes.node.size(); ++i) {
    nodes.emplace(modes.node[i], modes.place.row(static_cast<Index>(i)).transpose());
  }
  return uff_head(modes.title, nodes, modes.program) + triangles_2412(modes);
}

// What a dataset says of a mode before the values.
struct ModeHead {
  Index number = 0;  // from 1
  bool is_complex = false;
  double frequency_hz = 0.0, damping_ratio = 0.0, modal_mass = 0.0;
  Complex eigenvalue, modal_a, modal_b;
};

ModeHead head_of(const UffModes& modes, Index m) {
  ModeHead head;
  head.number = m + 1;
  head.is_complex = modes.imaginary.size() > 0;
  head.frequency_hz = modes.frequency_hz(m);
  head.damping_ratio = modes.damping_ratio(m);
  head.modal_mass = modes.has_scale[static_cast<std::size_t>(m)] ? 1.0 : 0.0;
  const double omega = 2.0 * std::numbers::pi * head.frequency_hz;
  const double damped =
      omega * std::sqrt(std::max(0.0, 1.0 - head.damping_ratio * head.damping_ratio));
  head.eigenvalue = {-head.damping_ratio * omega, damped};
  head.modal_a = head.modal_mass * Complex(0.0, 2.0 * damped);
  head.modal_b = -head.eigenvalue * head.modal_a;
  return head;
}

std::string identification(const UffModes& modes, const ModeHead& head) {
  return line_80(modes.title) +
         line_80(fmt::format("mode {}, {:.6g} Hz", head.number, head.frequency_hz)) + line_80("") +
         line_80(head.modal_mass > 0.0 ? "shapes in kg^-1/2, mass-normalised"
                                       : "the scale of the shape is not known") +
         line_80("");
}

std::array<double, 6> complex_numbers(const ModeHead& head) {
  return {head.eigenvalue.real(), head.eigenvalue.imag(), head.modal_a.real(),
          head.modal_a.imag(),    head.modal_b.real(),    head.modal_b.imag()};
}

std::string form_of(const ModeHead& head) {
  const Integers form{
      kStructural,   head.is_complex ? kComplexFirstOrder : kNormalMode, kTranslations,
      kDisplacement, head.is_complex ? kComplexValues : kRealValues,     kThreeValues};
  return lines_of_8(form);
}

std::string head_55(const ModeHead& head) {
  const Integers counts{2, head.is_complex ? 6 : 4, 1, head.number};
  const std::array<double, 4> numbers{head.frequency_hz, head.modal_mass, head.damping_ratio, 0.0};
  return form_of(head) + lines_of_8(counts) +
         (head.is_complex ? lines_of_6(complex_numbers(head)) : lines_of_6(numbers));
}

std::string head_2414(const UffModes& modes, const ModeHead& head) {
  const Integers of_analysis{0, 0, 0, 0, 1, head.number, 0, 0};
  const Integers none(8, 0);
  const double square = std::norm(head.eigenvalue);
  const std::array<double, 6> numbers{
      0.0, head.frequency_hz, square, head.modal_mass, head.damping_ratio, 0.0};
  const std::array<double, 6> nothing{};
  return fmt::format("{:10}\n", head.number) + line_80(fmt::format("mode {}", head.number)) +
         fmt::format("{:10}\n", 1) + identification(modes, head) + form_of(head) +
         lines_of_8(of_analysis) + lines_of_8(none) + lines_of_6(numbers) +
         (head.is_complex ? lines_of_6(complex_numbers(head)) : lines_of_6(nothing));
}

std::string values_of(const UffModes& modes, Index m) {
  std::string text;
  std::vector<double> values;
  for (std::size_t i = 0; i < modes.node.size(); ++i) {
    if (modes.known.cols() > 0 && !modes.known(static_cast<Index>(i), m)) continue;
    values.clear();
    for (Index row = 3 * static_cast<Index>(i); row < 3 * static_cast<Index>(i) + 3; ++row) {
      values.push_back(modes.shapes(row, m));
      if (modes.imaginary.size() > 0) values.push_back(modes.imaginary(row, m));
    }
    text += fmt::format("{:10}\n", modes.node[i]) + lines_of_6(values);
  }
  return text;
}

}  // namespace

std::string modes_uff(const UffModes& modes, ShapeDataset dataset) {
  require_sizes(modes);
  std::string text = geometry(modes);
  for (Index m = 0; m < modes.frequency_hz.size(); ++m) {
    if (modes.known.cols() > 0 && !modes.known.col(m).any()) continue;
    const ModeHead head = head_of(modes, m);
    text += dataset == ShapeDataset::nodes_55
                ? uff_block(55, identification(modes, head) + head_55(head) + values_of(modes, m))
                : uff_block(2414, head_2414(modes, head) + values_of(modes, m));
  }
  return text;
}

std::vector<std::array<Index, 2>> wire_frame(const Points& place) {
  std::vector<std::array<Index, 2>> lines;
  const Index n = place.rows();
  std::vector<bool> joined(static_cast<std::size_t>(n), false);
  Eigen::VectorXd distance = Eigen::VectorXd::Constant(n, std::numeric_limits<double>::infinity());
  std::vector<Index> nearest(static_cast<std::size_t>(n), 0);
  Index last = 0;
  for (Index step = 1; step < n; ++step) {
    joined[static_cast<std::size_t>(last)] = true;
    Index next = -1;
    for (Index i = 0; i < n; ++i) {
      if (joined[static_cast<std::size_t>(i)]) continue;
      const double to_last = (place.row(i) - place.row(last)).norm();
      if (to_last < distance(i)) {
        distance(i) = to_last;
        nearest[static_cast<std::size_t>(i)] = last;
      }
      if (next < 0 || distance(i) < distance(next)) next = i;
    }
    lines.push_back({nearest[static_cast<std::size_t>(next)], next});
    last = next;
  }
  return lines;
}

}  // namespace chladni::io
