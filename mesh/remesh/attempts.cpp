#include "mesh/remesh/attempts.h"

#include <exception>
#include <optional>
#include <utility>

#include "base/error.h"

namespace chladni::mesh {
namespace {

struct Attempt {
  std::optional<TetMesh> mesh;
  std::exception_ptr failure;  // the reason where there is no mesh
  std::string death;           // the same where a worker died

  [[nodiscard]] double angle() const {
    return mesh ? quality(*mesh).smallest_dihedral_degrees : -1.0;
  }
};

// Where memory lacks, the other attempt would need as much.
Attempt attempted(const std::function<TetMesh()>& way) {
  try {
    return {way(), nullptr, ""};
  } catch (const WorkerDied& death) {
    return {std::nullopt, std::current_exception(), death.what()};
  } catch (const NumericalFailure&) {
    return {std::nullopt, std::current_exception(), ""};
  } catch (const InvalidInput&) {  // an inverted cell
    return {std::nullopt, std::current_exception(), ""};
  }
}

}  // namespace

TetMesh better_mesh(const std::function<TetMesh()>& first, const std::function<TetMesh()>& second,
                    double good_enough, const std::function<void(const std::string&)>& on_death) {
  auto attempt = attempted(first);
  if (attempt.mesh && attempt.angle() >= good_enough) return *std::move(attempt.mesh);
  auto other = attempted(second);
  if (!attempt.mesh && !other.mesh) std::rethrow_exception(other.failure);
  for (const auto& death : {attempt.death, other.death}) {
    if (on_death && !death.empty()) on_death(death);
  }
  return *std::move(attempt.angle() >= other.angle() ? attempt.mesh : other.mesh);
}

}  // namespace chladni::mesh
