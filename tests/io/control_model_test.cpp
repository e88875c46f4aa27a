// Independent readers: a C compiler runs the header, SciPy reads the MAT file.
#include "io/control_model.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>

#include "tests/modal/chain.h"
#include "tests/refusal.h"

namespace chladni::io {
namespace {

namespace fs = std::filesystem;

class ControlFiles : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] fs::path operator/(const std::string& name) const { return folder_ / name; }

  /// What `command` prints; the test fails if it ends with a fault.
  [[nodiscard]] static std::string output_of(const std::string& command) {
    FILE* pipe = popen((command + " 2>&1").c_str(), "r");
    std::string text;
    std::array<char, 4096> part{};
    while (std::fgets(part.data(), part.size(), pipe) != nullptr) text += part.data();
    EXPECT_EQ(pclose(pipe), 0) << command << "\n" << text;
    return text;
  }

 private:
  fs::path folder_ =
      fs::temp_directory_path() / ("chladni_control_files_" + std::to_string(getpid()));
};

modal::ReducedModel modes_of_chain() {
  return modal::reduced(modal::chain(20, false), 6, {0, 7, 19}, {2, 19}, 0.01);
}

modal::ControlModel delayed() {
  auto model = modal::control_model(
      modes_of_chain(), {{"s1"}, {"s2"}, {"s \"3\" */", modal::FrfKind::mobility}}, {"a1", "a2"});
  model.input_delay << 3.5e-4, 0.0;
  model.output_delay << 0.0, 2.0e-4, 1.7e-4;
  return model;
}

double input(Eigen::Index k, Eigen::Index j) {
  return std::sin(0.3 * static_cast<double>(k * (j + 1))) + (k == 5 ? 2.0 : 0.0);
}

// The same input in C, and a row at a place whose shapes are 1, 1/2, 1/3, ...
constexpr const char* kProgram = R"(
#include "model.h"
#include <math.h>
#include <stdio.h>
int main(void) {
  static chladni_model m;
  chladni_reset(&m);
  for (int k = 0; k < 200; ++k) {
    double u[CHLADNI_INPUTS], y[CHLADNI_OUTPUTS], phi[CHLADNI_MODES];
    for (int j = 0; j < CHLADNI_INPUTS; ++j) u[j] = sin(0.3 * k * (j + 1)) + (k == 5 ? 2.0 : 0.0);
    for (int i = 0; i < CHLADNI_MODES; ++i) phi[i] = 1.0 / (i + 1);
    double z = chladni_displacement_at(&m, phi);
    chladni_step(&m, u, y);
    printf("%.17g", z);
    for (int i = 0; i < CHLADNI_OUTPUTS; ++i) printf(" %.17g", y[i]);
    printf("\n");
  }
  return 0;
}
)";

// Fields between the sensors have fewer modes than the model: the header says which phi has.
TEST(ControlHeader, ListsTheModesThatShapeValuesBelongTo) {
  modal::ReducedModel modes;
  modes.rigid_count = 1;
  modes.frequency_hz = Eigen::Vector2d(0.0, 40.0);
  modes.damping_ratio = Eigen::Vector2d(0.0, 0.01);
  modes.output_shapes = Eigen::RowVector2d(1.0, 2.0);
  modes.input_shapes = Eigen::Vector2d(1.0, 2.0);
  modes.residual = Eigen::MatrixXd::Zero(1, 1);
  const auto sampled = modal::discretised(modal::control_model(modes, {{"s1"}}, {"a1"}), 1e-4);
  const auto text = control_model_c(sampled, {"plate", {1.0, 0.5 / (std::numbers::pi * 40.0)}});
  EXPECT_NE(text.find("\n   0  0 Hz\n   1  40 Hz\n"), std::string::npos) << text;
  EXPECT_THROW((void)control_model_c(sampled, {"plate", {1.0, 1.0, 1.0}}), InvalidInput);
}

