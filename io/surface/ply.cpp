// Reads PLY (Stanford): a head that describes rows of numbers, then the rows, as text or binary.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "base/error.h"
#include "io/scan.h"
#include "io/surface/triangles.h"

namespace chladni::io {
namespace {

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

constexpr std::array<std::pair<std::string_view, Type>, 16> kTypes{{
    {"char", Type::int8},
    {"int8", Type::int8},
    {"uchar", Type::uint8},
    {"uint8", Type::uint8},
    {"short", Type::int16},
    {"int16", Type::int16},
    {"ushort", Type::uint16},
    {"uint16", Type::uint16},
    {"int", Type::int32},
    {"int32", Type::int32},
    {"uint", Type::uint32},
    {"uint32", Type::uint32},
    {"float", Type::float32},
    {"float32", Type::float32},
    {"double", Type::float64},
    {"float64", Type::float64},
}};

struct Property {
  std::string name;
  Type type = Type::float32;
  std::optional<Type> count_type;  // set for a list
};

struct Element {
  std::string name;
  std::int64_t count = 0;
  std::vector<Property> properties;
};

std::size_t size_of(Type type) {
  switch (type) {
    case Type::int8:
    case Type::uint8:
      return 1;
    case Type::int16:
    case Type::uint16:
      return 2;
    case Type::float64:
      return 8;
    default:
      return 4;
  }
}

double number(Values& values, Type type, std::string_view what) {
  if (values.is_text()) return values.next<double>(what);
  switch (type) {
    case Type::int8:
      return values.next<std::int8_t>(what);
    case Type::uint8:
      return values.next<std::uint8_t>(what);
    case Type::int16:
      return values.next<std::int16_t>(what);
    case Type::uint16:
      return values.next<std::uint16_t>(what);
    case Type::int32:
      return values.next<std::int32_t>(what);
    case Type::uint32:
      return values.next<std::uint32_t>(what);
    case Type::float32:
      return static_cast<double>(values.next<float>(what));
    case Type::float64:
      return values.next<double>(what);
  }
  return 0.0;
}

std::int64_t whole(Values& values, Type type, std::string_view what) {
  if (type == Type::float32 || type == Type::float64) {
    values.scanner().fail(std::string(what) + " is of a floating-point type, expected an integer");
  }
  if (values.is_text()) return values.next<std::int64_t>(what);
  return static_cast<std::int64_t>(number(values, type, what));
}

Type read_type(Scanner& scanner) {
  const std::string_view word = scanner.word_on_line();
  const auto* const found =
      std::find_if(kTypes.begin(), kTypes.end(), [&](const auto& t) { return t.first == word; });
  if (found == kTypes.end())
    scanner.fail("found " + shown(word) + ", expected a type such as 'float'");
  return found->second;
}

Property read_property(Scanner& scanner) {
  Property property;
  Scanner ahead = scanner;
  if (ahead.word_on_line() == "list") {
    scanner = ahead;
    property.count_type = read_type(scanner);
  }
  property.type = read_type(scanner);
  property.name = std::string(scanner.word_on_line());
  if (property.name.empty()) scanner.fail("a property without a name");
  return property;
}

Encoding read_encoding(Scanner& scanner) {
  scanner.expect("format");
  const std::string_view word = scanner.word_on_line();
  if (word == "ascii") return Encoding::text;
  if (word == "binary_little_endian") return Encoding::little_endian;
  if (word == "binary_big_endian") return Encoding::big_endian;
  scanner.fail("format " + shown(word) +
               ", expected 'ascii', 'binary_little_endian' or 'binary_big_endian'");
}

class PlyReader {
 public:
  explicit PlyReader(std::string_view bytes) : scanner_(bytes) {}
  mesh::Surface surface(Notes* notes);

 private:
  Encoding read_head();
  void read_rows(const Element& element, Values& values);
  void read_vertices(const Element& element, Values& values);
  void read_faces(const Element& element, Values& values);
  void read_list(const Property& property, Values& values);
  void skip_row(const Element& element, Values& values);

