// Writes unstructured grids with VTK.
#include "io/vtu.h"

#include <fmt/core.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDoubleArray.h>
#include <vtkErrorCode.h>
#include <vtkFieldData.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkStringArray.h>
#include <vtkTypeInt32Array.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "host/atomic_file.h"
#include "io/bytes/escape.h"
#include "io/cells/quadratic.h"
#include "mesh/surface.h"

namespace chladni::io {
namespace {

using DoubleArray = vtkSmartPointer<vtkDoubleArray>;

// A VTK array that views `values`, which must outlive it.
DoubleArray view(const std::string& name, const double* values, Eigen::Index count, int columns) {
  auto array = DoubleArray::New();
  array->SetName(name.c_str());
  array->SetNumberOfComponents(columns);
  // VTK's interface needs a non-const pointer, but it does not change the values here (save = 1: it
  // does not free them).
  array->SetArray(const_cast<double*>(values), count, 1);
  return array;
}

void add_words(vtkFieldData* data, const char* name, const std::vector<std::string>& words) {
  vtkNew<vtkStringArray> array;
  array->SetName(name);
  for (const std::string& word : words) array->InsertNextValue(word);
  data->AddArray(array);
}

void set_points(vtkUnstructuredGrid* grid, const Points& points) {
  vtkNew<vtkPoints> holder;
  holder->SetData(view("Points", points.data(), points.size(), 3));
  grid->SetPoints(holder);
}

// A grid that views the arrays of `mesh` (orders 1 and 2), which must outlive it.
vtkSmartPointer<vtkUnstructuredGrid> grid_of(const mesh::TetMesh& mesh, const Units& units) {
  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  set_points(grid, mesh.points);
  vtkNew<vtkTypeInt32Array> nodes, offsets;
  nodes->SetArray(const_cast<std::int32_t*>(mesh.tets.data()), mesh.tets.size(), 1);
  offsets->SetNumberOfValues(mesh.tets.rows() + 1);
  for (Eigen::Index t = 0; t <= mesh.tets.rows(); ++t) {
    offsets->SetValue(t, static_cast<std::int32_t>(t * mesh.tets.cols()));
  }
  vtkNew<vtkCellArray> cells;
  cells->SetData(offsets, nodes);
  grid->SetCells(mesh.order() == 1 ? VTK_TETRA : VTK_QUADRATIC_TETRA, cells);

  vtkNew<vtkIntArray> region;
  region->SetName("region");
  region->SetNumberOfValues(mesh.tets.rows());
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) region->SetValue(t, mesh.region(t));
  grid->GetCellData()->AddArray(region);

  if (!units.title.empty()) add_words(grid->GetFieldData(), "title", {units.title});
  add_words(grid->GetFieldData(), "units", units.lines);
  add_words(grid->GetFieldData(), "region_names", mesh.region_names);
  return grid;
}

// For each node of the boundary its patch, on a border the smaller patch; -1 inside.
vtkSmartPointer<vtkIntArray> patches_of(const mesh::TetMesh& mesh) {
  std::vector<int> size(mesh.patch_names.size(), 0);
  for (const int patch : mesh.face_patch) ++size[static_cast<std::size_t>(patch)];
  auto array = vtkSmartPointer<vtkIntArray>::New();
  array->SetName("patch");
  array->SetNumberOfValues(mesh.node_count());
  array->FillValue(-1);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    const int patch = mesh.face_patch(f);
    for (const std::int32_t node : mesh.faces.row(f)) {
      const int known = array->GetValue(node);
      const bool smaller = known < 0 || size[static_cast<std::size_t>(patch)] <
                                            size[static_cast<std::size_t>(known)];
      if (smaller) array->SetValue(node, patch);
    }
  }
  return array;
}

// Adds the patches where the boundary has any.
void add_patches(vtkUnstructuredGrid* grid, const mesh::TetMesh& mesh) {
  if (mesh.faces.rows() == 0 || mesh.face_patch.size() != mesh.faces.rows()) return;
  grid->GetPointData()->AddArray(patches_of(mesh));
  add_words(grid->GetFieldData(), "patch_names", mesh.patch_names);
}

