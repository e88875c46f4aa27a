// From a file or a shape to tetrahedra: what is told of them.
#include "stage/body.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numbers>
#include <tuple>

#include "fem/assemble.h"
#include "mesh/bodies.h"
#include "stage/estimates/blind_spots.h"
#include "stage/faces.h"
#include "stage/forecast.h"
#include "stage/model.h"
#include "stage/solution.h"
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

// A plate of steel whose part at x > 30 mm is of rubber, as an input deck.
std::string plate_of_two() {
  const auto body = mesh::layered(mesh::Plate{0.1, 0.06, 0.005}, mesh::Layering{0.01});
  std::string deck = "*NODE\n";
  for (Eigen::Index i = 0; i < body.node_count(); ++i) {
    deck += fmt::format("{}, {}, {}, {}\n", i + 1, body.points(i, 0), body.points(i, 1),
                        body.points(i, 2));
  }
  for (const std::string part : {"pad", "plate"}) {
    deck += "*ELEMENT, TYPE=C3D4, ELSET=" + part + "\n";
    for (Eigen::Index t = 0; t < body.tet_count(); ++t) {
      double middle = 0.0;
      for (int a = 0; a < 4; ++a) middle += 0.25 * body.points(body.tets(t, a), 0);
      if ((middle > 0.03) != (part == "pad")) continue;
      deck += fmt::format("{}", t + 1);
      for (const int node : body.tets.row(t)) deck += fmt::format(", {}", node + 1);
      deck += "\n";
    }
  }
  return deck;
}

const std::string kRubber =
    "[[material]]\nregion = \"PART\"\nyoungs_modulus = \"5 MPa\"\npoissons_ratio = 0.45\ndensity "
    "= \"1100 kg/m^3\"\n";
const std::string kSteel =
    "[[material]]\nyoungs_modulus = \"210 GPa\"\npoissons_ratio = 0.3\ndensity = \"7850 "
    "kg/m^3\"\n";

std::string rubber_of(const std::string& part) {
  auto text = kRubber;
  return text.replace(text.find("PART"), 4, part);
}

// The order in which materials stand in a study means nothing.
void expect_told_in_any_order(const std::string& geometry, const std::string& part,
                              const std::filesystem::path& file) {
  const auto rubber = rubber_of(part);
  const auto one = study::parse_study(geometry + rubber + kSteel, file);
  const auto other = study::parse_study(geometry + kSteel + rubber, file);
  const auto outline = outline_of(one);
  const auto told = understood(one, outline);
  const auto again = understood(other, outline);
  EXPECT_EQ(told.mass_kg, again.mass_kg);
  EXPECT_EQ(told.first_frequency_hz, again.first_frequency_hz);
  EXPECT_EQ(told.material.density, 7850.0);
  EXPECT_EQ(modes_below(told, 20e3), modes_below(again, 20e3));
  EXPECT_EQ(forecast(one, outline).memory_bytes, forecast(other, outline).memory_bytes);
}

TEST(Materials, OfAPlateInTwoPartsAreThoseOfItsRegions) {
  const app::TestFolder folder("two_materials");
  std::ofstream(folder.path() / "plate.inp") << plate_of_two();
  const std::string geometry =
      "geometry = { file = \"plate.inp\", unit = \"m\" }\nmodes = { up_to = \"20 kHz\" }\n";
  const auto file = folder.path() / "study.toml";
  expect_told_in_any_order(geometry, "pad", file);
  const auto study = study::parse_study(geometry + rubber_of("pad") + kSteel, file);
  const auto outline = outline_of(study);
  const auto exact =
      fem::mass_properties(outline.shell, materials_of(study, outline.shell.region_names), {});
  EXPECT_NEAR(understood(study, outline).mass_kg / exact.mass_kg, 1.0, 1e-12);
  EXPECT_NEAR(exact.mass_kg, 0.3e-4 * (0.8 * 7850.0 + 0.2 * 1100.0), 1e-9);
}

TEST(Materials, OfATableAndItsWaferAreThoseOfTheirRegions) {
  const std::string geometry =
      "geometry = { wafer_table = { length = \"400 mm\", width = \"400 mm\", height = \"20 mm\", "
      "wafer = { diameter = \"300 mm\", thickness = \"1 mm\" } } }\n"
      "modes = { up_to = \"2 kHz\" }\n";
  expect_told_in_any_order(geometry, "wafer", "study.toml");
  const auto study = study::parse_study(geometry + rubber_of("wafer") + kSteel, "study.toml");
  const double wafer = std::numbers::pi / 4.0 * 0.09 * 1e-3;
  EXPECT_NEAR(understood(study, outline_of(study)).mass_kg, 0.0032 * 7850.0 + wafer * 1100.0, 1e-6);
}

