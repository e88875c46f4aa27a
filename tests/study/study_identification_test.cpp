// [identification] of a study: what it takes, and what it refuses where it would change nothing.
#include <gtest/gtest.h>

#include "base/error.h"
#include "study/study.h"

namespace chladni::study {
namespace {

const std::string kBody = R"(
geometry = { plate = { length = "600 mm", width = "600 mm", thickness = "20 mm" } }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
[identification]
)";

study::IdentificationPlan read(const std::string& keys) {
  return *study::parse_study(kBody + keys, "bench/study.toml").identification;
}

void refused(const std::string& keys, const std::string& because) {
  try {
    (void)read(keys);
    ADD_FAILURE() << "taken: " << keys;
  } catch (const InvalidInput& e) {
    EXPECT_NE(std::string(e.what()).find(because), std::string::npos) << e.what();
  }
}

TEST(StudyIdentification, HasTheThesisSettingsUnlessItSaysOthers) {
  const auto plain = read("method = \"thesis\"");
  EXPECT_EQ(plain.weighting, "inverse_magnitude");
  EXPECT_EQ(plain.cut_off_db, 40.0);
  EXPECT_EQ(plain.clip_db, 0.0);
  EXPECT_EQ(plain.fraction_degree, 0);
  EXPECT_EQ(plain.sanathanan_koerner, 30);
  EXPECT_EQ(plain.levenberg_marquardt, 10);
  EXPECT_EQ(plain.modal_iterations, 10);
  EXPECT_EQ(plain.suspended_modes, -1);
  const auto other = read(R"(method = "thesis"
cut_off_db = 80
clip_db = 20
fraction_degree = 12
sanathanan_koerner = 100
levenberg_marquardt = 0
modal_iterations = 25
suspended_modes = 2
)");
  EXPECT_EQ(other.cut_off_db, 80.0);
  EXPECT_EQ(other.clip_db, 20.0);
  EXPECT_EQ(other.fraction_degree, 12);
  EXPECT_EQ(other.sanathanan_koerner, 100);
  EXPECT_EQ(other.levenberg_marquardt, 0);
  EXPECT_EQ(other.modal_iterations, 25);
  EXPECT_EQ(other.suspended_modes, 2);
}

TEST(StudyIdentification, RefusesWhatWouldChangeNothing) {
  for (const auto* key : {"fraction_degree = 12", "sanathanan_koerner = 100",
                          "levenberg_marquardt = 5", "modal_iterations = 5"}) {
    refused(key, "method = \"thesis\"");
  }
  refused("clip_db = 20", "weighting = \"inverse_magnitude\"");
  refused("weighting = \"inverse_magnitude\"\nmodel_error = \"1 %\"", "weighting = \"variance\"");
  EXPECT_EQ(read("weighting = \"inverse_magnitude\"\nclip_db = 20").clip_db, 20.0);
}

TEST(StudyIdentification, RefusesWhatIsOutOfBounds) {
  refused("method = \"thesis\"\nfraction_degree = 0", "1");
  refused("method = \"thesis\"\nsanathanan_koerner = 0", "1");
  refused("method = \"thesis\"\nlevenberg_marquardt = -1", "0");
  refused("method = \"thesis\"\nmodal_iterations = 0", "1");
  refused("method = \"thesis\"\nclip_db = 40", "not below cut_off_db");
  refused("method = \"thesis\"\nclip_db = -3", "clip_db");
  refused("suspended_modes = 4", "3");
}

TEST(StudyIdentification, RefusesAPairWithoutItsChannels) {
  refused("pair = [{}]", "identification.pair[0] lacks \"sensor\"");
}

}  // namespace
}  // namespace chladni::study
