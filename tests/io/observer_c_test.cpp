// A C compiler runs the header of an observer beside that of its model.
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "base/draw.h"
#include "io/control_model.h"
#include "modal/kalman_filter.h"
#include "tests/modal/chain.h"

namespace chladni::io {
namespace {

namespace fs = std::filesystem;

constexpr Eigen::Index kSamples = 400;
constexpr double kStep = 2e-4;

// Both headers in one program: it reads forces and sensors, and prints points and innovations.
constexpr const char* kObserverProgram = R"(
#include "model.h"
#include "observer.h"
#include <stdio.h>
#include <time.h>
int main(void) {
  static chladni_observer_model m;
  static chladni_model other;
  double in[CHLADNI_OBSERVER_INPUTS], out[CHLADNI_OBSERVER_OUTPUTS];
  chladni_reset(&other);
  chladni_observer_reset(&m);
  while (scanf("%lf %lf %lf", &in[0], &in[1], &in[2]) == 3) {
    chladni_observer_step(&m, in, out);
    for (int i = 0; i < CHLADNI_OBSERVER_OUTPUTS; ++i) printf("%.17g ", out[i]);
    printf("\n");
  }
  clock_t begin = clock();
  for (int k = 0; k < 100000; ++k) chladni_observer_step(&m, in, out);
  fprintf(stderr, "one step of %d states: %.0f ns\n", CHLADNI_OBSERVER_STATES,
          1e9 * (double)(clock() - begin) / CLOCKS_PER_SEC / 1e5);
  return 0;
}
)";

modal::KalmanFilter filter() {
  auto model =
      modal::control_model(modal::reduced(modal::chain(20, false), 6, {0, 7, 12}, {2, 19}, 0.01),
                           {{"s1"}, {"s2"}, {"z"}}, {"a", "cable"});
  model.input_delay(0) = 2.3 * kStep;
  model.output_delay(0) = 1.6 * kStep;
  return modal::kalman_filter(modal::disturbed_model(
      model, 1, {{.name = "cable", .input = 1, .rms = 0.2}}, Eigen::Vector2d(2e-9, 3e-9), kStep));
}

TEST(ObserverInC, StepsToTheEstimatesOfTheFilter) {
  const auto observer = filter();
  const fs::path folder =
      fs::temp_directory_path() / ("chladni_observer_c_" + std::to_string(getpid()));
  fs::create_directories(folder);
  CHeaderText text{"observer", {}};
  text.prefix = "chladni_observer";
  std::ofstream(folder / "observer.h") << control_model_c(modal::observer_model(observer), text);
  std::ofstream(folder / "model.h") << control_model_c(observer.system.model, {"model", {}});
  std::ofstream(folder / "main.c") << kObserverProgram;
  Draw draw(3);
  Eigen::MatrixXd forces(kSamples, 1);
  Eigen::MatrixXd sensors(kSamples, 2);
  std::ofstream samples(folder / "samples");
  samples.precision(17);
  for (Eigen::Index k = 0; k < kSamples; ++k) {
    forces(k, 0) = draw.normal();
    sensors(k, 0) = 1e-7 * draw.normal();
    sensors(k, 1) = 1e-7 * draw.normal();
    samples << forces(k, 0) << " " << sensors(k, 0) << " " << sensors(k, 1) << "\n";
  }
  samples.close();
  const std::string in = "cd " + folder.string() + " && ";
  ASSERT_EQ(std::system((in + "cc -std=c99 -O2 -Wall -Wextra -Wpedantic -Wconversion -Werror "
                              "-o main main.c && ./main < samples > estimates")
                            .c_str()),
            0);
  std::ifstream estimates(folder / "estimates");
  const auto expected = modal::estimate(observer, forces, sensors);
  const double size = expected.points.cwiseAbs().maxCoeff();
  for (Eigen::Index k = 0; k < kSamples; ++k) {
    double z = 0.0;
    double e1 = 0.0;
    double e2 = 0.0;
    ASSERT_TRUE(estimates >> z >> e1 >> e2) << k;
    EXPECT_NEAR(z, expected.points(k, 0), 1e-11 * size) << k;
    EXPECT_NEAR(e1, expected.innovation(k, 0), 1e-11 * size + 1e-17) << k;
    EXPECT_NEAR(e2, expected.innovation(k, 1), 1e-11 * size + 1e-17) << k;
  }
  fs::remove_all(folder);
}

}  // namespace
}  // namespace chladni::io
