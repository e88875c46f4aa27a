// What rests on the last bits of the modes, on a fit that has not ended, on variances too large.
#include "diagnosis/verdict/stability.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "diagnosis/diagnosed.h"
#include "diagnosis/small_plate.h"
#include "simulators/tables/loaded_table.h"

namespace chladni::diagnosis {
namespace {

using Eigen::VectorXd;

Supposed mass_at(double u) { return {&effect("point_mass"), 0, Eigen::Vector3d(0.2, u, 0.07)}; }
Supposed gain_of(Eigen::Index sensor) {
  return {&effect("sensor_gain"), sensor, VectorXd::Constant(1, 0.1)};
}
Fit fit_of(std::vector<Supposed> causes) {
  Fit fit;
  fit.causes = std::move(causes);
  fit.converged = true;
  return fit;
}

TEST(Nudged, IsTheSameStructureToNineDigits) {
  const auto& plate = small_plate();
  const Structure other = nudged(plate);
  EXPECT_NE(other.frequency_hz, plate.frequency_hz);
  EXPECT_NE(other.outputs.shapes, plate.outputs.shapes);
  EXPECT_TRUE(other.frequency_hz.isApprox(plate.frequency_hz, 2e-9));
  EXPECT_TRUE(other.inputs.shapes.isApprox(plate.inputs.shapes, 2e-9));
  EXPECT_EQ(other.frequency_hz.head(plate.rigid_count).norm(), 0.0);
  check(other);
}

TEST(NotRepeated, IsWhatASecondSearchNamesOtherwise) {
  const auto& plate = small_plate();
  using Which = std::vector<std::size_t>;
  const Fit told = fit_of({mass_at(0.1), gain_of(1)});
  EXPECT_EQ(not_repeated(plate, told, fit_of({gain_of(1), mass_at(0.101)})), Which{});
  EXPECT_EQ(not_repeated(plate, told, fit_of({gain_of(1), mass_at(-0.1)})), Which{0});
  EXPECT_EQ(not_repeated(plate, told, fit_of({mass_at(0.1), gain_of(2)})), Which{1});
  EXPECT_EQ(not_repeated(plate, told, fit_of({})), (Which{0, 1}));
}

Explanation told_as(const std::string& effect, double probability) {
  Explanation one;
  one.causes.emplace_back().effect = effect;
  one.probability = probability;
  return one;
}

// The list of causes turned on the kernel of BLAS where none of them was named.
TEST(NoteOnOrder, NamesTheExplanationsThatMayComeFirst) {
  Diagnosis diagnosis;
  diagnosis.verdict = Verdict::unexplained;
  diagnosis.best = told_as("size_error", 0.5);
  EXPECT_EQ(note_on_order(diagnosis, 5.0), "") << "no rival";
  diagnosis.rivals = {told_as("thickness", 0.3), told_as("density", 0.5 * std::exp(-6.0))};
  diagnosis.rivals.front().causes.emplace_back().effect = "sensor_gain";
  diagnosis.rivals.front().causes.back().channels = {"y1"};
  const auto note = note_on_order(diagnosis, 5.0);
  EXPECT_NE(note.find("order of the causes is not certain"), std::string::npos) << note;
  EXPECT_NE(note.find("(size_error)"), std::string::npos) << note;
  EXPECT_NE(note.find("thickness and sensor_gain of y1"), std::string::npos) << note;
  EXPECT_EQ(note.find("density"), std::string::npos) << note;
  // A ratio of e^6 is 10 in evidence, where that counts by its power of 0.6; and 4 by one of 1.5.
  EXPECT_EQ(note_on_order(diagnosis, 9.9, 0.6).find("density"), std::string::npos);
  EXPECT_NE(note_on_order(diagnosis, 10.1, 0.6).find("density"), std::string::npos);
  EXPECT_NE(note_on_order(diagnosis, 5.0, 1.5).find("density"), std::string::npos);
  for (int n = 0; n < 4; ++n) diagnosis.rivals.push_back(told_as("orthotropy", 0.1));
  EXPECT_NE(note_on_order(diagnosis, 5.0).find("2 more"), std::string::npos);
  diagnosis.verdict = Verdict::named;
  EXPECT_EQ(note_on_order(diagnosis, 5.0), "");
  diagnosis.verdict = Verdict::no_discrepancy;
  diagnosis.best = {};
  EXPECT_EQ(note_on_order(diagnosis, 5.0), "") << "no cause is told";
}

Diagnosis sure_of(const Fit& fit) {
  Diagnosis diagnosis;
  diagnosis.verdict = Verdict::named;
  for (const auto& cause : fit.causes) {
    diagnosis.best.causes.emplace_back().effect = cause.effect->name;
    diagnosis.best.causes.back().probability = 0.99;
  }
  return diagnosis;
}

// A second search costs as much as the first: only where it may take a name back.
TEST(Doubt, IsOfWhatIsLikely) {
  Fit best;
  best.converged = true;
  Diagnosis diagnosis;
  diagnosis.verdict = Verdict::partial;
  EXPECT_FALSE(is_doubtful(diagnosis, best));
  diagnosis.best.causes.resize(2);
  diagnosis.best.causes[1].probability = 0.3;
  EXPECT_FALSE(is_doubtful(diagnosis, best));
  diagnosis.best.causes[1].probability = 0.7;
  EXPECT_TRUE(is_doubtful(diagnosis, best));
  diagnosis.verdict = Verdict::named;
  EXPECT_FALSE(is_doubtful(diagnosis, best));
  best.converged = false;
  EXPECT_TRUE(is_doubtful(diagnosis, best));
  diagnosis.verdict = Verdict::unexplained;
  EXPECT_FALSE(is_doubtful(diagnosis, best));
}

TEST(Doubt, TakesTheConfidenceFromWhatIsNotNamedAgain) {
  const Fit told = fit_of({mass_at(0.1), gain_of(1)});
  Found second;
  second.fits = {fit_of({mass_at(-0.1), gain_of(1)}), fit_of({})};
  auto diagnosis = sure_of(told);
  EXPECT_EQ(doubt(small_plate(), told, second, diagnosis),
            "not stable: a search from modes that differ by 1e-9 does not name point_mass again "
            "but point_mass");
  EXPECT_EQ(diagnosis.best.causes[0].probability, 0.5);
  EXPECT_EQ(diagnosis.best.causes[1].probability, 0.99);
  EXPECT_EQ(diagnosis.verdict, Verdict::partial);
  // A rival within reach of its last word counts as named again.
  second.fits.push_back(fit_of({mass_at(0.1)}));
  diagnosis = sure_of(told);
  EXPECT_EQ(doubt(small_plate(), told, second, diagnosis), "");
  EXPECT_EQ(diagnosis.verdict, Verdict::named);
  second.fits.back().log_evidence = -1000.0;
  EXPECT_NE(doubt(small_plate(), told, second, diagnosis), "");
}

TEST(Convergence, IsDoubtedAloud) {
  Fit ended = fit_of({mass_at(0.1)});
  EXPECT_EQ(note_on_convergence(ended, ended), "");
  Fit open = ended;
  open.converged = false;
  open.promise = 3.25;
  EXPECT_NE(note_on_convergence(open, ended).find("promises 3.2"), std::string::npos);
  EXPECT_NE(note_on_convergence(ended, open).find("tolerances alone"), std::string::npos);
}

// The deviations take as many numbers as they are known better than by their priors.
TEST(Noise, IsDoubtedWhereLessIsLeft) {
  constexpr double kNumbers = 20000.0;
  Fit fit = fit_of({});
  fit.eta = VectorXd::Zero(600);
  fit.covariance = Eigen::MatrixXd::Zero(600, 600);  // each known exactly: 600 numbers are gone
  fit.chi_square = kNumbers - 600.0;
  EXPECT_EQ(note_on_noise(fit, kNumbers), "");
  fit.chi_square = kNumbers / 1.1 - 600.0;
  EXPECT_NE(note_on_noise(fit, kNumbers).find("by about 10 %"), std::string::npos);
  fit.covariance.setIdentity();  // known as before: nothing is gone
  fit.chi_square = kNumbers - 900.0;
  EXPECT_NE(note_on_noise(fit, kNumbers).find("z = -4.5"), std::string::npos);
}

bool says(const Diagnosis& diagnosis, std::string_view words) {
  return std::ranges::any_of(diagnosis.notes, [&](const std::string& note) {
    return note.find(words) != std::string::npos;
  });
}

// Variances stated twice too large.
TEST(Diagnosed, DoubtsVariancesThatAreTooLarge) {
  auto measured = simulators::loaded_table(simulators::believed_table(8), {.high_hz = 700.0});
  DiagnosisOptions options;
  options.only = {"sensor_sign"};
  options.lines = 60;
  EXPECT_FALSE(says(diagnosed(small_plate(), measured, options), "variances"));
  for (auto& variance : measured.variance) variance *= 2.0;
  EXPECT_TRUE(says(diagnosed(small_plate(), measured, options), "too large, by about"));
}

}  // namespace
}  // namespace chladni::diagnosis