// A place between the table and its wafer is inside the body. `check` took it for its surface, on
// which it lay, and `modes` moved it.
TEST(Places, BetweenTwoRegionsAreInsideTheBody) {
  const std::string text =
      "title = \"t\"\ngeometry = { wafer_table = { length = \"400 mm\", width = \"400 mm\", height "
      "= "
      "\"20 mm\", wafer = { diameter = \"300 mm\", thickness = \"5 mm\" } } }\n[[sensor]]\nname = "
      "\"s\"\nat = [\"1 mm\", \"2 mm\", \"0 mm\"]\ndirection = \"z\"\n" +
      kSteel;
  const auto study = study::parse_study(text, "table.toml");
  const auto places = places_of(study, outline_of(study).shell);
  ASSERT_EQ(places.warnings.size(), 1U);
  EXPECT_NE(places.warnings[0].find("is 5 mm inside the body"), std::string::npos)
      << places.warnings[0];
  EXPECT_NEAR(places.sensors[0].position.z(), 5e-3, 1e-9);
}

std::string round_of(const std::string& shape, const std::string& rest) {
  return "title = \"round\"\ngeometry = { " + shape + " }\n" + kAluminiumTable + rest;
}

const std::string kDisc = "disc = { diameter = \"300 mm\", thickness = \"10 mm\" }";
const std::string kBall = "sphere = { diameter = \"200 mm\" }";

// Places on the true rim are on the body, in `check` as in `modes`; on a polygon of 24 edges some
// would be 1.3 mm off.
TEST(RoundBody, HasItsPlacesWhereItsMeshHasThem) {
  Work work;
  for (const std::string rest : {"", "mesh = { order = 2 }\n"}) {
    const auto study = study::parse_study(round_of(kDisc, rest), "round.toml");
    const auto outline = outline_of(study);
    const auto body = body_of(study, outline, work);
    const auto seen = rounded_outline(study, outline);
    ASSERT_TRUE(seen.has_value());
    EXPECT_EQ(seen->tet_count(), 0);  // places need no cells
    EXPECT_EQ(seen->order(), body.order());
    const mesh::SiteFinder checked(*seen);
    const mesh::SiteFinder solved(body);
    for (int i = 0; i < 40; ++i) {
      const double angle = 0.157 * i;
      const Eigen::Vector3d at(0.15 * std::cos(angle), 0.15 * std::sin(angle), -0.004);
      const auto site = checked.nearest(at);
      EXPECT_LT(site.distance, 2e-5);
      EXPECT_LT((site.position - solved.nearest(at).position).norm(), 1e-12);
    }
  }
  const auto plate = study::parse_study(
      "title = \"p\"\ngeometry = { plate = { length = \"1 m\", width = \"1 m\", thickness = \"9 "
      "mm\" "
      "} }\n" +
          kAluminiumTable,
      "plate.toml");
  EXPECT_FALSE(rounded_outline(plate, outline_of(plate)).has_value());
}

// Where TetGen will mesh it, nothing is laid in layers, and the order is that of the forecast.
TEST(RoundBody, OfTetGenHasItsPlacesWithoutAMesh) {
  for (const std::string edge : {"40 mm", "2 mm"}) {
    const auto study = study::parse_study(
        round_of(kDisc, "mesh = { mesher = \"tetgen\", edge_length = \"" + edge + "\" }\n"),
        "round.toml");
    const auto outline = outline_of(study);
    const auto seen = rounded_outline(study, outline);
    ASSERT_TRUE(seen.has_value());
    EXPECT_EQ(seen->tet_count(), 0);
    EXPECT_EQ(seen->order(), edge == "2 mm" ? 2 : 3);
    const mesh::SiteFinder finder(*seen);
    for (int i = 0; i < 40; ++i) {
      const Eigen::Vector3d at(0.15 * std::cos(0.157 * i), 0.15 * std::sin(0.157 * i), -0.004);
      EXPECT_LT(finder.nearest(at).distance, 3e-5);
    }
  }
}

TEST(RoundBody, OfEitherMesherIsRoundAndHeavyEnough) {
  Work work;
  const double ball = std::numbers::pi / 6.0 * 0.008;
  for (const std::string rest : {"", "mesh = { mesher = \"tetgen\" }\n"}) {
    const auto study = study::parse_study(round_of(kBall, rest), "ball.toml");
    const auto outline = outline_of(study);
    EXPECT_NEAR(understood(study, outline).mass_kg / (2700.0 * ball), 1.0, 1e-12);
    const auto body = body_of(study, outline, work);
    EXPECT_NEAR(volume(body) / ball, 1.0, 3e-4) << rest;
    const auto seen = rounded_outline(study, outline);
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector3d at =
          0.1 * Eigen::Vector3d(std::sin(i), std::cos(2.0 * i), std::sin(3.0 + i)).normalized();
      EXPECT_LT(mesh::SiteFinder(*seen).nearest(at).distance, 1e-4);
      EXPECT_LT(mesh::SiteFinder(body).nearest(at).distance, 1e-4);
    }
  }
}

