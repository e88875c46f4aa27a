// The .vtu files of the verbs as VTK's own reader sees them: what ParaView opens.
#include <gtest/gtest.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataArray.h>
#include <vtkDoubleArray.h>
#include <vtkErrorCode.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkStringArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <cmath>
#include <set>

#include "io/json.h"
#include "placement/criteria.h"
#include "tests/app/program.h"
#include "tests/rotation/turn.h"

namespace chladni::app {
namespace {

using Grid = vtkSmartPointer<vtkUnstructuredGrid>;
using Names = std::set<std::string>;

const std::string kBody = R"(title = "plate <1> & co"
geometry = { plate = { length = "600 mm", width = "450 mm", thickness = "10 mm" } }
material = { youngs_modulus = "210 GPa", poissons_ratio = 0.3, density = "7850 kg/m^3" }
mesh = { edge_length = "90 mm", order = 2 }
modes = { count = 12, damping_ratio = 0.01 }
)";

const std::vector<std::pair<int, int>> kPlaces{{-250, 150}, {110, 40}, {240, -170},
                                               {-90, -60},  {40, 180}, {-200, -180}};

std::string channels() {
  std::string text;
  int number = 0;
  for (const auto& [x, y] : kPlaces) {
    text += "[[sensor]]\nname = \"s" + std::to_string(++number) + "\"\nat = [\"" +
            std::to_string(x) + " mm\", \"" + std::to_string(y) + " mm\"]\ndirection = \"z\"\n";
  }
  return text;
}

class VtuFiles : public CommandLine {
 protected:
  void ran(const std::string& verb, const std::string& study) const {
    write("study.toml", study);
    const auto end = run({verb, "study.toml", "--no-pictures", "-o", "out"});
    ASSERT_EQ(end.status, 0) << end.err;
  }

  Grid grid(const std::string& name) const {
    vtkNew<vtkXMLUnstructuredGridReader> reader;
    const auto file = folder_ / "out" / name;
    EXPECT_TRUE(fs::exists(file));
    EXPECT_NE(reader->CanReadFile(file.c_str()), 0) << file;
    reader->SetFileName(file.c_str());
    reader->Update();
    EXPECT_EQ(reader->GetErrorCode(), vtkErrorCode::NoError) << file;
    return reader->GetOutput();
  }

