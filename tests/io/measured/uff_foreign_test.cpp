// Universal files with what other programs put into them, that was read in another sense or passed
// over without a word.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <complex>
#include <string>
#include <vector>

#include "io/frf_file.h"
#include "io/node_shapes.h"
#include "io/time_file.h"
#include "io/uff/frf_uff.h"
#include "io/uff/time_uff.h"
#include "io/uff/uff.h"
#include "tests/io/measured/uff_samples.h"
#include "tests/refusal.h"

namespace chladni::io {
namespace {

using Complex = std::complex<double>;
using Eigen::Vector3cd;
using Eigen::Vector3d;

/// Dataset 55 of one node, 11, and what follows it.
struct Sample55 {
  int analysis = 2, characteristic = 2, type = 8, data_type = 2, components = 3;
  std::vector<double> reals{12.5, 1.0, 0.02, 0.0};
  std::vector<double> values{1.0, -2.0, 3.0};
  std::string more;
};

std::string numbers_13(const std::vector<double>& numbers) {
  std::string text;
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    text += fmt::format("{:13.5E}", numbers[k]) + ((k + 1) % 6 == 0 ? "\n" : "");
  }
  return text + (numbers.size() % 6 == 0 ? "" : "\n");
}

std::string dataset_55(const Sample55& s) {
  return "    -1\n    55\nmodes\nNONE\nNONE\nNONE\nNONE\n" +
         fmt::format("{:10}{:10}{:10}{:10}{:10}{:10}\n{:10}{:10}{:10}{:10}\n", 1, s.analysis,
                     s.characteristic, s.type, s.data_type, s.components, 2, s.reals.size(), 1, 1) +
         numbers_13(s.reals) + "        11\n" + numbers_13(s.values) + s.more + "    -1\n";
}

NodeShapes modes_in(const std::string& bytes) { return parse_node_shapes(bytes, "m.unv"); }

std::string said_of(const Sample55& s) {
  return refusal_of([&] { return modes_in(dataset_55(s)); });
}

// Reaction forces were mode shapes, and analyses of other kinds went without a word.
TEST(ForeignUff, OnlyMotionsOfModesAreModes) {
  const auto sound = dataset_55({});
  const auto file = modes_in(dataset_55({.type = 9}) + sound + dataset_55({.analysis = 5}) +
                             dataset_55({.analysis = 0, .reals = {}}));
  ASSERT_EQ(file.modes.size(), 1U);
  EXPECT_EQ(times(file.notes, "dataset 55 from line 2 has data of type 9"), 1)
      << testing::PrintToString(file.notes);
  EXPECT_EQ(times(file.notes, "is of analysis type 5"), 1) << testing::PrintToString(file.notes);
  EXPECT_EQ(times(file.notes, "is of analysis type 0"), 1);
  for (const int type : {0, 1, 8, 11, 12}) {
    EXPECT_EQ(modes_in(dataset_55({.type = type})).modes.size(), 1U) << type;
  }
}

// A mode whose frequency is its only number was one at 0 Hz, and so was one without a number.
TEST(ForeignUff, AModeMayStateItsFrequencyAlone) {
  EXPECT_EQ(modes_in(dataset_55({.reals = {12.5}})).modes.at(0).frequency_hz, 12.5);
  const auto damped = modes_in(dataset_55({.reals = {12.5, 1.0, 0.02}})).modes.at(0);
  EXPECT_EQ(damped.damping_ratio, 0.02);
  const auto file = modes_in(dataset_55({.reals = {}}) + dataset_55({}));
  EXPECT_EQ(file.modes.size(), 1U);
  EXPECT_EQ(times(file.notes, "from line 2 does not state the frequency"), 1)
      << testing::PrintToString(file.notes);
}

TEST(ForeignUff, ModesThatCannotBeMeantAreRefused) {
  EXPECT_NE(said_of({.reals = {-3.0, 1.0, 0.0, 0.0}}).find("is -3 Hz, expected 0 or more"),
            std::string::npos);
  EXPECT_NE(said_of({.reals = {3.0, 1.0, 2.0, 0.0}}).find("damping ratio is 2; expected a ratio"),
            std::string::npos);
  const auto twice = said_of({.more = "        11\n" + numbers_13({1.0, -2.0, 4.0})});
  EXPECT_NE(twice.find("m.unv: dataset 55 from line 2: node 11 has two motions"), std::string::npos)
      << twice;
  EXPECT_EQ(said_of({.more = "        11\n" + numbers_13({1.0, -2.0, 3.0})}), "");
}

Sample55 complex_mode(Complex eigenvalue, const Vector3cd& shape) {
  Sample55 s{.analysis = 3, .data_type = 5};
  s.reals = {eigenvalue.real(), eigenvalue.imag(), 1.0, 0.0, 1.0, 0.0};
  s.values.clear();
  for (const auto& value : shape) s.values.insert(s.values.end(), {value.real(), value.imag()});
  return s;
}

// Eigenvalues come in conjugate pairs, of which one is the mode: it was there twice. The shape of
// the other one is the conjugate.
TEST(ForeignUff, OfConjugateEigenvaluesTheUpperOneIsTheMode) {
  const Complex pole(-0.5, 62.5), other(-1.0, 125.0);
  const Vector3cd shape(Complex(1.0, 0.25), Complex(-2.0, 0.5), Complex(0.0, 1.0));
  const auto upper = dataset_55(complex_mode(pole, shape));
  const auto lower = dataset_55(complex_mode(std::conj(pole), shape.conjugate()));
  const auto alone = modes_in(upper);
  EXPECT_TRUE(alone.notes.empty()) << testing::PrintToString(alone.notes);
  for (const auto& bytes : {lower + upper, upper + lower, lower}) {
    const auto file = modes_in(bytes + dataset_55(complex_mode(other, shape)));
    ASSERT_EQ(file.modes.size(), 2U);
    EXPECT_EQ(file.modes[0].frequency_hz, alone.modes[0].frequency_hz);
    EXPECT_EQ(file.modes[0].damping_ratio, alone.modes[0].damping_ratio);
    EXPECT_EQ(file.modes[0].motion.at(11), shape);
    EXPECT_EQ(times(file.notes, "conjugate eigenvalues"), bytes == lower ? 0 : 1);
  }
  const auto real = modes_in(upper + dataset_55(complex_mode(Complex(-3.0, 0.0), shape)));
  EXPECT_EQ(real.modes.size(), 1U);
  EXPECT_EQ(times(real.notes, "1 mode without oscillation"), 1);
}

// Both datasets of one mode were two modes.
TEST(ForeignUff, AModeThatIsThereAgainIsReadOnce) {
  const auto file = modes_in(dataset_55({}) + dataset_55({.values = {3.0, -2.0, 1.0}}) +
                             dataset_55({.reals = {12.50001}}) + dataset_55({.reals = {13.0}}));
  ASSERT_EQ(file.modes.size(), 3U);
  EXPECT_EQ(file.modes[2].frequency_hz, 13.0);
  EXPECT_EQ(times(file.notes, "1 mode there again"), 1) << testing::PrintToString(file.notes);
  const auto still = modes_in(dataset_55({}) + dataset_55({.values = {0.0, 0.0, 0.0}}));
  EXPECT_EQ(still.modes.size(), 1U);
  EXPECT_EQ(times(still.notes, "1 mode whose motion is 0 at every node"), 1);
}

TEST(ForeignUff, RotationsOfNodesAreNamedAsNotRead) {
  Sample55 s{.characteristic = 3, .components = 6, .values = {1, 2, 3, 0, 0, 0}};
  EXPECT_TRUE(modes_in(dataset_55(s)).notes.empty());
  s.values[5] = 0.1;
  EXPECT_EQ(times(modes_in(dataset_55(s)).notes, "1 mode with rotations of nodes"), 1);
}

std::string nodes_15(const std::string& lines) { return "    -1\n    15\n" + lines + "    -1\n"; }

std::string node_line(int node, int displacement, const Vector3d& at) {
  return fmt::format("{:10}{:10}{:10}{:10}{:13.5E}{:13.5E}{:13.5E}\n", node, 0, displacement, 8,
                     at.x(), at.y(), at.z());
}

// Each dataset 164 holds for what follows it, but places counted in the unit of the first one.
TEST(ForeignUff, PlacesAreInTheUnitOfTheirPart) {
  const auto set =
      parse_frf_uff(dataset_164(1.0, 1.0) + nodes_15(node_line(3, 0, {0.5, 0.0, 0.0})) +
                        dataset_164(1000.0, 1.0) + nodes_15(node_line(12, 0, {250.0, 0.0, 0.0})) +
                        dataset_58({}),
                    "two.unv")
          .set;
  ASSERT_TRUE(set.outputs[0].position && set.inputs[0].position);
  EXPECT_NEAR(set.outputs[0].position->x(), 0.25, 1e-12);
  EXPECT_NEAR(set.inputs[0].position->x(), 0.5, 1e-12);
}

// The unit that is stated for files without one took the place of that of dataset 164.
TEST(ForeignUff, TheUnitOfLengthsInTheFileCounts) {
  FrfOptions options;
  options.length_unit = "mm";
  const auto nodes = nodes_15(node_line(12, 0, {0.5, 0.0, 0.0})) + dataset_58({});
  EXPECT_NEAR(parse_frf_uff(nodes, "a.unv", options).set.outputs[0].position->x(), 5e-4, 1e-15);
  const auto file = parse_frf_uff(dataset_164(1.0, 1.0) + nodes, "a.unv", options);
  EXPECT_NEAR(file.set.outputs[0].position->x(), 0.5, 1e-12);
  EXPECT_EQ(times(file.notes, "\"mm\" is not used"), 1) << testing::PrintToString(file.notes);
}

TEST(ForeignUff, ANodeWithTwoSystemsIsNamed) {
  const auto notes = parse_uff(nodes_15(node_line(12, 0, {1, 0, 0}) + node_line(12, 5, {1, 0, 0})) +
                                   nodes_15(node_line(12, 5, {1, 0, 0})),
                               "a.unv")
                         .notes;
  EXPECT_EQ(times(notes, "node 12 has two coordinate systems of displacements, 0 and 5"), 2)
      << testing::PrintToString(notes);
}

// "m/(s^2*N)" lost its brackets and was no unit; so did all that needs them.
TEST(ForeignUff, LabelsKeepTheBracketsWithinThem) {
  for (const auto& [label, factor] :
       {std::pair("m/(s^2*N)", 1.0), std::pair("(mm/s^2)/N", 1e-3), std::pair("[m/s^2]/(kN)", 1e-3),
        std::pair("(m/s^2", 1.0), std::pair("(g)/(N)", 9.80665)}) {
    Sample58 s{.unit = label, .input_unit = ""};
    const auto file = parse_frf_uff(dataset_58(s), "a.unv");
    EXPECT_NEAR(file.set.value[0](0, 0).real(), 1.5 * factor, 1e-6 * factor) << label;
    EXPECT_EQ(file.set.outputs[0].unit, "m/s^2") << label;
    EXPECT_EQ(times(file.notes, "not known"), 0) << label;
  }
}

Sample58 recording(int node, double start) {
  Sample58 s{.ordinate_type = 2, .function_type = 1, .denominator = 0};
  s.input_unit = "";
  s.x = {start, start + 0.5, start + 1.0, start + 1.5, start + 2.0};
  s.response_node = node;
  return s;
}

// Channels of one recording that begin at different times were taken as simultaneous.
TEST(ForeignUff, ChannelsOfARecordingBeginTogether) {
  const auto read = [](double one, double other) {
    return parse_time_uff(dataset_58(recording(12, one)) + dataset_58(recording(13, other)),
                          "a.unv");
  };
  EXPECT_EQ(read(-0.25, -0.25).data.outputs.size(), 2U);
  const auto said = refusal_of([&] { return read(0.0, -0.25); });
  EXPECT_NE(said.find("unequal times: line"), std::string::npos) << said;
  EXPECT_NE(said.find("begins at 0 s"), std::string::npos) << said;
  EXPECT_NE(said.find("at -0.25 s"), std::string::npos) << said;
}

// Several load cases are experiments of their number; one alone may have any number.
TEST(ForeignUff, LoadCasesAreExperiments) {
  const auto read = [](const std::vector<int>& cases) {
    std::string bytes;
    for (const int number : cases) {
      auto one = recording(12, 0.0);
      one.load_case = number;
      bytes += dataset_58(one);
    }
    std::vector<int> experiments;
    for (const auto& record : parse_time_uff(bytes, "a.unv").data.records) {
      experiments.push_back(record.experiment);
    }
    return experiments;
  };
  EXPECT_EQ(read({1, 3}), (std::vector{1, 3}));
  EXPECT_EQ(read({7}), std::vector{7});
  EXPECT_EQ(read({-4}), std::vector{0});
  const auto said = refusal_of([&] { return read({1, -4}); });
  EXPECT_EQ(said, "a.unv: line 17 (12z): the load case -4, expected 0 to 1000000");
}

// Responses of one pair in two load cases are two that differ.
TEST(ForeignUff, ResponsesOfSeveralLoadCasesAreRefused) {
  Sample58 first{.load_case = 1}, second{.load_case = 2};
  second.y[2] *= 2.0;
  const auto said =
      refusal_of([&] { return parse_frf_uff(dataset_58(first) + dataset_58(second), "a.unv"); });
  EXPECT_NE(said.find("two responses of one pair that differ: line"), std::string::npos) << said;
}

// Each shape of another analysis had a note, and each mode was compared with all before it.
TEST(ForeignUff, ManyShapesAreReadInTime) {
  std::string bytes = dataset_55({.analysis = 5}) + dataset_55({.analysis = 5});
  constexpr int count = 20'000;
  for (int mode = 0; mode < count; ++mode) {
    bytes += dataset_55({.reals = {10.0 + mode, 1.0, 0.01, 0.0}});
  }
  const auto file = modes_in(bytes + dataset_55({.reals = {10.0, 1.0, 0.01, 0.0}}));
  EXPECT_EQ(std::ssize(file.modes), count);
  EXPECT_EQ(times(file.notes, "are of analysis type 5"), 1) << testing::PrintToString(file.notes);
  EXPECT_EQ(times(file.notes, "1 mode there again"), 1);
}

}  // namespace
}  // namespace chladni::io
