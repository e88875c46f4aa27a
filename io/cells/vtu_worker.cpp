// The program chladni-vtu reads the .vtu file named on its command line with VTK, checks every
// count, and writes points, tetrahedra and regions to stdout. A crash of it does no harm.
#include <fmt/core.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>
#include <vtkPoints.h>
#include <vtkStringArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <cstdio>
#include <exception>
#include <iostream>
#include <map>

#include "base/error.h"
#include "io/bytes/message.h"

namespace {

using chladni::require;
using chladni::io::Message;

// VTK's reader continues after an error with the data that it has. Here the first error is kept, so
// that the worker can refuse the file.
class FirstError : public vtkOutputWindow {
 public:
  static FirstError* New() { return new FirstError; }
  void DisplayErrorText(const char* text) override { note(text); }
  void DisplayGenericWarningText(const char* text) override { note(text); }
  void DisplayWarningText(const char* text) override { note(text); }
  [[nodiscard]] const std::string& message() const { return message_; }

 private:
  void note(std::string text) {
    while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
    const std::size_t from = text.find("): ");  // after file, line and object
    if (message_.empty()) message_ = from == std::string::npos ? text : text.substr(from + 3);
  }
  std::string message_;
};

struct Kind {
  const char* name;
  int tet_nodes;  // 0: flat cell, skipped; −1: a solid that is no tetrahedron
};

Kind kind(int type) {
  static const std::map<int, Kind> kinds{{VTK_TETRA, {"tetra", 4}},
                                         {VTK_QUADRATIC_TETRA, {"quadratic tetra", 10}},
                                         {VTK_LAGRANGE_TETRAHEDRON, {"Lagrange tetra", 20}},
                                         {VTK_VERTEX, {"vertex", 0}},
                                         {VTK_POLY_VERTEX, {"vertices", 0}},
                                         {VTK_LINE, {"line", 0}},
                                         {VTK_POLY_LINE, {"lines", 0}},
                                         {VTK_QUADRATIC_EDGE, {"quadratic edge", 0}},
                                         {VTK_TRIANGLE, {"triangle", 0}},
                                         {VTK_QUADRATIC_TRIANGLE, {"quadratic triangle", 0}},
                                         {VTK_LAGRANGE_TRIANGLE, {"Lagrange triangle", 0}},
                                         {VTK_QUAD, {"quadrilateral", 0}},
                                         {VTK_QUADRATIC_QUAD, {"quadratic quadrilateral", 0}},
                                         {VTK_HEXAHEDRON, {"hexahedron", -1}},
                                         {VTK_QUADRATIC_HEXAHEDRON, {"quadratic hexahedron", -1}},
                                         {VTK_VOXEL, {"voxel", -1}},
                                         {VTK_WEDGE, {"wedge", -1}},
                                         {VTK_QUADRATIC_WEDGE, {"quadratic wedge", -1}},
                                         {VTK_PYRAMID, {"pyramid", -1}}};
  const auto found = kinds.find(type);
  return found == kinds.end() ? Kind{"cell of an unknown type", -1} : found->second;
}

// The cells that are tetrahedra. All must have one order.
std::vector<vtkIdType> tets_of(vtkUnstructuredGrid* grid) {
  std::vector<vtkIdType> tets;
  vtkCellArray* cells = grid->GetCells();
  int order_type = -1;
  for (vtkIdType c = 0; c < grid->GetNumberOfCells(); ++c) {
    const int type = grid->GetCellType(c);
    const Kind is = kind(type);
    require(is.tet_nodes >= 0, fmt::format("cell {} is a {} (VTK type {}), expected tetrahedra of "
                                           "4, 10 or 20 nodes (types 10, 24, 71)",
                                           c, is.name, type));
    if (is.tet_nodes == 0) continue;
    const vtkIdType size = cells->GetCellSize(c);
    require(size == is.tet_nodes, fmt::format("cell {}, a {}, has {} nodes, expected {}", c,
                                              is.name, size, is.tet_nodes));
    if (order_type < 0) order_type = type;
    require(type == order_type,
            fmt::format("cell {} is a {}, cells before it are {}s; expected one "
                        "kind",
                        c, is.name, kind(order_type).name));
    tets.push_back(c);
  }
  require(!tets.empty(), fmt::format("no tetrahedron among {} cells and {} points",
                                     grid->GetNumberOfCells(), grid->GetNumberOfPoints()));
  return tets;
}

// Checks that the offsets ascend within the connectivity, because VTK itself does not check this.
void require_sound_cells(vtkUnstructuredGrid* grid) {
  vtkCellArray* cells = grid->GetCells();
  require(cells != nullptr && cells->GetNumberOfCells() == grid->GetNumberOfCells(),
          "there are no cells in it");
  const auto entries = static_cast<double>(cells->GetNumberOfConnectivityIds());
  double last = 0.0;
  for (vtkIdType c = 0; c <= cells->GetNumberOfCells(); ++c) {
    const double offset = cells->GetOffsetsArray()->GetComponent(c, 0);
    require(last <= offset && offset <= entries && (c > 0 || offset == 0.0),
            fmt::format("offset {} of the cells is {}, there are {} entries", c, offset, entries));
    last = offset;
  }
}

chladni::Cells nodes_of(vtkUnstructuredGrid* grid, const std::vector<vtkIdType>& tets) {
  vtkNew<vtkIdList> ids;
  grid->GetCells()->GetCellAtId(tets.front(), ids);
  chladni::Cells nodes(static_cast<Eigen::Index>(tets.size()), ids->GetNumberOfIds());
  for (Eigen::Index t = 0; t < nodes.rows(); ++t) {
    grid->GetCells()->GetCellAtId(tets[static_cast<std::size_t>(t)], ids);
    for (Eigen::Index a = 0; a < nodes.cols(); ++a) {
      const vtkIdType node = ids->GetId(a);
      require(0 <= node && node < grid->GetNumberOfPoints(),
              fmt::format("cell {} names point {}, there are {}", tets[static_cast<std::size_t>(t)],
                          node, grid->GetNumberOfPoints()));
      nodes(t, a) = static_cast<std::int32_t>(node);
    }
  }
  return nodes;
}

chladni::Cells region_of(vtkUnstructuredGrid* grid, const std::vector<vtkIdType>& tets) {
  chladni::Cells region = chladni::Cells::Zero(static_cast<Eigen::Index>(tets.size()), 1);
  vtkDataArray* array = grid->GetCellData()->GetArray("region");
  if (array == nullptr || array->GetNumberOfTuples() != grid->GetNumberOfCells()) return region;
  for (Eigen::Index t = 0; t < region.rows(); ++t) {
    const double value = array->GetComponent(tets[static_cast<std::size_t>(t)], 0);
    require(value >= 0.0 && value < 1e6, fmt::format("region {} of cell {}, expected 0 to 10^6",
                                                     value, tets[static_cast<std::size_t>(t)]));
    region(t) = static_cast<std::int32_t>(value);
  }
  return region;
}

chladni::io::JsonArray region_names(vtkUnstructuredGrid* grid) {
  chladni::io::JsonArray names;
  auto* array =
      vtkStringArray::SafeDownCast(grid->GetFieldData()->GetAbstractArray("region_names"));
  for (vtkIdType i = 0; array != nullptr && i < array->GetNumberOfValues(); ++i) {
    names.emplace_back(std::string(array->GetValue(i)));
  }
  return names;
}

Message contents(const char* file) {
  vtkNew<FirstError> errors;
  vtkOutputWindow::SetInstance(errors);
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  require(reader->CanReadFile(file) != 0,
          "it does not begin as a VTK file of an unstructured grid");
  reader->SetFileName(file);
  reader->Update();
  require(errors->message().empty(), "damaged: " + errors->message());
  vtkUnstructuredGrid* grid = reader->GetOutput();
  require_sound_cells(grid);
  const std::vector<vtkIdType> tets = tets_of(grid);
  Message found;
  found.head = chladni::io::JsonObject{{"region_names", region_names(grid)}};
  found.integers["tets"] = nodes_of(grid, tets);
  found.integers["region"] = region_of(grid, tets);
  auto& points = found.doubles["points"];
  points.resize(grid->GetNumberOfPoints(), 3);
  for (Eigen::Index i = 0; i < points.rows(); ++i) grid->GetPoint(i, points.row(i).data());
  return found;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    require(argc == 2, "usage: chladni-vtu FILE.vtu");
    const std::string found = chladni::io::bytes(contents(argv[1]));
    std::cout.write(found.data(), static_cast<std::streamsize>(found.size()));
    return std::cout.flush() ? 0 : 1;
  } catch (const std::bad_alloc&) {
    std::cerr << "a count in it asks for more memory than a file of its size can need\n";
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
  }
  return 1;
}
