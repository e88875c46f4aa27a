// chladni export: the files, read back by another reader, are the study's K, M and channels.
#include <sys/resource.h>

#include <Eigen/Dense>
#include <cmath>
#include <csignal>
#include <cstdlib>

#include "fem/system.h"
#include "io/json.h"
#include "stage/solution.h"
#include "tests/app/program.h"
#include "tests/app/quiet_run.h"

namespace chladni::app {
namespace {

// A study with held nodes, a resonator, a dashpot, two sensors and an actuator.
const std::string kHeld = std::string(kPlate) + R"([[sensor]]
name = "s2"
at = ["30 mm", "-10 mm"]
direction = "z"
[[actuator]]
name = "a1"
at = ["10 mm", "0 mm"]
direction = "z"
[[attachment]]
name = "absorber"
kind = "resonator"
at = ["20 mm", "10 mm"]
direction = "z"
mass = "5 g"
frequency = "400 Hz"
damping_ratio = 0.02
[[support]]
patch = "x_min"
fixed = "xyz"
)";

// A matrix of a Matrix Market file, dense; of a symmetric one both triangles.
Eigen::MatrixXd market(const fs::path& file) {
  std::ifstream in(file);
  std::string head;
  std::getline(in, head);
  Eigen::Index rows = 0;
  Eigen::Index columns = 0;
  in >> rows >> columns;
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(rows, columns);
  const auto number = [&] {
    std::string word;
    in >> word;
    return std::strtod(word.c_str(), nullptr);
  };
  if (head.find("array") != std::string::npos) {
    for (double& value : matrix.reshaped()) value = number();
    return matrix;
  }
  long long entries = 0;
  in >> entries;
  for (; entries > 0; --entries) {
    Eigen::Index i = 0;
    Eigen::Index j = 0;
    in >> i >> j;
    matrix(i - 1, j - 1) = number();
    if (head.find("symmetric") != std::string::npos) matrix(j - 1, i - 1) = matrix(i - 1, j - 1);
  }
  EXPECT_TRUE(static_cast<bool>(in));
  return matrix;
}

Eigen::MatrixXd dense(const SparseMatrix& lower) {
  return Eigen::MatrixXd(lower).selfadjointView<Eigen::Lower>();
}

stage::Solution assembled(const fs::path& file) {
  const auto study = study::read_study(file, {});
  QuietRun quiet(study, file.parent_path() / "quiet");
  return stage::assembled(study, quiet.run());
}

std::vector<std::vector<std::string>> rows_of(const fs::path& file) {
  std::ifstream in(file);
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(in, line);) {
    auto& row = rows.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(cell);
  }
  return rows;
}

TEST_F(CommandLine, ExportIsTheSystemOfTheStudy) {
  for (const auto& text : {std::string(kPlate), kHeld}) {
    const auto file = write("study.toml", text);
    const auto ended = run({"export", file.string(), "-o", "out"});
    ASSERT_EQ(ended.status, 0) << ended.err;
    const auto folder = folder_ / "out" / "system";
    const auto solution = assembled(file);
    const auto& system = *solution.system;
    EXPECT_EQ(market(folder / "stiffness.mtx"), dense(system.stiffness));
    EXPECT_EQ(market(folder / "mass.mtx"), dense(system.mass));
    EXPECT_EQ(fs::exists(folder / "damping.mtx"), system.damping.nonZeros() > 0);
    EXPECT_EQ(fs::exists(folder / "damping.petsc"), system.damping.nonZeros() > 0);
    const Eigen::MatrixXd rigid = market(folder / "rigid.mtx");
    EXPECT_EQ(rigid.cols(), system.rigid.cols());
    const auto json = io::parse_json(whole(folder_ / "out" / "export.json"));
    EXPECT_EQ(json.at("degrees_of_freedom").number(), static_cast<double>(system.mass.rows()));
  }
}

