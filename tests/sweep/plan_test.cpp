// Plans of many studies: their axes, their grid and their sample.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "base/error.h"
#include "study/study.h"
#include "study/sweep_plan.h"
#include "study/sweep_variants.h"
#include "sweep/sweep_folder.h"

namespace chladni::sweep {
namespace {

std::string refusal_of(const std::string& plan) {
  const SweepFolder folder("refused", plan);
  try {
    const auto read = folder.plan();
    const study::Variants variants(read);
    return "taken";
  } catch (const InvalidInput& e) {
    return e.what();
  }
}

void expect_in(const std::string& part, const std::string& text) {
  EXPECT_NE(text.find(part), std::string::npos) << text;
}

const std::string kResult = "[[result]]\nname = \"m\"\nfile = \"modes.json\"\nat = \"mass_kg\"\n";

// The study of a variant, read beside its base.
study::Study study_of(const SweepFolder& folder, const study::Variants& variants, long long i) {
  return study::parse_study(variants.text(variants.at(i), "base.toml", true),
                            folder.path() / "variant.toml");
}

TEST(SweepPlan, TheGridHasEachPointOnceAndTheLastAxisChangesFastest) {
  const SweepFolder folder("grid");
  const auto plan = folder.plan();
  const study::Variants variants(plan);
  ASSERT_EQ(variants.size(), 6);
  std::set<std::vector<std::string>> seen;
  for (long long i = 0; i < 6; ++i) seen.insert(variants.at(i).labels);
  EXPECT_EQ(seen.size(), 6U);
  EXPECT_EQ(variants.at(0).labels, (std::vector<std::string>{"16 mm", "60 GPa"}));
  EXPECT_EQ(variants.at(1).labels, (std::vector<std::string>{"16 mm", "80 GPa"}));
  EXPECT_EQ(variants.at(5).labels, (std::vector<std::string>{"24 mm", "80 GPa"}));
}

// Axes that touch one list: what is removed is removed from the base, whatever the order.
TEST(SweepPlan, AnAxisMayRemoveAChannelThatAnotherMoves) {
  const std::string moves = "[[axis]]\nkey = \"sensor[s1].at\"\nvalues = [[\"0 mm\", \"0 mm\"]]\n";
  const std::string removes =
      "[[axis]]\nname = \"without\"\n[[axis.choice]]\nname = \"s1\"\n"
      "study = { sensor = [ { name = \"s1\", removed = true } ], title = \"bare\" }\n"
      "[[axis.choice]]\nname = \"none\"\nstudy = { modes = { count = 7 } }\n";
  for (const auto& axes : {moves + removes, removes + moves}) {
    const SweepFolder folder("removed", "title = \"t\"\nbase = \"base.toml\"\n" + axes + kResult);
    write(folder.path() / "base.toml",
          kBase + "[[sensor]]\nname = \"s2\"\nat = [\"0 mm\", \"50 mm\"]\ndirection = \"z\"\n");
    const auto plan = folder.plan();
    const study::Variants variants(plan);
    const auto bare = study_of(folder, variants, 0);
    ASSERT_EQ(bare.sensors.size(), 1U);
    EXPECT_EQ(bare.sensors[0].name, "s2");
    EXPECT_EQ(bare.title, "bare");
    const auto whole = study_of(folder, variants, 1);
    ASSERT_EQ(whole.sensors.size(), 2U);
    EXPECT_EQ(whole.sensors[0].at.point.x(), 0.0);
  }
}

TEST(SweepPlan, AVariantIsItsBaseWithThePointsOfTheAxes) {
  const SweepFolder folder("variant");
  const auto plan = folder.plan();
  const auto read = study_of(folder, study::Variants(plan), 1);
  EXPECT_EQ(read.title, "plates: thickness 16 mm, modulus 80 GPa");
  EXPECT_NE(read.text.find("thickness = \"16 mm\""), std::string::npos) << read.text;
  EXPECT_NE(read.text.find("youngs_modulus = \"80 GPa\""), std::string::npos) << read.text;
  EXPECT_NE(read.text.find("width = \"400 mm\""), std::string::npos) << read.text;
  ASSERT_EQ(read.sensors.size(), 1U);
}

TEST(SweepPlan, AKeyMayNameAnElementOfAList) {
  const SweepFolder folder("element",
                           "base = \"base.toml\"\n[[axis]]\nname = \"place\"\n"
                           "key = \"sensor[s1].at\"\n"
                           "values = [[\"-10 mm\", \"20 mm\"], [\"0 mm\", \"0 mm\"]]\n" +
                               kResult);
  const auto plan = folder.plan();
  const study::Variants variants(plan);
  EXPECT_EQ(variants.at(0).labels.front(), "[-10 mm 20 mm]");
  const auto read = study_of(folder, variants, 0);
  ASSERT_EQ(read.sensors.size(), 1U);
  EXPECT_EQ(read.sensors.front().name, "s1");
  EXPECT_TRUE(read.text.find("-10 mm") != std::string::npos);
}

TEST(SweepPlan, AChoiceSetsSeveralKeys) {
  const SweepFolder folder("choice", R"(base = "base.toml"
[[axis]]
name = "layout"
[[axis.choice]]
name = "one"
study = {}
[[axis.choice]]
name = "two"
[[axis.choice.study.sensor]]
name = "s2"
at = ["100 mm", "0 mm"]
direction = "z"
)" + kResult);
  const auto plan = folder.plan();
  const study::Variants variants(plan);
  ASSERT_EQ(variants.size(), 2);
  EXPECT_EQ(study_of(folder, variants, 0).sensors.size(), 1U);
  EXPECT_EQ(study_of(folder, variants, 1).sensors.size(), 2U);
}

// Each of n equal parts of a range is taken once, and values come equally often.
TEST(SweepPlan, ASampleIsALatinHypercube) {
  const SweepFolder folder("sample", R"(base = "base.toml"
sample = { count = 60, seed = 5 }
[[axis]]
key = "geometry.plate.thickness"
from = "10 mm"
to = "40 mm"
[[axis]]
key = "material.youngs_modulus"
from = "1 GPa"
to = "100 GPa"
spacing = "logarithmic"
[[axis]]
key = "material.poissons_ratio"
values = [0.2, 0.3, 0.4]
)" + kResult);
  const auto plan = folder.plan();
  const study::Variants variants(plan);
  ASSERT_EQ(variants.size(), 60);
  std::set<int> thickness;
  std::set<int> modulus;
  std::map<std::string, int> ratios;
  for (long long i = 0; i < 60; ++i) {
    const auto labels = variants.at(i).labels;
    thickness.insert(static_cast<int>(60.0 * (std::stod(labels[0]) - 10.0) / 30.0));
    modulus.insert(static_cast<int>(60.0 * std::log10(std::stod(labels[1])) / 2.0));
    ++ratios[labels[2]];
  }
  EXPECT_EQ(thickness.size(), 60U);
  EXPECT_EQ(modulus.size(), 60U);
  ASSERT_EQ(ratios.size(), 3U);
  for (const auto& [label, count] : ratios) EXPECT_EQ(count, 20) << label;
  const study::Variants again(plan);
  EXPECT_EQ(again.at(17).labels, variants.at(17).labels);
}

TEST(SweepPlan, ARangeEndsWhereItSays) {
  const SweepFolder folder("range", R"(base = "base.toml"
[[axis]]
key = "material.youngs_modulus"
from = "1 GPa"
to = "100 GPa"
spacing = "logarithmic"
count = 3
)" + kResult);
  const auto plan = folder.plan();
  const study::Variants variants(plan);
  ASSERT_EQ(variants.size(), 3);
  EXPECT_EQ(variants.at(0).labels.front(), "1 GPa");
  EXPECT_EQ(variants.at(1).labels.front(), "10 GPa");
  EXPECT_EQ(variants.at(2).labels.front(), "100 GPa");
}

// It was called a study, which its reader then searched for the fault.
TEST(SweepPlan, IsCalledOneInItsErrors) {
  const std::string axis = "[[axis]]\nkey = \"seed\"\nvalues = [1]\n";
  expect_in("the plan lacks \"base\"", refusal_of(axis + kResult));
  expect_in("the plan lacks \"result\"", refusal_of("base = \"base.toml\"\n" + axis));
  expect_in("unknown key \"vreb\" in the plan",
            refusal_of("base = \"base.toml\"\nvreb = \"modes\"\n" + axis + kResult));
}

TEST(SweepPlan, WhatIsWrongIsToldWithItsLine) {
  expect_in("base", refusal_of(kResult));
  expect_in("axis", refusal_of("base = \"base.toml\"\n" + kResult));
  expect_in("result", refusal_of("base = \"base.toml\"\n[[axis]]\nkey = \"seed\"\nvalues = [1]\n"));
  expect_in("3:7",
            refusal_of("base = \"base.toml\"\n[[axis]]\nkey = \"geometry..x\"\nvalues = [1]\n" +
                       kResult));
  expect_in(
      "one unit",
      refusal_of("base = \"base.toml\"\n[[axis]]\nkey = \"a.b\"\nfrom = \"1 mm\"\nto = \"2 m\"\n"
                 "count = 2\n" +
                 kResult));
  expect_in(
      "count",
      refusal_of("base = \"base.toml\"\n[[axis]]\nkey = \"a.b\"\nfrom = 1\nto = 2\n" + kResult));
  expect_in("twice", refusal_of(kPlan + kResult + kResult));
  expect_in("\"spacin\"", refusal_of("base = \"base.toml\"\n[[axis]]\nkey = \"a.b\"\nvalues = [1]\n"
                                     "spacin = \"linear\"\n" +
                                     kResult));
}

// The later axis took the place of the former, whose values stood in the table all the same.
TEST(SweepPlan, AnAxisThatUndoesAnotherIsRefused) {
  const auto both = [](const std::string& first, const std::string& second) {
    return refusal_of("base = \"base.toml\"\n[[axis]]\nname = \"one\"\n" + first +
                      "[[axis]]\nname = \"other\"\n" + second + kResult);
  };
  const std::string thickness = "key = \"geometry.plate.thickness\"\nvalues = [\"1 mm\"]\n";
  const std::string modulus = "key = \"material.youngs_modulus\"\nvalues = [\"70 GPa\"]\n";
  const std::string moved = "key = \"sensor[s1].at\"\nvalues = [[\"0 mm\", \"0 mm\"]]\n";
  const auto choice = [](const std::string& study) {
    return "[[axis.choice]]\nname = \"c\"\nstudy = { " + study + " }\n";
  };
  expect_in("\"one\" and \"other\" both set geometry.plate.thickness", both(thickness, thickness));
  expect_in("both set geometry.plate.thickness",
            both(thickness, "key = \"geometry.plate.thickness\"\nfrom = 1\nto = 2\ncount = 2\n"));
  expect_in("both set geometry;", both(thickness, choice("geometry = { disc = { } }")));
  expect_in("both set material;", both("key = \"material\"\nvalues = [\"zerodur\"]\n", modulus));
  expect_in("both set sensor[s1].at;",
            both(choice("sensor = [ { name = \"s1\", at = [\"1 mm\", \"0 mm\"] } ]"), moved));
  expect_in("taken", both(thickness, modulus));
  expect_in("taken", both(moved, "key = \"sensor[s1].gain\"\nvalues = [1.0, 1.1]\n"));
  expect_in("taken", both(moved, "key = \"sensor[s2].at\"\nvalues = [[\"0 mm\", \"0 mm\"]]\n"));
}

// A million variants are told before any is made.
TEST(SweepPlan, TooManyVariantsAreTold) {
  std::string plan = "base = \"base.toml\"\n";
  for (const char* key : {"a.x", "a.y", "a.z"}) {
    plan += std::string("[[axis]]\nkey = \"") + key + "\"\nfrom = 1\nto = 100\ncount = 100\n";
  }
  expect_in("1000000 variants", refusal_of(plan + kResult));
}

}  // namespace
}  // namespace chladni::sweep