// Writes raw appended blocks, deflated at the fastest level. The last bits of a shape are noise, so
// a higher level makes the file only 3 % smaller and takes three times as long.
void write(const std::filesystem::path& file, vtkUnstructuredGrid* grid) {
  write_atomically_at(file, [&](const std::filesystem::path& temporary) {
    vtkNew<vtkXMLUnstructuredGridWriter> writer;
    writer->SetFileName(temporary.c_str());
    writer->SetDataModeToAppended();
    writer->EncodeAppendedDataOff();
    writer->SetCompressorTypeToZLib();
    writer->SetCompressionLevel(1);
    writer->SetHeaderTypeToUInt64();
    writer->SetInputData(grid);
    vtkObject::GlobalWarningDisplayOff();  // errors are queried, not printed
    if (writer->Write() == 1 && writer->GetErrorCode() == vtkErrorCode::NoError) return;
    throw OutOfResources(file.string() + ": cannot be written: " +
                         vtkErrorCode::GetStringFromErrorCode(writer->GetErrorCode()));
  });
}

void require_rows(const mesh::TetMesh& mesh, const NodeField& field) {
  const Eigen::Index rows = field.values.size(), nodes = mesh.node_count();
  require(rows == nodes || rows == 3 * nodes,
          fmt::format("field \"{}\" has {} rows, expected {} or {} (3 per node)", field.name, rows,
                      nodes, 3 * nodes));
}

void require_shapes(const mesh::TetMesh& mesh, const modal::Modes& modes) {
  require(modes.shapes.rows() == 3 * mesh.node_count(),
          fmt::format("the modes have {} rows, expected 3 per node of the mesh: {}",
                      modes.shapes.rows(), 3 * mesh.node_count()));
  require(modes.shapes.cols() == modes.mode_count(),
          fmt::format("there are {} mode shapes and {} frequencies", modes.shapes.cols(),
                      modes.mode_count()));
}

// Adds a field (3·nodes or nodes rows) of the original mesh. `kept` keeps the data that the grid
// views.
void add_field(vtkUnstructuredGrid* grid, const QuadraticCells& cells, const std::string& name,
               const Eigen::Ref<const Eigen::VectorXd>& values, Eigen::Index nodes,
               std::vector<Eigen::VectorXd>& kept) {
  const int columns = values.size() == nodes ? 1 : 3;
  const double* data = values.data();
  Eigen::Index size = values.size();
  if (cells.is_other()) {
    kept.push_back(cells.field(values));
    data = kept.back().data();
    size = kept.back().size();
  }
  grid->GetPointData()->AddArray(view(name, data, size, columns));
}

}  // namespace

std::string mode_name(Eigen::Index index, double frequency_hz) {
  return fmt::format("mode_{:03}_{:.2f}Hz", index + 1, frequency_hz);
}

void write_vtu(const std::filesystem::path& file, const mesh::TetMesh& mesh,
               const std::vector<NodeField>& fields, const Units& units) {
  for (const NodeField& field : fields) require_rows(mesh, field);
  const QuadraticCells cells(mesh);
  const auto grid = grid_of(cells.mesh(), units);
  add_patches(grid, cells.mesh());
  std::vector<Eigen::VectorXd> kept;
  kept.reserve(fields.size());
  for (const NodeField& field : fields) {
    add_field(grid, cells, field.name, field.values, mesh.node_count(), kept);
  }
  write(file, grid);
}

void write_modes_vtu(const std::filesystem::path& file, const mesh::TetMesh& mesh,
                     const modal::Modes& modes, const std::string& title) {
  require_shapes(mesh, modes);
  const QuadraticCells cells(mesh);
  const auto grid = grid_of(
      cells.mesh(), {title, {"length: m", "mode shapes: kg^-1/2, mass-normalised", "region: -"}});
  add_patches(grid, cells.mesh());
  std::vector<Eigen::VectorXd> kept;
  kept.reserve(static_cast<std::size_t>(modes.mode_count()));
  for (Eigen::Index k = 0; k < modes.mode_count(); ++k) {
    add_field(grid, cells, mode_name(k, modes.frequency_hz(k)), modes.shapes.col(k),
              mesh.node_count(), kept);
  }
  grid->GetFieldData()->AddArray(
      view("frequency_hz", modes.frequency_hz.data(), modes.mode_count(), 1));
  write(file, grid);
}

