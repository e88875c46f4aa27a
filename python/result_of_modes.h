// Results of the steps that come after the modes of a study.
#pragma once

#include <functional>
#include <memory>
#include <utility>

#include "python/modes_result.h"

namespace chladni::python {

/// A result that needs the modes of its study.
template <typename Found>
class ResultOfModes : public Result {
 public:
  ResultOfModes(const Subject& subject, Said said, Found found)
      : Result(subject.opened, std::move(said)),
        solution_(subject.solution),
        found_(std::move(found)) {}
  [[nodiscard]] const stage::Solution& solution() const { return *solution_; }
  [[nodiscard]] const Found& found() const { return found_; }

 private:
  std::shared_ptr<const stage::Solution> solution_;
  Found found_;
};

/// Makes the result of a step after the modes, which are solved unless the source has them.
/// @param refuse  throws where the study lacks what the step needs, before minutes of solving
template <typename Made, typename Step>
std::shared_ptr<Made> made_by(const pybind11::object& source, const Asked& asked, Step step,
                              const std::function<void(const study::Study&)>& refuse = {}) {
  auto subject = subject_of(source);
  PythonWork work(subject, asked);
  auto found = work.done([&] {
    if (refuse) refuse(subject.study());
    solve(subject, work);
    return step(subject.study(), *subject.solution, work);
  });
  auto said = work.said();
  return std::make_shared<Made>(subject, std::move(said), std::move(found));
}

}  // namespace chladni::python