// Rigid-body modes cost no energy and are orthonormal, by the files alone.
TEST_F(CommandLine, ExportedRigidBodyModesAreTheNullSpaceOfK) {
  const auto file = write("study.toml", kPlate);
  ASSERT_EQ(run({"export", file.string(), "-o", "out"}).status, 0);
  const auto folder = folder_ / "out" / "system";
  const Eigen::MatrixXd k = market(folder / "stiffness.mtx");
  const Eigen::MatrixXd m = market(folder / "mass.mtx");
  const Eigen::MatrixXd rigid = market(folder / "rigid.mtx");
  ASSERT_EQ(rigid.cols(), 6);
  EXPECT_LT((k * rigid).cwiseAbs().maxCoeff(),
            1e-12 * k.cwiseAbs().maxCoeff() * rigid.cwiseAbs().maxCoeff());
  EXPECT_LT((rigid.transpose() * m * rigid - Eigen::MatrixXd::Identity(6, 6)).cwiseAbs().maxCoeff(),
            1e-12);
  // The mass of the whole body, by the rows that move along x.
  const auto rows = rows_of(folder / "rows.csv");
  ASSERT_EQ(static_cast<Eigen::Index>(rows.size()), k.rows() + 1);
  Eigen::VectorXd along_x = Eigen::VectorXd::Zero(k.rows());
  for (std::size_t i = 1; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i][0], std::to_string(i - 1));
    if (rows[i][2] == "x") along_x(static_cast<Eigen::Index>(i) - 1) = 1.0;
  }
  EXPECT_NEAR(along_x.dot(m * along_x), 0.1 * 0.06 * 0.005 * 2700.0, 1e-12);
}

// A rigid motion, laid out by rows.csv, moves each channel as a rigid body does.
TEST_F(CommandLine, ExportedChannelsSeeRigidMotions) {
  const auto file = write("study.toml", kPlate);
  ASSERT_EQ(run({"export", file.string(), "-o", "out"}).status, 0);
  const auto folder = folder_ / "out" / "system";
  const Eigen::MatrixXd c = market(folder / "sensors.mtx");
  const auto rows = rows_of(folder / "rows.csv");
  ASSERT_EQ(c.rows(), 1);
  Eigen::VectorXd turned = Eigen::VectorXd::Zero(c.cols());  // about x: u_z = y
  for (std::size_t i = 1; i < rows.size(); ++i) {
    if (rows[i][2] == "z") turned(static_cast<Eigen::Index>(i) - 1) = std::stod(rows[i][4]);
  }
  EXPECT_NEAR((c * turned)(0), 0.020, 1e-12);
  EXPECT_EQ(market(folder / "actuators.mtx").size(), 0);
  const auto channels = rows_of(folder / "channels.csv");
  ASSERT_EQ(channels.size(), 2U);
  EXPECT_EQ(channels[1][2], "s1");
}

TEST_F(CommandLine, ExportNamesWhatAnAttachmentAdds) {
  const auto file = write("study.toml", kHeld);
  ASSERT_EQ(run({"export", file.string(), "-o", "out"}).status, 0);
  const auto folder = folder_ / "out" / "system";
  const auto rows = rows_of(folder / "rows.csv");
  EXPECT_EQ(rows.back()[1], "-1");
  EXPECT_EQ(rows.back()[2], "added");
  EXPECT_EQ(market(folder / "sensors.mtx").rows(), 2);
  EXPECT_EQ(market(folder / "actuators.mtx").cols(), 1);
  EXPECT_TRUE(fs::exists(folder / "damping.petsc"));
}

// The folder is there whole or not at all: a disk that is full, here a limit of files, leaves the
// older one.
TEST_F(CommandLine, ExportLeavesNoHalfFolder) {
  const auto file = write("study.toml", kPlate);
  ASSERT_EQ(run({"export", file.string(), "-o", "out"}).status, 0);
  const auto before = whole(folder_ / "out" / "system" / "stiffness.petsc");
  write("study.toml", std::string(kPlate) + "[[support]]\npatch = \"x_min\"\nfixed = \"x\"\n");
  const auto full = ended(started({"export", file.string(), "-o", "out"}, "", [] {
    const rlimit limit = {200'000, 200'000};
    setrlimit(RLIMIT_FSIZE, &limit);
  }));
  EXPECT_EQ(full.status, 5) << full.err;
  EXPECT_EQ(whole(folder_ / "out" / "system" / "stiffness.petsc"), before);
  EXPECT_EQ(left("out"), (std::vector<std::string>{"export.json", "system"}));
}

TEST_F(CommandLine, ExportReplacesNoFolderThatIsNotItsOwn) {
  const auto file = write("study.toml", kPlate);
  fs::create_directories(folder_ / "out/system");
  ASSERT_EQ(run({"export", file.string(), "-o", "out"}).status, 0);  // an empty one is
  ASSERT_EQ(run({"export", file.string(), "-o", "out"}).status, 0);
  fs::remove_all(folder_ / "out/system");
  fs::create_directories(folder_ / "out/system");
  write("out/system/thesis.tex", "three years");
  const auto refused = run({"export", file.string(), "-o", "out"});
  EXPECT_EQ(refused.status, 3);
  EXPECT_TRUE(says(refused.err, "not of an earlier export"));
  EXPECT_EQ(whole(folder_ / "out/system/thesis.tex"), "three years");
  EXPECT_FALSE(fs::exists(folder_ / "out/system.part"));
}

}  // namespace
}  // namespace chladni::app
