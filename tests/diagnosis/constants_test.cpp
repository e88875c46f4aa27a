// docs/reference/constants.md says what diagnosis/constants.h has, with mode_constants.h, and
// nothing decides beside it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <regex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "diagnosis/constants.h"
#include "diagnosis/diagnosed.h"
#include "diagnosis/search/search.h"

namespace chladni::diagnosis {
namespace {

const std::filesystem::path kRoot = CHLADNI_SOURCE_DIR;

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// The groups of each match, the first for the whole.
std::vector<std::vector<std::string>> matches(const std::string& text, const std::regex& pattern) {
  std::vector<std::vector<std::string>> found;
  for (std::sregex_iterator match(text.begin(), text.end(), pattern), end; match != end; ++match) {
    found.emplace_back(match->begin(), match->end());
  }
  return found;
}

struct Row {
  std::string name, unit;
  double value = 0.0;

  bool operator==(const Row&) const = default;
};

void PrintTo(const Row& row, std::ostream* out) {
  *out << row.name << " = " << row.value << " [" << row.unit << "]";
}

std::string header() {
  return text_of(kRoot / "diagnosis/constants.h") + text_of(kRoot / "diagnosis/mode_constants.h");
}

// "/// [unit] What it decides." and perhaps further lines, then "type name = value;".
std::vector<Row> declared() {
  const auto text = header();
  const std::regex member(
      R"(\n  /// \[([^\]]+)\][^\n]*(?:\n  /// [^\[\n][^\n]*)*\n  [\w:]+ (\w+) = ([^;]+);)");
  std::vector<Row> rows;
  for (const auto& match : matches(text, member)) {
    rows.push_back({match[2], match[1], std::stod(match[3])});
  }
  return rows;
}

// "| `name` | value | unit | ...".
std::vector<Row> documented() {
  const auto text = text_of(kRoot / "docs/reference/constants.md");
  const std::regex line(R"(\n\| `(\w+)` \| ([^ |]+) \| ([^|]+) \|)");
  std::vector<Row> rows;
  for (const auto& match : matches(text, line)) {
    rows.push_back({match[1], match[3], std::stod(match[2])});
  }
  return rows;
}

// The sources of the room and of its steps, without the effects, which keep their own numbers.
std::vector<std::filesystem::path> sources() {
  std::vector<std::filesystem::path> files;
  for (const auto* folder : {"diagnosis", "steps/diagnosis"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(kRoot / folder)) {
      const auto& file = entry.path();
      const bool code = file.extension() == ".h" || file.extension() == ".cpp";
      const bool own = file.parent_path().filename() != "effects" && file.stem() != "catalogue";
      if (code && own) files.push_back(file);
    }
  }
  return files;
}

// Constants derives from ModeConstants: a name in both would hide the other from who means it.
TEST(Constants, HaveNamesOfTheirOwn) {
  std::set<std::string> names;
  for (const auto& row : declared()) EXPECT_TRUE(names.insert(row.name).second) << row.name;
}

TEST(Constants, EachHasUnitAndPurpose) {
  const auto text = header();
  EXPECT_EQ(declared().size(), matches(text, std::regex(R"(\n  [\w:]+ \w+ = [^;]+;)")).size());
}

TEST(Constants, AreThoseOfThePage) {
  EXPECT_EQ(documented(), declared());
  ASSERT_FALSE(declared().empty());
  EXPECT_EQ(declared().front().name, "least_evidence");
  EXPECT_EQ(declared().front().value, kConstants.least_evidence);
}

TEST(Constants, EachDecidesSomething) {
  std::string text;
  for (const auto& file : sources()) text += text_of(file);
  for (const auto& row : declared()) {
    EXPECT_NE(text.find("kConstants." + row.name), std::string::npos) << row.name;
  }
}

// What is left: numerics, a value that is not measured, and what belongs to an effect or a scan.
TEST(Constants, NoOtherPlaceHasAny) {
  const std::set<std::string> left{"kEnough",      "kInfinite", "kNoRounding", "kNone",
                                   "kNotMeasured", "kOneAxis",  "kOnePeak",    "kPlausible",
                                   "kRounding",    "kStep",     "kUnknown"};
  for (const auto& file : sources()) {
    for (const auto& match : matches(text_of(file), std::regex(R"(constexpr double (k\w+))"))) {
      EXPECT_TRUE(left.contains(match[1])) << file << ": " << match[1];
    }
  }
}

// The excess below which a number of causes and noise are believed to be all there is.
double gate(const Constants& constants, int causes) {
  const double prior =
      constants.one_cause_prior * std::pow(constants.further_cause_prior, causes - 1);
  const double odds = constants.believed / (1.0 - constants.believed);
  const double other = odds * constants.outside_prior / constants.outside_excess;
  const double density = other / prior * std::sqrt(2.0 * std::numbers::pi);
  return density < 1.0 ? std::sqrt(-2.0 * std::log(density)) : 0.0;
}

// The gates as the page has them: "3.20, 2.73, 2.17".
std::string gates(double Constants::*which, double factor) {
  Constants changed;
  changed.*which *= factor;
  return fmt::format("{:.2f}, {:.2f}, {:.2f}", gate(changed, 1), gate(changed, 2),
                     gate(changed, 3));
}

TEST(Constants, GatesOfTheVerdictAreThoseOfThePage) {
  const auto page = text_of(kRoot / "docs/reference/constants.md");
  const std::vector<std::pair<std::string, double Constants::*>> priors{
      {"one_cause_prior", &Constants::one_cause_prior},
      {"further_cause_prior", &Constants::further_cause_prior},
      {"outside_prior", &Constants::outside_prior},
      {"outside_excess", &Constants::outside_excess}};
  for (const auto& [name, which] : priors) {
    const auto row = fmt::format("| `{}` | {} | {} | {} |", name, gates(which, 0.5),
                                 gates(which, 1.0), gates(which, 2.0));
    EXPECT_NE(page.find(row), std::string::npos) << row;
  }
}

TEST(Constants, AreTheDefaultsOfEveryOption) {
  EXPECT_EQ(DiagnosisOptions{}.least_evidence, SearchLimits{}.least_evidence);
  EXPECT_EQ(DiagnosisOptions{}.most_causes, SearchLimits{}.most_causes);
}

}  // namespace
}  // namespace chladni::diagnosis
