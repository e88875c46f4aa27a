#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <system_error>

#include "base/error.h"
#include "fem/given_modes.h"
#include "host/atomic_file.h"
#include "host/descriptor.h"
#include "host/folder.h"
#include "io/csv.h"
#include "io/matrix.h"
#include "mesh/site.h"
#include "show/export.h"
#include "show/readable.h"

namespace chladni::show {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMark = "stiffness.petsc";  // in every export

// A folder under another name until all of it is there.
class NewFolder {
 public:
  // The folder is replaced where it is empty or an earlier export's.
  explicit NewFolder(fs::path folder) : folder_(std::move(folder)), part_(folder_) {
    part_ += ".part";
    std::error_code fault;
    const bool is_ours = !fs::exists(folder_, fault) || fs::exists(folder_ / kMark, fault) ||
                         fs::is_empty(folder_, fault);
    require(is_ours, folder_.string() +
                         ": this folder is not of an earlier export, and is not replaced; give "
                         "another output folder with -o");
    remove_whole(part_);  // of a run that was cut off
    fs::create_directory(part_, fault);
    if (fault) {
      throw_path_error(fault.value(), "cannot make the folder " + part_.string());
    }
  }
  ~NewFolder() { remove_whole(part_); }
  NewFolder(const NewFolder&) = delete;
  NewFolder& operator=(const NewFolder&) = delete;
  NewFolder(NewFolder&&) = delete;
  NewFolder& operator=(NewFolder&&) = delete;

  [[nodiscard]] fs::path operator/(const std::string& name) const { return part_ / name; }
  void move_into_place() {
    fs::path old = folder_;
    old += ".old";
    remove_whole(old);
    if (fs::exists(folder_)) fs::rename(folder_, old);
    fs::rename(part_, folder_);
    remove_whole(old);
  }

 private:
  fs::path folder_, part_;
};

void write_symmetric(const NewFolder& folder, const std::string& name, const SparseMatrix& lower,
                     io::PetscIndex index) {
  io::write_petsc(folder / (name + ".petsc"), lower, index);
  io::write_matrix_market_symmetric(folder / (name + ".mtx"), lower);
}

io::PetscIndex index_of(const fem::System& system) {
  return std::max({io::petsc_index(system.stiffness), io::petsc_index(system.mass),
                   io::petsc_index(system.damping)});
}

// Row i of K and M: its node, counted from 0, or -1 where an attachment added it; its direction.
void write_rows(const fs::path& file, const stage::Solution& solution) {
  const auto& dofs = solution.system->dofs;
  const auto& points = solution.model.body.points;
  const Eigen::Index n = dofs.free_count;
  const Eigen::VectorXi row = Eigen::VectorXi::LinSpaced(n, 0, static_cast<int>(n) - 1);
  Eigen::VectorXi node = Eigen::VectorXi::Constant(n, -1);
  Points at = Points::Constant(n, 3, std::nan(""));
  std::vector<std::string> direction(static_cast<std::size_t>(n), "added");
  for (Eigen::Index i = 0; i < 3 * dofs.node_count; ++i) {
    const auto free = dofs.free_dof(i);
    if (free < 0) continue;
    node(free) = static_cast<int>(i / 3);
    at.row(free) = points.row(i / 3);
    direction[static_cast<std::size_t>(free)] = std::string(1, "xyz"[i % 3]);
  }
  io::write_csv(file, {{"row", row},
                       {"node", node},
                       {"direction", direction},
                       {"x_m", Eigen::VectorXd(at.col(0))},
                       {"y_m", Eigen::VectorXd(at.col(1))},
                       {"z_m", Eigen::VectorXd(at.col(2))}});
}

// A row per channel: the displacement along its direction is row · u.
SparseMatrix rows_of(const std::vector<study::Channel>& channels,
                     const std::vector<mesh::Site>& sites, const fem::DofMap& dofs) {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const auto row = mesh::row_at(sites[i], channels[i].direction, dofs.node_count);
    for (Eigen::SparseVector<double>::InnerIterator entry(row); entry; ++entry) {
      const auto free = dofs.free_dof(entry.index());
      if (free >= 0) entries.emplace_back(static_cast<int>(i), free, entry.value());
    }
  }
  SparseMatrix rows(static_cast<Eigen::Index>(channels.size()), dofs.free_count);
  rows.setFromTriplets(entries.begin(), entries.end());
  return rows;
}