  Scanner scanner_;
  std::vector<Element> elements_;
  Triangles triangles_;
  std::vector<std::int64_t> list_;
};

Encoding PlyReader::read_head() {
  if (scanner_.word() != "ply") scanner_.fail("the file does not start with 'ply'");
  const Encoding encoding = read_encoding(scanner_);
  while (scanner_.next_line()) {
    const std::string_view key = scanner_.word_on_line();
    if (key == "end_header") {
      static_cast<void>(scanner_.next_line());
      return encoding;
    }
    if (key.empty() || key == "comment" || key == "obj_info") continue;
    if (key == "element") {
      const std::string name(scanner_.word_on_line());
      const auto count = integer_in(scanner_.word_on_line());
      if (!count || *count < 0) scanner_.fail("element " + shown(name) + ": expected a count");
      elements_.push_back({name, *count, {}});
    } else if (key == "property") {
      if (elements_.empty()) scanner_.fail("a property before the first element");
      elements_.back().properties.push_back(read_property(scanner_));
    } else {
      scanner_.fail("found " + shown(key) + ", expected 'element', 'property' or 'end_header'");
    }
  }
  scanner_.fail_truncated("'end_header'");
}

// Reads the whole numbers of a list into list_. Lists of other numbers are skipped.
void PlyReader::read_list(const Property& property, Values& values) {
  const std::int64_t count = whole(values, *property.count_type, "the length of a list");
  scanner_.require_room(count, "entries of a list", values.is_text() ? 2 : size_of(property.type));
  list_.clear();
  const bool is_whole = property.type != Type::float32 && property.type != Type::float64;
  for (std::int64_t i = 0; i < count; ++i) {
    if (is_whole) {
      list_.push_back(whole(values, property.type, "an entry of a list"));
    } else {
      static_cast<void>(number(values, property.type, "an entry of a list"));
    }
  }
}

void PlyReader::skip_row(const Element& element, Values& values) {
  for (const Property& property : element.properties) {
    if (property.count_type) {
      read_list(property, values);
    } else {
      static_cast<void>(number(values, property.type, property.name));
    }
  }
}

void PlyReader::read_vertices(const Element& element, Values& values) {
  std::array<bool, 3> has{};
  for (const Property& property : element.properties) {
    for (std::size_t i = 0; i < 3; ++i) {
      has.at(i) = has.at(i) || (property.name == std::string(1, "xyz"[i]) && !property.count_type);
    }
  }
  if (!has[0] || !has[1] || !has[2]) scanner_.fail("element 'vertex' lacks x, y or z");
  for (std::int64_t v = 0; v < element.count; ++v) {
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    for (const Property& property : element.properties) {
      if (property.count_type) {
        read_list(property, values);
        continue;
      }
      const double value = number(values, property.type, property.name);
      if (property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z') {
        p[property.name[0] - 'x'] = value;
      }
    }
    if (!p.allFinite()) {
      scanner_.fail("vertex " + fmt::to_string(v) +
                    " has a coordinate that is not a finite number");
    }
    static_cast<void>(triangles_.point(p));
  }
}

bool names_corners(const Property& property) {
  return property.count_type &&
         (property.name == "vertex_indices" || property.name == "vertex_index");
}

void PlyReader::read_faces(const Element& element, Values& values) {
  const bool has_corners =
      std::any_of(element.properties.begin(), element.properties.end(), names_corners);
  if (!has_corners) scanner_.fail("element 'face' lacks the list 'vertex_indices'");
  const int patch = triangles_.patch("surface");
  std::vector<std::int32_t> corners;
  for (std::int64_t f = 0; f < element.count; ++f) {
    corners.clear();
    for (const Property& property : element.properties) {
      if (!property.count_type) {
        static_cast<void>(number(values, property.type, property.name));
        continue;
      }
      read_list(property, values);
      if (!names_corners(property)) continue;
      if (property.type == Type::float32 || property.type == Type::float64) {
        scanner_.fail("the corners of a face are of a floating-point type");
      }
      corners.clear();
      for (const std::int64_t index : list_) corners.push_back(triangles_.corner(index, scanner_));
    }
    triangles_.face(corners, patch, scanner_);
  }
}

void PlyReader::read_rows(const Element& element, Values& values) {
  if (element.properties.empty()) return;
  std::size_t smallest_row = 0;
  for (const Property& property : element.properties) {
    smallest_row += values.is_text() ? 2 : size_of(property.count_type.value_or(property.type));
  }
  scanner_.require_room(element.count, "rows of element " + shown(element.name), smallest_row);
  if (element.name == "vertex") return read_vertices(element, values);
  if (element.name == "face") return read_faces(element, values);
  if (element.name == "tristrips") {
    scanner_.fail("triangle strips (element 'tristrips'), expected an element 'face'");
  }
  for (std::int64_t row = 0; row < element.count; ++row) skip_row(element, values);
}

mesh::Surface PlyReader::surface(Notes* notes) {
  Values values(scanner_, read_head());
  for (const Element& element : elements_) read_rows(element, values);
  return triangles_.surface(notes);
}

}  // namespace

mesh::Surface parse_ply(std::string_view bytes, Notes* notes) {
  require(!trimmed(bytes.substr(0, 4096)).empty(), "the file is empty");
  return PlyReader(bytes).surface(notes);
}

}  // namespace chladni::io
