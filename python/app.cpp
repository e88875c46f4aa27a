// Studies from Python.
#include <fmt/format.h>
#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <optional>
#include <sstream>

#include "base/error.h"
#include "mesh/site.h"
#include "python/long_call.h"
#include "python/rooms.h"
#include "show/identification.h"
#include "show/interpolation.h"
#include "steps/interpolation.h"

namespace chladni::python {
namespace {

namespace py = pybind11;

constexpr double kOnTheBody = 1e-3;  // [m]

// The interpolated shapes of a study, with the solution that they are based on.
class StudyField {
 public:
  StudyField(stage::Solution solution, steps::Interpolated result)
      : solution_(std::move(solution)), result_(std::move(result)), finder_(solution_.model.body) {}
  StudyField(const StudyField&) = delete;
  StudyField& operator=(const StudyField&) = delete;

  // Mean and deviation at the points of the surface nearest to `points`, n×3.
  py::tuple at(const Points& points, const std::optional<Eigen::Vector3d>& direction,
               const std::string& method) const {
    auto found = [&] {
      const LongCall call;
      return values_at(points, direction, method);
    }();
    return py::make_tuple(std::move(found.first), std::move(found.second));
  }

  [[nodiscard]] const Eigen::VectorXd& frequency_hz() const {
    return result_.measured.shapes.frequency_hz;
  }
  [[nodiscard]] std::vector<std::string> methods() const {
    std::vector<std::string> names;
    for (const auto& one : result_.methods) names.emplace_back(one.method->name);
    return names;
  }
  [[nodiscard]] std::string text() const { return show::interpolation_table(result_); }

 private:
  [[nodiscard]] std::pair<Eigen::MatrixXd, Eigen::MatrixXd> values_at(
      const Points& points, const std::optional<Eigen::Vector3d>& direction,
      const std::string& method) const {
    std::vector<mesh::Site> sites;
    Points directions(points.rows(), 3);
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
      sites.push_back(site_near(points.row(i).transpose(), i));
      directions.row(i) = direction.value_or(sites.back().normal).transpose();
    }
    const auto places = steps::places_at(sites, directions, solution_.modes, result_.harmonics);
    auto [mean, deviation] = method_called(method).field->at(places);
    return {std::move(mean), std::move(deviation)};
  }

  // The site nearest to a point. A point more than 1 mm off the body is refused, as for the places
  // of a study.
  [[nodiscard]] mesh::Site site_near(const Eigen::Vector3d& point, Eigen::Index row) const {
    const auto site = finder_.nearest(point);
    const double off = (site.position - point).norm();
    const auto in_mm = [](const Eigen::Vector3d& at) {
      return fmt::format("({:.6g}, {:.6g}, {:.6g}) mm", 1e3 * at.x(), 1e3 * at.y(), 1e3 * at.z());
    };
    require(off <= kOnTheBody,
            fmt::format("point {} at {} is {:.4g} mm off the surface of the body; nearest is {}",
                        row, in_mm(point), 1e3 * off, in_mm(site.position)));
    return site;
  }

  [[nodiscard]] const steps::Interpolation& method_called(const std::string& name) const {
    if (name.empty()) return result_.methods.front();
    const auto found =
        std::find_if(result_.methods.begin(), result_.methods.end(),
                     [&](const steps::Interpolation& one) { return name == one.method->name; });
    require(found != result_.methods.end(),
            "the study was not interpolated by \"" + name + "\"; interpolation.methods names how");
    return *found;
  }

  stage::Solution solution_;
  steps::Interpolated result_;
  mesh::SiteFinder finder_;
};

std::unique_ptr<StudyField> interpolate(const std::filesystem::path& file,
                                        const std::filesystem::path& folder) {
  const LongCall call;
  const auto study = study::read_study(file);
  show::Options options;
  options.folder = folder;
  options.pictures = false;
  std::ostringstream results;
  std::ostringstream said;
  show::Talk talk(said, {.quiet = true});
  show::Run run(study, options, results, talk);
  auto solution = stage::solved(study, run);
  auto result = steps::interpolated(study, solution, run, show::shown_and_left(study, run));
  show::leave_interpolation(study, solution, result, run, true);
  return std::make_unique<StudyField>(std::move(solution), std::move(result));
}

}  // namespace

void add_app(py::module_& module) {
  py::class_<StudyField>(module, "StudyField", "mode shapes on the body of a study")
      .def(
          "at", &StudyField::at, py::arg("points"), py::arg("direction") = py::none(),
          py::arg("method") = "",
          "Mean and standard deviation, each n x m, at the places of the surface nearest to points "
          "(n x 3 [m], within 1 mm), along direction or the outward normal.")
      .def_property_readonly("frequency_hz", &StudyField::frequency_hz)
      .def_property_readonly("methods", &StudyField::methods)
      .def("__str__", &StudyField::text);
  module.def("interpolate", &interpolate, py::arg("study"), py::arg("folder") = "",
             "chladni interpolate STUDY: leaves its files in folder (default out/<study name>) and "
             "gives the shapes.");
}

}  // namespace chladni::python
