#include "stage/mirrors.h"

#include "base/error.h"

namespace chladni::stage {

std::vector<fem::Mirror> mirrors_of(const Model& model, const fem::System& system,
                                    const std::vector<std::string>& axes) {
  std::vector<fem::Mirror> mirrors;
  for (const auto& axis : axes) {
    try {
      mirrors.push_back(fem::mirror_of(model.body, model.attachments, system, axis.front() - 'x'));
    } catch (const InvalidInput& e) {
      throw InvalidInput("modes.mirrors has \"" + axis + "\", but " + e.what());
    }
  }
  return mirrors;
}

}  // namespace chladni::stage