void write_animation(const std::filesystem::path& file, const mesh::TetMesh& mesh,
                     const modal::Modes& modes, Eigen::Index index, int frames) {
  require_shapes(mesh, modes);
  require(0 <= index && index < modes.mode_count(),
          fmt::format("mode {} is to be animated, there are {}", index + 1, modes.mode_count()));
  require(2 <= frames && frames <= 999,
          fmt::format("an animation of {} frames, expected 2 to 999", frames));
  const QuadraticCells cells(mesh);
  mesh::TetMesh moved = cells.mesh();
  const Points rest = moved.points;
  const Eigen::VectorXd field = cells.field(modes.shapes.col(index));
  const Eigen::Map<const Points> shape(field.data(), rest.rows(), 3);
  const auto box = mesh::bounding_box(rest);
  const double largest = shape.rowwise().norm().maxCoeff();
  const double scale = largest > 0.0 ? 0.06 * (box.row(1) - box.row(0)).norm() / largest : 0.0;
  const Units units{mode_name(index, modes.frequency_hz(index)),
                    {"length: m", "displacement: m, scaled to 6 % of the body's diagonal"}};

  std::string list =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" "
      "byte_order=\"LittleEndian\">\n  <Collection>\n";
  for (int frame = 0; frame < frames; ++frame) {
    const double phase = static_cast<double>(frame) / frames;
    NodeField motion{"displacement", scale * std::cos(2.0 * std::numbers::pi * phase) * field};
    moved.points = rest + Eigen::Map<const Points>(motion.values.data(), rest.rows(), 3);
    const std::string name = fmt::format("{}_{:02}.vtu", file.stem().string(), frame);
    write_vtu(file.parent_path() / name, moved, {motion}, units);
    list += fmt::format("    <DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", phase,
                        escaped(name));
  }
  write_atomically(file, list + "  </Collection>\n</VTKFile>\n");
}

void write_surface_vtu(const std::filesystem::path& file, const Points& points,
                       const Cells& triangles, const std::vector<NodeField>& fields,
                       const Units& units) {
  vtkNew<vtkUnstructuredGrid> grid;
  set_points(grid, points);
  grid->Allocate(triangles.rows());
  for (const auto row : triangles.rowwise()) {
    const std::array<vtkIdType, 3> corners{row(0), row(1), row(2)};
    grid->InsertNextCell(VTK_TRIANGLE, 3, corners.data());
  }
  for (const NodeField& field : fields) {
    require(field.values.size() == points.rows(),
            fmt::format("field \"{}\" has {} rows, expected one per point: {}", field.name,
                        field.values.size(), points.rows()));
    grid->GetPointData()->AddArray(view(field.name, field.values.data(), field.values.size(), 1));
  }
  if (!units.title.empty()) add_words(grid->GetFieldData(), "title", {units.title});
  add_words(grid->GetFieldData(), "units", units.lines);
  write(file, grid);
}

void write_markers_vtu(const std::filesystem::path& file, const std::vector<Marker>& markers) {
  Points points(static_cast<Eigen::Index>(markers.size()), 3), directions(points.rows(), 3);
  vtkNew<vtkStringArray> names, kinds;
  names->SetName("name");
  kinds->SetName("kind");
  vtkNew<vtkUnstructuredGrid> grid;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const Marker& marker = markers[static_cast<std::size_t>(i)];
    points.row(i) = marker.position;
    directions.row(i) = marker.direction;
    names->InsertNextValue(marker.name);
    kinds->InsertNextValue(marker.kind);
  }
  set_points(grid, points);
  grid->Allocate(points.rows());
  for (vtkIdType i = 0; i < points.rows(); ++i) grid->InsertNextCell(VTK_VERTEX, 1, &i);
  grid->GetPointData()->AddArray(view("direction", directions.data(), directions.size(), 3));
  grid->GetPointData()->AddArray(names);
  grid->GetPointData()->AddArray(kinds);
  write(file, grid);
}

}  // namespace chladni::io