// A wall that a mesher's round faces bend over is refused, not solved.
TEST(RoundBody, ThinRingsAreMeshed) {
  Work work;
  for (const std::string hole : {"298 mm", "299.9 mm"}) {
    const auto study = study::parse_study(
        round_of("disc = { diameter = \"300 mm\", thickness = \"10 mm\", hole_diameter = \"" +
                     hole + "\" }",
                 ""),
        "ring.toml");
    const auto body = body_of(study, outline_of(study), work);
    const double inner = hole == "298 mm" ? 0.298 : 0.2999;
    const double exact = std::numbers::pi / 4.0 * (0.09 - inner * inner) * 0.01;
    EXPECT_NEAR(volume(body) / exact, 1.0, 1e-9);
  }
}

// A free disc with two nodal diameters (Leissa 1969, nu = 0.33). A wafer is so thin that 24 edges
// around the rim gave 1.2 % more, and an estimated error of 28 %.
TEST(RoundBody, AWaferAtTheDefaultBendsAsAThinPlate) {
  Work work;
  const auto wafer = round_of("disc = { diameter = \"300 mm\", thickness = \"775 um\" }",
                              "modes = { count = 2 }\n");
  const auto solution = solved(study::parse_study(wafer, "wafer.toml"), work);
  const double radius = 0.15;
  const double per_area = 70e9 * 0.775e-3 * 0.775e-3 / (12.0 * (1.0 - 0.33 * 0.33) * 2700.0);
  const double hz = 5.253 / (2.0 * std::numbers::pi * radius * radius) * std::sqrt(per_area);
  EXPECT_NEAR(solution.modes.frequency_hz(6) / hz, 1.0, 3e-3);
  EXPECT_NEAR(solution.modes.frequency_hz(7) / hz, 1.0, 3e-3);
  EXPECT_LT(solution.frequency_error(6), 0.02);
  EXPECT_LT(solution.degrees_of_freedom, 20000);
}

// A wide ring, one whose wall is thicker than it is high, and one that bends in its plane first. As
// full discs they were told to begin at 485, 648 and 1808 Hz.
TEST(RoundBody, TheFirstFrequencyOfARingIsThatOfItsModes) {
  Work work;
  for (const std::string hole : {"90 mm", "210 mm", "290 mm"}) {
    const auto study = study::parse_study(
        round_of("disc = { diameter = \"300 mm\", thickness = \"8 mm\", hole_diameter = \"" + hole +
                     "\" }",
                 "modes = { count = 2 }\n"),
        "ring.toml");
    const auto told = understood(study, outline_of(study));
    const auto solution = solved(study, work);
    EXPECT_NEAR(told.first_frequency_hz / solution.modes.frequency_hz(6), 1.0, 0.05) << hole;
    EXPECT_NE(told.line().find("300.0 x 300.0 x 8.0 mm (diameter 300.0 mm)"), std::string::npos);
    EXPECT_NE(told.line().find("first ring estimate"), std::string::npos) << told.line();
  }
}

std::string table_of(int pockets, const std::string& rest) {
  return fmt::format(
             "title = \"table\"\ngeometry = {{ wafer_table = {{ length = \"1 m\", width = \"1 m\", "
             "height = \"50 mm\", face_sheet = \"8 mm\", pockets = [{}, {}], rib = \"6 mm\" }} "
             "}}\n",
             pockets, pockets) +
         kAluminiumTable + rest;
}

// Elements are of the order that their cells are laid for.
TEST(LargeTable, IsSolvedWithTheOrderItIsLaidFor) {
  const auto laid = [](const std::string& rest) {
    const auto study = study::parse_study(table_of(19, rest), "table.toml");
    const auto outline = outline_of(study);
    return std::tuple(outline.shell.tet_count(), forecast(study, outline).order,
                      mesh::quality(outline.shell).shortest_edge);
  };
  const auto [tets, order, shortest] = laid("");
  EXPECT_GT(tets, 60000);
  EXPECT_EQ(order, 3);
  EXPECT_NEAR(shortest, 6e-3, 1e-6);
  const auto [more, second, across] = laid("mesh = { edge_length = \"24 mm\" }\n");
  EXPECT_GT(more, 60000);
  EXPECT_EQ(second, 2);
  EXPECT_NEAR(across, 3e-3, 1e-6);  // two cells through a rib
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