TEST_F(ControlFiles, TheCHeaderStepsToTheSamplesOfTheModel) {
  const auto sampled = modal::discretised(delayed(), 1e-4);
  std::vector<double> position;
  const auto modes = modes_of_chain();
  for (const double f : modes.frequency_hz) {
    position.push_back(f == 0.0 ? 1.0 : 0.5 / (std::numbers::pi * f));
  }
  std::ofstream(*this / "model.h")
      << control_model_c(sampled, {"a \"title\" */ of two\nlines", position});
  std::ofstream(*this / "main.c") << kProgram;
  const auto program = (*this / "main").string();
  (void)output_of("cc -std=c99 -O2 -Wall -Wextra -Wpedantic -Wconversion -Werror -o " + program +
                  " " + (*this / "main.c").string() + " -lm");
  std::istringstream lines(output_of(program));
  const auto whole = modal::with_delay_states(sampled).space;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(whole.a.rows());
  double size = 0.0;
  for (Eigen::Index k = 0; k < 200; ++k) {
    double z = 0.0;
    for (Eigen::Index m = 0; m < 6; ++m) {
      z += position[static_cast<std::size_t>(m)] * x(2 * m) / static_cast<double>(m + 1);
    }
    const Eigen::Vector2d u(input(k, 0), input(k, 1));
    const Eigen::VectorXd y = whole.c * x + whole.d * u;
    x = whole.a * x + whole.b * u;
    size = std::max(size, y.cwiseAbs().maxCoeff());
    double found = 0.0;
    ASSERT_TRUE(lines >> found) << k;
    EXPECT_NEAR(found, z, 1e-12 * std::abs(z) + 1e-18) << k;
    for (Eigen::Index i = 0; i < 3; ++i) {
      ASSERT_TRUE(lines >> found) << k;
      EXPECT_NEAR(found, y(i), 1e-12 * size) << k << " " << i;
    }
  }
  EXPECT_GT(size, 0.0);
}

constexpr const char* kReader = R"(
import sys, numpy, scipy.io
m = scipy.io.loadmat(sys.argv[1], simplify_cells=True)[sys.argv[2]]
p = dict(zip(m["properties"][0::2], m["properties"][1::2]))
w = 2 * numpy.pi * float(sys.argv[3])
step = m["Ts"]
z = numpy.exp(1j * w * step) if step > 0 else 1j * w
late = lambda d: numpy.exp(-1j * w * (step if step > 0 else 1.0) * numpy.atleast_1d(d))
g = m["C"] @ numpy.linalg.solve(z * numpy.eye(len(m["A"])) - m["A"], m["B"]) + m["D"]
g = late(p["OutputDelay"])[:, None] * g * late(p["InputDelay"])[None, :]
print(len(p["StateName"]), p["OutputName"][1], p["OutputUnit"][2], p["InputUnit"][0])
for value in g.ravel():
    print("%.17g %.17g" % (value.real, value.imag))
)";

TEST_F(ControlFiles, SciPyReadsTheMatFileWithTheSameResponse) {
  if (std::system("/usr/bin/python3 -c 'import scipy.io' 2> /dev/null") != 0) {
    GTEST_SKIP() << "SciPy is not on this machine: no independent reader of the MAT file";
  }
  const auto continuous = delayed();
  const auto sampled = modal::discretised(continuous, 1e-4);
  write_mat(*this / "model.mat", {{"continuous", control_model_mat(continuous)},
                                  {"discrete", control_model_mat(sampled)}});
  std::ofstream(*this / "read.py") << kReader;
  for (const auto* model : {&continuous, &sampled}) {
    const bool discrete = model == &sampled;
    for (const char* f : {"12.5", "400", "1300"}) {
      std::istringstream lines(output_of("/usr/bin/python3 " + (*this / "read.py").string() + " " +
                                         (*this / "model.mat").string() +
                                         (discrete ? " discrete " : " continuous ") + f));
      std::string heading;
      std::getline(lines, heading);
      EXPECT_EQ(heading, (discrete ? "13" : "12") + std::string(" s2 m/s N"));
      const auto expected = modal::response(*model, std::stod(f));
      for (Eigen::Index i = 0; i < 3; ++i) {
        for (Eigen::Index j = 0; j < 2; ++j) {
          double real = 0.0;
          double imaginary = 0.0;
          ASSERT_TRUE(lines >> real >> imaginary);
          EXPECT_LT(std::abs(std::complex<double>(real, imaginary) - expected(i, j)),
                    1e-9 * std::abs(expected(i, j)));
        }
      }
    }
  }
}

TEST_F(ControlFiles, JsonHasTheSameNumbers) {
  const auto model = modal::discretised(delayed(), 1e-4);
  const auto json = parse_json(text(control_model_json(model)));
  EXPECT_EQ(json.at("A").array().at(1).array().at(1).number(), model.space.a(1, 1));
  EXPECT_EQ(json.at("output_delay").array().at(1).number(), model.output_delay(1));
  EXPECT_EQ(json.at("delay_unit").string(), "samples");
  EXPECT_EQ(json.at("states").array().size(), model.states.size());
}

TEST_F(ControlFiles, NoHeaderOfAContinuousModel) {
  EXPECT_NE(refusal_of([&] { return control_model_c(delayed(), {}); }).find("continuous"),
            std::string::npos);
}

}  // namespace
}  // namespace chladni::io
