// The keys of [[variation]] and [[support]].
#include "study/schemas.h"
#include "study/tables/rows.h"

namespace chladni::study {
namespace {

using Variation = VariationPlan;

bool has_patch(const TableReader& table) {
  return table.has("at") || table.has("radius") || table.has("relative");
}

/// A row of a patch: it is needed where one of the others is there, and else not shown.
Key<Variation> of_patch(Key<Variation> key) {
  const auto name = key.text.name;
  const auto read = key.read;
  const auto json = key.json;
  if (name != "at") key.text.otherwise = "needed with at";
  key.read = [=](TableReader& table, Variation& plan) {
    table.find(name);  // known, also where no patch is wanted
    if (has_patch(table)) read(table, plan);
  };
  key.json = [=](const Variation& plan) { return plan.at ? json(plan) : std::nullopt; };
  return key;
}

Key<Variation> patch_centre() {
  return {.text = {"at", "two lengths (onto the top along z) or three (the nearest point)", "none",
                   "centre of a patch"},
          .json_name = "at_m",
          .read = [](TableReader& table, Variation& plan) { plan.at = read_place(table, "at"); },
          .json = [](const Variation& plan) { return place_json(*plan.at); }};
}

Key<Variation> patch_change() {
  const std::string name = "relative";
  return {.text = {name, "a number, more than -1", "needed", "change at that centre"},
          .json_name = name,
          .read =
              [=](TableReader& table, Variation& plan) {
                plan.relative = table.required_quantity(name, "1");
                if (plan.relative <= -1.0) {
                  table.wrong(*table.find(name),
                              table.name(name) + " leaves nothing; expected more than -1");
                }
              },
          .json = [](const Variation& plan) { return io::Json(plan.relative); }};
}

Key<Variation> wave(std::size_t number, const std::string& meaning) {
  const std::string name(kVariationWaves.at(number));
  return {.text = {name, expected_quantity("1", Sign::any), "0", meaning},
          .json_name = name,
          .read =
              [=](TableReader& table, Variation& plan) {
                plan.waves.at(number) = table.quantity(name, "1").value_or(0.0);
              },
          .json = [=](const Variation& plan) { return io::Json(plan.waves.at(number)); }};
}

Key<Variation> changed_property() {
  const std::vector<std::string> words = {"stiffness", "thickness"};
  return {.text = {"of", quoted(words), "needed",
                   "what varies; the thickness its cube in the stiffness, itself in the mass"},
          .json_name = "of",
          .read =
              [=](TableReader& table, Variation& plan) {
                if (!table.has("of")) table.missing("of", "\"stiffness\" or \"thickness\"");
                plan.of = table.choice("of", words).value_or(words.front());
              },
          .json = [](const Variation& plan) { return io::Json(plan.of); }};
}

/// The axes along which the nodes of a patch do not move.
struct FixedAxis {
  char letter;
  bool fem::Support::*fixed;
};
constexpr FixedAxis kFixedAxes[] = {
    {'x', &fem::Support::x}, {'y', &fem::Support::y}, {'z', &fem::Support::z}};

void read_fixed(TableReader& table, fem::Support& support) {
  const std::string letters = table.required_text("fixed");
  if (letters.find_first_not_of("xyz") != std::string::npos) {
    table.wrong(*table.find("fixed"), table.name("fixed") + " is \"" + letters +
                                          "\"; expected some of the letters x, y and z");
  }
  for (const auto& axis : kFixedAxes) {
    support.*axis.fixed = letters.find(axis.letter) != std::string::npos;
  }
}

io::Json fixed_json(const fem::Support& support) {
  std::string letters;
  for (const auto& axis : kFixedAxes) {
    if (support.*axis.fixed) letters += axis.letter;
  }
  return letters;
}

}  // namespace

const Schema<VariationPlan>& variation_schema() {
  using P = VariationPlan;
  static const Schema<P> schema = {
      "[variation]",
      {changed_property(), of_patch(patch_centre()),
       of_patch(needed("radius", "m", &P::radius,
                       "of a disc as large as the patch, which ends smoothly")),
       of_patch(patch_change()), wave(0, "wave over the whole body: u, along its longest side"),
       wave(1, "wave over the whole body: v, along its second side"),
       wave(2, "wave over the whole body: (3 u^2 - 1) / 2"),
       wave(3, "wave over the whole body: u v"),
       wave(4, "wave over the whole body: (3 v^2 - 1) / 2")}};
  return schema;
}

const Schema<fem::Support>& support_schema() {
  using P = fem::Support;
  static const Schema<P> schema = {
      "[support]",
      {{.text = {"patch", "a name", "needed", "the faces whose nodes are held"},
        .json_name = "patch",
        .read = [](TableReader& table,
                   P& support) { support.patch = table.required_text("patch"); },
        .json = [](const P& support) { return io::Json(support.patch); }},
       {.text = {"fixed", "some of the letters x, y, z", "needed",
                 "axes along which they do not move"},
        .json_name = "fixed",
        .read = read_fixed,
        .json = fixed_json}}};
  return schema;
}

}  // namespace chladni::study