class ChannelTable {
 public:
  void add(const std::string& kind, const std::vector<study::Channel>& channels,
           const std::vector<mesh::Site>& sites) {
    for (std::size_t i = 0; i < channels.size(); ++i) {
      kind_.push_back(kind);
      number_.push_back(fmt::to_string(i + 1));
      name_.push_back(channels[i].name);
      quantity_.push_back(channels[i].quantity);
      for (int axis = 0; axis < 3; ++axis) {
        numbers_[static_cast<std::size_t>(axis)].push_back(sites[i].position(axis));
        numbers_[static_cast<std::size_t>(3 + axis)].push_back(channels[i].direction(axis));
      }
    }
  }
  [[nodiscard]] std::vector<io::CsvColumn> columns() const {
    std::vector<io::CsvColumn> all{
        {"kind", kind_}, {"number", number_}, {"name", name_}, {"quantity", quantity_}};
    constexpr std::array names{"x_m", "y_m", "z_m", "along_x", "along_y", "along_z"};
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto& values = numbers_[i];
      all.push_back({names[i], Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(
                                   values.data(), static_cast<Eigen::Index>(values.size())))});
    }
    return all;
  }

 private:
  std::vector<std::string> kind_, number_, name_, quantity_;
  std::array<std::vector<double>, 6> numbers_;
};

void write_channels(const NewFolder& folder, const study::Study& study,
                    const stage::Solution& solution) {
  const auto& model = solution.model;
  const auto& dofs = solution.system->dofs;
  ChannelTable table;
  table.add("sensor", study.sensors, model.sensors);
  table.add("actuator", study.actuators, model.actuators);
  io::write_csv(folder / "channels.csv", table.columns());
  io::write_matrix_market(folder / "sensors.mtx", rows_of(study.sensors, model.sensors, dofs));
  io::write_matrix_market(
      folder / "actuators.mtx",
      SparseMatrix(rows_of(study.actuators, model.actuators, dofs).transpose()));
}

std::string script(const fem::System& system, int count) {
  return fmt::format(
      R"(#!/usr/bin/env python3
"""The lowest natural frequencies [Hz] of the body in this folder, with SciPy."""
from pathlib import Path

import numpy as np
from scipy.io import mmread
from scipy.sparse.linalg import eigsh

here = Path(__file__).parent
k, m = (mmread(here / name).tocsc() for name in ("stiffness.mtx", "mass.mtx"))
squares = eigsh(k, {}, m, sigma=-{:.6g}, return_eigenvectors=False)  # [s^-2]
print(*np.sqrt(np.maximum(np.sort(squares), 0.0)) / (2.0 * np.pi), sep="\n")
)",
      count + static_cast<int>(system.rigid.cols()), fem::inverted_shift(system));
}

}  // namespace

void leave_system(const study::Study& study, const stage::Solution& solution, Run& run) {
  const auto& system = *solution.system;
  tell(run.progress(), "writing K and M");
  NewFolder folder(run / "system");
  const auto index = index_of(system);
  write_symmetric(folder, "stiffness", system.stiffness, index);
  write_symmetric(folder, "mass", system.mass, index);
  if (system.damping.nonZeros() > 0) write_symmetric(folder, "damping", system.damping, index);
  write_rows(folder / "rows.csv", solution);
  io::write_matrix_market(folder / "rigid.mtx", system.rigid);
  write_channels(folder, study, solution);
  const int most = static_cast<int>(system.mass.rows() - system.rigid.cols()) - 1;
  write_atomically(folder / "solve.py", script(system, std::min(study.modes.count, most)));
  folder.move_into_place();
}

io::JsonObject export_json(const stage::Solution& solution) {
  const auto& system = *solution.system;
  const bool wide = index_of(system) == io::PetscIndex::wide;
  return {{"folder", "system"},
          {"degrees_of_freedom", static_cast<long long>(system.mass.rows())},
          {"nodes", static_cast<long long>(system.dofs.node_count)},
          {"rigid_body_modes", static_cast<long long>(system.rigid.cols())},
          {"stiffness_entries_of_triangle", static_cast<long long>(system.stiffness.nonZeros())},
          {"mass_entries_of_triangle", static_cast<long long>(system.mass.nonZeros())},
          {"has_damping", system.damping.nonZeros() > 0},
          {"petsc_index_bits", wide ? 64 : 32},
          {"shift_s2", fem::inverted_shift(system)}};
}

std::string export_text(const stage::Solution& solution, const Run& run) {
  const auto& system = *solution.system;
  return fmt::format("{} degrees of freedom, {}, {}, {}\n{}\n", system.mass.rows(),
                     how_many(system.rigid.cols(), "rigid-body mode"),
                     how_many(std::ssize(solution.model.sensors), "sensor"),
                     how_many(std::ssize(solution.model.actuators), "actuator"),
                     (run / "system").string());
}

}  // namespace chladni::show
