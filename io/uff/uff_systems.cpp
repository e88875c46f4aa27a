#include "io/uff/uff_systems.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "io/scan.h"
#include "io/uff/uff_datasets.h"

namespace chladni::io {
namespace {

constexpr double kRounding = 1e-3;  // rounding of axes that are stated with few digits

template <std::size_t count>
std::array<double, count> numbers_of(UffLines& lines, const char* what) {
  std::array<double, count> numbers{};
  std::size_t have = 0;
  while (have < count) {
    const auto line = lines.filled_record(what);
    std::size_t at = 0;
    while (have < count && at < line.size()) {
      const auto value = run_on_number(line, at);
      if (value) {
        numbers[have++] = *value;
      } else if (at < line.size()) {
        lines.fail(std::string(what) + ": " + not_a_number(words_of(line.substr(at)).front()));
      }
    }
  }
  return numbers;
}

// Reads the first `count` whole numbers of a line.
std::vector<long long> integers_of(UffLines& lines, std::size_t count, const char* what) {
  const auto line = lines.filled_record(what);
  const auto words = words_of(line);
  if (words.size() < count) {
    lines.fail("found " + shown(trimmed(line)) + ", expected the " + what + ": " +
               fmt::to_string(count) + " whole numbers");
  }
  std::vector<long long> numbers;
  for (std::size_t n = 0; n < count; ++n) numbers.push_back(uff_integer(lines, words[n], what));
  return numbers;
}

void add(UffSystems& systems, long long number, const UffSystem& system) {
  const auto [place, is_new] = systems.emplace(number, system);
  auto& first = place->second;
  if (is_new || (first.type == system.type && first.reference == system.reference &&
                 first.points.isApprox(system.points, kRounding))) {
    return;
  }
  first.fault = "is defined twice, and differently";
}

// Whether all coordinates in a system are lengths, as far as it is known.
bool is_cartesian(long long number, const UffSystems& systems) {
  const auto found = systems.find(number);
  return number == 0 || (found != systems.end() && found->second.type == 0);
}

int type_of(UffLines& lines, long long type) {
  if (type >= 0 && type <= 2) return static_cast<int>(type);
  lines.fail("type of a coordinate system " + fmt::to_string(type) +
             ", expected 0 (Cartesian), 1 (cylindrical) or 2 (spherical)");
}

}  // namespace

void read_systems_of_18(UffLines& lines, double length, UffSystems& systems) {
  while (!lines.at_end_of_dataset()) {
    const auto head = integers_of(lines, 3, "coordinate system");
    UffSystem system;
    system.type = type_of(lines, head[1]);
    system.reference = head[2];
    static_cast<void>(lines.record("name of a coordinate system"));
    const auto numbers = numbers_of<9>(lines, "points of a coordinate system");
    system.points = length * Eigen::Map<const Eigen::Matrix3d>(numbers.data());
    if (length != 1.0 && !is_cartesian(system.reference, systems)) {
      system.fault = "is not in the unit of the first dataset 164";
    }
    add(systems, head[0], system);
  }
}

void read_systems_of_2420(UffLines& lines, double length, UffSystems& systems) {
  static_cast<void>(integers_of(lines, 1, "number of the part"));
  static_cast<void>(lines.record("name of the part"));
  while (!lines.at_end_of_dataset()) {
    const auto head = integers_of(lines, 2, "coordinate system");
    UffSystem system;
    system.type = type_of(lines, head[1]);
    static_cast<void>(lines.record("name of a coordinate system"));
    const auto numbers = numbers_of<12>(lines, "matrix of a coordinate system");
    const Eigen::Matrix3d axes = Eigen::Map<const Eigen::Matrix3d>(numbers.data());
    const Eigen::Vector3d origin = length * Eigen::Map<const Eigen::Vector3d>(numbers.data() + 9);
    system.points << origin, origin + axes.col(0), origin + axes.col(2);
    if (!(axes.transpose() * axes).isIdentity(kRounding) || axes.determinant() < 0.0) {
      system.fault = "has a matrix that is no rotation";
    }
    add(systems, head[0], system);
  }
}

Eigen::Vector3d UffFrames::place_in(const Frame& frame, const Eigen::Vector3d& at) {
  if (frame.type == 0) return frame.origin + frame.axes * at;
  const double angle = at.y() * std::numbers::pi / 180.0;
  return frame.origin +
         frame.axes * Eigen::Vector3d(at.x() * std::cos(angle), at.x() * std::sin(angle), at.z());
}

UffNodeSystems UffFrames::systems_of(long long node) const {
  const auto found = uff_.node_systems.find(node);
  return found == uff_.node_systems.end() ? UffNodeSystems{} : found->second;
}

UffFrames::Frame UffFrames::frame(long long number, std::size_t depth) const {
  const bool stands_for_global = number == 1 && !uff_.defines_systems;
  if (number == 0 || stands_for_global) return {};
  const auto fail = [&](const std::string& what) {
    throw InvalidInput("coordinate system " + fmt::to_string(number) + " " + what);
  };
  const auto found = uff_.systems.find(number);
  if (found == uff_.systems.end()) fail("is not in the file (datasets 18 and 2420)");
  const auto& system = found->second;
  if (!system.fault.empty()) fail(system.fault);
  if (system.type == 2) fail("is spherical: that is not read");
  if (depth > uff_.systems.size()) fail("is defined by way of itself");
  const Frame reference = frame(system.reference, depth + 1);
  const Eigen::Vector3d origin = place_in(reference, system.points.col(0));
  const Eigen::Vector3d x = place_in(reference, system.points.col(1)) - origin;
  const Eigen::Vector3d plane = place_in(reference, system.points.col(2)) - origin;
  const Eigen::Vector3d y = plane.cross(x);
  if (!(y.norm() > 1e-6 * plane.norm() * x.norm()) || !y.allFinite()) {
    fail("has its three points on one line");
  }
  Frame result{system.type, {}, origin};
  result.axes.col(0) = x.normalized();
  result.axes.col(1) = y.normalized();
  result.axes.col(2) = result.axes.col(0).cross(result.axes.col(1));
  return result;
}

Eigen::Vector3d UffFrames::place(long long node) const {
  return place_in(frame(systems_of(node).place), uff_.nodes.at(node));
}

Eigen::Matrix3d UffFrames::axes(long long node) const {
  const auto number = systems_of(node).displacement;
  const Frame own = frame(number);
  if (own.type == 0) return own.axes;
  const Eigen::Vector3d from = own.axes.transpose() * (place(node) - own.origin);
  const double radius = std::hypot(from.x(), from.y());
  require(radius > 1e-9 * from.norm() && radius > 0.0,
          "coordinate system " + fmt::to_string(number) +
              " is cylindrical, and the node lies on its axis");
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() << from.x() / radius, -from.y() / radius, from.y() / radius,
      from.x() / radius;
  return own.axes * turn;
}

namespace {

// Notes, each once for all channels that share it.
struct Said {
  std::map<std::string, std::vector<std::string>> of;

