// Makes a mesh from the reply of the worker chladni-vtu.
#include <fmt/core.h>

#include <array>

#include "base/error.h"
#include "host/atomic_file.h"
#include "host/worker.h"
#include "io/bytes/message.h"
#include "io/cells/tets.h"
#include "io/vtu.h"

namespace chladni::io {
namespace {

// The limits of time and memory grow with the file. A file that needs more is not valid.
WorkerLimits limits(const std::filesystem::path& file) {
  const std::size_t size = std::filesystem::file_size(file);
  return {.time = std::chrono::seconds(20 + size / 1'000'000),
          .memory_bytes = (std::size_t{1} << 30U) + 64 * size,
          .output_bytes = (std::size_t{64} << 20U) + 64 * size,
          .confined = true,
          .files = {file}};
}

mesh::TetMesh mesh_of(const Message& found, Notes* notes) {
  const auto& points = found.numbers("points");
  const Cells& tets = found.cells("tets");
  const Cells& region = found.cells("region");
  const JsonArray& names = found.head.at("region_names").array();
  require(points.cols() == 3 && region.size() == tets.rows(), "its cells make no sense");
  Tets result;
  for (Eigen::Index i = 0; i < points.rows(); ++i) result.node(i, points.row(i).transpose());
  std::vector<std::int64_t> nodes(static_cast<std::size_t>(tets.cols()));
  for (Eigen::Index t = 0; t < tets.rows(); ++t) {
    for (Eigen::Index a = 0; a < tets.cols(); ++a) {
      nodes[static_cast<std::size_t>(a)] = tets(t, a);
    }
    const auto index = static_cast<std::size_t>(region(t));
    const std::string name = region(t) >= 0 && index < names.size() ? names[index].string()
                             : region(t) == 0                       ? "body"
                                              : fmt::format("region_{}", region(t));
    result.tet(t, nodes, result.regions.index(name));
  }
  return result.mesh(notes);
}

}  // namespace

mesh::TetMesh read_vtu(const std::filesystem::path& file, Notes* notes) {
  require(std::filesystem::is_regular_file(file),
          file.string() + ": there is no such file, or it is not a regular one");
  const std::filesystem::path worker = worker_path("chladni-vtu");
  try {
    const auto result = run_worker(worker, {file.string()}, "", limits(file));
    return mesh_of(reply_of(worker, [&] { return message(result.output); }), notes);
  } catch (const UnusableReply&) {
    throw;
  } catch (const ForbiddenCall& call) {
    throw ForbiddenCall(file.string() + ": " + call.what());
  } catch (const WorkerDied& died) {
    throw InvalidInput(file.string() + ": not a readable .vtu of tetrahedra: " + died.what());
  } catch (const InvalidInput& error) {
    throw InvalidInput(file.string() + ": " + error.what());
  }
}

}  // namespace chladni::io
