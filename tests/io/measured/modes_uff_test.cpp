#include "io/modes_uff.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "base/draw.h"
#include "base/error.h"
#include "io/node_shapes.h"
#include "io/uff/uff.h"
#include "tests/io/measured/uff_samples.h"

namespace chladni::io {
namespace {

using Eigen::Index;
using Complex = std::complex<double>;

// Shapes of all sizes at nodes with numbers of all lengths.
UffModes drawn(Index nodes, Index count, bool with_surface, bool is_complex) {
  Draw draw(17);
  UffModes modes;
  modes.title = "table on three feet";
  modes.program = "chladni 0.1.0+g0123456789";
  modes.place.resize(nodes, 3);
  modes.frequency_hz.resize(count);
  modes.damping_ratio.resize(count);
  modes.shapes.resize(3 * nodes, count);
  if (is_complex) modes.imaginary.resize(3 * nodes, count);
  for (Index i = 0; i < nodes; ++i) {
    modes.node.push_back(i == 0 ? 2147483647 : 7 * i);
    for (Index axis = 0; axis < 3; ++axis) modes.place(i, axis) = draw.uniform() - 0.5;
  }
  for (Index m = 0; m < count; ++m) {
    modes.frequency_hz(m) = m == 0 ? 0.0 : 100.0 * static_cast<double>(m) + draw.uniform();
    modes.damping_ratio(m) = m == 0 ? 0.0 : 0.001 + 0.1 * draw.uniform();
    modes.has_scale.push_back(m % 2 == 0);
    for (Index row = 0; row < 3 * nodes; ++row) {
      const double size = std::pow(10.0, -6.0 * draw.uniform());
      modes.shapes(row, m) = size * (draw.uniform() - 0.5);
      if (is_complex) modes.imaginary(row, m) = size * (draw.uniform() - 0.5);
    }
  }
  if (with_surface) {
    modes.triangles.resize(nodes - 2, 3);
    for (Index t = 0; t < nodes - 2; ++t) {
      modes.triangles.row(t) << static_cast<int>(t), static_cast<int>(t + 1),
          static_cast<int>(t + 2);
    }
  } else {
    modes.lines = wire_frame(modes.place);
  }
  return modes;
}

void expect_same(const NodeShape& found, const UffModes& modes, Index m, ShapeDataset dataset) {
  EXPECT_EQ(found.dataset, dataset == ShapeDataset::nodes_55 ? 55 : 2414);
  EXPECT_NEAR(found.frequency_hz, modes.frequency_hz(m), 1e-9 * modes.frequency_hz(m));
  EXPECT_NEAR(found.damping_ratio, modes.damping_ratio(m), 1e-8);
  const double largest = modes.shapes.col(m).cwiseAbs().maxCoeff();
  ASSERT_EQ(found.motion.size(), modes.node.size());
  for (std::size_t i = 0; i < modes.node.size(); ++i) {
    const auto& motion = found.motion.at(modes.node[i]);
    for (Index axis = 0; axis < 3; ++axis) {
      const Index row = 3 * static_cast<Index>(i) + axis;
      const Complex expected(modes.shapes(row, m),
                             modes.imaginary.size() > 0 ? modes.imaginary(row, m) : 0.0);
      EXPECT_LT(std::abs(motion(axis) - expected), 1e-8 * largest);
      EXPECT_LT(std::abs(motion(axis) - expected), 1e-5 * std::abs(expected));
    }
  }
}

TEST(ModesUff, AreReadBackFromBothDatasetsRealAndComplex) {
  for (const auto dataset : {ShapeDataset::nodes_55, ShapeDataset::analysis_2414}) {
    for (const bool is_complex : {false, true}) {
      for (const bool with_surface : {false, true}) {
        const auto modes = drawn(40, 4, with_surface, is_complex);
        const auto bytes = modes_uff(modes, dataset);
        const auto back = parse_node_shapes(bytes, "modes.unv");
        EXPECT_TRUE(back.notes.empty()) << testing::PrintToString(back.notes);
        EXPECT_EQ(back.nodes, 40);
        EXPECT_EQ(back.elements, with_surface ? 38 : 0);
        EXPECT_EQ(back.trace_lines, with_surface ? 0 : 1);
        ASSERT_EQ(back.modes.size(), 4U);
        for (Index m = 0; m < 4; ++m) {
          expect_same(back.modes[static_cast<std::size_t>(m)], modes, m, dataset);
        }
      }
    }
  }
}

TEST(ModesUff, ThePlacesAndWhatJoinsThemAreReadBack) {
  const auto body = drawn(40, 1, true, false);
  const auto surface = parse_uff(modes_uff(body, ShapeDataset::analysis_2414), "modes.unv");
  EXPECT_EQ(surface.title, body.title);
  ASSERT_EQ(surface.elements.size(), 38U);
  EXPECT_EQ(surface.elements[0], (std::vector<long long>{2147483647, 7, 14}));
  const auto channels = drawn(300, 1, false, false);
  const auto frame = parse_uff(modes_uff(channels, ShapeDataset::nodes_55), "identified.unv");
  for (std::size_t i = 0; i < 40; ++i) {
    const auto row = static_cast<Index>(i);
    EXPECT_EQ(surface.nodes.at(body.node[i]), body.place.row(row).transpose());  // 17 digits
    const auto off = frame.nodes.at(channels.node[i]) - channels.place.row(row).transpose();
    EXPECT_LT(off.norm(), 1e-9);
  }
  // 299 lines of two nodes and a lift, at most 125 entries in each trace line
  ASSERT_EQ(frame.trace_lines.size(), 8U);
  std::size_t entries = 0;
  for (const auto& line : frame.trace_lines) {
    EXPECT_LE(line.size(), 125U);
    entries += line.size();
    for (std::size_t k = 0; k < line.size(); ++k) EXPECT_EQ(line[k] == 0, k % 3 == 2);
  }
  EXPECT_EQ(entries, 3U * 299U);
}

// Column by column, as the descriptions of the datasets have them.
TEST(ModesUff, StandInTheColumnsOfTheFormat) {
  UffModes modes;
  modes.title = "one node";
  modes.program = "chladni 1";
  modes.node = {12};
  modes.place = Points::Constant(1, 3, 0.25);
  modes.frequency_hz = Eigen::VectorXd::Constant(1, 123.5);
  modes.damping_ratio = Eigen::VectorXd::Constant(1, 0.005);
  modes.shapes.resize(3, 1);
  modes.shapes << 0.5, -1.25e-7, 3.0;
  modes.has_scale = {true};
  const auto text = modes_uff(modes, ShapeDataset::nodes_55);
  EXPECT_NE(text.find("    -1\n   151\none node\nwritten by chladni\nchladni 1\n"), text.npos)
      << text;
  EXPECT_NE(
      text.find("   1.0000000000000000D+00   1.0000000000000000D+00   1.0000000000000000D+00\n"
                "   2.7314999999999998D+02\n"),
      text.npos)
      << text;
  EXPECT_NE(text.find("    -1\n    15\n        12         0         0         7"
                      "         0.25         0.25         0.25\n    -1\n"),
            text.npos)
      << text;
  EXPECT_NE(text.find("    -1\n    55\none node\nmode 1, 123.5 Hz\nNONE\n"
                      "shapes in kg^-1/2, mass-normalised\nNONE\n"
                      "         1         2         2         8         2         3\n"
                      "         2         4         1         1\n"
                      "        123.5           1.        0.005           0.\n"
                      "        12\n"
                      "          0.5    -1.25E-07           3.\n"
                      "    -1\n"),
            text.npos)
      << text;
  modes.imaginary = 2.0 * modes.shapes;
  modes.damping_ratio(0) = 0.0;
  modes.triangles.resize(1, 3);
  modes.triangles << 0, 0, 0;
  const auto other = modes_uff(modes, ShapeDataset::analysis_2414);
  EXPECT_NE(
      other.find("    -1\n  2411\n        12         0         0        11\n"
                 "   2.5000000000000000D-01   2.5000000000000000D-01   2.5000000000000000D-01\n"),
      other.npos)
      << other;
  EXPECT_NE(other.find("    -1\n  2412\n"
                       "         1        91         1         1         7         3\n"
                       "        12        12        12\n"),
            other.npos)
      << other;
  EXPECT_NE(other.find("    -1\n  2414\n         1\nmode 1\n         1\none node\n"), other.npos)
      << other;
  EXPECT_NE(other.find("         1         3         2         8         5         3\n"
                       "         0         0         0         0         1         1         0"
                       "         0\n"
                       "         0         0         0         0         0         0         0"
                       "         0\n"
                       "           0.        123.5"),
            other.npos)
      << other;
  EXPECT_NE(other.find("          0.5           1.    -1.25E-07     -2.5E-07           3."
                       "           6.\n"),
            other.npos)
      << other;
  for (const auto& whole : {text, other}) {
    std::size_t from = 0;
    for (auto end = whole.find('\n'); end != whole.npos; end = whole.find('\n', from)) {
      EXPECT_LE(end - from, 80U) << whole.substr(from, end - from);
      from = end + 1;
    }
  }
}

// a = 2jω√(1−ζ²) and b = −λ a of a mode of unit modal mass (first-order form of the equations).
TEST(ModesUff, ComplexModesHaveTheirModalConstants) {
  auto modes = drawn(3, 3, false, true);
  modes.has_scale = {true, true, false};
  const auto text = modes_uff(modes, ShapeDataset::nodes_55);
  std::size_t at = text.find("mode 2,");
  const auto numbers = [&] {
    for (int line = 0; line < 6; ++line) at = text.find('\n', at) + 1;
    std::vector<double> values;
    for (int k = 0; k < 6; ++k) values.push_back(std::stod(text.substr(at + 13U * k, 13)));
    return values;
  };
  const auto found = numbers();
  const Complex pole(found[0], found[1]), a(found[2], found[3]), b(found[4], found[5]);
  const double omega = 2.0 * std::numbers::pi * modes.frequency_hz(1);
  EXPECT_NEAR(std::abs(pole), omega, 1e-6 * omega);
  EXPECT_NEAR(pole.real(), -modes.damping_ratio(1) * omega, 1e-6 * omega);
  EXPECT_LT(std::abs(a - Complex(0.0, 2.0 * pole.imag())), 1e-6 * omega);
  EXPECT_LT(std::abs(b + pole * a), 1e-6 * omega * omega);
  at = text.find("mode 3,");
  const auto unscaled = numbers();
  EXPECT_NE(unscaled[1], 0.0);
  EXPECT_EQ(unscaled[3], 0.0);  // its scale is not known
  EXPECT_EQ(unscaled[4], 0.0);
}

std::string refusal(UffModes modes) {
  try {
    (void)modes_uff(modes, ShapeDataset::nodes_55);
  } catch (const InvalidInput& e) {
    return e.what();
  }
  return "";
}

TEST(ModesUff, WhatDoesNotFitIsRefused) {
  auto modes = drawn(3, 2, false, false);
  EXPECT_EQ(refusal(modes), "");
  modes.node[1] = modes.node[2];
  EXPECT_EQ(refusal(modes), "UFF: node 14 occurs twice");
  modes.node[1] = 0;
  EXPECT_EQ(refusal(modes), "UFF: node 0, expected 1 to 2147483647");
  modes.node[1] = 1;
  modes.shapes(4, 1) = NAN;
  EXPECT_EQ(refusal(modes), "UFF: a shape or a place is no number");
  modes.shapes.conservativeResize(6, 2);
  EXPECT_NE(refusal(modes).find("3 nodes with 3 places, 2 modes"), std::string::npos);
}

double length_of(const std::vector<std::array<Index, 2>>& lines, const Points& place) {
  double sum = 0.0;
  for (const auto& [a, b] : lines) sum += (place.row(a) - place.row(b)).norm();
  return sum;
}

TEST(WireFrame, JoinsAllPlacesByTheShortestTree) {
  Draw draw(3);
  EXPECT_TRUE(wire_frame(Points(0, 3)).empty());
  EXPECT_TRUE(wire_frame(Points::Zero(1, 3)).empty());
  Points on_a_line(6, 3);
  on_a_line << 3, 0, 0, 0, 0, 0, 5, 0, 0, 1, 0, 0, 4, 0, 0, 2, 0, 0;
  EXPECT_DOUBLE_EQ(length_of(wire_frame(on_a_line), on_a_line), 5.0);
  Points place(25, 3);
  for (auto& x : place.reshaped()) x = draw.uniform();
  const auto lines = wire_frame(place);
  ASSERT_EQ(lines.size(), 24U);
  std::set<Index> joined{0};
  for (const auto& [a, b] : lines) {
    EXPECT_TRUE(joined.contains(a));
    EXPECT_TRUE(joined.insert(b).second);
  }
  // No tree is shorter that has another line instead of one of these.
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<std::array<Index, 2>> other;
    for (Index i = 1; i < 25; ++i) {
      other.push_back({static_cast<Index>(draw.uniform() * static_cast<double>(i)), i});
    }
    EXPECT_LE(length_of(lines, place), length_of(other, place));
  }
}

// A dataset 2414 as another program writes it. @param form  record 9
std::string dataset_2414(const std::string& location, const std::string& form,
                         const std::string& values) {
  return "    -1\n  2414\n         1\nMODE 1\n" + location + "\nmodel\nNONE\nNONE\nNONE\nNONE\n" +
         form +
         "\n         1         0         1         0         1         7         0         0\n"
         "         0         0         0         0         0         0         0         0\n"
         "  0.00000E+00  1.23400E+02  6.01154E+05  2.00000E+00  5.00000E-03  0.00000E+00\n"
         "  0.00000E+00  0.00000E+00  0.00000E+00  0.00000E+00  0.00000E+00  0.00000E+00\n" +
         values + "    -1\n";
}

TEST(ModesUff, OfOtherProgramsAreRead) {
  const std::string at_nodes = "         1";
  const std::string real = "         1         2         2         8         2         3";
  const std::string two_nodes =
      "        11\n  1.00000E+00  0.00000E+00 -2.00000E+00\n"
      "        12\n  0.00000D+00-3.00000D+00  3.00000D+00\n";
  const auto modes = parse_node_shapes(dataset_2414(at_nodes, real, two_nodes), "a.unv").modes;
  ASSERT_EQ(modes.size(), 1U);
  EXPECT_EQ(modes[0].frequency_hz, 123.4);
  EXPECT_EQ(modes[0].damping_ratio, 0.005);
  EXPECT_EQ(modes[0].motion.at(12), Eigen::Vector3cd(0.0, -3.0, 3.0));
  // double precision, translations and rotations
  const std::string six = "         1         2         3         8         4         6";
  const auto turning =
      parse_uff(dataset_2414(at_nodes, six,
                             "        11\n   1.0000000000000000D+00   2.0D+00   3.0D+00\n"
                             "   4.0000000000000000D+00   5.0D+00   6.0D+00\n"),
                "b.unv");
  ASSERT_EQ(turning.shapes.size(), 1U);
  EXPECT_EQ(turning.shapes[0].values(0, 5), Complex(6.0));
  // stresses, and data of elements, are noted and not read
  const std::string stress = "         1         2         4         2         2         6";
  for (const auto& bytes :
       {dataset_2414("         2", real, two_nodes),
        dataset_2414(at_nodes, "         1         2         1         2         2         1",
                     two_nodes)}) {
    const auto uff = parse_uff(bytes, "c.unv");
    EXPECT_TRUE(uff.shapes.empty());
    EXPECT_EQ(times(uff.notes, "dataset 2414 from line 2"), 1) << testing::PrintToString(uff.notes);
    EXPECT_THROW((void)parse_node_shapes(bytes, "c.unv"), NoShapes);
  }
  EXPECT_THROW((void)parse_node_shapes(dataset_2414(at_nodes, stress, two_nodes), "d.unv"),
               NoShapes);
}

// Number 1 is the global frame where a file defines none: most programs write it beside each node.
TEST(ModesUff, SystemOneIsTheGlobalFrameWhereNoneIsDefined) {
  const std::string shape =
      dataset_2414("         1", "         1         2         2         8         2         3",
                   "        11\n  1.00000E+00  0.00000E+00 -2.00000E+00\n");
  const auto nodes = [](int system) {
    return fmt::format(
        "    -1\n  2411\n{:10}{:10}{:10}{:10}\n{:25.16E}{:25.16E}{:25.16E}\n    -1\n", 11, system,
        system, 11, 0.1, 0.2, 0.3);
  };
  for (const int system : {0, 1}) {
    const auto modes = parse_node_shapes(nodes(system) + shape, "a.unv").modes;
    ASSERT_EQ(modes.size(), 1U);
    EXPECT_EQ(modes[0].motion.at(11), Eigen::Vector3cd(1.0, 0.0, -2.0));
  }
  EXPECT_THROW((void)parse_node_shapes(nodes(2) + shape, "a.unv"), InvalidInput);
}

TEST(ModesUff, AGeometryThatCannotBeReadIsNotedOnly) {
  const auto sound = modes_uff(drawn(5, 1, false, false), ShapeDataset::nodes_55);
  const std::string lines = "    -1\n    82\n         1         2\n    -1\n";
  const std::string elements =
      "    -1\n  2412\n         1        21         1         1         7         2\n"
      "         0         0         0\n         1         2\n"
      "         2        91         1         1         7         3\n         1         2\n    "
      "-1\n";
  const auto uff = parse_uff(sound + lines + elements, "a.unv");
  EXPECT_EQ(uff.shapes.size(), 1U);
  ASSERT_EQ(uff.elements.size(), 1U);  // a beam has a record more than other elements
  EXPECT_EQ(uff.elements[0], (std::vector<long long>{1, 2}));
  EXPECT_EQ(times(uff.notes, "the trace lines from there on are not read"), 1)
      << testing::PrintToString(uff.notes);
  EXPECT_EQ(times(uff.notes, "the elements from there on are not read"), 1);
}

}  // namespace
}  // namespace chladni::io
