// Reads OBJ (Wavefront): points and polygons. Groups, objects and materials become patches.
#include <fmt/format.h>

#include <array>
#include <map>
#include <set>

#include "base/error.h"
#include "io/scan.h"
#include "io/surface/triangles.h"

namespace chladni::io {
namespace {

constexpr std::array<std::string_view, 3> kGroupings{"g", "o", "usemtl"};

// Keywords that do not concern the shape, or only its appearance.
const std::set<std::string_view> kIgnored{
    "vt",  "vn",    "vp",       "s",        "mtllib",     "maplib",    "usemap",
    "lod", "bevel", "c_interp", "d_interp", "shadow_obj", "trace_obj", "mg"};
const std::set<std::string_view> kFreeForm{"cstype", "deg",  "curv", "curv2", "surf", "bmat",
                                           "step",   "parm", "trim", "hole",  "scrv", "con"};

class ObjReader {
 public:
  explicit ObjReader(std::string_view bytes) : scanner_(bytes, '#') {}
  mesh::Surface surface(Notes* notes);

 private:
  std::string_view word();
  void read_line(std::string_view key);
  void read_point();
  void read_face();
  void read_grouping(std::size_t kind);
  std::string patch_name(const std::array<int, 3>& grouping) const;

  Scanner scanner_;
  Triangles triangles_;
  std::array<int, 3> grouping_{};
  std::array<std::vector<std::string>, 3> names_{{{""}, {""}, {""}}};
  std::array<std::map<std::string, int>, 3> index_of_name_;
  std::array<std::set<int>, 3> used_;
  // Faces are divided into triangles last, when all values of the groupings are known.
  std::vector<std::int32_t> corners_;
  std::vector<std::size_t> face_end_, face_line_;
  std::vector<std::array<int, 3>> face_grouping_;
  std::int64_t lines_and_points_ = 0;
  std::map<std::string, std::int64_t> unknown_;
};

// The next word of the statement. A backslash continues the statement on the next line.
std::string_view ObjReader::word() {
  std::string_view found = scanner_.word_on_line();
  while (found == "\\" && scanner_.next_line()) found = scanner_.word_on_line();
  return found;
}

void ObjReader::read_point() {
  Eigen::Vector3d p;
  for (int i = 0; i < 3; ++i) {
    const std::string_view coordinate = word();
    const auto value = number_in(coordinate);
    if (!value) {
      scanner_.fail(coordinate.empty()
                        ? "a point of " + fmt::to_string(i) + " coordinates, expected 3"
                        : "a point: " + not_a_number(coordinate));
    }
    p[i] = *value;
  }
  static_cast<void>(triangles_.point(p));  // a weight or a colour may follow
}

void ObjReader::read_face() {
  const std::size_t begin = corners_.size();
  for (std::string_view corner = word(); !corner.empty(); corner = word()) {
    const bool continues = corner.size() > 1 && corner.back() == '\\';
    if (continues) corner.remove_suffix(1);
    const auto index = integer_in(corner.substr(0, corner.find('/')));
    if (!index || *index == 0) {
      scanner_.fail("a corner of a face: found " + shown(corner) +
                    ", expected a point's number from 1, or from -1 backwards");
    }
    const std::int64_t count = triangles_.point_count();
    if (*index < -count || *index > count) {
      scanner_.fail("a face names point " + fmt::to_string(*index) + ", but there are " +
                    fmt::to_string(count) + " so far");
    }
    corners_.push_back(static_cast<std::int32_t>(*index > 0 ? *index - 1 : count + *index));
    if (continues && !scanner_.next_line()) break;
  }
  if (corners_.size() - begin < 3) {
    triangles_.face(std::span(corners_).subspan(begin), 0, scanner_);
    return corners_.resize(begin);
  }
  for (std::size_t kind = 0; kind < 3; ++kind) used_.at(kind).insert(grouping_.at(kind));
  face_end_.push_back(corners_.size());
  face_line_.push_back(scanner_.line());
  face_grouping_.push_back(grouping_);
}

void ObjReader::read_grouping(std::size_t kind) {
  const std::string name(scanner_.rest_of_line());
  auto& names = names_.at(kind);
  const auto [entry, is_new] =
      index_of_name_.at(kind).try_emplace(name, static_cast<int>(names.size()));
  if (is_new) names.push_back(name);
  grouping_.at(kind) = entry->second;
}

// The patch name is made of the groupings that have more than one value in the file. Where none
// has, it is the last grouping that is given.
std::string ObjReader::patch_name(const std::array<int, 3>& grouping) const {
  std::string joined, single;
  for (std::size_t kind = 0; kind < 3; ++kind) {
    const std::string& name = names_.at(kind).at(static_cast<std::size_t>(grouping.at(kind)));
    if (name.empty()) continue;
    single = name;
    if (used_.at(kind).size() > 1) joined += (joined.empty() ? "" : ".") + name;
  }
  if (!joined.empty()) return joined;
  return single.empty() ? "surface" : single;
}

void ObjReader::read_line(std::string_view key) {
  for (std::size_t kind = 0; kind < 3; ++kind) {
    if (key == kGroupings.at(kind)) return read_grouping(kind);
  }
  if (key == "v") return read_point();
  if (key == "f" || key == "fo") return read_face();
  if (kFreeForm.contains(key)) {
    scanner_.fail("a free-form curve or surface ('" + std::string(key) +
                  "'), expected polygons: export it triangulated");
  }
  if (key == "l" || key == "p") {
    ++lines_and_points_;
  } else if (!kIgnored.contains(key)) {
    if (unknown_.size() < 10) ++unknown_[shown(key)];
  }
  for (std::string_view rest = word(); !rest.empty();) rest = word();
}

mesh::Surface ObjReader::surface(Notes* notes) {
  do {
    if (const std::string_view key = scanner_.word_on_line(); !key.empty()) read_line(key);
  } while (scanner_.next_line());
  std::map<std::array<int, 3>, int> patch_of_grouping;
  for (std::size_t f = 0; f < face_end_.size(); ++f) {
    const auto [entry, is_new] = patch_of_grouping.try_emplace(face_grouping_[f], 0);
    if (is_new) entry->second = triangles_.patch(patch_name(face_grouping_[f]));
    const std::size_t begin = f == 0 ? 0 : face_end_[f - 1];
    triangles_.face(std::span(corners_).subspan(begin, face_end_[f] - begin), entry->second,
                    scanner_.at_line(face_line_[f]));
  }
  if (lines_and_points_ > 0) {
    add_note(notes, fmt::to_string(lines_and_points_) + " lines and points without area left out");
  }
  for (const auto& [key, count] : unknown_) {
    add_note(notes, fmt::to_string(count) + " statements " + key + " not understood, passed over");
  }
  return triangles_.surface(notes);
}

}  // namespace

mesh::Surface parse_obj(std::string_view bytes, Notes* notes) {
  require(!trimmed(bytes.substr(0, 4096)).empty(), "the file is empty");
  return ObjReader(bytes).surface(notes);
}

}  // namespace chladni::io
