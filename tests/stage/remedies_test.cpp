// Meshes that are proposed where a solution does not fit.
#include "stage/remedies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "stage/remedies/trials.h"
#include "tests/rotation/turn.h"

namespace chladni::stage {
namespace {

study::Study body(const std::string& geometry, const std::string& mesh, int count) {
  return study::parse_study("geometry = { " + geometry + R"( }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
mesh = { )" + mesh +
                                " }\nmodes = { count = " + std::to_string(count) + " }\n",
                            "body.toml");
}

study::Study with(const Remedy& remedy, study::Study study) {
  if (remedy.edge_length_m > 0.0) study.mesh.edge_length = remedy.edge_length_m;
  study.mesh.order = remedy.order > 0 ? remedy.order : study.mesh.order;
  study.modes.mirrors = remedy.mirrors;
  return study;
}

WorkOptions limited(std::size_t bytes) {
  WorkOptions options;
  options.certificate = false;
  options.memory_limit_bytes = bytes;
  return options;
}

std::vector<Remedy> ways_of(const study::Study& study, std::size_t limit_bytes) {
  Work work(limited(limit_bytes));
  try {
    (void)solved(study, work);
  } catch (const DoesNotFit& e) {
    return e.remedies;
  }
  return {};
}

// The analysis of a cube's own matrices finds more than the forecast, which is fitted to plates.
TEST(Remedies, OfACompactBodyFitToo) {
  EVERY_FOURTH_LANDING();
  constexpr std::size_t kLimit = 200'000'000;
  const auto cube = body("plate = { length = \"60 mm\", width = \"60 mm\", thickness = \"60 mm\" }",
                         "edge_length = \"5.5 mm\", order = 2, layers = 10", 12);
  Work work;
  EXPECT_LT(introduced(cube, work).cost.memory_bytes, 1.0 * kLimit);
  const auto ways = ways_of(cube, kLimit);
  ASSERT_GE(ways.size(), 2U);
  for (const auto& way : ways) {
    if (way.ranks > 0) continue;
    Work little(limited(kLimit));
    EXPECT_EQ(solved(with(way, cube), little).modes.rigid_count, 6) << way.line();
    EXPECT_TRUE(way.frequency_error || way.edge_length_m == 0.0) << way.line();
  }
}

// Above 25 000 degrees of freedom the error is extrapolated from coarser meshes.
TEST(Remedies, TellAnExtrapolatedErrorThatHolds) {
  EVERY_FOURTH_LANDING();
  constexpr std::size_t kLimit = 300'000'000;
  const auto plate =
      body("plate = { length = \"600 mm\", width = \"600 mm\", thickness = \"20 mm\" }",
           "edge_length = \"8 mm\", order = 2", 10);
  const auto ways = ways_of(plate, kLimit);
  ASSERT_GE(ways.size(), 2U);
  // Cubic cells of 30 mm leave less than a tenth of these errors.
  Work work;
  auto fine = plate;
  fine.mesh.edge_length = 0.03;
  fine.mesh.order = 3;
  const auto truth = solved(fine, work).modes;
  for (const auto& way : ways) {
    if (way.ranks > 0 || way.edge_length_m == 0.0) continue;
    ASSERT_TRUE(way.frequency_error);
    if (way.order == 2) {
      EXPECT_GT(way.degrees_of_freedom, 3e4);
    }
    Work little(limited(kLimit));
    const auto found = solved(with(way, plate), little);
    const auto flexible = std::min(found.modes.mode_count(), truth.mode_count()) - 6;
    const double worst = (found.modes.frequency_hz.segment(6, flexible).array() /
                              truth.frequency_hz.segment(6, flexible).array() -
                          1.0)
                             .maxCoeff();
    EXPECT_LT(worst, *way.frequency_error) << way.line();
    EXPECT_LT(found.frequency_error.maxCoeff(), 1.05 * *way.frequency_error) << way.line();
    EXPECT_GT(found.frequency_error.maxCoeff(), 0.2 * *way.frequency_error) << way.line();
  }
}

// Two cells span the beam: the eighth motion of the mesh is not the
// eighth of the beam, which is two thirds lower. What the mesh leaves is not known.
TEST(Trials, TellNoErrorOfAMeshThatIsTooCoarse) {
  const auto beam = body("beam = { length = \"600 mm\", width = \"40 mm\", thickness = \"20 mm\" }",
                         "edge_length = \"20 mm\", order = 2", 8);
  Work work;
  const auto introduction = introduced(beam, work);
  Trials trials(beam, introduction, 1e9, work);
  const auto error = [&](double edge) {
    return trials.error({.elements = {.order = 2, .edge_length = edge}, .degrees_of_freedom = 1e3});
  };
  EXPECT_FALSE(error(0.3));
  const auto known = error(0.04);
  ASSERT_TRUE(known);
  EXPECT_GT(known->relative, 0.0335);  // the truth
  EXPECT_LT(known->relative, 0.1);
}

}  // namespace
}  // namespace chladni::stage
