// `on` and `direction` of a study: faces of the body, and the direction of motion there.
#include "study/tables/tables.h"

namespace chladni::study {

FacePlan read_faces(TableReader& table, std::string_view key) {
  FacePlan on;
  const TomlNode* node = table.find(key);
  if (node == nullptr) return on;
  on.line = node->line;
  on.column = node->column;
  if (node->kind == TomlNode::Kind::table) {
    auto inner = table.table(key);
    if (!inner->has("facing")) inner->missing("facing", "a direction such as \"z\" or \"-x\"");
    on.facing = inner->direction("facing");
    inner->refuse_unknown();
    return on;
  }
  if (node->kind != TomlNode::Kind::array) {
    table.wrong(*node, table.name(key) + " is " + description(*node) +
                           "; expected names of patches, [\"top\"], or { facing = \"z\" }");
    return on;
  }
  on.patches = table.texts(key);
  return on;
}

io::Json faces_json(const FacePlan& on) {
  if (on.facing) return io::JsonObject{{"facing", io::Json(*on.facing)}};
  return io::Json::texts(on.patches);
}

void read_motion(TableReader& table, std::optional<Eigen::Vector3d>& direction,
                 bool& along_normal) {
  const TomlNode* node = table.find("direction");
  if (node == nullptr) return;
  along_normal = node->kind == TomlNode::Kind::text && node->text == "normal";
  if (!along_normal) direction = table.direction("direction");
}

io::Json motion_json(const std::optional<Eigen::Vector3d>& direction) {
  return direction ? io::Json(*direction) : io::Json("normal");
}

}  // namespace chladni::study