  io::Json json(const std::string& name) const {
    return io::parse_json(whole(folder_ / "out" / name));
  }
};

Names point_arrays(vtkUnstructuredGrid* grid) {
  Names names;
  for (int k = 0; k < grid->GetPointData()->GetNumberOfArrays(); ++k) {
    names.insert(grid->GetPointData()->GetArrayName(k));
  }
  return names;
}

// All cells have the type, and name points that are there.
void expect_cells(vtkUnstructuredGrid* grid, int type) {
  ASSERT_GT(grid->GetNumberOfCells(), 0);
  vtkNew<vtkIdList> nodes;
  for (vtkIdType c = 0; c < grid->GetNumberOfCells(); ++c) {
    ASSERT_EQ(grid->GetCellType(c), type);
    grid->GetCellPoints(c, nodes);
    for (vtkIdType k = 0; k < nodes->GetNumberOfIds(); ++k) {
      ASSERT_LT(nodes->GetId(k), grid->GetNumberOfPoints());
    }
  }
}

// An array of doubles with a value per point; returns it.
vtkDataArray* doubles(vtkUnstructuredGrid* grid, const std::string& name, int components) {
  vtkDataArray* array = grid->GetPointData()->GetArray(name.c_str());
  EXPECT_NE(array, nullptr) << name;
  if (array == nullptr) return nullptr;
  EXPECT_EQ(array->GetDataType(), VTK_DOUBLE) << name;
  EXPECT_EQ(array->GetNumberOfComponents(), components) << name;
  EXPECT_EQ(array->GetNumberOfTuples(), grid->GetNumberOfPoints()) << name;
  return array;
}

std::vector<std::string> words(vtkUnstructuredGrid* grid, const char* name) {
  auto* array = vtkStringArray::SafeDownCast(grid->GetFieldData()->GetAbstractArray(name));
  std::vector<std::string> all;
  for (vtkIdType k = 0; array != nullptr && k < array->GetNumberOfValues(); ++k) {
    all.push_back(array->GetValue(k));
  }
  return all;
}

void expect_bounds(vtkUnstructuredGrid* grid, double half_width, double low_z) {
  const double* box = grid->GetBounds();
  const std::array expected{-0.3, 0.3, -half_width, half_width, low_z, 0.0};
  for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(box[k], expected[k], 1e-12) << k;
}

void expect_within(vtkDataArray* array, double low, double high) {
  ASSERT_NE(array, nullptr);
  for (vtkIdType i = 0; i < array->GetNumberOfTuples(); ++i) {
    ASSERT_GE(array->GetTuple1(i), low) << array->GetName();
    ASSERT_LE(array->GetTuple1(i), high) << array->GetName();
  }
}

TEST_F(VtuFiles, OfTheMeshHaveRegionsAndPatches) {
  ran("mesh", kBody);
  const auto mesh = grid("mesh.vtu");
  const auto counts = json("mesh.json");
  EXPECT_EQ(mesh->GetNumberOfPoints(), counts.at("nodes").number());
  EXPECT_EQ(mesh->GetNumberOfCells(), counts.at("tetrahedra").number());
  expect_cells(mesh, VTK_QUADRATIC_TETRA);
  expect_bounds(mesh, 0.225, -0.01);
  EXPECT_EQ(point_arrays(mesh), Names{"patch"});
  auto* patch = mesh->GetPointData()->GetArray("patch");
  EXPECT_EQ(patch->GetDataType(), VTK_INT);
  const auto patches = words(mesh, "patch_names");
  expect_within(patch, -1.0, static_cast<double>(patches.size()) - 1.0);
  EXPECT_EQ(Names(patches.begin(), patches.end()),
            (Names{"top", "bottom", "x_min", "x_max", "y_min", "y_max"}));
  auto* region = mesh->GetCellData()->GetArray("region");
  ASSERT_NE(region, nullptr);
  EXPECT_EQ(region->GetNumberOfTuples(), mesh->GetNumberOfCells());
  EXPECT_EQ(words(mesh, "region_names"), std::vector<std::string>{"body"});
  EXPECT_FALSE(fs::exists(folder_ / "out/mesh.png"));
}

TEST_F(VtuFiles, OfTheMeshComeWithAPicture) {
  write("study.toml", kBody);
  const auto end = run({"mesh", "study.toml", "-o", "out"});
  ASSERT_EQ(end.status, 0) << end.err;
  EXPECT_TRUE(whole(folder_ / "out/mesh.png").starts_with("\x89PNG\r\n"));
}

TEST_F(VtuFiles, OfModesHaveAVectorPerModeAndTheFrequencies) {
  ran("modes", kBody + channels());
  const auto modes = grid("modes.vtu");
  const auto result = json("modes.json");
  const auto& hertz = result.at("frequency_hz").array();
  expect_cells(modes, VTK_QUADRATIC_TETRA);
  expect_bounds(modes, 0.225, -0.01);
  EXPECT_EQ(words(modes, "title"), std::vector<std::string>{"plate <1> & co"});
  EXPECT_EQ(words(modes, "units").size(), 3U);
  ASSERT_EQ(hertz.size(), 18U);
  EXPECT_EQ(point_arrays(modes).size(), 19U);  // and the patches
  auto* frequency = vtkDoubleArray::SafeDownCast(modes->GetFieldData()->GetArray("frequency_hz"));
  ASSERT_NE(frequency, nullptr);
  int vectors = 0;
  for (const auto& name : point_arrays(modes)) {
    if (!name.starts_with("mode_")) continue;
    ASSERT_NE(doubles(modes, name, 3), nullptr);
    const int mode = std::stoi(name.substr(5, 3)) - 1;
    const double stated = std::stod(name.substr(9));
    EXPECT_EQ(frequency->GetValue(mode), hertz[static_cast<std::size_t>(mode)].number());
    EXPECT_NEAR(stated, frequency->GetValue(mode), 0.0051);
    ++vectors;
  }
  EXPECT_EQ(vectors, 18);
  const auto places = grid("channels.vtu");
  EXPECT_EQ(places->GetNumberOfPoints(), 6);
  expect_cells(places, VTK_VERTEX);
  EXPECT_EQ(point_arrays(places).count("direction"), 1U);
  ASSERT_NE(places->GetPointData()->GetAbstractArray("name"), nullptr);
  for (int k = 0; k < 6; ++k) {
    EXPECT_NEAR(places->GetPoint(k)[0], 1e-3 * kPlaces[static_cast<std::size_t>(k)].first, 1e-12);
  }
}

TEST_F(VtuFiles, OfTheHeatMapHaveTheScoreOfEachCriterion) {
  ran("place", kBody + "[placement]\nmodes = 3\n");
  const auto map = grid("heat_map.vtu");
  expect_cells(map, VTK_TRIANGLE);
  expect_bounds(map, 0.225, 0.0);
  Names expected{"limiting_mode", "admissible"};
  for (const auto* criterion : placement::criteria()) expected.insert(std::string(criterion->name));
  EXPECT_EQ(point_arrays(map), expected);
  EXPECT_EQ(words(map, "units").size(), expected.size() - 1);  // the length, and each criterion's
  for (const auto& name : expected) static_cast<void>(doubles(map, name, 1));
  expect_within(map->GetPointData()->GetArray("limiting_mode"), 1.0, 3.0);
  expect_within(map->GetPointData()->GetArray("admissible"), 0.0, 1.0);
  // Its largest score is that of the best pair.
  const auto best = json("placement.json").at("best").array().front().at("score").number();
  const std::string chosen = json("placement.json").at("criterion").string();
  double range[2];
  map->GetPointData()->GetArray(chosen.c_str())->GetRange(range);
  EXPECT_LE(range[1], best * (1.0 + 1e-9));
  EXPECT_GE(range[1], 0.8 * best);
}

TEST_F(VtuFiles, OfInterpolatedShapesHaveMeanDeviationAndTruth) {
  write("truth.toml", kBody);
  ran("interpolate", kBody + "measurement = { truth = \"truth.toml\", modes = 3 }\n" + channels());
  const auto field = grid("mode_field.vtu");
  expect_cells(field, VTK_TRIANGLE);
  expect_bounds(field, 0.225, 0.0);
  const auto names = point_arrays(field);
  EXPECT_EQ(names.size(), 9U);
  for (const auto& name : names) {
    auto* values = doubles(field, name, 1);
    if (name.ends_with("_std")) expect_within(values, 0.0, INFINITY);
    if (!name.ends_with("_mean")) continue;
    const auto mode = name.substr(0, name.size() - 5);
    EXPECT_TRUE(names.contains(mode + "_std")) << mode;
    EXPECT_TRUE(names.contains(mode + "_truth")) << mode;
  }
}

// The hidden resonator of this study sits at (125, 115) mm.
TEST_F(VtuFiles, OfTheCauseHaveWhatEachPlaceExplains) {
  EVERY_EIGHTH_LANDING();
  const auto end = run({"diagnose", CHLADNI_SOURCE_DIR "/models/oat/with_hidden_effect/study.toml",
                        "--no-pictures", "-o", "out"});
  ASSERT_EQ(end.status, 0) << end.err;
  const auto map = grid("cause_map.vtu");
  expect_cells(map, VTK_TRIANGLE);
  expect_bounds(map, 0.3, 0.0);
  EXPECT_EQ(point_arrays(map), (Names{"explained", "posterior_per_m2"}));
  auto* explained = doubles(map, "explained", 1);
  expect_within(explained, -1e-9, 1.0 + 1e-9);
  expect_within(doubles(map, "posterior_per_m2", 1), 0.0, INFINITY);
  vtkIdType best = 0;
  for (vtkIdType i = 0; i < map->GetNumberOfPoints(); ++i) {
    if (explained->GetTuple1(i) > explained->GetTuple1(best)) best = i;
  }
  EXPECT_NEAR(map->GetPoint(best)[0], 0.125, 0.05);
  EXPECT_NEAR(map->GetPoint(best)[1], 0.115, 0.05);
}

}  // namespace
}  // namespace chladni::app