  void add(const std::string& what, const std::string& whom) { of[what].push_back(whom); }
  void tell(std::vector<std::string>& notes) const {
    for (const auto& [what, whom] : of) notes.push_back(listed(whom) + ": " + what);
  }
};

void turn(const UffFrames& frames, modal::MeasuredChannel& channel, Said& said) {
  if (!channel.direction.any()) return;
  try {
    const Eigen::Vector3d turned = frames.axes(*channel.node) * channel.direction;
    if (turned.isApprox(channel.direction, 1e-9)) return;
    channel.direction = turned;
    said.add(
        "measured in a coordinate system of the node: the direction is turned into the global "
        "one",
        channel.name);
  } catch (const InvalidInput& e) {
    channel.direction.setZero();
    said.add(std::string("the direction is not known: ") + e.what(), channel.name);
  }
}

void put(const UffFrames& frames, double length, modal::MeasuredChannel& channel, Said& said) {
  try {
    channel.position = length * frames.place(*channel.node);
  } catch (const InvalidInput& e) {
    said.add(std::string("the place is not known: ") + e.what(), channel.name);
  }
}

}  // namespace

void place_channels(const Uff& uff, std::optional<double> length,
                    std::vector<modal::MeasuredChannel>& channels,
                    std::vector<std::string>& notes) {
  const UffFrames frames(uff);
  Said said;
  for (auto& channel : channels) {
    if (!channel.node || !uff.nodes.contains(*channel.node)) continue;
    turn(frames, channel, said);
    if (length) put(frames, *length, channel, said);
  }
  said.tell(notes);
}

}  // namespace chladni::io
