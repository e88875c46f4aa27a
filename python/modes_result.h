// The modes of a study as Python holds them.
#pragma once

#include "mesh/site.h"
#include "python/result.h"

namespace chladni::python {

class ModesResult : public Result {
 public:
  ModesResult(std::shared_ptr<const OpenedStudy> opened, Said said, stage::Solution solution);

  [[nodiscard]] std::string text() const override;
  [[nodiscard]] io::JsonObject json() const override;
  void leave(show::Run& run) const override;
  [[nodiscard]] std::string page() const override;

  [[nodiscard]] const std::shared_ptr<const stage::Solution>& solution() const { return solution_; }
  [[nodiscard]] const mesh::SiteFinder& finder() const { return finder_; }

 private:
  std::shared_ptr<const stage::Solution> solution_;
  mesh::SiteFinder finder_;
};

/// Solves the study of a subject that is not solved yet.
void solve(Subject& subject, stage::Work& work);

}  // namespace chladni::python
