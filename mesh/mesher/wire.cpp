#include "mesh/mesher/wire.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <span>
#include <stdexcept>

namespace chladni::mesh::wire {
namespace {

static_assert(std::endian::native == std::endian::little, "the wire format is little-endian");

constexpr std::string_view request_magic = "CHLplc02";
constexpr std::string_view reply_magic = "CHLtet01";

class Writer {
 public:
  explicit Writer(std::string_view magic) : bytes_(magic) {}

  template <typename T>
  void value(const T& number) {
    bytes_.append(std::string_view(reinterpret_cast<const char*>(&number), sizeof(T)));
  }

  template <typename T>
  void array(const std::vector<T>& numbers) {
    value(static_cast<std::uint64_t>(numbers.size()));
    bytes_.append(std::string_view(reinterpret_cast<const char*>(numbers.data()),
                                   numbers.size() * sizeof(T)));
  }

  [[nodiscard]] std::string bytes() && { return std::move(bytes_); }

 private:
  std::string bytes_;
};

class Reader {
 public:
  Reader(std::string_view bytes, std::string_view magic) : rest_(bytes) {
    if (!rest_.starts_with(magic)) {
      throw std::runtime_error("expected bytes that begin with \"" + std::string(magic) + "\"");
    }
    rest_.remove_prefix(magic.size());
  }

  template <typename T>
  [[nodiscard]] T value() {
    T number;
    std::memcpy(&number, taken(sizeof(T)).data(), sizeof(T));
    return number;
  }

  template <typename T>
  [[nodiscard]] std::vector<T> array() {
    const auto count = value<std::uint64_t>();
    if (count > rest_.size() / sizeof(T)) {
      throw std::runtime_error("expected " + std::to_string(count) + " numbers, but only " +
                               std::to_string(rest_.size()) + " bytes are left");
    }
    std::vector<T> numbers(count);
    if (count > 0) std::memcpy(numbers.data(), taken(count * sizeof(T)).data(), count * sizeof(T));
    return numbers;
  }

  void expect_end() const {
    if (!rest_.empty()) throw std::runtime_error(std::to_string(rest_.size()) + " bytes too many");
  }

 private:
  std::string_view taken(std::size_t size) {
    if (size > rest_.size()) throw std::runtime_error("ended in the middle of a number");
    const std::string_view head = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return head;
  }

  std::string_view rest_;
};

void expect(bool condition, const char* what) {
  if (!condition) throw std::runtime_error(what);
}

void expect_finite(std::span<const double> numbers) {
  for (const double number : numbers) expect(std::isfinite(number), "a number is not finite");
}

void expect_indices(const std::vector<std::int32_t>& indices, std::size_t count) {
  for (const std::int32_t i : indices) {
    expect(i >= 0 && static_cast<std::size_t>(i) < count, "an index is out of range");
  }
}

}  // namespace

std::string bytes_of(const Request& request) {
  Writer writer(request_magic);
  writer.value(request.largest_radius_edge);
  writer.value(request.smallest_dihedral_degrees);
  writer.value(request.largest_volume);
  writer.array(request.points);
  writer.array(request.triangles);
  writer.array(request.markers);
  writer.array(request.seeds);
  writer.value(request.surface_stays);
  return std::move(writer).bytes();
}

std::string bytes_of(const Reply& reply) {
  Writer writer(reply_magic);
  writer.array(reply.points);
  writer.array(reply.tets);
  writer.array(reply.parts);
  writer.array(reply.faces);
  writer.array(reply.face_markers);
  return std::move(writer).bytes();
}

Request request_from(std::string_view bytes) {
  Reader reader(bytes, request_magic);
  Request request;
  request.largest_radius_edge = reader.value<double>();
  request.smallest_dihedral_degrees = reader.value<double>();
  request.largest_volume = reader.value<double>();
  request.points = reader.array<double>();
  request.triangles = reader.array<std::int32_t>();
  request.markers = reader.array<std::int32_t>();
  request.seeds = reader.array<Seed>();
  request.surface_stays = reader.value<std::int32_t>();
  reader.expect_end();
  expect(request.points.size() % 3 == 0 && request.triangles.size() % 3 == 0 &&
             request.markers.size() == request.triangles.size() / 3,
         "the counts of points, triangles and markers do not fit each other");
  expect_finite(request.points);
  expect_indices(request.triangles, request.points.size() / 3);
  expect(std::isfinite(request.largest_radius_edge) && request.largest_radius_edge >= 1.0 &&
             request.smallest_dihedral_degrees >= 0.0 && request.smallest_dihedral_degrees <= 30.0,
         "the wanted quality is out of range");
  expect(std::isfinite(request.largest_volume) && request.largest_volume > 0.0,
         "the largest volume is not positive");
  return request;
}

Reply reply_from(std::string_view bytes) {
  Reader reader(bytes, reply_magic);
  Reply reply;
  reply.points = reader.array<double>();
  reply.tets = reader.array<std::int32_t>();
  reply.parts = reader.array<std::int32_t>();
  reply.faces = reader.array<std::int32_t>();
  reply.face_markers = reader.array<std::int32_t>();
  reader.expect_end();
  expect(reply.points.size() % 3 == 0 && reply.tets.size() == 4 * reply.parts.size() &&
             reply.faces.size() == 3 * reply.face_markers.size(),
         "the counts of points, cells and faces do not fit each other");
  expect_finite(reply.points);
  expect_indices(reply.tets, reply.points.size() / 3);
  expect_indices(reply.faces, reply.points.size() / 3);
  return reply;
}

}  // namespace chladni::mesh::wire
