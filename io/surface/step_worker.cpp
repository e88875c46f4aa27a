// The program chladni-step FILE writes the solid of a STEP file as triangles to stdout, as a
// Message. It is a separate program because OpenCASCADE prints to stdout and crashes on invalid
// files.
#include <fcntl.h>
#include <unistd.h>

#include <BRepBndLib.hxx>
#include <BRepGProp.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <STEPControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Solid.hxx>
#include <TopoDS_Vertex.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <cmath>
#include <iostream>
#include <map>

#include "base/error.h"
#include "base/text_stream.h"
#include "io/bytes/message.h"
#include "mesh/disjoint_sets.h"

namespace {

using chladni::InvalidInput;
using chladni::require;
using chladni::io::Json;
using chladni::io::JsonArray;
using chladni::io::JsonObject;
using chladni::io::Message;

constexpr double kDeflection = 2e-4;  // of the body's diagonal
constexpr double kAngle = 0.2;        // between a triangle and the face [rad]

std::string length_unit(STEPControl_Reader& reader) {
  TColStd_SequenceOfAsciiString lengths, angles, solid_angles;
  reader.FileUnits(lengths, angles, solid_angles);
  return lengths.IsEmpty() ? std::string() : std::string(lengths.First().ToCString());
}

double volume(const TopoDS_Shape& solid) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(solid, properties);
  return properties.Mass();
}

TopoDS_Shape only_solid(const TopoDS_Shape& shape) {
  TopTools_IndexedMapOfShape solids, faces;
  TopExp::MapShapes(shape, TopAbs_SOLID, solids);
  TopExp::MapShapes(shape, TopAbs_FACE, faces);
  require(solids.Extent() > 0, "no solid in the file, but " + std::to_string(faces.Extent()) +
                                   " faces: expected one closed solid, export it so");
  if (solids.Extent() > 1) {
    chladni::TextWriter text;
    text << solids.Extent() << " solids, expected one: unite them or export them apart; volumes";
    for (int i = 1; i <= std::min(solids.Extent(), 10); ++i) text << " " << volume(solids(i));
    text << " mm3";
    throw InvalidInput(text.str());
  }
  return solids(1);
}

void triangulate(const TopoDS_Shape& solid) {
  Bnd_Box box;
  BRepBndLib::Add(solid, box);
  require(!box.IsVoid(), "the solid is empty");
  const double diagonal = std::sqrt(box.SquareExtent());
  require(std::isfinite(diagonal) && diagonal > 0.0 && diagonal < 1e9, "the solid has no size");
  const BRepMesh_IncrementalMesh mesher(solid, kDeflection * diagonal, Standard_False, kAngle);
  require(mesher.IsDone() == Standard_True, "OpenCASCADE could not triangulate the solid");
}

// The triangles of the faces. Shared edges and vertices decide which points are equal. This is
// exact, while a comparison of coordinates would need a tolerance.
class Triangulation {
 public:
  explicit Triangulation(const TopoDS_Shape& solid);
  [[nodiscard]] Message message(STEPControl_Reader& reader) const;

 private:
  void add_face(const TopoDS_Face& face);
  void mark_edge(const TopoDS_Edge& edge, const Handle(Poly_Triangulation) & triangles,
                 const TopLoc_Location& place, std::size_t first);
  void mark(std::map<int, std::size_t>& known, int key, std::size_t point);

  TopTools_IndexedMapOfShape faces_, edges_, vertices_;
  std::vector<double> xyz_;
  std::vector<std::array<std::size_t, 3>> triangles_;
  std::vector<int> face_of_triangle_;
  std::vector<std::array<std::size_t, 2>> equal_;
  std::map<std::pair<int, int>, std::size_t> point_of_edge_;  // edge, position along it
  std::map<int, std::size_t> point_of_vertex_;
};

Triangulation::Triangulation(const TopoDS_Shape& solid) {
  TopExp::MapShapes(solid, TopAbs_FACE, faces_);
  TopExp::MapShapes(solid, TopAbs_EDGE, edges_);
  TopExp::MapShapes(solid, TopAbs_VERTEX, vertices_);
  for (TopExp_Explorer at(solid, TopAbs_FACE); at.More(); at.Next()) {
    add_face(TopoDS::Face(at.Current()));
  }
}

void Triangulation::add_face(const TopoDS_Face& face) {
  const int number = faces_.FindIndex(face);
  TopLoc_Location place;
  const Handle(Poly_Triangulation) triangles = BRep_Tool::Triangulation(face, place);
  require(
      !triangles.IsNull() && triangles->NbTriangles() > 0,
      "face " + std::to_string(number) + " gets no triangles: heal the solid where it was made");
  const std::size_t first = xyz_.size() / 3;
  for (int i = 1; i <= triangles->NbNodes(); ++i) {
    const gp_Pnt p = triangles->Node(i).Transformed(place.Transformation());
    xyz_.insert(xyz_.end(), {p.X(), p.Y(), p.Z()});
  }
  const bool mirrored = place.Transformation().IsNegative() == Standard_True;
  const bool turn = (face.Orientation() == TopAbs_REVERSED) != mirrored;
  for (int t = 1; t <= triangles->NbTriangles(); ++t) {
    std::array<int, 3> n{};
    triangles->Triangle(t).Get(n[0], n[1], n[2]);
    if (turn) std::swap(n[1], n[2]);
    triangles_.push_back({first + static_cast<std::size_t>(n[0] - 1),
                          first + static_cast<std::size_t>(n[1] - 1),
                          first + static_cast<std::size_t>(n[2] - 1)});
    face_of_triangle_.push_back(number);
  }
  for (TopExp_Explorer at(face, TopAbs_EDGE); at.More(); at.Next()) {
    mark_edge(TopoDS::Edge(at.Current()), triangles, place, first);
  }
}

