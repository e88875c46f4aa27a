#include "stage/at_channels.h"

#include <fmt/format.h>

#include "base/error.h"
#include "fem/reduced.h"

namespace chladni::stage {
namespace {

using Rows = std::vector<Eigen::SparseVector<double>>;

void add_rows(const fem::DofMap& dofs, const std::vector<study::Channel>& channels,
              const std::vector<mesh::Site>& sites, Rows& rows) {
  for (std::size_t i = 0; i < channels.size(); ++i) {
    rows.push_back(mesh::row_at(sites[i], channels[i].direction, dofs.node_count));
  }
}

SparseMatrix columns_of(const fem::DofMap& dofs, const std::vector<study::Channel>& channels,
                        const std::vector<mesh::Site>& sites) {
  Rows rows;
  add_rows(dofs, channels, sites, rows);
  return fem::columns_on_free(dofs, rows);
}

// The first modes on the free degrees of freedom.
modal::Modes on_free(const fem::DofMap& dofs, const Solution& solution, Eigen::Index count) {
  const auto& all = solution.modes;
  modal::Modes modes{all.frequency_hz.head(count), all.damping_ratio.head(count),
                     Eigen::MatrixXd(dofs.free_count, count), std::min(all.rigid_count, count)};
  for (Eigen::Index i = 0; i < dofs.free_dof.size(); ++i) {
    const auto free = dofs.free_dof(i);
    if (free < 0) continue;
    const Eigen::Index extra = i - all.dof_count();
    if (extra < 0) {
      modes.shapes.row(free) = all.shapes.row(i).head(count);
    } else {
      modes.shapes.row(free) = solution.extra_shapes.row(extra).head(count);
    }
  }
  return modes;
}

}  // namespace

modal::ReducedModel at_channels(const study::Study& study, const Solution& solution,
                                Eigen::Index mode_count) {
  const auto& model = solution.model;
  const Eigen::Index count = mode_count > 0 ? mode_count : solution.modes.mode_count();
  require(count <= solution.modes.mode_count(),
          fmt::format("{} modes are wanted at the channels and the solution has {}", count,
                      solution.modes.mode_count()));
  const auto& system = *solution.system;
  return fem::reduced(system, on_free(system.dofs, solution, count),
                      columns_of(system.dofs, study.sensors, model.sensors),
                      columns_of(system.dofs, study.actuators, model.actuators));
}

modal::ReducedModel at_channels_and_drives(const study::Study& study, const Solution& solution) {
  const auto& model = solution.model;
  const auto& system = *solution.system;
  Rows rows;
  add_rows(system.dofs, study.sensors, model.sensors, rows);
  add_rows(system.dofs, study.actuators, model.actuators, rows);
  return fem::reduced(system, on_free(system.dofs, solution, solution.modes.mode_count()),
                      fem::columns_on_free(system.dofs, rows),
                      columns_of(system.dofs, study.actuators, model.actuators));
}

}  // namespace chladni::stage
