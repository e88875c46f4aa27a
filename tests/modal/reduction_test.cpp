#include <gtest/gtest.h>

#include <Eigen/SVD>

#include "modal/control_model.h"
#include "tests/modal/chain.h"
#include "tests/refusal.h"

namespace chladni::modal {
namespace {

const std::vector<OutputChannel> kOutputs{{"s1"}, {"s2"}, {"s3"}};
const std::vector<std::string> kInputs{"a1", "a2"};

ControlModel chain_model(bool held, double damping_ratio) {
  return control_model(reduced(chain(20, held), 8, {0, 7, 19}, {2, 19}, damping_ratio), kOutputs,
                       kInputs);
}

double largest_gain(const Eigen::MatrixXcd& value) {
  return Eigen::JacobiSVD<Eigen::MatrixXcd>(value).singularValues()(0);
}

// k / (s² + 2ζωs + ω²): σ = k / (4ζω²) (√(1 + ζ²) ± ζ). Their difference is half of the static
// gain.
TEST(BalancedReduction, HankelValuesOfOneModeAreThoseOfTheClosedForm) {
  for (const double z : {1e-5, 1e-3, 0.1, 0.7}) {
    ReducedModel one;
    one.frequency_hz = Eigen::VectorXd::Constant(1, 85.0);
    one.damping_ratio = Eigen::VectorXd::Constant(1, z);
    one.output_shapes = Eigen::MatrixXd::Constant(1, 1, 0.3);
    one.input_shapes = Eigen::MatrixXd::Constant(1, 1, 0.5);
    one.residual = Eigen::MatrixXd::Zero(1, 1);
    const auto small = reduced(control_model(one, {{"s"}}, {"a"}), 2);
    const double w = 2.0 * std::numbers::pi * 85.0;
    const double both = 0.15 / (4.0 * z * w * w);
    ASSERT_EQ(small.hankel.size(), 2);
    EXPECT_NEAR(small.hankel(0), both * (std::sqrt(1.0 + z * z) + z), 1e-9 * both);
    EXPECT_NEAR(small.hankel(1), both * (std::sqrt(1.0 + z * z) - z), 1e-9 * both);
  }
}

TEST(BalancedReduction, ErrsNoMoreThanItsBoundAndNotAtRest) {
  for (const double damping : {0.002, 0.05}) {
    const auto whole = chain_model(true, damping);
    for (const Eigen::Index states : {2, 4, 6, 10, 14}) {
      const auto small = reduced(whole, states);
      EXPECT_EQ(small.model.space.a.rows(), states);
      EXPECT_NEAR(small.error_bound, 2.0 * small.hankel.tail(16 - states).sum(),
                  1e-15 * small.error_bound);
      double largest = 0.0;
      for (const double f : Eigen::VectorXd::LinSpaced(4000, 1.0, 2500.0)) {
        largest = std::max(largest, largest_gain(response(small.model, f) - response(whole, f)));
      }
      EXPECT_LT(largest, small.error_bound) << states;
      EXPECT_GT(largest, 0.1 * small.error_bound) << states;
      EXPECT_LT((response(small.model, 0.0) - response(whole, 0.0)).norm(),
                1e-9 * response(whole, 0.0).norm());
    }
  }
}

TEST(BalancedReduction, AllStatesAreAnotherRealisation) {
  for (const bool held : {false, true}) {
    const auto whole = chain_model(held, 0.01);
    const auto same = reduced(whole, 16);
    EXPECT_EQ(same.error_bound, 0.0);
    for (const double f : {5.0, 400.0, 1100.0}) {
      EXPECT_LT((response(same.model, f) - response(whole, f)).norm(),
                1e-9 * response(whole, f).norm());
    }
  }
}

TEST(BalancedReduction, KeepsRigidBodyMotion) {
  const auto whole = chain_model(false, 0.01);
  const auto small = reduced(whole, 6);
  EXPECT_EQ(small.integrators, 2);
  EXPECT_EQ(small.hankel.size(), 14);
  // At low frequency nothing but the mass is seen.
  EXPECT_LT((response(small.model, 1e-2) - response(whole, 1e-2)).norm(),
            1e-9 * response(whole, 1e-2).norm());
  for (const double f : Eigen::VectorXd::LinSpaced(2000, 5.0, 2500.0)) {
    EXPECT_LT(largest_gain(response(small.model, f) - response(whole, f)), small.error_bound);
  }
}

TEST(BalancedReduction, KeepsDelaysAndNames) {
  auto whole = chain_model(true, 0.01);
  whole.input_delay << 1e-4, 2e-4;
  const auto small = reduced(whole, 4);
  EXPECT_EQ(small.model.input_delay, whole.input_delay);
  EXPECT_EQ(small.model.outputs[1].name, "s2");
  EXPECT_EQ(small.model.states.size(), 4U);
}

TEST(BalancedReduction, SaysWhyItRefuses) {
  auto model = chain_model(true, 0.01);
  EXPECT_NE(refusal_of([&] { return reduced(model, 17); }).find("to 16 (all)"), std::string::npos);
  EXPECT_NE(refusal_of([&] { return reduced(chain_model(false, 0.01), 1); }).find("rigid-body"),
            std::string::npos);
  EXPECT_NE(refusal_of([&] { return reduced(chain_model(true, 0.0), 4); }).find("undamped"),
            std::string::npos);
  EXPECT_NE(refusal_of([&] { return reduced(chain_model(true, -0.01), 4); }).find("unstable"),
            std::string::npos);
  EXPECT_NE(refusal_of([&] { return reduced(discretised(model, 1e-4), 4); }).find("discrete"),
            std::string::npos);
}

}  // namespace
}  // namespace chladni::modal