// An edge has its points in the same order in each of its faces. An edge that occurs twice in a
// face (a seam) has two polygons, which differ by the orientation.
void Triangulation::mark_edge(const TopoDS_Edge& edge, const Handle(Poly_Triangulation) & triangles,
                              const TopLoc_Location& place, std::size_t first) {
  const Handle(Poly_PolygonOnTriangulation) polygon =
      BRep_Tool::PolygonOnTriangulation(edge, triangles, place);
  if (polygon.IsNull()) return;
  const int number = edges_.FindIndex(edge), count = polygon->NbNodes();
  const bool is_point = BRep_Tool::Degenerated(edge) == Standard_True;
  std::size_t start = 0, end = 0;
  for (int i = 1; i <= count; ++i) {
    const std::size_t point = first + static_cast<std::size_t>(polygon->Node(i) - 1);
    const auto [known, is_new] = point_of_edge_.try_emplace({number, is_point ? 0 : i}, point);
    if (!is_new) equal_.push_back({known->second, point});
    if (i == 1) start = point;
    if (i == count) end = point;
  }
  TopoDS_Vertex from, to;
  TopExp::Vertices(edge, from, to);
  if (!from.IsNull()) mark(point_of_vertex_, vertices_.FindIndex(from), start);
  if (!to.IsNull()) mark(point_of_vertex_, vertices_.FindIndex(to), end);
}

void Triangulation::mark(std::map<int, std::size_t>& known, int key, std::size_t point) {
  const auto [entry, is_new] = known.try_emplace(key, point);
  if (!is_new) equal_.push_back({entry->second, point});
}

std::string face_name(STEPControl_Reader& reader, const TopoDS_Shape& face, int number) {
  const Handle(Transfer_TransientProcess) process =
      reader.WS()->TransferReader()->TransientProcess();
  Handle(StepRepr_RepresentationItem) item;
  if (!process.IsNull()) {
    item = Handle(StepRepr_RepresentationItem)::DownCast(
        reader.WS()->TransferReader()->EntityFromShapeResult(face, 1));
  }
  std::string name = item.IsNull() || item->Name().IsNull() ? "" : item->Name()->ToCString();
  for (char& c : name) c = c < ' ' || c > '~' ? '?' : c;
  return name.empty() || name == "NONE" ? "face_" + std::to_string(number) : name;
}

Message Triangulation::message(STEPControl_Reader& reader) const {
  chladni::mesh::DisjointSets sets(xyz_.size() / 3);
  for (const auto& [a, b] : equal_) sets.join(a, b);
  const auto number = sets.numbers();
  Message result;
  auto& points = result.doubles["points"];
  points.resize(*std::max_element(number.begin(), number.end()) + 1, 3);
  for (std::size_t p = number.size(); p-- > 0;) {
    points.row(number[p]) = Eigen::Map<const Eigen::RowVector3d>(&xyz_[3 * p]);
  }
  std::map<std::string, int> patches;
  JsonArray names;
  std::vector<int> patch_of_face;
  for (int f = 1; f <= faces_.Extent(); ++f) {
    const std::string name = face_name(reader, faces_(f), f);
    const auto [patch, is_new] = patches.try_emplace(name, static_cast<int>(names.size()));
    if (is_new) names.emplace_back(name);
    patch_of_face.push_back(patch->second);
  }
  auto& corners = result.integers["triangles"];
  auto& patch = result.integers["patch"];
  corners.resize(static_cast<Eigen::Index>(triangles_.size()), 3);
  patch.resize(corners.rows(), 1);
  Eigen::Index kept = 0;
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const auto [a, b, c] = triangles_[t];
    if (number[a] == number[b] || number[b] == number[c] || number[c] == number[a]) continue;
    corners.row(kept) << number[a], number[b], number[c];
    patch(kept++) = patch_of_face[static_cast<std::size_t>(face_of_triangle_[t] - 1)];
  }
  corners.conservativeResize(kept, 3);
  patch.conservativeResize(kept, 1);
  result.head =
      JsonObject{{"refused", ""}, {"unit", length_unit(reader)}, {"patch_names", std::move(names)}};
  return result;
}

Message contents(const char* file) {
  STEPControl_Reader reader;
  require(reader.ReadFile(file) == IFSelect_RetDone, "OpenCASCADE cannot read it as STEP");
  require(reader.TransferRoots() > 0, "no shape in the file, expected one closed solid");
  const TopoDS_Shape solid = only_solid(reader.OneShape());
  triangulate(solid);
  return Triangulation(solid).message(reader);
}

Message refusal(const std::string& why) {
  Message message;
  message.head = JsonObject{{"refused", why}};
  return message;
}

// Redirects OpenCASCADE's output to stderr; returns a descriptor of the true stdout.
int take_stdout() {
  const int stream = dup(STDOUT_FILENO);
  dup2(STDERR_FILENO, STDOUT_FILENO);
  return stream;
}

bool write_all(int stream, const std::string& bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t count = write(stream, bytes.data() + done, bytes.size() - done);
    if (count <= 0) return false;
    done += static_cast<std::size_t>(count);
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  const int stream = take_stdout();
  Message answer;
  try {
    require(argc == 2, "usage: chladni-step FILE.step");
    answer = contents(argv[1]);
  } catch (const Standard_Failure& failure) {
    answer = refusal(std::string("OpenCASCADE gives up: ") + failure.GetMessageString());
  } catch (const InvalidInput& error) {
    answer = refusal(error.what());
  } catch (const std::bad_alloc&) {
    std::cerr << "out of memory\n";
    return 1;
  }
  return write_all(stream, chladni::io::bytes(answer)) ? 0 : 1;
}
