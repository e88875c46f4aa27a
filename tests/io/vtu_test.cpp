#include "io/vtu.h"

#include <gtest/gtest.h>
#include <unistd.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkStringArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "base/error.h"
#include "host/atomic_file.h"
#include "io/read.h"
#include "mesh/bodies.h"
#include "mesh/surface.h"

namespace chladni::io {
namespace {

namespace fs = std::filesystem;

class Vtu : public testing::Test {
 protected:
  Vtu() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() /
              ("chladni_vtu_" + std::string(test->name()) + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  ~Vtu() override { fs::remove_all(folder_); }
  [[nodiscard]] fs::path file(const std::string& name) const { return folder_ / name; }

  fs::path folder_;
};

mesh::TetMesh vtu_plate(int order) {
  mesh::TetMesh mesh = with_order(mesh::layered(mesh::Plate{0.3, 0.2, 0.02}, 0.1, 1), order);
  for (Eigen::Index t = 0; t < mesh.tet_count(); ++t) mesh.region(t) = static_cast<int>(t % 2);
  mesh.region_names = {"body", "wafer"};
  return mesh;
}

// A field that no polynomial of degree 2 equals, in metres.
Eigen::VectorXd cubic_field(const Points& points) {
  Points field(points.rows(), 3);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const double x = points(i, 0), y = points(i, 1), z = points(i, 2);
    field.row(i) << x * x * y - z, y * y * y + 2.0, x * y * z + z * z - x;
  }
  return Eigen::Map<Eigen::VectorXd>(field.data(), field.size());
}

modal::Modes two_modes(const mesh::TetMesh& mesh) {
  modal::Modes modes;
  modes.frequency_hz = Eigen::Vector2d(0.0, 178.9199);
  modes.damping_ratio = Eigen::Vector2d::Zero();
  modes.shapes.resize(3 * mesh.node_count(), 2);
  modes.shapes.col(0).setOnes();
  modes.shapes.col(1) = cubic_field(mesh.points);
  modes.rigid_count = 1;
  return modes;
}

vtkSmartPointer<vtkUnstructuredGrid> grid_in(const fs::path& file) {
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  return reader->GetOutput();
}

double distance_from(vtkUnstructuredGrid* grid, const std::string& name,
                     const std::function<Eigen::VectorXd(const Points&)>& field) {
  vtkDataArray* array = grid->GetPointData()->GetArray(name.c_str());
  if (array == nullptr) return INFINITY;
  Points points(grid->GetNumberOfPoints(), 3), values(grid->GetNumberOfPoints(), 3);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    grid->GetPoint(i, points.row(i).data());
    array->GetTuple(i, values.row(i).data());
  }
  const Eigen::VectorXd expected = field(points);
  return (Eigen::Map<Eigen::VectorXd>(values.data(), values.size()) - expected)
      .cwiseAbs()
      .maxCoeff();
}

std::string failure(const fs::path& file) {
  try {
    static_cast<void>(read_vtu(file));
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST_F(Vtu, AModesNameCountsFromOneWithTheRigidOnes) {
  EXPECT_EQ(mode_name(6, 178.9199), "mode_007_178.92Hz");
  EXPECT_EQ(mode_name(0, 0.0), "mode_001_0.00Hz");
}

TEST_F(Vtu, AMeshReadsBackBitByBit) {
  for (const int order : {1, 2}) {
    const mesh::TetMesh there = vtu_plate(order);
    write_vtu(file("mesh.vtu"), there, {});
    const mesh::TetMesh back = read_vtu(file("mesh.vtu"));
    EXPECT_EQ(back.points, there.points);
    EXPECT_EQ(back.tets, there.tets);
    EXPECT_EQ(back.region, there.region);
    EXPECT_EQ(back.region_names, there.region_names);
    EXPECT_NO_THROW(mesh::check(back));
  }
}

// Nodes inside have none; on a border the smaller patch counts.
TEST_F(Vtu, TheBoundarysNodesKnowTheirPatches) {
  for (const int order : {1, 2, 3}) {
    const mesh::TetMesh mesh =
        with_order(mesh::layered(mesh::Plate{0.3, 0.2, 0.02}, 0.05, 2), order);
    write_modes_vtu(file("modes.vtu"), mesh, two_modes(mesh));
    const auto grid = grid_in(file("modes.vtu"));
    auto* names =
        vtkStringArray::SafeDownCast(grid->GetFieldData()->GetAbstractArray("patch_names"));
    auto* patch = grid->GetPointData()->GetArray("patch");
    ASSERT_NE(names, nullptr);
    ASSERT_NE(patch, nullptr);
    for (vtkIdType i = 0; i < grid->GetNumberOfPoints(); ++i) {
      const Eigen::Array3d at = Eigen::Map<Eigen::Array3d>(grid->GetPoint(i));
      const Eigen::Array3d off =
          (at - Eigen::Array3d(0.0, 0.0, -0.01)).abs() / Eigen::Array3d(0.15, 0.1, 0.01);
      const double number = patch->GetTuple1(i);
      if (off.maxCoeff() < 1.0 - 1e-9) {
        EXPECT_EQ(number, -1.0);
        continue;
      }
      const std::string name = names->GetValue(static_cast<vtkIdType>(number));
      const bool on_y_side = off.x() < 1.0 - 1e-9 && off.y() > 1.0 - 1e-9;
      if (off.x() > 1.0 - 1e-9) EXPECT_EQ(name, at.x() > 0.0 ? "x_max" : "x_min");
      if (on_y_side) EXPECT_EQ(name, at.y() > 0.0 ? "y_max" : "y_min");
      if (off.head<2>().maxCoeff() < 1.0 - 1e-9) EXPECT_EQ(name, at.z() > -0.01 ? "top" : "bottom");
    }
  }
}

TEST_F(Vtu, ACubicMeshIsWrittenAsQuadraticCells) {
  write_vtu(file("mesh.vtu"), vtu_plate(3), {});
  const mesh::TetMesh back = read_vtu(file("mesh.vtu")), expected = vtu_plate(2);
  EXPECT_EQ(back.order(), 2);
  EXPECT_EQ(back.node_count(), expected.node_count());
  EXPECT_NEAR(mesh::volume(back), 0.3 * 0.2 * 0.02, 1e-15);
  EXPECT_NO_THROW(mesh::check(back));
}

TEST_F(Vtu, TheArraysOfTheModesHoldTheShapes) {
  for (const int order : {1, 2, 3}) {
    const mesh::TetMesh mesh = vtu_plate(order);
    write_modes_vtu(file("modes.vtu"), mesh, two_modes(mesh), "a <plate> & \"more\"");
    const auto grid = grid_in(file("modes.vtu"));
    EXPECT_EQ(grid->GetCellType(0), order == 1 ? 10 : 24);
    EXPECT_EQ(grid->GetPointData()->GetNumberOfArrays(), 3);  // and the patches
    EXPECT_LT(distance_from(grid, "mode_002_178.92Hz", cubic_field), 1e-15) << order;
    EXPECT_EQ(distance_from(grid, "mode_001_0.00Hz",
                            [](const Points& p) { return Eigen::VectorXd::Ones(p.size()); }),
              0.0);
    EXPECT_EQ(grid->GetFieldData()->GetArray("frequency_hz")->GetComponent(1, 0), 178.9199);
    auto* title = vtkStringArray::SafeDownCast(grid->GetFieldData()->GetAbstractArray("title"));
    ASSERT_NE(title, nullptr);
    EXPECT_EQ(title->GetValue(0), "a <plate> & \"more\"");
  }
}

TEST_F(Vtu, AFieldOfOneValuePerNodeHasOneComponent) {
  const mesh::TetMesh mesh = vtu_plate(2);
  write_vtu(file("heat.vtu"), mesh, {{"score", mesh.points.col(0)}});
  const auto grid = grid_in(file("heat.vtu"));
  vtkDataArray* score = grid->GetPointData()->GetArray("score");
  ASSERT_NE(score, nullptr);
  EXPECT_EQ(score->GetNumberOfComponents(), 1);
  EXPECT_EQ(score->GetComponent(5, 0), mesh.points(5, 0));
}

TEST_F(Vtu, TheSameInputGivesTheSameBytes) {
  const mesh::TetMesh mesh = vtu_plate(3);
  write_modes_vtu(file("a.vtu"), mesh, two_modes(mesh), "title");
  const std::string first = read_whole(file("a.vtu"));
  for (int i = 0; i < 5; ++i) {
    write_modes_vtu(file("b.vtu"), mesh, two_modes(mesh), "title");
    ASSERT_EQ(read_whole(file("b.vtu")), first);
  }
}

TEST_F(Vtu, TheFileIsCompressedAndAppended) {
  const mesh::TetMesh mesh = vtu_plate(2);
  write_vtu(file("a.vtu"), mesh, {});
  const std::string bytes = read_whole(file("a.vtu"));
  EXPECT_NE(bytes.find("vtkZLibDataCompressor"), std::string::npos);
  EXPECT_NE(bytes.find("<AppendedData encoding=\"raw\">"), std::string::npos);
}

TEST_F(Vtu, AnAnimationSwingsOnceThroughItsFrames) {
  const mesh::TetMesh mesh = vtu_plate(3);
  const modal::Modes modes = two_modes(mesh);
  write_animation(file("mode.pvd"), mesh, modes, 1, 8);
  const auto box = mesh::bounding_box(mesh.points);
  const double amplitude = 0.06 * (box.row(1) - box.row(0)).norm();
  const std::string list = read_whole(file("mode.pvd"));
  for (int frame = 0; frame < 8; ++frame) {
    const std::string name = "mode_0" + std::to_string(frame) + ".vtu";
    EXPECT_NE(list.find("file=\"" + name + "\""), std::string::npos);
    const auto grid = grid_in(file(name));
    vtkDataArray* moved = grid->GetPointData()->GetArray("displacement");
    double largest = 0.0;
    for (vtkIdType i = 0; i < moved->GetNumberOfTuples(); ++i) {
      largest = std::max(largest, Eigen::Vector3d(moved->GetTuple3(i)).norm());
    }
    EXPECT_NEAR(largest, amplitude * std::abs(std::cos(frame * std::numbers::pi / 4.0)),
                2e-3 * amplitude);
  }
}

TEST_F(Vtu, MarkersKeepNamesKindsAndDirections) {
  const std::vector<Marker> markers{{"s<1>", "sensor", {0.1, 0.2, 0.0}, {0.0, 0.0, 1.0}},
                                    {"a1", "actuator", {0.3, 0.4, -0.1}, {1.0, 0.0, 0.0}}};
  write_markers_vtu(file("channels.vtu"), markers);
  const auto grid = grid_in(file("channels.vtu"));
  ASSERT_EQ(grid->GetNumberOfPoints(), 2);
  auto* names = vtkStringArray::SafeDownCast(grid->GetPointData()->GetAbstractArray("name"));
  ASSERT_NE(names, nullptr);
  EXPECT_EQ(names->GetValue(0), "s<1>");
  EXPECT_EQ(grid->GetPointData()->GetArray("direction")->GetComponent(1, 0), 1.0);
  EXPECT_EQ(Eigen::Vector3d(grid->GetPoint(1)), markers[1].position);
  write_markers_vtu(file("none.vtu"), {});
  EXPECT_EQ(grid_in(file("none.vtu"))->GetNumberOfPoints(), 0);
}

TEST_F(Vtu, AFieldThatDoesNotFitIsNamed) {
  const mesh::TetMesh mesh = vtu_plate(2);
  EXPECT_THROW(write_vtu(file("a.vtu"), mesh, {{"short", Eigen::VectorXd::Ones(7)}}), InvalidInput);
  modal::Modes modes = two_modes(mesh);
  modes.shapes.conservativeResize(modes.shapes.rows() - 1, 2);
  EXPECT_THROW(write_modes_vtu(file("a.vtu"), mesh, modes), InvalidInput);
  EXPECT_THROW(write_animation(file("a.pvd"), mesh, two_modes(mesh), 2), InvalidInput);
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(Vtu, AFolderThatIsNotThereIsNamed) {
  EXPECT_THROW(write_vtu(folder_ / "no" / "a.vtu", vtu_plate(1), {}), InvalidInput);
}

TEST_F(Vtu, WhatIsNoVtuIsRefused) {
  EXPECT_NE(failure(file("missing.vtu")).find("there is no such file"), std::string::npos);
  EXPECT_NE(failure(folder_).find("not a regular one"), std::string::npos);
  for (const std::string content : {"", "solid cube", "<VTKFile type=\"PolyData\"></VTKFile>"}) {
    write_atomically(file("a.vtu"), content);
    EXPECT_NE(failure(file("a.vtu")).find("a.vtu: "), std::string::npos) << content;
  }
}

TEST_F(Vtu, ACutFileIsRefusedWhereverItIsCut) {
  write_vtu(file("whole.vtu"), vtu_plate(2), {});
  const std::string whole = read_whole(file("whole.vtu"));
  const std::size_t end = whole.rfind("</AppendedData>");
  for (int i = 0; i < 12; ++i) {
    write_atomically(file("cut.vtu"), whole.substr(0, end * static_cast<std::size_t>(i) / 12));
    EXPECT_NE(failure(file("cut.vtu")), "") << i;
  }
}

// Whatever a flipped byte does, the answer is a mesh that passes the check or InvalidInput.
TEST_F(Vtu, ADamagedFileNeverGivesADamagedMesh) {
  write_vtu(file("whole.vtu"), vtu_plate(1), {});
  const std::string whole = read_whole(file("whole.vtu"));
  std::mt19937 random(5);
  for (int i = 0; i < 25; ++i) {
    std::string damaged = whole;
    damaged[random() % damaged.size()] = static_cast<char>(random() % 256);
    write_atomically(file("damaged.vtu"), damaged);
    try {
      EXPECT_GT(read_vtu(file("damaged.vtu")).tet_count(), 0);
    } catch (const InvalidInput&) {
    }
  }
}

std::string ascii_grid(const std::string& points, const std::string& cells, const std::string& at,
                       const std::string& offsets, const std::string& types) {
  return "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\"><UnstructuredGrid><Piece "
         "NumberOfPoints=\"" +
         points + "\" NumberOfCells=\"" + cells +
         "\"><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">"
         "0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points><Cells>"
         "<DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">" +
         at + "</DataArray><DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">" + offsets +
         "</DataArray><DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">" + types +
         "</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>";
}

TEST_F(Vtu, OnlyTetrahedraAndFlatCellsAreTaken) {
  write_atomically(file("a.vtu"), ascii_grid("4", "2", "0 1 2 3 0 1 2", "4 7", "10 5"));
  const mesh::TetMesh mesh = read_vtu(file("a.vtu"));
  EXPECT_EQ(mesh.tet_count(), 1);
  EXPECT_EQ(mesh.faces.rows(), 4);
  EXPECT_NEAR(mesh::volume(mesh), 1.0 / 6.0, 1e-15);
  write_atomically(file("b.vtu"), ascii_grid("4", "1", "0 1 2 3 0", "5", "14"));
  EXPECT_NE(failure(file("b.vtu")).find("cell 0 is a pyramid (VTK type 14)"), std::string::npos);
  write_atomically(file("c.vtu"), ascii_grid("4", "1", "0 1 2", "3", "5"));
  EXPECT_NE(failure(file("c.vtu")).find("no tetrahedron among 1 cells"), std::string::npos);
}

TEST_F(Vtu, WhatTheReaderChangesIsNoted) {
  write_atomically(file("a.vtu"), ascii_grid("4", "2", "0 2 1 3 0 2 1 3", "4 8", "10 10"));
  const Geometry found = read_geometry(file("a.vtu"), "m");
  ASSERT_EQ(found.notes.size(), 2U);
  EXPECT_NE(found.notes[0].find("1 element repeated another's corners"), std::string::npos);
  EXPECT_NE(found.notes[1].find("all 1 elements were inside out"), std::string::npos);
}

TEST_F(Vtu, CountsThatLieAreRefused) {
  write_atomically(file("a.vtu"), ascii_grid("4", "1", "0 1 2 9", "4", "10"));
  EXPECT_NE(failure(file("a.vtu")).find("cell 0 names point 9, there are 4"), std::string::npos)
      << failure(file("a.vtu"));
  write_atomically(file("b.vtu"), ascii_grid("4", "1", "0 1 2 3", "4000000", "10"));
  EXPECT_NE(failure(file("b.vtu")), "");
  write_atomically(file("c.vtu"), ascii_grid("4000000000", "1", "0 1 2 3", "4", "10"));
  EXPECT_NE(failure(file("c.vtu")), "");
  write_atomically(file("d.vtu"), ascii_grid("-4", "1", "0 1 2 3", "4", "10"));
  EXPECT_NE(failure(file("d.vtu")), "");
}

}  // namespace
}  // namespace chladni::io
