// From a file or a shape to tetrahedra: what is told of them.
#include "stage/body.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numbers>

#include "mesh/bodies.h"
#include "stage/estimates/blind_spots.h"
#include "stage/faces.h"
#include "tests/app/quiet_run.h"
#include "tests/refusal.h"

namespace chladni::stage {
namespace {

const std::string kAluminiumTable =
    R"(material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
)";

class Heard : public Work {
 public:
  void warn(std::string_view message) override { warnings.emplace_back(message); }
  std::vector<std::string> warnings;
};

// A ball of quadratic cells as an input deck.
std::string curved_deck() {
  const mesh::Sphere ball{.diameter = 0.2};
  auto body = mesh::with_order(mesh::layered(ball, 0.06), 2);
  mesh::project_to_sphere(body, ball);
  std::string deck = "*NODE\n";
  for (Eigen::Index i = 0; i < body.node_count(); ++i) {
    deck += fmt::format("{}, {}, {}, {}\n", i + 1, body.points(i, 0), body.points(i, 1),
                        body.points(i, 2));
  }
  deck += "*ELEMENT, TYPE=C3D10\n";
  for (Eigen::Index t = 0; t < body.tet_count(); ++t) {
    deck += fmt::format("{}", t + 1);
    for (const int node : body.tets.row(t)) deck += fmt::format(", {}", node + 1);
    deck += "\n";
  }
  return deck;
}

class BodyOfFile : public testing::Test {
 protected:
  void SetUp() override { std::ofstream(folder_.path() / "ball.inp") << curved_deck(); }

  study::Study study_of(const std::string& mesh) const {
    return study::parse_study(
        "title = \"ball\"\ngeometry = { file = \"ball.inp\", unit = \"m\" }\n" + kAluminiumTable +
            mesh,
        folder_.path() / "study.toml");
  }

  mesh::TetMesh body(const std::string& mesh, Work& work) const {
    const auto study = study_of(mesh);
    return body_of(study, outline_of(study), work);
  }

  app::TestFolder folder_{"body_of_file"};
};

TEST_F(BodyOfFile, LosesItsCurvatureAloudInALowerOrder) {
  Heard heard;
  const auto own = body("", heard);
  EXPECT_EQ(own.order(), 2);
  const auto cubic = body("mesh = { order = 3 }\n", heard);
  EXPECT_EQ(cubic.order(), 3);
  EXPECT_NEAR(volume(cubic) / volume(own), 1.0, 1e-12);
  EXPECT_NEAR(volume(own) / (std::numbers::pi / 6.0 * 0.008), 1.0, 0.01);
  EXPECT_TRUE(heard.warnings.empty());
  const auto straight = body("mesh = { order = 1 }\n", heard);
  ASSERT_EQ(heard.warnings.size(), 1U);
  const auto volumes = fmt::format("the volume changes from {:.6g} to {:.6g} cm3",
                                   1e6 * volume(own), 1e6 * volume(straight));
  EXPECT_LT(volume(straight), 0.98 * volume(own));
  EXPECT_NE(heard.warnings[0].find("mesh.order is 1, and the file has curved cells of order 2"),
            std::string::npos)
      << heard.warnings[0];
  EXPECT_NE(heard.warnings[0].find(volumes), std::string::npos) << heard.warnings[0];
}

TEST_F(BodyOfFile, TellsWhichKeysOfTheMeshAreOfNoUse) {
  EXPECT_TRUE(outline_of(study_of("mesh = { order = 2 }\n")).notes.empty());
  const auto notes = outline_of(study_of("mesh = { edge_length = \"5 mm\", layers = 2, mesher = "
                                         "\"tetgen\", repair = \"fill\" }\n"))
                         .notes;
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0],
            "the file has tetrahedra, which are used as they are: mesh.edge_length, mesh.layers, "
            "mesh.mesher, mesh.repair are of no use");
}

// A solution whose seventh mode is 4 % too high.
Solution coarse(int order, bool file_has_cells) {
  Solution solution;
  solution.introduction.outline.file_has_cells = file_has_cells;
  solution.model.body.tets.resize(1, mesh::tet_nodes(order));
  solution.modes.frequency_hz = Eigen::VectorXd::Constant(7, 100.0);
  solution.frequency_error = Eigen::VectorXd::Zero(7);
  solution.frequency_error(6) = 0.04;
  return solution;
}

TEST(CoarseMesh, IsMendedWhereItWasMade) {
  const auto advice = [](int order, bool file_has_cells) {
    const auto lines = coarse_mesh(coarse(order, file_has_cells));
    return lines.size() == 1 ? lines[0].substr(lines[0].find("for 1 %")) : "";
  };
  EXPECT_EQ(advice(1, false),
            "for 1 % shorten mesh.edge_length to 0.50 of it, or raise mesh.order");
  EXPECT_EQ(advice(3, false), "for 1 % shorten mesh.edge_length to 0.79 of it");
  EXPECT_EQ(advice(1, true),
            "for 1 % mesh it finer where it was made, with edges 0.50 as long, or raise "
            "mesh.order");
  EXPECT_EQ(advice(3, true), "for 1 % mesh it finer where it was made, with edges 0.79 as long");
}

TEST(Supports, BetweenTwoRegionsAreRefusedWithTheirLine) {
  const auto refused = [](const std::string& patch) {
    const auto study = study::parse_study(
        R"(title = "table"
geometry = { wafer_table = { length = "400 mm", width = "400 mm", height = "20 mm", wafer = { diameter = "300 mm", thickness = "1 mm" } } }
)" + kAluminiumTable +
            "[[support]]\npatch = \"" + patch + "\"\nfixed = \"xyz\"\n",
        "table.toml");
    return refusal_of([&] {
      require_faces(study, outline_of(study).shell);
      return 0;
    });
  };
  EXPECT_EQ(refused("bottom"), "");
  const auto message = refused("interface_wafer");
  EXPECT_NE(message.find("table.toml:4:1: support.patch: no face of \"interface_wafer\" is on the "
                         "outside of the body"),
            std::string::npos)
      << message;
}

}  // namespace
}  // namespace chladni::stage
