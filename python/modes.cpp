// Modes of a study from Python, with its mesh and its matrices.
#include <pybind11/complex.h>
#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <optional>

#include "io/frf_file.h"
#include "python/modes_result.h"
#include "python/rooms.h"
#include "python/values/given.h"
#include "show/report.h"
#include "show/solution.h"
#include "stage/at_channels.h"
#include "stage/points_on_body.h"
#include "steps/control_models.h"
#include "steps/simulated.h"

namespace chladni::python {
namespace {

namespace py = pybind11;
using ModesClass = py::class_<ModesResult, std::shared_ptr<ModesResult>, Result>;

// An array that is the last owner of its numbers.
template <typename Number>
py::array owned(std::shared_ptr<SparseMatrix> matrix, const Number* numbers, Eigen::Index size) {
  auto* owner = new std::shared_ptr<SparseMatrix>(std::move(matrix));
  const py::capsule holder(
      owner, [](void* held) { delete static_cast<std::shared_ptr<SparseMatrix>*>(held); });
  return py::array_t<Number>(size, numbers, holder);
}

// The whole of a matrix of which the lower triangle is stored, in compressed columns: values, rows,
// starts of the columns, size.
py::tuple whole(const SparseMatrix& lower) {
  const auto all = std::make_shared<SparseMatrix>(lower.selfadjointView<Eigen::Lower>());
  all->makeCompressed();
  return py::make_tuple(owned(all, all->valuePtr(), all->nonZeros()),
                        owned(all, all->innerIndexPtr(), all->nonZeros()),
                        owned(all, all->outerIndexPtr(), all->outerSize() + 1), all->rows());
}

std::shared_ptr<ModesResult> modes_of(const py::object& source, const py::object& progress,
                                      std::optional<Seed> seed, bool certificate,
                                      const std::string& engine, double memory_limit_gb) {
  const auto subject = subject_of(source);
  PythonWork work(subject, {progress, seed, certificate, engine, memory_limit_gb});
  auto solution = work.done([&] { return stage::solved(subject.study(), work); });
  return std::make_shared<ModesResult>(subject.opened, work.said(), std::move(solution));
}

Eigen::MatrixXd values_at(const ModesResult& modes, const Given<"points", Points>& points,
                          const std::optional<Given<"direction", Points>>& direction) {
  const LongCall call;
  const auto sites = stage::sites_near(modes.finder(), points.value,
                                       stage::reach_of(modes.solution()->model.body));
  return stage::shapes_at(sites, stage::directions_at(sites, value_of(direction)),
                          modes.solution()->modes);
}

std::shared_ptr<io::FrfFile> responses_of(const ModesResult& modes,
                                          const Given<"frequency_hz", Eigen::VectorXd>& lines,
                                          const py::object& progress) {
  require_lines(lines.value);
  PythonWork work({modes.opened(), modes.solution()}, {.progress = progress});
  auto set = work.done(
      [&] { return steps::simulated_responses(modes.study(), *modes.solution(), lines.value); });
  return std::make_shared<io::FrfFile>(io::FrfFile{"simulation", std::move(set), {}});
}

modal::ControlModel state_space_of(const ModesResult& modes, double sample_rate_hz, int states,
                                   int pade_order, const py::object& progress) {
  PythonWork work({modes.opened(), modes.solution()}, {.progress = progress});
  const auto asked = with_state_space(modes.study(), sample_rate_hz, states, pade_order);
  auto models = work.done([&] { return steps::control_models(asked, *modes.solution()); });
  warn_python(models.notes);
  return sample_rate_hz > 0.0 ? *models.discrete : models.continuous;
}

void add_mesh(py::module_& module) {
  using mesh::TetMesh;
  py::class_<TetMesh>(module, "Mesh", "Tetrahedra that fill a body. Arrays are views.")
      .def_readonly("nodes", &TetMesh::points, "N x 3 [m]")
      .def_readonly("cells", &TetMesh::tets, "T x 4, 10 or 20 rows of nodes, in VTK's order")
      .def_readonly("faces", &TetMesh::faces, "F x 3, 6 or 10: the boundary, outward")
      .def_readonly("region", &TetMesh::region, "T, index into region_names")
      .def_readonly("patch", &TetMesh::face_patch, "F, index into patch_names")
      .def_readonly("region_names", &TetMesh::region_names)
      .def_readonly("patch_names", &TetMesh::patch_names)
      .def_property_readonly("order", &TetMesh::order);
}

void add_arrays(ModesClass& bound) {
  // A view of a member of the solution, which lives as long as the array.
  const auto view = [&bound](const char* name, auto member, const char* text) {
    bound.def_property_readonly(
        name, [member](const ModesResult& one) -> const auto& { return member(*one.solution()); },
        text);
  };
  using stage::Solution;
  view(
      "frequency_hz", [](const Solution& s) -> const auto& { return s.modes.frequency_hz; },
      "m, ascending; rigid-body modes come first with 0");
  view(
      "damping_ratio", [](const Solution& s) -> const auto& { return s.modes.damping_ratio; },
      "m, fraction of critical; 0: not known");
  view(
      "shapes", [](const Solution& s) -> const auto& { return s.modes.shapes; },
      "3 nodes x m [kg^-1/2], rows x0 y0 z0 x1 ..., mass-normalised with extra_shapes");
  view(
      "extra_shapes", [](const Solution& s) -> const auto& { return s.extra_shapes; },
      "what attachments add x m: rows of free_dof after those of shapes");
  view(
      "residual", [](const Solution& s) -> const auto& { return s.summary.residual; },
      "m, relative");
  view(
      "frequency_error", [](const Solution& s) -> const auto& { return s.frequency_error; },
      "m, relative: what the mesh leaves");
  view(
      "free_dof", [](const Solution& s) -> const auto& { return s.system->dofs.free_dof; },
      "for the rows of shapes, then of extra_shapes: row of K and M, or -1 where it is held");
  view(
      "mesh", [](const Solution& s) -> const auto& { return s.model.body; }, "the body");
}

void add_numbers(ModesClass& bound) {
  bound
      .def_property_readonly(
          "rigid_body_modes",
          [](const ModesResult& one) { return one.solution()->modes.rigid_count; })
      .def_property_readonly(
          "complete", [](const ModesResult& one) { return one.solution()->summary.complete; },
          "an inertia count proves that no mode below counted_below_hz is missing")
      .def_property_readonly(
          "counted_below_hz",
          [](const ModesResult& one) { return one.solution()->summary.counted_below_hz; })
      .def_property_readonly("summary",
                             [](const ModesResult& one) { return one.solution()->summary.text; })
      .def_property_readonly(
          "mass_kg", [](const ModesResult& one) { return one.solution()->model.mass.mass_kg; })
      .def_property_readonly(
          "centre_m", [](const ModesResult& one) { return one.solution()->model.mass.centre_m; })
      .def_property_readonly("inertia_kg_m2", [](const ModesResult& one) {
        return one.solution()->model.mass.inertia_kg_m2;
      });
}

}  // namespace

ModesResult::ModesResult(std::shared_ptr<const OpenedStudy> opened, Said said,
                         stage::Solution solution)
    : Result(std::move(opened), std::move(said)),
      solution_(std::make_shared<const stage::Solution>(std::move(solution))),
      finder_(solution_->model.body) {}

std::string ModesResult::text() const { return show::modes_table(*solution_); }
io::JsonObject ModesResult::json() const { return show::modes_json(study(), *solution_); }
void ModesResult::leave(show::Run& run) const { show::leave_modes(study(), *solution_, run); }
std::string ModesResult::page() const { return show::modes_page(study(), *solution_); }

void solve(Subject& subject, stage::Work& work) {
  if (subject.solution) return;
  subject.solution = std::make_shared<const stage::Solution>(stage::solved(subject.study(), work));
}

study::Study with_state_space(study::Study study, double sample_rate_hz, int states,
                              int pade_order) {
  require_not_negative(sample_rate_hz, "sample_rate_hz");
  require_not_negative(states, "states");
  require_not_negative(pade_order, "pade_order");
  auto plan = study.state_space.value_or(study::StateSpacePlan{});
  if (sample_rate_hz > 0.0) plan.sample_rate_hz = sample_rate_hz;
  if (states > 0) plan.states = states;
  if (pade_order > 0) plan.pade_order = pade_order;
  study.state_space = plan;
  return study;
}

void add_modes(py::module_& module) {
  add_mesh(module);
  ModesClass bound(module, "Modes", "Natural frequencies and shapes of a study's body.");
  add_arrays(bound);
  add_numbers(bound);
  bound
      .def("at", &values_at, py::arg("points"), py::arg("direction") = py::none(),
           "n x m [kg^-1/2]: shapes at the places of the surface nearest to points (n x 3 [m], "
           "within 1 mm), along direction (3 or n x 3) or the outward normal.")
      .def("frf", &responses_of, py::arg("frequency_hz"), py::kw_only(),
           py::arg("progress") = py::none(),
           "Responses from the study's actuators to its sensors, each in its quantity, with the "
           "static flexibility of the modes above.")
      .def("state_space", &state_space_of, py::kw_only(), py::arg("sample_rate_hz") = 0.0,
           py::arg("states") = 0, py::arg("pade_order") = 0, py::arg("progress") = py::none(),
           "From the study's actuators to its sensors; discrete with a sample rate. states after "
           "balanced reduction, 0: as [state_space] says, or all.")
      .def("_stiffness",
           [](const ModesResult& one) { return whole(one.solution()->system->stiffness); })
      .def("_mass", [](const ModesResult& one) { return whole(one.solution()->system->mass); })
      .def("_damping", [](const ModesResult& one) -> py::object {
        const auto& damping = one.solution()->system->damping;
        if (damping.nonZeros() == 0) return py::none();
        return whole(damping);
      });
  module.def("modes", &modes_of, py::arg("study"), py::kw_only(), py::arg("progress") = py::none(),
             py::arg("seed") = py::none(), py::arg("certificate") = true, py::arg("engine") = "",
             py::arg("memory_limit_gb") = 0.0,
             "Natural frequencies and shapes. study: a Study, a file or a dict.");
}

}  // namespace chladni::python
