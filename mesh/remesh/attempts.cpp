#include "mesh/remesh/attempts.h"

#include <algorithm>
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

// Whether the second attempt is the better one, where the first is not good enough.
bool is_better(const Attempt& second, const Attempt& first, double good_enough) {
  constexpr double kNearly = 1.25;  // between angles that count as the same
  if (!first.mesh || !second.mesh) return second.mesh.has_value();
  const double before = first.angle();
  const double now = second.angle();
  if (now >= good_enough) return true;
  if (std::max(now, before) > kNearly * std::min(now, before)) return now > before;
  return second.mesh->tet_count() < first.mesh->tet_count();
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
  return *std::move(is_better(other, attempt, good_enough) ? other.mesh : attempt.mesh);
}

}  // namespace chladni::mesh
